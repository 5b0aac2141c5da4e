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
        // Beyond the nearest neighbour every marker is in reach of every other.
        match self.gate > 0.0 && self.gate <= 1.0 {
            true => Ok(()),
            false => Err(Error::Parameter {
                name: "gate",
                value: self.gate,
                allowed: "it must lie above 0, and be 1 at most",
            }),
        }?;
        length("least-gate-px", self.least_gate_px)?;
        length("most-gate-px", self.most_gate_px)?;
        if self.least_gate_px > self.most_gate_px {
            let (name, value) = ("least-gate-px", self.least_gate_px);
            return Err(Error::Parameter { name, value, allowed: "it must not be above most-gate-px" });
        }
        length("guide-gate-px", self.guide_gate_px)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_makes_no_sense_is_refused_by_name() {
        assert_eq!(Params::default().check(), Ok(()));
        for (params, wrong) in [
            (Params { gate: 100.0, ..Params::default() }, "gate"),
            (Params { least_gate_px: 30.0, ..Params::default() }, "least-gate-px"),
            (Params { guide_gate_px: f64::NAN, ..Params::default() }, "guide-gate-px"),
        ] {
            assert!(matches!(params.check(), Err(Error::Parameter { name, .. }) if name == wrong), "{wrong}");
        }
    }
}
