//! The third-order energy of a displacement field: how much its curvature varies.

use crate::{cotan_stiffness, lumped_mass, weighted_cotan_stiffness};
use nalgebra::Point3;
use sprs::CsMat;

/// Stretching, and the variation of bending [BotschKobbelt2004, Sec. 3]: `a uᵀ L u + b (M⁻¹ L u)ᵀ L_κ (M⁻¹ L u)`, which for
/// smooth fields is `∫ a ‖∇u‖² + b κ ‖∇Δu‖²`. κ says how stiff the surface is at each place.
///
/// The matrix of this energy has entries that grow with the fourth power of 1 / edge length, and rows that sum to zero
/// only as far as rounding allows: a solve with it loses a factor of 100 per halving of the edges. [`Variation::apply`]
/// goes through the factors instead, in differences, so that a residual taken with it is good enough to refine a solve.
pub struct Variation {
    stiffness: CsMat<f64>,
    mass: Vec<f64>,
    /// `b L_κ`.
    varying: CsMat<f64>,
    stretching: f64,
}

impl Variation {
    /// For a mesh; `points`: #V, mm; `weights`: #F, κ ≥ 0; `stretching` a without unit; `variation` b in mm⁴.
    ///
    /// # Panics
    /// If there is not one weight per triangle.
    #[must_use]
    pub fn new(
        points: &[Point3<f64>],
        triangles: &[[u32; 3]],
        weights: &[f64],
        [stretching, variation]: [f64; 2],
        cotangent_limit: f64,
    ) -> Self {
        let varying = weighted_cotan_stiffness(points, triangles, weights, cotangent_limit);
        Self {
            stiffness: cotan_stiffness(points, triangles, cotangent_limit).0,
            mass: lumped_mass(points, triangles),
            varying: varying.map(|value| variation * value),
            stretching,
        }
    }

    /// The energy's matrix, #V × #V; its rows reach three rings far.
    #[must_use]
    pub fn matrix(&self) -> CsMat<f64> {
        let mut pointwise = self.stiffness.clone();
        for (row, mut entries) in pointwise.outer_iterator_mut().enumerate() {
            entries.iter_mut().for_each(|(_, value)| *value /= self.mass[row]);
        }
        let third = &pointwise.transpose_view().to_csr() * &(&self.varying * &pointwise);
        match self.stretching == 0.0 {
            true => third,
            false => &third + &self.stiffness.map(|value| self.stretching * value),
        }
    }

    /// The matrix times a field, factor by factor; constants give exactly zero.
    ///
    /// # Panics
    /// If the field does not have one value per vertex.
    #[must_use]
    pub fn apply(&self, field: &[f64]) -> Vec<f64> {
        let stretched = times(&self.stiffness, field);
        let pointwise: Vec<f64> =
            stretched.iter().zip(&self.mass).map(|(value, mass)| value / mass).collect();
        let mut varied = times(&self.varying, &pointwise);
        varied.iter_mut().zip(&self.mass).for_each(|(value, mass)| *value /= mass);
        let mut third = times(&self.stiffness, &varied);
        third.iter_mut().zip(&stretched).for_each(|(sum, value)| *sum += self.stretching * value);
        third
    }
}

/// A matrix whose rows sum to zero times a field, in differences.
fn times(matrix: &CsMat<f64>, field: &[f64]) -> Vec<f64> {
    assert_eq!(matrix.cols(), field.len(), "one value per vertex");
    let row = |(at, row): (usize, sprs::CsVecView<'_, f64>)| {
        row.iter().map(|(other, &entry)| entry * (field[other] - field[at])).sum()
    };
    matrix.outer_iterator().enumerate().map(row).collect()
}
