//! A waved bright point.

use super::Volume;
use nalgebra::{Point3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Waves along each axis; more would not look hand-made.
const WAVES: usize = 3;

/// Where the bright point is in each frame, world space, mm: a smooth path that fills the ball, out to its edge.
///
/// Each coordinate is a sum of three slow waves whose frequencies have no common multiple, so that the path does not repeat; points
/// beyond the edge are drawn in, smoothly. `frames_per_sweep`: how many frames a sweep from side to side takes, about.
#[must_use]
pub fn wand_path(volume: &Volume, frames: usize, frames_per_sweep: f64, seed: u64) -> Vec<Point3<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x3a4d);
    let mut wave = |_| {
        let turn = std::f64::consts::PI / frames_per_sweep * rng.random_range(0.6..1.4);
        (turn, rng.random_range(0.0..std::f64::consts::TAU), rng.random_range(0.5..1.0))
    };
    let waves: [[(f64, f64, f64); WAVES]; 3] = std::array::from_fn(|_| std::array::from_fn(&mut wave));
    let at = |frame: usize| {
        let sum = |waves: &[(f64, f64, f64); WAVES]| {
            waves
                .iter()
                .map(|(turn, phase, height)| height * (turn * frame as f64 + phase).sin())
                .sum::<f64>()
        };
        let step = Vector3::from(waves.each_ref().map(sum));
        volume.middle + volume.radius_mm * step / (1.0 + step.norm_squared()).sqrt()
    };
    (0..frames).map(at).collect()
}
