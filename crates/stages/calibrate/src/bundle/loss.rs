//! How much a residual counts.

use serde::{Deserialize, Serialize};

/// What a residual costs, by its length in pixels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Loss {
    /// Its square: best where every observation is right.
    Squares,
    /// Its square up to the scale, from there on linear [Huber1964].
    Huber {
        /// Where it turns linear, px.
        scale_px: f64,
    },
    /// The logarithm's: gross errors end up with next to no pull.
    Cauchy {
        /// Where a residual's pull is half of its square's, px.
        scale_px: f64,
    },
}

impl Loss {
    /// ρ(s) of a squared length s, px²; it is s near zero.
    #[must_use]
    pub fn cost(self, squared: f64) -> f64 {
        match self {
            Self::Squares => squared,
            Self::Huber { scale_px: c } if squared <= c * c => squared,
            Self::Huber { scale_px: c } => 2.0 * c * squared.sqrt() - c * c,
            Self::Cauchy { scale_px: c } => c * c * (squared / (c * c)).ln_1p(),
        }
    }

    /// ρ′(s): the weight that makes least squares of the residual pull like the loss; 1 near zero.
    #[must_use]
    pub fn weight(self, squared: f64) -> f64 {
        match self {
            Self::Squares => 1.0,
            Self::Huber { scale_px: c } if squared <= c * c => 1.0,
            Self::Huber { scale_px: c } => c / squared.sqrt(),
            Self::Cauchy { scale_px: c } => 1.0 / (1.0 + squared / (c * c)),
        }
    }

    /// The scale, px; none where there is none.
    #[must_use]
    pub fn scale_px(self) -> Option<f64> {
        match self {
            Self::Squares => None,
            Self::Huber { scale_px } | Self::Cauchy { scale_px } => Some(scale_px),
        }
    }
}
