//! Smooth random fields: sums of plane waves.

use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// A field of standard deviation 1 and mean 0 over the plane.
#[derive(Debug, Clone)]
pub(super) struct Waves(Vec<[f64; 3]>);

const COUNT: usize = 24;

impl Waves {
    /// Waves of random direction whose lengths (mm) lie between two, even in their logarithm.
    pub(super) fn new(rng: &mut ChaCha8Rng, [least, most]: [f64; 2]) -> Self {
        let wave = |_| {
            let length = least * (most / least).powf(rng.random::<f64>());
            let (sin, cos) = (TAU * rng.random::<f64>()).sin_cos();
            [TAU / length * cos, TAU / length * sin, TAU * rng.random::<f64>()]
        };
        Self((0..COUNT).map(wave).collect())
    }

    /// The field at a place, mm.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let sum: f64 = self.0.iter().map(|[kx, ky, phase]| (kx * x + ky * y + phase).cos()).sum();
        sum * (2.0 / COUNT as f64).sqrt()
    }
}
