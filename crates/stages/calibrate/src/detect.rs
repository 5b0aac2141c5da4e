//! Corners of boards in pictures, found by OpenCV.

use crate::Board;
use crate::board::Dictionary;
use nalgebra::Point2;
use opencv::aruco;
use opencv::boxed_ref::BoxedRef;
use opencv::calib3d::{
    CALIB_CB_ADAPTIVE_THRESH, CALIB_CB_FAST_CHECK, CALIB_CB_NORMALIZE_IMAGE, find_chessboard_corners,
};
use opencv::core::{Mat, Point2f, Ptr, Size, TermCriteria, TermCriteria_Type, Vector, no_array};
use opencv::imgproc::{INTER_AREA, corner_sub_pix, resize};
use opencv::prelude::{MatTraitConst, VectorToVec};
use std::collections::BTreeMap;

/// OpenCV could not do its work.
#[derive(Debug, thiserror::Error)]
#[error("OpenCV: {0}")]
pub struct DetectError(#[from] opencv::Error);

/// A grey picture of 8 bits, row after row from the top.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    /// Width, height, px.
    pub size: [u32; 2],
    /// Its pixels.
    pub gray: &'a [u8],
}

/// Corners by number.
type Found = BTreeMap<u32, Point2<f64>>;

/// The board's corners in a picture, by number; none where it is not seen. Of a chessboard all corners or none; of a ChArUco
/// board as many as there are markers around to name them. Pixel (0, 0) is the centre of the top-left pixel.
///
/// Chessboards by their squares; then, as for ChArUco boards, each corner to where the gradients around it meet
/// (`cornerSubPix`). A picture that shows no board at a glance is left at that: what looks longer takes seconds.
///
/// # Errors
/// If the picture is empty, or OpenCV refuses.
pub fn find_corners(picture: Picture, board: &Board) -> Result<Found, DetectError> {
    // One picture per thread is enough, and the same for any number of threads.
    opencv::core::set_num_threads(1)?;
    let [width, height] = picture.size.map(|side| side as i32);
    let image = Mat::new_rows_cols_with_data(height, width, picture.gray)?;
    match *board {
        Board::Chessboard { columns, rows, .. } => chessboard(&image, columns, rows),
        Board::Charuco { columns, rows, square_mm, marker_mm, dictionary } => {
            let markers = aruco::get_predefined_dictionary_i32(dictionary.opencv())?;
            let (square, marker) = (square_mm as f32, marker_mm as f32);
            let board = aruco::CharucoBoard::create(columns as i32, rows as i32, square, marker, &markers)?;
            charuco(&image, &board, &markers)
        }
    }
}

type Image<'a> = BoxedRef<'a, Mat>;

/// Larger pictures are searched at a fraction of their size: a search for squares can take minutes on a large one.
const SEARCH_PX: i32 = 1000;

fn chessboard(image: &Image, columns: u32, rows: u32) -> Result<Found, DetectError> {
    let size = Size::new(columns as i32, rows as i32);
    let mut corners = Vector::<Point2f>::new();
    let side = image.cols().max(image.rows());
    // Rounded up.
    let shrink = (side + SEARCH_PX - 1) / SEARCH_PX;
    let mut small = Mat::default();
    resize(image, &mut small, Size::new(image.cols() / shrink, image.rows() / shrink), 0.0, 0.0, INTER_AREA)?;
    let by_squares = CALIB_CB_ADAPTIVE_THRESH | CALIB_CB_NORMALIZE_IMAGE | CALIB_CB_FAST_CHECK;
    if !find_chessboard_corners(&small, size, &mut corners, by_squares)? {
        return Ok(Found::new());
    }
    let scale = [image.cols() as f32 / small.cols() as f32, image.rows() as f32 / small.rows() as f32];
    let grown = |at: Point2f| Point2f::new((at.x + 0.5) * scale[0] - 0.5, (at.y + 0.5) * scale[1] - 0.5);
    corners = corners.iter().map(grown).collect();
    refine(image, &mut corners, columns as usize)?;
    Ok((0..).zip(&corners).map(|(id, at)| (id, point(at))).collect())
}

fn charuco(
    image: &Image,
    board: &Ptr<aruco::CharucoBoard>,
    markers: &Ptr<aruco::Dictionary>,
) -> Result<Found, DetectError> {
    let mut parameters = aruco::DetectorParameters::create()?;
    sharpen(&mut parameters);
    let (mut outlines, mut rejected) = (Vector::<Vector<Point2f>>::new(), Vector::<Vector<Point2f>>::new());
    let mut ids = Vector::<i32>::new();
    aruco::detect_markers(image, markers, &mut outlines, &mut ids, &parameters, &mut rejected)?;
    if ids.is_empty() {
        return Ok(Found::new());
    }
    let (mut corners, mut numbers) = (Vector::<Point2f>::new(), Vector::<i32>::new());
    let fewest = 2;
    aruco::interpolate_corners_charuco(
        &outlines,
        &ids,
        image,
        board,
        &mut corners,
        &mut numbers,
        &no_array(),
        &no_array(),
        fewest,
    )?;
    Ok(numbers.iter().zip(&corners).map(|(id, at)| (id as u32, point(at))).collect())
}

/// Cells of a few blurred pixels are misread when they are resampled to the 4 px of OpenCV's default. Boards that are printed
/// white on black are boards too.
fn sharpen(parameters: &mut Ptr<aruco::DetectorParameters>) {
    use aruco::DetectorParametersTrait;
    parameters.set_detect_inverted_marker(true);
    parameters.set_perspective_remove_pixel_per_cell(8);
    parameters.set_perspective_remove_ignored_margin_per_cell(0.3);
}

/// Share of the distance to the nearest neighbour that the window around a corner reaches.
const WINDOW_SHARE: f32 = 0.4;
/// Reach of the window, px: fewer pixels are all noise, more only cost time.
const WINDOW_PX: std::ops::RangeInclusive<i32> = 2..=8;

fn refine(image: &Image, corners: &mut Vector<Point2f>, columns: usize) -> Result<(), DetectError> {
    let all = corners.to_vec();
    let apart = |(i, at): (usize, &Point2f)| {
        let right = (i % columns + 1 < columns).then(|| i + 1);
        let below = (i + columns < all.len()).then_some(i + columns);
        let distance = |j: usize| (all[j].x - at.x).hypot(all[j].y - at.y);
        right.into_iter().chain(below).map(distance).fold(f32::INFINITY, f32::min)
    };
    let nearest = all.iter().enumerate().map(apart).fold(f32::INFINITY, f32::min);
    let reach = ((WINDOW_SHARE * nearest) as i32).clamp(*WINDOW_PX.start(), *WINDOW_PX.end());
    let (steps, enough) = (100, 1e-4);
    let kind = TermCriteria_Type::COUNT as i32 + TermCriteria_Type::EPS as i32;
    let stop = TermCriteria::new(kind, steps, enough)?;
    corner_sub_pix(image, corners, Size::new(reach, reach), Size::new(-1, -1), stop)?;
    Ok(())
}

fn point(at: Point2f) -> Point2<f64> {
    Point2::new(f64::from(at.x), f64::from(at.y))
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
