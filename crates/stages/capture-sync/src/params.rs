//! Parameters, with their units and defaults.

use crate::Error;
use serde::Serialize;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Where the time of the images is taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// As the take says: image `first` shows the first frame, and all go on at their stated rates.
    Stated,
    /// Time stamps by a common clock.
    Timestamps,
    /// A flash that all cameras see.
    Flash,
    /// What moves in the images.
    Correlation,
}

/// How a time base is found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Params {
    /// Where the time of the images is taken from.
    pub mode: Mode,
    /// Whether dropped and doubled images are found from time stamps where there are some.
    pub use_stamps: bool,
    /// How far the cameras' starts may lie apart, s; for correlation.
    pub search_s: f64,
    /// How far off a free clock is expected to run, standard deviation, ppm: keeps the drift of short takes, which tell
    /// little of it, from being noise.
    pub drift_prior_ppm: f64,
    /// Per camera id how many mocap frames later it takes its images than what is found otherwise says; for what is known
    /// from elsewhere, such as from tracks.
    pub late: BTreeMap<String, f64>,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            mode: Mode::Stated,
            use_stamps: true,
            search_s: 2.0,
            drift_prior_ppm: 100.0,
            late: BTreeMap::new(),
        }
    }
}

/// How far the cameras' starts may lie apart, s.
pub const SEARCH_S: RangeInclusive<f64> = 0.0..=600.0;
/// How far off clocks may be expected to run, ppm.
pub const DRIFT_PRIOR_PPM: RangeInclusive<f64> = 1e-3..=1e5;
/// How much later a camera may be said to take its images, mocap frames.
pub const LATE_FRAMES: RangeInclusive<f64> = -1e4..=1e4;

impl Params {
    /// Refuses values that make no sense.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<(), Error> {
        let check = |name, value: f64, range: RangeInclusive<f64>, allowed| match range.contains(&value) {
            true => Ok(()),
            false => Err(Error::Parameter { name, value, allowed }),
        };
        check("search-s", self.search_s, SEARCH_S, "0 to 600 s are allowed")?;
        check("drift-prior-ppm", self.drift_prior_ppm, DRIFT_PRIOR_PPM, "0.001 to 100000 ppm are allowed")?;
        self.late.values().try_for_each(|&frames| {
            check("late", frames, LATE_FRAMES, "-10000 to 10000 mocap frames are allowed")
        })
    }
}
