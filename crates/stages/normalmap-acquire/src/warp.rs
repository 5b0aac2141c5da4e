//! From one picture to another by landmarks: a thin plate that may miss them by a little.

use crate::Error;
use crate::plane::Plane;
use nalgebra::{DMatrix, Matrix2};

/// A landmark in two pictures, px.
#[derive(Debug, Clone, PartialEq)]
pub struct Pair {
    /// Its id.
    pub id: String,
    /// In the picture that the warp starts from.
    pub from: [f64; 2],
    /// In the picture that it leads to.
    pub to: [f64; 2],
}

/// A thin-plate spline of the plane with smoothing [Bookstein1989]:
/// `w(x) = a + B x + Σ cᵢ φ(‖x − xᵢ‖)`, φ(r) = r² ln r, lengths in `scale`; `smoothing` lets it miss landmarks.
#[derive(Debug, Clone, PartialEq)]
pub struct Warp {
    centers: Vec<[f64; 2]>,
    weights: Vec<[f64; 2]>,
    /// Rows: 1, x, y.
    affine: [[f64; 2]; 3],
    origin: [f64; 2],
    scale: f64,
    left_out: Vec<f64>,
}

impl Warp {
    /// The warp from `from` to `to`. Lengths are counted in `scale` px, so that `smoothing` means the same on faces of any size.
    ///
    /// # Errors
    /// If there are fewer than 4 landmarks or all lie on a line.
    pub fn fit(pairs: &[Pair], scale: f64, smoothing: f64) -> Result<Self, Error> {
        let count = pairs.len();
        if count < 4 {
            return Err(Error::FewLandmarks { count });
        }
        let mean = |axis: usize| pairs.iter().map(|pair| pair.from[axis]).sum::<f64>() / count as f64;
        let origin = [mean(0), mean(1)];
        let centers: Vec<[f64; 2]> =
            pairs.iter().map(|pair| [0, 1].map(|axis| (pair.from[axis] - origin[axis]) / scale)).collect();
        if is_line(&centers) {
            return Err(Error::LandmarksOnALine);
        }
        let inverse = system(&centers, smoothing).try_inverse().ok_or(Error::LandmarksOnALine)?;
        let column = |axis: usize| {
            let right =
                nalgebra::DVector::from_fn(count + 3, |i, _| pairs.get(i).map_or(0.0, |pair| pair.to[axis]));
            &inverse * right
        };
        let solved = [column(0), column(1)];
        let row = |i: usize| [solved[0][i], solved[1][i]];
        // How far the others alone would miss a landmark: its weight over the inverse's diagonal.
        let left_out = (0..count).map(|i| row(i)[0].hypot(row(i)[1]) / inverse[(i, i)].abs()).collect();
        let weights = (0..count).map(row).collect();
        let affine = [row(count), row(count + 1), row(count + 2)];
        Ok(Self { centers, weights, affine, origin, scale, left_out })
    }

    /// Per landmark, how far the warp of the others misses it, px.
    #[must_use]
    pub fn left_out(&self) -> &[f64] {
        &self.left_out
    }

    /// Where a place lies in the other picture, px.
    #[must_use]
    pub fn at(&self, place: [f64; 2]) -> [f64; 2] {
        let [x, y] = [0, 1].map(|axis| (place[axis] - self.origin[axis]) / self.scale);
        let [one, along_x, along_y] = &self.affine;
        let mut sum = [0, 1].map(|axis| one[axis] + along_x[axis] * x + along_y[axis] * y);
        for (center, weight) in self.centers.iter().zip(&self.weights) {
            let bend = kernel((x - center[0]).powi(2) + (y - center[1]).powi(2));
            sum[0] += weight[0] * bend;
            sum[1] += weight[1] * bend;
        }
        sum
    }
}

/// r² ln r, of r².
fn kernel(square: f64) -> f64 {
    if square > 0.0 { 0.5 * square * square.ln() } else { 0.0 }
}

/// The smoothing adds to the diagonal; φ is negative where it bends most, so that with this sign it smooths.
fn system(centers: &[[f64; 2]], smoothing: f64) -> DMatrix<f64> {
    let count = centers.len();
    DMatrix::from_fn(count + 3, count + 3, |i, j| match (centers.get(i), centers.get(j)) {
        (Some(a), Some(b)) if i == j => kernel((a[0] - b[0]).powi(2)) + smoothing,
        (Some(a), Some(b)) => kernel((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)),
        (Some(a), None) | (None, Some(a)) => [1.0, a[0], a[1]][i.max(j) - count],
        (None, None) => 0.0,
    })
}

/// Whether points spread in one direction only.
fn is_line(points: &[[f64; 2]]) -> bool {
    let sum = |value: fn(&[f64; 2]) -> f64| points.iter().map(value).sum::<f64>();
    let spread =
        Matrix2::new(sum(|p| p[0] * p[0]), sum(|p| p[0] * p[1]), sum(|p| p[0] * p[1]), sum(|p| p[1] * p[1]));
    spread.determinant() <= 1e-6 * spread.trace().powi(2)
}

/// A warp worked out at each pixel: columns and rows in the other picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Columns in the other picture, px.
    pub x: Plane,
    /// Rows there, px.
    pub y: Plane,
}

/// Pixels between the places at which a warp is worked out; between them it is interpolated by cubics.
const STEP: usize = 8;

impl Field {
    /// A warp over a picture of some size, for the pixels from `first` on.
    #[must_use]
    pub fn of(warp: &Warp, first: [usize; 2], width: usize, height: usize) -> Self {
        // One place more on each side, for the cubics.
        let (columns, rows) = (width / STEP + 4, height / STEP + 4);
        let place = |index: usize, first: usize| first as f64 + STEP as f64 * (index as f64 - 1.0);
        let coarse: Vec<[f64; 2]> = {
            use rayon::prelude::*;
            (0..columns * rows)
                .into_par_iter()
                .map(|i| warp.at([place(i % columns, first[0]), place(i / columns, first[1])]))
                .collect()
        };
        let axis = |axis: usize| {
            let values = coarse.iter().map(|at| at[axis]).collect();
            let coarse = Plane { width: columns, height: rows, values };
            Plane::from_fn(width, height, |column, row| {
                let at = |place: usize| place as f64 / STEP as f64 + 1.0;
                coarse.cubic(at(column), at(row))
            })
        };
        Self { x: axis(0), y: axis(1) }
    }

    /// The other picture brought here.
    #[must_use]
    pub fn fetch(&self, other: &Plane) -> Plane {
        Plane::from_fn(self.x.width, self.x.height, |column, row| {
            other.cubic(self.x.at(column, row), self.y.at(column, row))
        })
    }

    /// ∂(x, y)/∂(column, row) at a pixel.
    #[must_use]
    pub fn jacobian(&self, column: usize, row: usize) -> Matrix2<f64> {
        let [left, right] = [column.saturating_sub(1), (column + 1).min(self.x.width - 1)];
        let [above, below] = [row.saturating_sub(1), (row + 1).min(self.x.height - 1)];
        let along_x =
            |plane: &Plane| (plane.at(right, row) - plane.at(left, row)) / (right - left).max(1) as f64;
        let along_y = |plane: &Plane| {
            (plane.at(column, below) - plane.at(column, above)) / (below - above).max(1) as f64
        };
        Matrix2::new(along_x(&self.x), along_y(&self.x), along_x(&self.y), along_y(&self.y))
    }

    /// 1 where the warp turns the picture over (folds), 0 elsewhere.
    #[must_use]
    pub fn folds(&self) -> Plane {
        Plane::from_fn(self.x.width, self.x.height, |column, row| {
            f64::from(u8::from(self.jacobian(column, row).determinant() <= 0.0))
        })
    }

    /// 1 where the place lies in the other picture, 0 beyond its edge.
    #[must_use]
    pub fn covered(&self, width: usize, height: usize) -> Plane {
        let inside = |place: f64, size: usize| (0.0..=(size - 1) as f64).contains(&place);
        self.x.with(&self.y, |x, y| f64::from(u8::from(inside(x, width) && inside(y, height))))
    }
}
