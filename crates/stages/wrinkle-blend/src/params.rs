//! How poses are compared and wrinkles shown.

use crate::Error;
use serde::{Deserialize, Serialize};

/// Parameters of a [`Blender`](crate::Blender).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Params {
    /// Which point of a bone is watched.
    pub probe: Probe,
    /// How a bone's share reaches the vertices that hang on it.
    pub mask: Mask,
    /// Whether poses share out a bone's move among them, instead of each comparing it with its own.
    pub dual: bool,
    /// A bone that moves less in a pose is not of that pose, mm.
    pub least_mm: f64,
    /// The same, as a share of what the farthest bone of the pose moves.
    pub least_share: f64,
}

/// Which point of a bone is watched, in the space of the head.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Probe {
    /// The centroid of the skin that hangs on it, by weight: moves also where a bone turns on the spot.
    Skin,
    /// Its origin [DutreveMeyer2011, Eq. 4].
    Joint,
}

/// How a bone's share reaches the vertices that hang on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mask {
    /// Fades in over skin weights from 0 to 0.25; where several bones of a pose hold a vertex, their mean.
    Smooth,
    /// Wholly, however small the weight; shares add up, to 1 at most [DutreveMeyer2011, Eq. 5].
    Paper,
}

impl Default for Params {
    fn default() -> Self {
        Self { probe: Probe::Skin, mask: Mask::Smooth, dual: false, least_mm: 0.5, least_share: 0.01 }
    }
}

impl Params {
    /// Whether every parameter is in its range.
    ///
    /// # Errors
    /// Names the one that is not.
    pub fn check(&self) -> Result<(), Error> {
        let refuse = |what| Err(Error::Params(what));
        if !(self.least_mm >= 0.0 && self.least_mm.is_finite()) {
            return refuse(format!("least_mm is {}, not a length", self.least_mm));
        }
        if !(0.0..1.0).contains(&self.least_share) {
            return refuse(format!("least_share is {}, not in 0 … 1", self.least_share));
        }
        Ok(())
    }
}
