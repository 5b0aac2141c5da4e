//! Checks of a calibration by what it did not see: points that several cameras watch at the same time.
//!
//! A low reprojection error of a calibration's own pictures proves little: a lens with a wrong focal length bends its pose
//! until they fit. Here every camera is judged by the others. They say where each point is; what is left between that and what
//! the camera shows is explained by single faults (late, zoomed, turned, mirrored, flipped, moved), and the simplest
//! fault that explains it is named, with its size.
//!
//! Lengths that are known (squares of a board, a wand's path) tell what all cameras have wrong together; sizes,
//! focal lengths and the share of each image that was looked at need no points at all.

mod clock;
mod consensus;
mod fault;
mod finding;
mod lengths;
mod lens;
mod model;
mod numbering;
mod rays;
mod timing;
mod trajectory;

pub use finding::{CameraReport, Examination, Finding, Kind};
pub use lengths::{KnownLength, LengthEnds};
pub use numbering::{SeenCorners, numbered_alike};
pub use timing::at_frame_times;

use camera::Camera;
use nalgebra::Vector2;
use serde::Serialize;

/// A camera on trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Patient {
    /// Its id.
    pub id: String,
    /// Its calibration.
    pub camera: Camera,
    /// Width and height of its footage, px, where they are known.
    pub footage_size: Option<[u32; 2]>,
}

/// A point that cameras saw at the same time.
#[derive(Debug, Clone, PartialEq)]
pub struct Sighting {
    /// Frame number.
    pub frame: i64,
    /// Which point: the same name in other frames is the same point.
    pub name: String,
    /// Who saw it where: index of the camera, px.
    pub views: Vec<(usize, Vector2<f64>)>,
}

/// What a calibration is judged by.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// The cameras.
    pub patients: Vec<Patient>,
    /// What they saw.
    pub sightings: Vec<Sighting>,
    /// Lengths between sightings or cameras.
    pub lengths: Vec<KnownLength>,
}

/// From where on something is a finding.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Params {
    /// A fault must explain this much of a camera's residuals, px.
    pub tolerance_px: f64,
    /// A focal length may be off by this share where the camera's pose hides it.
    pub hidden_focal: f64,
    /// Known lengths may be off by this share in the mean.
    pub length: f64,
    /// The sightings must cover this share of an image.
    pub coverage: f64,
    /// The focal lengths along x and y may differ by this share.
    pub aspect: f64,
}

impl Default for Params {
    fn default() -> Self {
        Self { tolerance_px: 0.25, hidden_focal: 0.01, length: 0.005, coverage: 0.05, aspect: 0.02 }
    }
}

/// Examines a calibration.
///
/// Each finding names a camera, or none where it is the whole rig's. What could not be checked is said too.
#[must_use]
pub fn examine(evidence: &Evidence, params: &Params) -> Examination {
    let mut examination = lens::examine(evidence, params);
    consensus::examine(evidence, params, &mut examination);
    examination.findings.sort_by(|a, b| a.camera.cmp(&b.camera));
    examination
}
