//! How the head moves.

use super::band::Band;
use super::refuse;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Slow turns and shifts of the head, bounded, the head at rest at time 0.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct HeadMotion {
    /// Largest turn, rad.
    pub turn_rad: f64,
    /// Largest shift, mm.
    pub shift_mm: f64,
    /// Duration of the slowest swing, s; the fastest is three times as fast.
    pub period_s: f64,
    /// Other seeds move otherwise.
    pub seed: u64,
}

impl Default for HeadMotion {
    /// ±3° and 5 mm.
    fn default() -> Self {
        Self { turn_rad: 3f64.to_radians(), shift_mm: 5.0, period_s: 3.0, seed: 0 }
    }
}

/// A head turns to the sides more than it nods, and nods more than it tilts: about x, y, z.
const TURN: Vector3<f64> = Vector3::new(0.6, 0.7, 0.387);
/// A head shifts forwards and sideways more than upwards: along x, y, z.
const SHIFT: Vector3<f64> = Vector3::new(0.6, 0.35, 0.719);

impl HeadMotion {
    /// The top of the neck in the average face's space, mm: between the ears' lower ends.
    pub const NECK: Point3<f64> = Point3::new(0.0, -25.0, -45.0);

    /// A head that keeps still.
    #[must_use]
    pub fn still() -> Self {
        Self { turn_rad: 0.0, shift_mm: 0.0, ..Self::default() }
    }

    /// Refuses amplitudes and a period that make no sense.
    ///
    /// # Errors
    /// Names the parameter below `place`.
    pub fn check(&self, place: &str) -> Result<(), crate::Error> {
        let within =
            |name: &str, value: f64, range: std::ops::RangeInclusive<f64>| match range.contains(&value) {
                true => Ok(()),
                false => {
                    let what = format!("{value} is not from {} to {}", range.start(), range.end());
                    Err(refuse(format!("{place}.{name}"), what))
                }
            };
        within("turn_rad", self.turn_rad, 0.0..=1.0)?;
        within("shift_mm", self.shift_mm, 0.0..=200.0)?;
        within("period_s", self.period_s, 0.2..=1000.0)
    }

    /// The head's place at a time: the identity at time 0; it turns about `pivot` by no more than `turn_rad`, and shifts
    /// by no more than `shift_mm`.
    #[must_use]
    pub fn world_from_head(&self, time_s: f64, pivot: &Point3<f64>) -> Isometry3<f64> {
        let slowest = 1.0 / self.period_s;
        let swing = |channel: u64| Band::new(self.seed, channel, [slowest, 3.0 * slowest]).since_rest(time_s);
        let turn =
            Vector3::new(swing(0), swing(1), swing(2)).component_mul(&TURN.normalize()) * self.turn_rad;
        let shift =
            Vector3::new(swing(3), swing(4), swing(5)).component_mul(&SHIFT.normalize()) * self.shift_mm;
        let about = Translation3::from(pivot.coords);
        Translation3::from(shift) * about * UnitQuaternion::from_scaled_axis(turn) * about.inverse()
    }
}
