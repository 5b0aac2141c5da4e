//! How to bake.

use crate::Error;
use serde::{Deserialize, Serialize};

/// Parameters of [`bake`](crate::bake).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Params {
    /// Texels in a row and rows of each map.
    pub size: usize,
    /// Samples in a row and rows within a texel.
    pub samples: usize,
    /// How far from the low-resolution surface the wrinkled one is looked for, to both sides, mm.
    pub reach_mm: f64,
    /// By how many texels the maps grow beyond the edges of what is unwrapped, so that filtering finds no gap.
    pub padding: usize,
}

impl Default for Params {
    fn default() -> Self {
        Self { size: 2048, samples: 2, reach_mm: 3.0, padding: 8 }
    }
}

impl Params {
    /// Whether every parameter is in its range.
    ///
    /// # Errors
    /// If one is not.
    pub fn check(&self) -> Result<(), Error> {
        let refuse = |name, value, range| Err(Error::Parameter { name, value, range });
        match self {
            Self { size, .. } if !(1..=32_768).contains(size) => {
                refuse("size", *size as f64, "between 1 and 32768")
            }
            Self { samples, .. } if !(1..=16).contains(samples) => {
                refuse("samples", *samples as f64, "between 1 and 16")
            }
            Self { reach_mm, .. } if !(reach_mm.is_finite() && *reach_mm > 0.0) => {
                refuse("reach-mm", *reach_mm, "a number above 0")
            }
            Self { padding, size, .. } if padding > size => {
                refuse("padding", *padding as f64, "at most the size")
            }
            _ => Ok(()),
        }
    }
}
