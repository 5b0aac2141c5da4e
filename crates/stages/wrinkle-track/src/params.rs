//! What can be chosen.

use crate::Error;
use serde::{Deserialize, Serialize};

/// How paints are learnt.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TrainParams {
    /// Cost of squared slack; found by cross-validation if absent.
    pub c: Option<f64>,
    /// Kernel exp(−gamma d²) over log ratios; found by cross-validation if absent.
    pub gamma: Option<f64>,
    /// Pixels that a paint is learnt from, at most.
    pub pixels: usize,
    /// Share of held-out pixels that must be told rightly.
    pub least_score: f64,
}

impl Default for TrainParams {
    fn default() -> Self {
        Self { c: None, gamma: None, pixels: 3000, least_score: 0.95 }
    }
}

/// Kernel matrices grow with the square.
const PIXELS: std::ops::RangeInclusive<usize> = 100..=8000;

impl TrainParams {
    /// Whether every parameter is in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<(), Error> {
        let positive = "it must be a positive number";
        ranged("c", self.c.unwrap_or(1.0), f64::MIN_POSITIVE..=1e9, positive)?;
        ranged("gamma", self.gamma.unwrap_or(1.0), f64::MIN_POSITIVE..=1e6, positive)?;
        let pixels = (*PIXELS.start() as f64)..=(*PIXELS.end() as f64);
        ranged("pixels", self.pixels as f64, pixels, "it must lie between 100 and 8000")?;
        ranged("least-score", self.least_score, 0.5..=1.0, "it must lie between 0.5, chance, and 1")
    }
}

/// How wrinkles are followed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TrackParams {
    /// Steps of the opening and the closing that tidy classified pixels, px.
    pub tidy_px: usize,
    /// Patches smaller than this are noise, px².
    pub least_area_px: usize,
    /// How far from where a wrinkle is expected its paint may lie, px.
    pub gate_px: f64,
    /// Pieces of one paint that lie so near to each other in the mask are one wrinkle, px.
    pub join_px: f64,
    /// A wrinkle that is not found is kept for so many images.
    pub hold: usize,
    /// Bound of a pixel's weight over that of the brightest pixel (eq. 5).
    pub most_weight: f64,
    /// Length of wrinkle per control point, px; there are 5 to 12.
    pub px_per_control: f64,
    /// A wrinkle that bends by more than this, degrees to its axis, goes along its skeleton.
    pub bent_deg: f64,
}

impl Default for TrackParams {
    fn default() -> Self {
        Self {
            tidy_px: 1,
            least_area_px: 24,
            gate_px: 30.0,
            join_px: 14.0,
            hold: 3,
            most_weight: 20.0,
            px_per_control: 20.0,
            bent_deg: 60.0,
        }
    }
}

impl TrackParams {
    /// Whether every parameter is in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<(), Error> {
        let length = |name, value| ranged(name, value, 0.0..=1e4, "it must be a length in px");
        ranged("tidy-px", self.tidy_px as f64, 0.0..=20.0, "it must lie between 0 and 20")?;
        length("least-area-px", self.least_area_px as f64)?;
        length("gate-px", self.gate_px)?;
        length("join-px", self.join_px)?;
        ranged("most-weight", self.most_weight, 1.0..=1e9, "it must be 1 at least")?;
        ranged("px-per-control", self.px_per_control, 1.0..=1e4, "it must be a length of 1 px at least")?;
        ranged("bent-deg", self.bent_deg, 0.0..=90.0, "it must lie between 0 and 90 degrees")
    }
}

fn ranged(
    name: &'static str,
    value: f64,
    range: std::ops::RangeInclusive<f64>,
    allowed: &'static str,
) -> Result<(), Error> {
    match range.contains(&value) {
        true => Ok(()),
        false => Err(Error::Parameter { name, value, allowed }),
    }
}
