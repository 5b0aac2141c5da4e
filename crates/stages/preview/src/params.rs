//! How pictures look.

use crate::{ColorMap, Error, ValueRange};
use serde::Serialize;

/// What stands behind the surface and around the pictures of a sheet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Backdrop {
    /// Nearly white, for paper.
    Light,
    /// Nearly black, for screens.
    Dark,
}

impl Backdrop {
    /// Its colour, sRGB.
    #[must_use]
    pub fn color(self) -> [u8; 3] {
        match self {
            Self::Light => [246, 246, 247],
            Self::Dark => [29, 31, 35],
        }
    }

    /// The colour of text on it, sRGB.
    #[must_use]
    pub fn ink(self) -> [u8; 3] {
        match self {
            Self::Light => [48, 51, 58],
            Self::Dark => [222, 224, 229],
        }
    }
}

/// How a surface is drawn.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Look {
    /// Samples per pixel along each side, 1–8; the samples stand on a turned grid, so that 3 already give nine steps
    /// along edges that are nearly upright or level.
    pub supersampling: u32,
    /// What stands behind.
    pub backdrop: Backdrop,
    /// How much hollows are darkened, 0–1.
    pub occlusion: f64,
    /// Whether polygon edges are drawn.
    pub wireframe: bool,
    /// Colours of the values.
    pub map: ColorMap,
    /// Values of the first and last colour; values beyond take the colour of the end.
    pub range: ValueRange,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            supersampling: 3,
            backdrop: Backdrop::Light,
            occlusion: 0.85,
            wireframe: false,
            map: ColorMap::Ember,
            range: ValueRange { low: 0.0, high: 1.0 },
        }
    }
}

impl Look {
    /// Whether every number is in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first that is not.
    pub fn check(&self) -> Result<(), Error> {
        let refuse = |name, value, range| Err(Error::Parameter { name, value, range });
        if !(1..=8).contains(&self.supersampling) {
            return refuse("supersampling", f64::from(self.supersampling), "1 to 8");
        }
        if !(0.0..=1.0).contains(&self.occlusion) {
            return refuse("occlusion", self.occlusion, "0 to 1");
        }
        self.range.check()
    }
}
