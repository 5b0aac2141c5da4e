//! A flash that all cameras see.

use super::Schedule;
use crate::Error;
use artifact::Rate;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A flash of light, to line files up by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Flash {
    /// The motion capture's frame, from 0, in the middle of whose exposure it flares up.
    pub mocap_frame: i64,
    /// How long it burns, s.
    pub length_s: f64,
    /// How many times brighter all is while it burns.
    pub factor: f64,
}

impl Flash {
    /// How much brighter a picture is: 1 + (`factor` − 1) · the share of the exposure in which the flash burns.
    ///
    /// `time_s`: the true middle of the exposure; `exposure_s`: its length, 0 for an instant.
    #[must_use]
    pub fn brightness(&self, rate: Rate, time_s: f64, exposure_s: f64) -> f64 {
        let start = (self.mocap_frame * i64::from(rate.seconds)) as f64 / f64::from(rate.frames);
        let end = start + self.length_s;
        let (open, close) = (time_s - 0.5 * exposure_s, time_s + 0.5 * exposure_s);
        let share = match exposure_s > 0.0 {
            true => ((close.min(end) - open.max(start)) / exposure_s).clamp(0.0, 1.0),
            false => f64::from(u8::from((start..end).contains(&time_s))),
        };
        1.0 + (self.factor - 1.0) * share
    }

    /// Refuses a flash that makes no sense or that a camera has no picture of.
    ///
    /// # Errors
    /// Names the parameter, or the camera.
    pub fn check(&self, schedule: &Schedule, rate: Rate, exposure_s: f64) -> Result<(), Error> {
        let refuse = |key: &str, what: String| Err(Error::Parameter { place: format!("flash.{key}"), what });
        if !(self.length_s.is_finite() && self.length_s > 0.0) {
            return refuse("length_s", format!("{} s is no length", self.length_s));
        }
        if !(self.factor.is_finite() && self.factor > 1.0) {
            return refuse("factor", format!("{} is not brighter; e.g. 3", self.factor));
        }
        for (camera, entries) in &schedule.cameras {
            let sees = |time_s: f64| self.brightness(rate, time_s, exposure_s) > 1.0;
            if !entries.iter().any(|entry| sees(entry.time_s)) {
                let what =
                    format!("camera {camera} has no picture of it; let it burn longer, or at another frame");
                return refuse("mocap_frame", what);
            }
        }
        Ok(())
    }
}
