//! One measured number.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Which way a number gets better.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Better {
    /// Errors.
    Lower,
    /// Shares of what was found.
    Higher,
}

/// A number that was measured against the truth, or the reason why it could not be.
#[derive(Debug, Clone, PartialEq)]
pub struct Metric {
    /// Its name, without the stage: `rms_mm`.
    pub name: &'static str,
    /// The number; `None` where it could not be measured.
    pub value: Option<f64>,
    /// Its unit: `px`, `mm`, `deg`, `frames`, `ppm`, `count`, `share` (0–1), `ratio` (to another length of its unit).
    pub unit: &'static str,
    /// Why there is no number.
    pub reason: Option<String>,
    /// Which way it gets better.
    pub better: Better,
    /// What it was measured from: counts, and the same number per camera or wrinkle.
    pub context: Map<String, Value>,
}

impl Metric {
    /// An error: lower is better. A number that is not finite counts as not measured.
    #[must_use]
    pub fn error(name: &'static str, unit: &'static str, value: Result<f64, String>) -> Self {
        Self::new(name, unit, Better::Lower, value)
    }

    /// A share of what was found, 0–1: higher is better.
    #[must_use]
    pub fn share(name: &'static str, value: Result<f64, String>) -> Self {
        Self::new(name, "share", Better::Higher, value)
    }

    /// A number of things that went wrong.
    #[must_use]
    pub fn count(name: &'static str, count: usize) -> Self {
        Self::error(name, "count", Ok(count as f64))
    }

    fn new(name: &'static str, unit: &'static str, better: Better, value: Result<f64, String>) -> Self {
        let (value, reason) = match value {
            Ok(value) if value.is_finite() => (Some(value), None),
            Ok(value) => (None, Some(format!("came out as {value}"))),
            Err(reason) => (None, Some(reason)),
        };
        Self { name, value, unit, reason, better, context: Map::new() }
    }

    /// Says what it was measured from.
    #[must_use]
    pub fn with(mut self, key: &str, value: impl Into<Value>) -> Self {
        self.context.insert(key.to_string(), value.into());
        self
    }

    /// Says several things that it was measured from.
    #[must_use]
    pub fn with_all(mut self, context: &Map<String, Value>) -> Self {
        self.context.extend(context.iter().map(|(key, value)| (key.clone(), value.clone())));
        self
    }

    /// Whether it reaches a target. What could not be measured does not.
    #[must_use]
    pub fn reaches(&self, target: f64) -> bool {
        self.value.is_some_and(|value| match self.better {
            Better::Lower => value <= target,
            Better::Higher => value >= target,
        })
    }
}

/// The share `part / whole`, or the reason why there is none.
pub(super) fn share_of(part: usize, whole: usize, nothing: &str) -> Result<f64, String> {
    match whole {
        0 => Err(nothing.to_string()),
        whole => Ok(part as f64 / whole as f64),
    }
}
