//! What is asked of a calibration.

use crate::bundle::{Focal, Free, Loss};
use serde::{Deserialize, Serialize};

/// Which distortion a lens has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LensModel {
    /// None.
    Pinhole,
    /// k₁.
    Radial1,
    /// k₁, k₂.
    Radial2,
    /// k₁, k₂ and a lens that sits askew: p₁, p₂.
    Tangential,
    /// k₁, k₂, k₃, p₁, p₂: OpenCV's own choice; k₃ needs views that reach into the corners.
    Full,
}

/// How residuals are weighed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Robust {
    /// All alike.
    Squares,
    /// Huber's loss [Huber1964].
    Huber,
    /// Cauchy's loss.
    Cauchy,
}

/// Parameters of [`calibrate_board`](crate::calibrate_board).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Params {
    /// Which distortion the lenses have.
    pub lens: LensModel,
    /// Whether pixels are square, so that there is one focal length.
    pub square_pixels: bool,
    /// Whether the principal point is the image's middle.
    pub centered: bool,
    /// How residuals are weighed.
    pub robust: Robust,
    /// From which length on a residual counts less than its square, px; from the residuals' own spread if absent.
    pub scale_px: Option<f64>,
    /// The camera whose space is the world; absent: the board of the first frame is.
    pub world_camera: Option<String>,
    /// The frame whose board is the world, if it is not the first.
    pub world_frame: Option<i64>,
    /// Corners that a view must show to be used.
    pub min_corners: usize,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            lens: LensModel::Tangential,
            square_pixels: false,
            centered: false,
            robust: Robust::Huber,
            scale_px: None,
            world_camera: None,
            world_frame: None,
            min_corners: 6,
        }
    }
}

/// Fewest corners that fix a board's pose.
pub const FEWEST_CORNERS: usize = 4;

impl Params {
    /// Refuses values that make no sense.
    ///
    /// # Errors
    /// What is wrong.
    pub fn check(&self) -> Result<(), crate::Error> {
        let refuse = |name, what: String| Err(crate::Error::Parameter { name, what });
        match self.scale_px {
            Some(scale) if !(scale.is_finite() && scale > 0.0) => {
                return refuse("scale-px", format!("{scale} px is not a positive length"));
            }
            _ => {}
        }
        if self.world_camera.is_some() && self.world_frame.is_some() {
            return refuse("world-frame", "the world is a camera's space or a board's, not both".to_string());
        }
        if self.min_corners < FEWEST_CORNERS {
            let what = format!("{} corners do not fix a board's pose; {FEWEST_CORNERS} do", self.min_corners);
            return refuse("min-corners", what);
        }
        Ok(())
    }

    /// What of a camera moves.
    #[must_use]
    pub fn free(&self) -> Free {
        Free {
            pose: true,
            focal: if self.square_pixels { Focal::Tied } else { Focal::Free },
            center: !self.centered,
            distortion: self.lens.free(),
        }
    }
}

impl LensModel {
    /// Which of k₁, k₂, p₁, p₂, k₃ move.
    #[must_use]
    pub fn free(self) -> [bool; 5] {
        match self {
            Self::Pinhole => [false; 5],
            Self::Radial1 => [true, false, false, false, false],
            Self::Radial2 => [true, true, false, false, false],
            Self::Tangential => [true, true, true, true, false],
            Self::Full => [true; 5],
        }
    }
}

impl Robust {
    /// The loss at a scale.
    #[must_use]
    pub fn loss(self, scale_px: f64) -> Loss {
        match self {
            Self::Squares => Loss::Squares,
            Self::Huber => Loss::Huber { scale_px },
            Self::Cauchy => Loss::Cauchy { scale_px },
        }
    }
}
