//! Parameters, with their units and defaults.

use crate::Error;
use serde::Serialize;
use std::ops::RangeInclusive;

/// Times that may be asked for, ms.
pub const TIMES_MS: RangeInclusive<f64> = 0.0..=10_000.0;
/// Lengths in the image that may be asked for, px.
pub const PIXELS: RangeInclusive<f64> = 1e-4..=1e3;

/// How markers are triangulated, filtered and filled.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Params {
    /// Standard deviation of a track's point, px per axis; measured in the take's first frames if absent.
    pub noise_px: Option<f64>,
    /// Reprojection error from which a view is an outlier, px; from the take's first frames if absent.
    pub outlier_px: Option<f64>,
    /// How the positions are filtered.
    pub filter: Filter,
    /// Standard deviation of the filter's weight over time, ms; fast motion shortens it.
    pub smooth_ms: f64,
    /// Longest gap that is filled from neighbours or over time, ms.
    pub fill_ms: f64,
}

/// How positions are filtered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Filter {
    /// Not at all.
    Off,
    /// Spatio-temporal bilateral: over time along the neighbours' affine motion.
    Affine,
    /// Spatio-temporal bilateral, as the paper says: one weighted mean of displacements from rest.
    Paper,
}

impl Default for Params {
    fn default() -> Self {
        Self { noise_px: None, outlier_px: None, filter: Filter::Affine, smooth_ms: 60.0, fill_ms: 200.0 }
    }
}

impl Params {
    /// Refuses values that make no sense.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<(), Error> {
        let within = |name, value: f64, range: &RangeInclusive<f64>, allowed| match range.contains(&value) {
            true => Ok(()),
            false => Err(Error::Parameter { name, value, allowed }),
        };
        within("smooth-ms", self.smooth_ms, &TIMES_MS, "0 to 10000 ms are allowed")?;
        within("fill-ms", self.fill_ms, &TIMES_MS, "0 to 10000 ms are allowed")?;
        let pixels = [("noise-px", self.noise_px), ("outlier-px", self.outlier_px)];
        pixels.into_iter().try_for_each(|(name, value)| {
            value.map_or(Ok(()), |value| within(name, value, &PIXELS, "0.0001 to 1000 px are allowed"))
        })
    }

    /// Whether anything is measured in time, so that the frame rate must be known.
    pub(crate) fn needs_rate(&self) -> bool {
        self.filter != Filter::Off || self.fill_ms > 0.0
    }
}
