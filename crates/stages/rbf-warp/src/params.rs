//! What a user can choose, with defaults and units.

use crate::{Error, Result};
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// Degree of the polynomial part q.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Degree {
    /// The paper's: 10 terms, from 10 markers on.
    #[default]
    Quadratic,
    /// 4 terms, from 4 markers on.
    Linear,
    /// Quadratic from 10 markers on, else linear.
    Auto,
}

impl Degree {
    /// Whether a fit to so many pairs is quadratic.
    ///
    /// # Errors
    /// If they are too few.
    pub fn is_quadratic_for(self, count: usize) -> Result<bool> {
        match (self, count) {
            (_, ..4) => Err(Error::TooFew { count }),
            (Self::Quadratic, ..10) => Err(Error::TooFewForQuadratic { count }),
            (degree, _) => Ok(degree == Self::Quadratic || (degree == Self::Auto && count >= 10)),
        }
    }
}

impl FromStr for Degree {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        match text {
            "quadratic" => Ok(Self::Quadratic),
            "linear" => Ok(Self::Linear),
            "auto" => Ok(Self::Auto),
            other => Err(format!("'{other}' is not a degree; say quadratic, linear or auto")),
        }
    }
}

/// Which frame shows the expression of the scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RestFrame {
    /// The one that a similarity carries closest to the scan.
    #[default]
    Auto,
    /// This one.
    #[serde(untagged)]
    Number(i64),
}

impl FromStr for RestFrame {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        match text {
            "auto" => Ok(Self::Auto),
            number => number
                .parse()
                .map(Self::Number)
                .map_err(|_| format!("'{text}' is no frame; say a frame number or auto")),
        }
    }
}

/// Parameters of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FitParams {
    /// Degree of the polynomial part.
    pub degree: Degree,
    /// Which frame is at rest.
    pub rest_frame: RestFrame,
    /// A marker that is missing at rest is taken from frames this far away at most, frames.
    pub fill_frames: u32,
    /// The mesh is checked for folds this far from the markers, mm.
    pub near_mm: f64,
}

impl Default for FitParams {
    fn default() -> Self {
        Self { degree: Degree::default(), rest_frame: RestFrame::default(), fill_frames: 10, near_mm: 20.0 }
    }
}

impl FitParams {
    /// Whether the values make sense.
    ///
    /// # Errors
    /// [`Error::Parameter`] that names the one that does not.
    pub fn check(&self) -> Result<()> {
        match self.near_mm.is_finite() && self.near_mm >= 0.0 {
            true => Ok(()),
            false => Err(Error::Parameter(format!("near_mm is {}; it must not be negative", self.near_mm))),
        }
    }
}
