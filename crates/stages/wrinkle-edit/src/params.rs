//! Parameters, with their units and defaults.

use crate::Error;
use serde::Serialize;

/// How edits are made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Params {
    /// Distance of the sections of a drawn wrinkle, px: that of `cross-section`.
    pub step_px: f64,
}

impl Default for Params {
    fn default() -> Self {
        Self { step_px: 2.0 }
    }
}

impl Params {
    /// Refuses values that make no sense.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<(), Error> {
        match (0.5..=50.0).contains(&self.step_px) {
            true => Ok(()),
            false => Err(Error::Parameter {
                name: "step-px",
                value: self.step_px,
                allowed: "it must lie between 0.5 and 50 px",
            }),
        }
    }
}
