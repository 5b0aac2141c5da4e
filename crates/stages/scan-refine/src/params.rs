//! How much positions and normals are trusted.

use crate::Error;
use serde::Serialize;
use std::f64::consts::TAU;

/// Parameters of [`refine`](crate::refine).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Params {
    /// Wavelength, mm, at which positions and normals weigh the same: longer waves come from the positions, shorter ones from
    /// the normals.
    pub crossover_mm: f64,
    /// Wavelength, mm, above which the normals' own shape is not believed: they are turned until, averaged over this, they agree
    /// with the positions' normals; 0 believes them.
    pub bias_mm: f64,
    /// Passes; each further one starts from the surface that the one before found.
    pub iterations: usize,
}

impl Default for Params {
    fn default() -> Self {
        Self { crossover_mm: 30.0, bias_mm: 40.0, iterations: 1 }
    }
}

/// The crossover wavelength, mm, that a weight λ of the positions [Nehab2005, Sec. 4.2] means here:
/// `λ E_p + (1 − λ) E_n` with lengths in mm, so that `Λ = 2π √((1 − λ) / λ)`.
#[must_use]
pub fn crossover_of_lambda(lambda: f64) -> f64 {
    TAU * ((1.0 - lambda) / lambda).sqrt()
}

impl Params {
    /// Whether every parameter is in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the first that is not.
    pub fn check(&self) -> Result<(), Error> {
        let passes = self.iterations as f64;
        let rows = [
            ("crossover in mm", self.crossover_mm, f64::MIN_POSITIVE..f64::INFINITY, "a positive number"),
            ("wavelength of bias in mm", self.bias_mm, 0.0..f64::INFINITY, "a number from 0 on"),
            ("number of passes", passes, 1.0..101.0, "from 1 to 100"),
        ];
        match rows.into_iter().find(|(_, value, range, _)| !range.contains(value)) {
            Some((name, value, _, range)) => Err(Error::Parameter { name, value, range }),
            None => Ok(()),
        }
    }
}
