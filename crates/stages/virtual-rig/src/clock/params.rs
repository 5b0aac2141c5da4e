//! A camera's clock, and its faults.

use crate::Error;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Who tells a camera when to expose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Trigger {
    /// The motion capture's trigger: exposures are in step with its frames, whatever the camera's clock says.
    #[default]
    Shared,
    /// The camera's own clock: exposures drift away from the motion capture's frames.
    Own,
}

/// When a camera exposes. Its own clock and the true time are related by
/// true = `offset_s` + (1 + `drift_ppm` · 10⁻⁶) · own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Clock {
    /// Who tells it when to expose.
    pub trigger: Trigger,
    /// It exposes with every so-manieth frame of the motion capture: 4 makes 12.5 Hz of 50 Hz.
    pub every: u32,
    /// The first of these frames, below `every`.
    pub phase: u32,
    /// The true time when its own clock says 0, s.
    pub offset_s: f64,
    /// How much too slowly its own clock runs, millionths: after an hour of its own, 50 ppm make 0.18 s more.
    pub drift_ppm: f64,
    /// Standard deviation of the exposures' true times, s.
    pub jitter_s: f64,
    /// Standard deviation of the time stamps, s.
    pub stamp_jitter_s: f64,
    /// Whether stamps count from the first picture in the file: a late start does not show in them.
    pub stamps_from_first: bool,
}

impl Default for Clock {
    fn default() -> Self {
        Self {
            trigger: Trigger::Shared,
            every: 1,
            phase: 0,
            offset_s: 0.0,
            drift_ppm: 0.0,
            jitter_s: 0.0,
            stamp_jitter_s: 0.0,
            stamps_from_first: false,
        }
    }
}

/// What happens to a camera's pictures on the way to its file. Exposures are numbered from 0 as they come, lost ones
/// included.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Faults {
    /// Exposures that never arrive.
    pub dropped: Vec<i64>,
    /// Exposures that arrive twice, one after the other and with the same stamp.
    pub doubled: Vec<i64>,
    /// Share of exposures that are lost by chance, 0 to 1.
    pub drop_share: f64,
    /// Share of exposures that are doubled by chance, 0 to 1.
    pub double_share: f64,
    /// By how many exposures the file starts late; below 0, early.
    pub late_start: i64,
}

/// Jitter beyond this share of the time between exposures would change their order.
const MAX_JITTER: f64 = 0.1;

fn refuse(place: &str, key: &str, what: String) -> Result<(), Error> {
    Err(Error::Parameter { place: format!("{place}.{key}"), what })
}

impl Clock {
    /// How many frames of the motion capture, to the nearest whole one, exposures come later than their count says; 0 if
    /// they are triggered. `rate_hz`: the motion capture's.
    #[must_use]
    pub fn late_frames(&self, rate_hz: f64) -> i64 {
        match self.trigger {
            Trigger::Shared => 0,
            Trigger::Own => (self.offset_s * rate_hz).round() as i64,
        }
    }

    /// Refuses what makes no sense. `place`: where in the scenario it stands; `rate_hz`: the motion capture's.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self, place: &str, rate_hz: f64) -> Result<(), Error> {
        if self.every == 0 {
            return refuse(place, "every", "0; 1 is every frame".into());
        }
        if self.phase >= self.every {
            let what = format!("{} is not below every = {}", self.phase, self.every);
            return refuse(place, "phase", what);
        }
        if !self.offset_s.is_finite() {
            return refuse(place, "offset_s", format!("{} s", self.offset_s));
        }
        if !(-1e5..=1e5).contains(&self.drift_ppm) {
            return refuse(place, "drift_ppm", format!("{} ppm; −100000 to 100000 will do", self.drift_ppm));
        }
        let most = MAX_JITTER * f64::from(self.every) / rate_hz;
        for (key, value) in [("jitter_s", self.jitter_s), ("stamp_jitter_s", self.stamp_jitter_s)] {
            if !(0.0..=most).contains(&value) {
                return refuse(
                    place,
                    key,
                    format!("{value} s; 0 to {most} s, a tenth of the time between exposures, will do"),
                );
            }
        }
        Ok(())
    }
}

impl Faults {
    /// Refuses what makes no sense. `place`: where in the scenario it stands.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self, place: &str) -> Result<(), Error> {
        for (key, share) in [("drop_share", self.drop_share), ("double_share", self.double_share)] {
            if !(0.0..=1.0).contains(&share) {
                return refuse(place, key, format!("{share}; 0 to 1 will do (0.02 is 2 %)"));
            }
        }
        match self.doubled.iter().find(|exposure| self.dropped.contains(exposure)) {
            Some(exposure) => refuse(place, "doubled", format!("exposure {exposure} is dropped already")),
            None => Ok(()),
        }
    }
}
