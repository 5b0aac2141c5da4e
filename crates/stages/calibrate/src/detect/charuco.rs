//! ChArUco boards: markers name the corners between them [GarridoJurado2014].

use super::refine::refine;
use super::{DetectError, Found, Image, point};
use crate::Board;
use crate::board::Dictionary;
use nalgebra::Point2;
use opencv::aruco;
use opencv::boxed_ref::BoxedRef;
use opencv::core::{Mat, Point2f, Ptr, Vector, flip, no_array};
use opencv::prelude::{MatTraitConst, VectorToVec};

/// The corners of a board with markers, by number; none of any other board. Of one that is seen through its back, the
/// picture or its mirror image tells more of them.
pub(super) fn find(image: &Image, board: &Board) -> Result<Found, DetectError> {
    let front = find_from_front(image, board)?;
    let Board::Charuco { see_through: true, .. } = board else { return Ok(front) };
    let mut mirrored = Mat::default();
    let about_y = 1;
    flip(image, &mut mirrored, about_y)?;
    let back = find_from_front(&BoxedRef::from(mirrored), board)?;
    let last = f64::from(image.cols() - 1);
    let turned = |(id, at): (u32, Point2<f64>)| (id, Point2::new(last - at.x, at.y));
    Ok(if back.len() > front.len() { back.into_iter().map(turned).collect() } else { front })
}

fn find_from_front(image: &Image, board: &Board) -> Result<Found, DetectError> {
    let &Board::Charuco { columns, rows, square_mm, marker_mm, dictionary, .. } = board else {
        return Ok(Found::new());
    };
    let markers = aruco::get_predefined_dictionary_i32(dictionary.opencv())?;
    let (square, marker) = (square_mm as f32, marker_mm as f32);
    let board = aruco::CharucoBoard::create(columns as i32, rows as i32, square, marker, &markers)?;
    let mut parameters = aruco::DetectorParameters::create()?;
    sharpen(&mut parameters);
    let (mut outlines, mut rejected) = (Vector::<Vector<Point2f>>::new(), Vector::<Vector<Point2f>>::new());
    let mut ids = Vector::<i32>::new();
    aruco::detect_markers(image, &markers, &mut outlines, &mut ids, &parameters, &mut rejected)?;
    if ids.is_empty() {
        return Ok(Found::new());
    }
    let (mut corners, mut numbers) = (Vector::<Point2f>::new(), Vector::<i32>::new());
    let fewest = 2;
    aruco::interpolate_corners_charuco(
        &outlines,
        &ids,
        image,
        &board,
        &mut corners,
        &mut numbers,
        &no_array(),
        &no_array(),
        fewest,
    )?;
    // What is interpolated between outlines of markers is half a pixel off. The window ends where the markers begin.
    let corners = refine(image, &corners.to_vec(), 0.5 * (1.0 - marker / square))?;
    Ok(numbers.iter().zip(corners).map(|(id, at)| (id as u32, point(at))).collect())
}

/// Cells of a few blurred pixels are misread when they are resampled to the 4 px of OpenCV's default. Boards that are printed
/// white on black are boards too.
fn sharpen(parameters: &mut Ptr<aruco::DetectorParameters>) {
    use aruco::DetectorParametersTrait;
    parameters.set_detect_inverted_marker(true);
    parameters.set_perspective_remove_pixel_per_cell(8);
    parameters.set_perspective_remove_ignored_margin_per_cell(0.3);
}

impl Dictionary {
    fn opencv(self) -> i32 {
        match self {
            Self::FourByFour50 => aruco::DICT_4X4_50,
            Self::FourByFour100 => aruco::DICT_4X4_100,
            Self::FourByFour250 => aruco::DICT_4X4_250,
            Self::FourByFour1000 => aruco::DICT_4X4_1000,
            Self::FiveByFive50 => aruco::DICT_5X5_50,
            Self::FiveByFive100 => aruco::DICT_5X5_100,
            Self::FiveByFive250 => aruco::DICT_5X5_250,
            Self::FiveByFive1000 => aruco::DICT_5X5_1000,
            Self::SixBySix50 => aruco::DICT_6X6_50,
            Self::SixBySix100 => aruco::DICT_6X6_100,
            Self::SixBySix250 => aruco::DICT_6X6_250,
            Self::SixBySix1000 => aruco::DICT_6X6_1000,
        }
    }
}
