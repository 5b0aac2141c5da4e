//! What the shell's displacements are measured from.

use crate::{Basis, Completion};
use nalgebra::{DMatrix, Point3, RowDVector, Vector3};
use rayon::prelude::*;

/// Singular values below this share of the largest count as zero: handles in one plane do not say how the rest moves off it.
const RANK: f64 = 1e-6;
/// Share of the energy from the rest pose that settles what an affine reference leaves open.
const TIE: f64 = 1e-3;

/// The affine motion that the handles make in the mean, by least squares. The shell then bends only for what is left:
/// a take that still has the head's motion in it, or a jaw that carries half of the face along, costs no stiffness.
///
/// Everything stays linear in the handles D: with X the handles' homogeneous coordinates, the motion is `c = X⁺ D`, and the field
/// `B (D − X c) + X_V c`, so a basis and its Schur complement can be carried over once for all frames.
#[derive(Debug, Clone, PartialEq)]
pub struct AffineReference {
    middle: Vector3<f64>,
    scale: f64,
    /// X, n × 4.
    handles: DMatrix<f64>,
    /// X⁺, 4 × n.
    fit: DMatrix<f64>,
}

impl AffineReference {
    /// For handles at these places, mm. Where they lie in a plane or on a line, the smallest motion that fits is taken.
    #[must_use]
    pub fn new(handles: &[Point3<f64>]) -> Self {
        let count = handles.len().max(1) as f64;
        let middle = handles.iter().map(|point| point.coords).sum::<Vector3<f64>>() / count;
        let spread: f64 = handles.iter().map(|point| (point.coords - middle).norm_squared()).sum();
        let scale = (spread / count).sqrt().max(f64::MIN_POSITIVE);
        let rows: Vec<RowDVector<f64>> = handles.iter().map(|point| row(point, &middle, scale)).collect();
        let handles = DMatrix::from_rows(&rows);
        let fit = pseudo_inverse(&handles);
        Self { middle, scale, handles, fit }
    }

    /// What is left of the handles' displacements, mm, and the motion taken off: 4 × 3 in coordinates of ours.
    #[must_use]
    pub fn split(&self, given: &[Vector3<f64>]) -> (Vec<Vector3<f64>>, DMatrix<f64>) {
        let told = DMatrix::from_fn(given.len(), 3, |row, axis| given[row][axis]);
        let motion = &self.fit * &told;
        let left = told - &self.handles * &motion;
        (left.row_iter().map(|row| Vector3::new(row[0], row[1], row[2])).collect(), motion)
    }

    /// Adds a motion to a field at these places, mm.
    pub fn add(&self, motion: &DMatrix<f64>, points: &[Point3<f64>], field: &mut [Vector3<f64>]) {
        for (point, d) in points.iter().zip(field) {
            let moved = row(point, &self.middle, self.scale) * motion;
            *d += Vector3::new(moved[0], moved[1], moved[2]);
        }
    }

    /// The responses with this reference from those without: `B + (X_V − B X) X⁺`.
    #[must_use]
    pub fn basis(&self, points: &[Point3<f64>], basis: &Basis) -> Basis {
        let count = self.handles.nrows();
        let mut values = basis.values().to_vec();
        values.par_chunks_mut(count).zip(points.par_iter()).for_each(|(responses, point)| {
            let own = RowDVector::from_iterator(count, responses.iter().map(|&response| f64::from(response)));
            let correction = (row(point, &self.middle, self.scale) - own * &self.handles) * &self.fit;
            responses.iter_mut().zip(correction.iter()).for_each(|(response, more)| {
                *response = (f64::from(*response) + more) as f32;
            });
        });
        Basis::new(values, count)
    }

    /// The energy as a function of the handles with this reference: `(1 − X X⁺)ᵀ S (1 − X X⁺) + ε S`. The last term decides where
    /// the handles that a frame shows do not determine an affine motion, as three or a flat set of them do not.
    #[must_use]
    pub fn completion(&self, completion: &Completion) -> Completion {
        let count = self.handles.nrows();
        let left = DMatrix::identity(count, count) - &self.handles * &self.fit;
        let schur = left.transpose() * completion.schur() * left + TIE * completion.schur();
        let rows: Vec<Vec<f64>> = (0..count)
            .map(|row| (0..count).map(|column| 0.5 * (schur[(row, column)] + schur[(column, row)])).collect())
            .collect();
        Completion::new(&rows)
    }
}

/// Homogeneous coordinates, of the size of 1.
fn row(point: &Point3<f64>, middle: &Vector3<f64>, scale: f64) -> RowDVector<f64> {
    let at = (point.coords - middle) / scale;
    RowDVector::from_row_slice(&[1.0, at.x, at.y, at.z])
}

/// The pseudo-inverse, 4 × n.
fn pseudo_inverse(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let svd = matrix.clone().svd(true, true);
    let tolerance = RANK * svd.singular_values.max();
    svd.pseudo_inverse(tolerance).unwrap_or_else(|_| DMatrix::zeros(matrix.ncols(), matrix.nrows()))
}
