//! ChArUco boards: markers name the corners between them [GarridoJurado2014].

use super::symmetry::{Seed, refine};
use super::{DetectError, Found, Image, point};
use crate::Board;
use crate::board::Dictionary;
use crate::planar::homography;
use nalgebra::{Point2, Vector2};
use opencv::aruco;
use opencv::boxed_ref::BoxedRef;
use opencv::calib3d::{RANSAC, find_homography};
use opencv::core::{Mat, Point2f, Point3f, Ptr, Vector, flip};
use opencv::prelude::{
    BoardTraitConst, CharucoBoardTraitConst, DictionaryTraitConst, MatTraitConst, VectorToVec,
};

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
    let dictionary = aruco::get_predefined_dictionary_i32(dictionary.opencv())?;
    let (square, marker) = (square_mm as f32, marker_mm as f32);
    let pattern = aruco::CharucoBoard::create(columns as i32, rows as i32, square, marker, &dictionary)?;
    let markers = Markers::find(image, &pattern, &dictionary)?;
    // As far as the black rims of the markers reach: the cells within are not alike.
    let rim = marker_mm / f64::from(dictionary.marker_size() + 2);
    let reach = (0.5 * (square_mm - marker_mm) + rim) / square_mm;
    let mut found = Found::new();
    for (id, corner) in (0..).zip(&pattern.chessboard_corners()) {
        let Some(seed) = markers.seed(on_board_mm(corner), square_mm) else { continue };
        let corner = refine(image, &seed, reach)?;
        if let Some(corner) = corner.filter(|corner| corner.likeness > LIKENESS && corner.checker > CHECKER) {
            found.insert(id, corner.at.into());
        }
    }
    Ok(found)
}

/// Least likeness of a corner's surroundings turned by half a turn.
const LIKENESS: f64 = 0.8;
/// Least share of black and white that lies as where squares meet; the markers' rims take some of it.
const CHECKER: f64 = 0.3;

fn on_board_mm(point: Point3f) -> Point2<f64> {
    Point2::new(f64::from(point.x), f64::from(point.y))
}

/// A marker's corners: on the board, mm, and in the image, px.
type Marker = [(Point2<f64>, Point2<f64>); 4];

/// The markers that were found and lie as on the board.
struct Markers(Vec<Marker>);

/// Fewer markers may be none: what looks like one is found in many a picture.
const AGREEING: usize = 2;
/// How far a marker may lie from where most others say, squares: lenses bend boards, but not so far.
const ASTRAY: f64 = 0.5;
/// A corner's place is said by so many markers, the nearest.
const SAYING: usize = 4;
/// The nearest is not farther than this, squares.
const NEAR: f64 = 2.5;

impl Markers {
    fn find(
        image: &Image,
        pattern: &Ptr<aruco::CharucoBoard>,
        dictionary: &Ptr<aruco::Dictionary>,
    ) -> Result<Self, DetectError> {
        let mut parameters = aruco::DetectorParameters::create()?;
        sharpen(&mut parameters);
        let (mut outlines, mut rejected) =
            (Vector::<Vector<Point2f>>::new(), Vector::<Vector<Point2f>>::new());
        let mut ids = Vector::<i32>::new();
        aruco::detect_markers(image, dictionary, &mut outlines, &mut ids, &parameters, &mut rejected)?;
        let (places, known) = (pattern.obj_points(), pattern.ids());
        let marker = |(id, outline): (i32, Vector<Point2f>)| {
            let place = places.get(known.iter().position(|known| known == id)?).ok()?;
            let pairs = place.iter().zip(&outline).map(|(on_board, at)| (on_board_mm(on_board), point(at)));
            pairs.collect::<Vec<_>>().try_into().ok()
        };
        let found = Self(ids.iter().zip(&outlines).filter_map(marker).collect());
        found.without_strays(f64::from(pattern.get_square_length()?))
    }

    /// Those about which most agree.
    fn without_strays(self, square_mm: f64) -> Result<Self, DetectError> {
        if self.0.len() < AGREEING {
            return Ok(Self(Vec::new()));
        }
        let float = |at: Point2<f64>| Point2f::new(at.x as f32, at.y as f32);
        let from: Vector<Point2f> = self.0.iter().flatten().map(|(_, at)| float(*at)).collect();
        let to: Vector<Point2f> = self.0.iter().flatten().map(|(on_board, _)| float(*on_board)).collect();
        let mut fits = Vector::<u8>::new();
        find_homography(&from, &to, &mut fits, RANSAC, ASTRAY * square_mm)?;
        let fits = fits.to_vec();
        let pairs = self.0.into_iter().zip(fits.chunks(4));
        let fitting = pairs.filter(|(_, fits)| fits.iter().all(|fit| *fit != 0));
        let kept: Vec<Marker> = fitting.map(|(marker, _)| marker).collect();
        Ok(Self(if kept.len() < AGREEING { Vec::new() } else { kept }))
    }

    /// Where the markers around a corner say that it is; none where there are none.
    fn seed(&self, corner: Point2<f64>, square_mm: f64) -> Option<Seed> {
        let distance = |marker: &Marker| (nalgebra::center(&marker[0].0, &marker[2].0) - corner).norm();
        let mut near: Vec<(f64, &Marker)> = self.0.iter().map(|marker| (distance(marker), marker)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        near.truncate(SAYING);
        near.first().filter(|(distance, _)| *distance < NEAR * square_mm)?;
        let (on_board, at): (Vec<_>, Vec<_>) = near.into_iter().flat_map(|(_, marker)| *marker).unzip();
        let map = homography(&on_board, &at)?;
        let place = |x: f64, y: f64| {
            let away = Vector2::new(x, y) * square_mm;
            Some(Point2::from_homogeneous(map * (corner + away).to_homogeneous())?.coords)
        };
        let axes = [place(0.5, 0.0)? - place(-0.5, 0.0)?, place(0.0, 0.5)? - place(0.0, -0.5)?];
        Some(Seed { at: place(0.0, 0.0)?, axes })
    }
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
