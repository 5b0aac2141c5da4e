//! What gets between the face and the cameras: round, skin-coloured things that wander over it, as fingers do.

use crate::Error;
use nalgebra::{Point3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Finger tips before the face.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Hands {
    /// How many.
    pub count: usize,
    /// Their radius, mm.
    pub radius_mm: f64,
    /// How far before the skin they wander, mm.
    pub height_mm: f64,
    /// Time in which each goes its way once, s.
    pub period_s: f64,
}

impl Default for Hands {
    fn default() -> Self {
        Self { count: 0, radius_mm: 11.0, height_mm: 16.0, period_s: 2.4 }
    }
}

/// Middle of the head, in face space, mm.
const MIDDLE: Point3<f64> = Point3::new(0.0, 10.0, -25.0);
/// Distance of the skin from there, mm.
const SKIN: f64 = 92.0;
/// How far around the face they wander, rad.
const REACH: [f64; 2] = [0.7, 0.6];

impl Hands {
    /// Whether such hands can be.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self) -> Result<(), Error> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        if self.count > 100 {
            return Err(Error::parameter("hands.count", "at most 100"));
        }
        if !positive(self.radius_mm) || !positive(self.height_mm) || !positive(self.period_s) {
            return Err(Error::parameter("hands", "radius_mm, height_mm and period_s must be positive"));
        }
        Ok(())
    }

    /// Their centres at a time, in the space of the resting head, mm. The take's first moment is free: there the
    /// markers are labelled.
    #[must_use]
    pub fn centers(&self, seed: u64, time_s: f64) -> Vec<Point3<f64>> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x0000_4a9d);
        let arrival = (time_s / 0.1 - 0.5).clamp(0.0, 1.0);
        let away = 400.0 * (1.0 - arrival);
        let wander = |rng: &mut ChaCha8Rng, reach: f64| {
            let (phase, harmonic) = (rng.random_range(0.0..TAU), rng.random_range(0.0..TAU));
            let turn = TAU * time_s / self.period_s;
            reach * (0.75 * (turn + phase).sin() + 0.25 * (2.0 * turn + harmonic).sin())
        };
        let center = |_| {
            let (azimuth, elevation) = (wander(&mut rng, REACH[0]), wander(&mut rng, REACH[1]));
            let out = Vector3::new(
                azimuth.sin() * elevation.cos(),
                elevation.sin(),
                azimuth.cos() * elevation.cos(),
            );
            MIDDLE + out * (SKIN + self.height_mm + self.radius_mm) - Vector3::y() * away
        };
        (0..self.count).map(center).collect()
    }
}
