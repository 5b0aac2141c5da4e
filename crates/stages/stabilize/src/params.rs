//! Parameters, with their units and defaults.

use crate::Error;
use serde::Serialize;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Times that may be asked for, ms.
pub const TIMES_MS: RangeInclusive<f64> = 0.0..=10_000.0;

/// How a take is stabilised.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Params {
    /// Ids of the head markers, or patterns with `*` and `?`; empty: the least deforming markers are found.
    pub head_markers: Vec<String>,
    /// Ids or patterns of markers to leave out altogether.
    pub drop: Vec<String>,
    /// The frame at which head space is world space; the first that shows the most markers if absent.
    pub reference_frame: Option<i64>,
    /// Time scale of pose jitter, ms: what all markers do together faster than this is taken for noise of the pose.
    /// 0 leaves the pose as it was fitted.
    pub smooth_ms: f64,
    /// From which step against its neighbours a marker counts as having jumped.
    pub jump: JumpLimit,
    /// Longest gap that is filled, ms.
    pub fill_ms: f64,
    /// What is done with samples that stand under another marker's name.
    pub swaps: Swaps,
    /// Whether the head markers are written among the trajectories.
    pub keep_head_markers: bool,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            head_markers: Vec::new(),
            drop: Vec::new(),
            reference_frame: None,
            smooth_ms: 60.0,
            jump: JumpLimit::Auto,
            fill_ms: 100.0,
            swaps: Swaps::Mend,
            keep_head_markers: false,
        }
    }
}

/// From which step against its neighbours a marker counts as having jumped.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum JumpLimit {
    /// From each marker's own steps, and never less than 10 mm or 0.4 m/s.
    Auto,
    /// Jumps are not looked for.
    Off,
    /// A fixed length, mm per frame.
    Mm(f64),
}

impl FromStr for JumpLimit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => Ok(Self::Auto),
            "off" => Ok(Self::Off),
            _ => match text.parse::<f64>() {
                Ok(limit) if limit.is_finite() && limit > 0.0 => Ok(Self::Mm(limit)),
                _ => Err(format!("'{text}' is not a positive length in mm, 'auto' or 'off'")),
            },
        }
    }
}

/// What is done with samples that stand under another marker's name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Swaps {
    /// They are reported and taken out.
    Report,
    /// Where it is clear whose they are, they are given back; else as `Report`.
    Mend,
}

impl Params {
    /// Refuses values that make no sense.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<(), Error> {
        let time = |name, value: f64| match TIMES_MS.contains(&value) {
            true => Ok(()),
            false => Err(Error::Parameter { name, value, allowed: "0 to 10000 ms are allowed" }),
        };
        time("smooth-ms", self.smooth_ms)?;
        time("fill-ms", self.fill_ms)?;
        match self.jump {
            JumpLimit::Mm(value) if !(value.is_finite() && value > 0.0) => {
                Err(Error::Parameter { name: "jump-mm", value, allowed: "it must be positive" })
            }
            _ => Ok(()),
        }
    }

    /// Whether anything is measured in time, so that the frame rate must be known.
    pub(crate) fn needs_rate(&self) -> bool {
        self.smooth_ms > 0.0 || self.fill_ms > 0.0 || self.jump == JumpLimit::Auto
    }
}
