//! Numbers on vertices: distances, their spread, and the range that colours span.

use crate::Error;
use nalgebra::Point3;
use serde::Serialize;

/// How far each vertex is from its counterpart, in the unit of the positions.
///
/// # Errors
/// [`Error::VertexCount`] where the counts differ.
pub fn distances(positions: &[Point3<f64>], reference: &[Point3<f64>]) -> Result<Vec<f64>, Error> {
    if positions.len() != reference.len() {
        return Err(Error::VertexCount { count: positions.len(), other: reference.len() });
    }
    Ok(positions.iter().zip(reference).map(|(point, other)| (point - other).norm()).collect())
}

/// The spread of a set of values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// 95 % of the values are at most this (nearest rank).
    pub p95: f64,
    /// Largest.
    pub max: f64,
}

impl Spread {
    /// The spread of `values`; zeros if there are none.
    #[must_use]
    pub fn of(values: &[f64]) -> Self {
        if values.is_empty() {
            return Self { mean: 0.0, p95: 0.0, max: 0.0 };
        }
        let mut ranked = values.to_vec();
        let rank = (values.len() * 95).div_ceil(100) - 1;
        let p95 = *ranked.select_nth_unstable_by(rank, f64::total_cmp).1;
        let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self { mean: values.iter().sum::<f64>() / values.len() as f64, p95, max }
    }
}

/// The values that the two ends of a colour map stand for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ValueRange {
    /// Value of the first colour.
    pub low: f64,
    /// Value of the last colour.
    pub high: f64,
}

impl ValueRange {
    /// From 0 to the next round number (1, 1.5, 2, 3, 4, 5, 6 or 8 times a power of ten) at or above `value`; to 1
    /// where `value` is next to nothing (below 10⁻⁶).
    #[must_use]
    pub fn up_to(value: f64) -> Self {
        if !(value.is_finite() && value > 1e-6) {
            return Self { low: 0.0, high: 1.0 };
        }
        let power = 10f64.powi(value.log10().floor() as i32);
        let round = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
        let step = round.into_iter().find(|step| step * power >= value * (1.0 - 1e-12)).unwrap_or(10.0);
        Self { low: 0.0, high: step * power }
    }

    /// Where a value lies in the range: 0 at its low end, 1 at its high end, not beyond.
    #[must_use]
    pub fn place(&self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        let proper = self.low.is_finite() && self.high.is_finite() && self.low < self.high;
        match proper {
            true => Ok(()),
            false => Err(Error::Parameter {
                name: "the high end of the colour range",
                value: self.high,
                range: "above its low end",
            }),
        }
    }
}

impl std::str::FromStr for ValueRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("'{text}' is not a range of values; say e.g. 0-5 or 0.5-2");
        let (low, high) = text.split_once('-').ok_or_else(wrong)?;
        let number = |part: &str| part.trim().parse::<f64>().map_err(|_| wrong());
        let range = Self { low: number(low)?, high: number(high)? };
        range.check().map_err(|error| error.to_string())?;
        Ok(range)
    }
}
