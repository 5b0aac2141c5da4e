//! Parameters, with their units and defaults.

use crate::Error;
use serde::Serialize;

/// How markers are found and followed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Params {
    /// The share of a pixel that must be paint for it to count as painted, 0–1.
    pub least_coverage: f64,
    /// How far from its prediction a marker is looked for, as a share of the distance to its nearest neighbour; never less than
    /// `least_gate_px`.
    pub gate: f64,
    /// Smallest distance from its prediction within which a marker is looked for, px.
    pub least_gate_px: f64,
    /// Largest such distance, px.
    pub most_gate_px: f64,
    /// Distance from a reprojected 3D marker within which its dot is looked for, px.
    pub guide_gate_px: f64,
    /// The share of a dot's usual area below which it counts as hidden, 0–1.
    pub least_share: f64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            least_coverage: 0.3,
            gate: 0.5,
            least_gate_px: 4.0,
            most_gate_px: 16.0,
            guide_gate_px: 2.0,
            least_share: 0.4,
        }
    }
}

impl Params {
    /// Refuses values that make no sense.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<(), Error> {
        let share = |name, value: f64| match value > 0.0 && value < 1.0 {
            true => Ok(()),
            false => Err(Error::Parameter { name, value, allowed: "it must lie between 0 and 1" }),
        };
        let length = |name, value: f64| match value.is_finite() && value > 0.0 {
            true => Ok(()),
            false => Err(Error::Parameter { name, value, allowed: "it must be positive" }),
        };
        share("least-coverage", self.least_coverage)?;
        share("least-share", self.least_share)?;
        length("gate", self.gate)?;
        length("least-gate-px", self.least_gate_px)?;
        length("most-gate-px", self.most_gate_px)?;
        length("guide-gate-px", self.guide_gate_px)
    }
}
