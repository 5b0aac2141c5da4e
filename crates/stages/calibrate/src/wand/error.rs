//! Why a waved point tells no cameras.

use super::{LEAST_FRAMES, scale::named};
use crate::bundle;

/// Why a waved point tells no cameras.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// Too few cameras.
    #[error("{0} cameras saw the point; three are needed, or two whose lenses are known")]
    TooFewCameras(usize),
    /// Some lenses are known, others are not.
    #[error("camera {0}: its lens is not given, but others' are; give all or none")]
    LensMissing(String),
    /// A camera that hardly saw the point.
    #[error("camera {camera}: sees the point in {seen} frames; {LEAST_FRAMES} are needed")]
    TooFewFrames {
        /// The camera.
        camera: String,
        /// In how many frames it saw the point.
        seen: usize,
    },
    /// No two cameras agree.
    #[error("no two cameras see the point move in a way that two views of one point can")]
    NoPair,
    /// A camera that does not fit with the others.
    #[error("camera {0}: what it sees does not fit with what the others see at the same time")]
    Apart(String),
    /// Most sightings fit with nothing.
    #[error("{rejected} of {seen} sightings fit with nothing that other cameras see at the same time")]
    Rejected {
        /// How many were taken out.
        rejected: usize,
        /// Of how many.
        seen: usize,
    },
    /// Cameras that see the world as in a mirror.
    #[error("camera {}: its images are mirrored", .0.join(", "))]
    Mirrored(Vec<String>),
    /// No metric reconstruction.
    #[error("no focal lengths make this one point before all cameras")]
    NoMetric,
    /// The bundle adjustment failed.
    #[error("the bundle adjustment failed: {0}")]
    Bundle(#[from] bundle::Error),
    /// A length between cameras or frames that are not there.
    #[error("the known length {}: {what}", named(.length))]
    Length {
        /// The length.
        length: super::Length,
        /// What is wrong.
        what: String,
    },
    /// Known lengths that no scale fits.
    #[error(
        "the known lengths contradict each other: {} comes out as {mm:.2} mm beside the others, {:+.1} % off; {:.0} % are let pass",
        named(.length), 100.0 * (mm / length.mm - 1.0), 100.0 * super::scale::LENGTHS_AGREE
    )]
    Contradiction {
        /// The length that is furthest off.
        length: super::Length,
        /// What it is at the scale that fits all best, mm.
        mm: f64,
    },
    /// A parameter outside its range.
    #[error("{name} is {value}, which is out of range")]
    Parameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
}

impl Error {
    /// What to do about it.
    #[must_use]
    pub fn fix(&self) -> Option<&'static str> {
        Some(match self {
            Self::TooFewFrames { .. } => "wave the point where this camera sees it, or leave the camera out",
            Self::NoPair | Self::Apart(_) => {
                "check that images of equal number were taken at the same time and are not mirrored, that one point only \
                 glows, and that it was waved through the depth of the space, not in a plane"
            }
            Self::Mirrored(_) => "switch off mirroring in the camera or its recorder, or flip the images",
            Self::TooFewCameras(_) => "film with more cameras, or give approximate lenses with --intrinsics",
            Self::LensMissing(_) => {
                "add the lens to the file of --intrinsics, or leave the camera out with --without"
            }
            Self::Length { .. } => {
                "state lengths between frames in which two cameras see the point, or between two cameras"
            }
            Self::NoMetric => {
                "wave the point through more of the images and the depth, or give approximate lenses"
            }
            Self::Contradiction { .. } => "measure the lengths again, and give those that are sure",
            Self::Bundle(_) | Self::Rejected { .. } => {
                "check that images of equal number were taken at the same time in all cameras: write --out-tracks and ask the doctor \
                 with an older calibration, or leave out cameras with --without until the others fit"
            }
            _ => return None,
        })
    }
}
