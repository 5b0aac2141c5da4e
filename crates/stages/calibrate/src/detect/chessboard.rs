//! Chessboards.

use super::level::Level;
use super::refine::{OF_SQUARES, nearest, refine};
use super::saddles::saddles;
use super::{DetectError, Found, Image, point};
use opencv::calib3d::{
    CALIB_CB_ADAPTIVE_THRESH, CALIB_CB_EXHAUSTIVE, CALIB_CB_FAST_CHECK, CALIB_CB_NORMALIZE_IMAGE,
    find_chessboard_corners, find_chessboard_corners_sb,
};
use opencv::core::{Mat, Point2f, Size, Vector};
use opencv::imgproc::{INTER_AREA, resize};
use opencv::prelude::{MatTraitConst, VectorToVec};

/// Larger pictures are searched at a fraction of their size: a search for squares can take minutes on a large one.
const SEARCH_PX: i32 = 1000;
/// What may be hidden of a board that is looked for longer, by glare or because two saddles are one: a share of its corners.
const HIDDEN: f64 = 0.2;

/// All corners of a chessboard, or none.
pub(super) fn find(image: &Image, columns: usize, rows: usize) -> Result<Found, DetectError> {
    let small = shrunken(image)?;
    let size = Size::new(columns as i32, rows as i32);
    let corners = match at_a_glance(&small, size)? {
        Some(corners) => {
            let scale =
                [image.cols() as f32 / small.cols() as f32, image.rows() as f32 / small.rows() as f32];
            let grown =
                |at: Point2f| Point2f::new((at.x + 0.5) * scale[0] - 0.5, (at.y + 0.5) * scale[1] - 0.5);
            refine(image, &corners.into_iter().map(grown).collect::<Vec<_>>(), OF_SQUARES)?
        }
        None => laid_level(image, &small, size)?,
    };
    let is_board = corners.iter().all(|at| is_inside(image, at)) && is_even(&corners, columns);
    let corners = if is_board { corners } else { Vec::new() };
    Ok((0..).zip(corners).map(|(id, at)| (id, point(at))).collect())
}

/// Corners this near the image's edge, px, are what lies beyond as much as what is seen.
const EDGE_PX: f32 = 1.0;

fn is_inside(image: &Image, at: &Point2f) -> bool {
    let inside = |at: f32, side: i32| (EDGE_PX..=side as f32 - 1.0 - EDGE_PX).contains(&at);
    inside(at.x, image.cols()) && inside(at.y, image.rows())
}

/// Share of the way between its neighbours that a corner may be off their middle: perspective and lens move it less.
const UNEVEN: f32 = 0.05;
/// ... and px.
const UNEVEN_PX: f32 = 0.3;

/// Whether each corner lies about midway between its neighbours in its row, and in its column.
fn is_even(corners: &[Point2f], columns: usize) -> bool {
    let is_midway = |[a, b, c]: [Point2f; 3]| {
        let (bend, way) = (a + c - b - b, c - a);
        0.5 * bend.x.hypot(bend.y) <= UNEVEN * way.x.hypot(way.y) + UNEVEN_PX
    };
    let row = |i: usize| (i % columns + 2 < columns).then(|| [i, i + 1, i + 2]);
    let column = |i: usize| (i + 2 * columns < corners.len()).then(|| [i, i + columns, i + 2 * columns]);
    (0..corners.len())
        .flat_map(|i| [row(i), column(i)].into_iter().flatten())
        .all(|triple| is_midway(triple.map(|i| corners[i])))
}

fn shrunken(image: &Image) -> Result<Mat, DetectError> {
    let side = image.cols().max(image.rows());
    // Rounded up.
    let shrink = (side + SEARCH_PX - 1) / SEARCH_PX;
    let mut small = Mat::default();
    let size = Size::new(image.cols() / shrink, image.rows() / shrink);
    resize(image, &mut small, size, 0.0, 0.0, INTER_AREA)?;
    Ok(small)
}

/// By the squares' outlines; tells at once whether there are any. Without that check a search that fails takes ten seconds.
fn at_a_glance(image: &Mat, size: Size) -> Result<Option<Vec<Point2f>>, DetectError> {
    let mut corners = Vector::<Point2f>::new();
    let by_squares = CALIB_CB_ADAPTIVE_THRESH | CALIB_CB_NORMALIZE_IMAGE | CALIB_CB_FAST_CHECK;
    let found = find_chessboard_corners(image, size, &mut corners, by_squares)?;
    Ok(found.then(|| corners.to_vec()))
}

/// By the corners themselves [DudaFrese2018], in a picture in which they spread alike to all sides: a board that leans is a grid
/// of slivers in the image, but of nearly square fields there, and the picture's edge does not cut it.
fn laid_level(image: &Image, small: &Mat, size: Size) -> Result<Vec<Point2f>, DetectError> {
    let (count, columns) = ((size.width * size.height) as usize, size.width as usize);
    let saddles = saddles(small, count)?;
    if (saddles.len() as f64) < (1.0 - HIDDEN) * count as f64 {
        return Ok(Vec::new());
    }
    let scale = f64::from(image.cols()) / f64::from(small.cols());
    let places: Vec<_> = saddles.iter().map(|saddle| saddle.at.map(|x| (x + 0.5) * scale - 0.5)).collect();
    let Some(level) = Level::of(places, size) else { return Ok(Vec::new()) };
    let picture = level.picture(image)?;
    let mut corners = Vector::<Point2f>::new();
    let found = match find_chessboard_corners_sb(&picture, size, &mut corners, CALIB_CB_EXHAUSTIVE)? {
        true => Some(corners.to_vec()),
        false => at_a_glance(&picture, size)?,
    };
    let Some(found) = found.map(|corners| numbered(corners, columns)) else { return Ok(Vec::new()) };
    let back = |corners: Vec<Point2f>| corners.into_iter().map(|at| level.in_image(at)).collect::<Vec<_>>();
    let coarse = back(found.clone());
    match nearest(&coarse) < SLIVERS_PX {
        // A window that is round in the image would hold the neighbours' gradients too.
        true => Ok(back(refine(&picture, &found, OF_SQUARES)?)),
        false => refine(image, &coarse, OF_SQUARES),
    }
}

/// Corners closer than this, px, are refined where the board lies level.
const SLIVERS_PX: f32 = 12.0;

/// Corners counted row after row so that columns, rows and the way into the board make a right-handed frame.
fn numbered(mut corners: Vec<Point2f>, columns: usize) -> Vec<Point2f> {
    let (across, down) = (corners[columns - 1] - corners[0], corners[corners.len() - columns] - corners[0]);
    if across.x * down.y < across.y * down.x {
        corners.chunks_mut(columns).for_each(<[Point2f]>::reverse);
    }
    corners
}
