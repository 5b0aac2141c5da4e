//! Chessboards.

use super::level::Level;
use super::saddles::saddles;
use super::symmetry::{Seed, refine};
use super::{DetectError, Found, Image, point};
use nalgebra::{Point2, Vector2};
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

/// How far around a corner the picture is looked at, squares: just not to its neighbours.
const REACH: f64 = 0.9;
/// Least likeness of a corner's surroundings turned by half a turn: a highlight or a finger on them is no longer alike.
const LIKENESS: f64 = 0.8;

/// Squares that are seen narrower than this, px, are lost in the blur.
const SLIVER_PX: f64 = 2.0;

/// All corners of a chessboard, or none.
pub(super) fn find(image: &Image, columns: usize, rows: usize) -> Result<Found, DetectError> {
    let small = shrunken(image)?;
    let size = Size::new(columns as i32, rows as i32);
    let coarse: Vec<Vector2<f64>> = match at_a_glance(&small, size)? {
        Some(corners) => {
            let scale = Vector2::new(
                f64::from(image.cols()) / f64::from(small.cols()),
                f64::from(image.rows()) / f64::from(small.rows()),
            );
            let half = Vector2::repeat(0.5);
            let grown = |at: Point2f| (point(at).coords + half).component_mul(&scale) - half;
            corners.into_iter().map(grown).collect()
        }
        None => laid_level(image, &small, size)?,
    };
    let mut corners = Vec::with_capacity(coarse.len());
    for seed in seeds(&coarse, columns) {
        if seed.width_px() < SLIVER_PX {
            return Ok(Found::new());
        }
        match refine(image, &seed, REACH)? {
            Some(corner) if corner.likeness > LIKENESS => corners.push(corner.at),
            _ => return Ok(Found::new()),
        }
    }
    let is_board = corners.iter().all(|at| is_inside(image, at)) && is_even(&corners, columns);
    let corners = if is_board { corners } else { Vec::new() };
    Ok((0..).zip(corners.into_iter().map(Point2::from)).collect())
}

/// Corners with the way to their neighbours.
fn seeds(corners: &[Vector2<f64>], columns: usize) -> Vec<Seed> {
    let way = |before: Option<usize>, here: usize, after: Option<usize>| {
        let steps = before.is_some() as u8 + after.is_some() as u8;
        (corners[after.unwrap_or(here)] - corners[before.unwrap_or(here)]) / f64::from(steps)
    };
    let seed = |i: usize| {
        let column = i % columns;
        let across = way((column > 0).then(|| i - 1), i, (column + 1 < columns).then_some(i + 1));
        let down = way(i.checked_sub(columns), i, Some(i + columns).filter(|&next| next < corners.len()));
        Seed { at: corners[i], axes: [across, down] }
    };
    (0..corners.len()).map(seed).collect()
}

/// Corners this near the image's edge, px, are what lies beyond as much as what is seen.
const EDGE_PX: f64 = 1.0;

fn is_inside(image: &Image, at: &Vector2<f64>) -> bool {
    let inside = |at: f64, side: i32| (EDGE_PX..=f64::from(side) - 1.0 - EDGE_PX).contains(&at);
    inside(at.x, image.cols()) && inside(at.y, image.rows())
}

/// Share of the way between its neighbours that a corner may be off their middle: perspective and lens move it less.
const UNEVEN: f64 = 0.05;
/// ... and px.
const UNEVEN_PX: f64 = 0.3;

/// Whether each corner lies about midway between its neighbours in its row, and in its column.
fn is_even(corners: &[Vector2<f64>], columns: usize) -> bool {
    let is_midway =
        |[a, b, c]: [Vector2<f64>; 3]| 0.5 * (a + c - 2.0 * b).norm() <= UNEVEN * (c - a).norm() + UNEVEN_PX;
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
fn laid_level(image: &Image, small: &Mat, size: Size) -> Result<Vec<Vector2<f64>>, DetectError> {
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
    let in_image = |at| level.in_image(point(at).coords);
    Ok(found.map_or_else(Vec::new, |corners| numbered(corners, columns).into_iter().map(in_image).collect()))
}

/// Corners counted row after row so that columns, rows and the way into the board make a right-handed frame.
fn numbered(mut corners: Vec<Point2f>, columns: usize) -> Vec<Point2f> {
    let (across, down) = (corners[columns - 1] - corners[0], corners[corners.len() - columns] - corners[0]);
    if across.x * down.y < across.y * down.x {
        corners.chunks_mut(columns).for_each(<[Point2f]>::reverse);
    }
    corners
}
