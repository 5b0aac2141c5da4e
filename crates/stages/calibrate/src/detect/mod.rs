//! Corners of boards in pictures, found with OpenCV.

mod charuco;
mod chessboard;
mod level;
mod saddles;
mod symmetry;

use crate::Board;
use nalgebra::Point2;
use opencv::boxed_ref::BoxedRef;
use opencv::core::{Mat, Point2f};
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
/// Chessboards by their squares, which is done at a glance where the board faces the camera; where it does not, its corners
/// are looked for one by one, as saddles of the grey values, and the board is laid level by their spread before it is looked
/// for again. A picture without enough saddles shows no board and costs no more than that. At last, as for ChArUco boards,
/// each corner goes to the point about which the picture around it is symmetric.
///
/// # Errors
/// If the picture is empty, or OpenCV refuses.
pub fn find_corners(picture: Picture, board: &Board) -> Result<Found, DetectError> {
    // One picture per thread is enough, and the same for any number of threads.
    opencv::core::set_num_threads(1)?;
    let [width, height] = picture.size.map(|side| side as i32);
    let image = Mat::new_rows_cols_with_data(height, width, picture.gray)?;
    match *board {
        Board::Chessboard { columns, rows, .. } => chessboard::find(&image, columns as usize, rows as usize),
        Board::Charuco { .. } => charuco::find(&image, board),
    }
}

type Image<'a> = BoxedRef<'a, Mat>;

fn point(at: Point2f) -> Point2<f64> {
    Point2::new(f64::from(at.x), f64::from(at.y))
}
