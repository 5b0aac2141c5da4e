//! Smooth noise along a line.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

const TERMS: usize = 4;

/// A sum of waves with random phases; values from −1 to 1, a standard deviation of about 0.4.
#[derive(Debug, Clone)]
pub(super) struct Wave {
    /// Wave number (rad per mm), phase (rad), amplitude.
    terms: [[f64; 3]; TERMS],
}

impl Wave {
    /// Waves of lengths between `shortest` and `longest`, mm.
    pub(super) fn new(seed: u64, shortest: f64, longest: f64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut term = || {
            let length = shortest * (longest / shortest).powf(rng.random::<f64>());
            // Shorter waves are lower, as on any grown thing.
            [TAU / length, TAU * rng.random::<f64>(), (length / longest).sqrt()]
        };
        let mut terms: [[f64; 3]; TERMS] = std::array::from_fn(|_| term());
        let sum: f64 = terms.iter().map(|term| term[2]).sum();
        terms.iter_mut().for_each(|term| term[2] /= sum);
        Self { terms }
    }

    pub(super) fn at(&self, x: f64) -> f64 {
        self.terms.iter().map(|[number, phase, height]| height * (number * x + phase).sin()).sum()
    }
}
