//! A picture in which a board that leans lies level.

use super::{DetectError, Image};
use nalgebra::{Matrix2, SymmetricEigen, Vector2};
use opencv::core::{BORDER_REPLICATE, Mat, Scalar, Size};
use opencv::imgproc::{INTER_CUBIC, WARP_INVERSE_MAP, warp_affine};

/// The way from a picture in which points spread alike to all sides to the image, about the middle of the points.
pub(super) struct Level {
    image_from_level: Matrix2<f64>,
    middle: Vector2<f64>,
    side_px: i32,
}

/// Pixels to a square of the board in the levelled picture.
const SQUARE_PX: f64 = 30.0;
/// Squares of margin around the board.
const MARGIN: f64 = 2.0;
/// Rounds in which what lies far from the rest is left out.
const ROUNDS: usize = 8;
/// Points of a full grid lie within √6 = 2.45 standard deviations of its middle, its corners there.
const FAR: f64 = 2.9;

impl Level {
    /// From the spread of a board's corners: a grid seen from afar, whichever way it leans, has a covariance whose inverse root
    /// lays it level up to a turn. None if the points lie in a line.
    pub(super) fn of(mut points: Vec<Vector2<f64>>, size: Size) -> Option<Self> {
        let fewest = (size.width * size.height) as usize / 2;
        for _ in 0..ROUNDS {
            let (middle, root) = spread(&points)?;
            let level = root.try_inverse()?;
            let near: Vec<Vector2<f64>> =
                points.iter().copied().filter(|at| (level * (at - middle)).norm() < FAR).collect();
            if near.len() == points.len() || near.len() < fewest {
                break;
            }
            points = near;
        }
        let (middle, root) = spread(&points)?;
        // A row of n squares' corners has the standard deviation √((n² − 1)/12).
        let squares = f64::from(size.width.max(size.height));
        let deviation_px = SQUARE_PX * ((squares * squares - 1.0) / 12.0).sqrt();
        let side_px = SQUARE_PX * (f64::from(size.width).hypot(f64::from(size.height)) + 2.0 * MARGIN);
        Some(Self { image_from_level: root / deviation_px, middle, side_px: side_px as i32 })
    }

    /// The levelled picture; beyond the image's edge its last pixels go on.
    pub(super) fn picture(&self, image: &Image) -> Result<Mat, DetectError> {
        let a = self.image_from_level;
        let shift = self.middle - a * self.center();
        let rows = [[a.m11, a.m12, shift.x], [a.m21, a.m22, shift.y]];
        let map = Mat::from_slice_2d(&rows)?;
        let mut picture = Mat::default();
        let size = Size::new(self.side_px, self.side_px);
        let how = INTER_CUBIC | WARP_INVERSE_MAP;
        warp_affine(image, &mut picture, &map, size, how, BORDER_REPLICATE, Scalar::default())?;
        Ok(picture)
    }

    /// Where a point of the levelled picture is in the image.
    pub(super) fn in_image(&self, at: Vector2<f64>) -> Vector2<f64> {
        self.image_from_level * (at - self.center()) + self.middle
    }

    fn center(&self) -> Vector2<f64> {
        Vector2::repeat(0.5 * (f64::from(self.side_px) - 1.0))
    }
}

/// The middle of points, and the root of their covariance; none if they lie in a line.
fn spread(points: &[Vector2<f64>]) -> Option<(Vector2<f64>, Matrix2<f64>)> {
    let count = points.len().max(1) as f64;
    let middle = points.iter().sum::<Vector2<f64>>() / count;
    let covariance =
        points.iter().map(|at| (at - middle) * (at - middle).transpose()).sum::<Matrix2<f64>>() / count;
    let eigen = SymmetricEigen::new(covariance);
    // A square pixel is the least that a picture can be spread over.
    if eigen.eigenvalues.min() < 1.0 {
        return None;
    }
    let roots = Matrix2::from_diagonal(&eigen.eigenvalues.map(f64::sqrt));
    Some((middle, eigen.eigenvectors * roots * eigen.eigenvectors.transpose()))
}
