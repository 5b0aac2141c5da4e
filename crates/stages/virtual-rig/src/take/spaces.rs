//! From the scan's space to the world of the cameras.

use crate::Error;
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the recording differs from the scan: a rigid motion, a scale, and a bend that neither explains (two systems
/// calibrated apart never agree exactly).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Spaces {
    /// Size of the bend, mm: at most 1.3 times this within the face.
    pub bend_mm: f64,
    /// Scale from scan to recording.
    pub scale: f64,
}

impl Default for Spaces {
    fn default() -> Self {
        Self { bend_mm: 1.0, scale: 1.0 }
    }
}

/// Length over which the bend grows to its size, mm.
const BEND_REACH: f64 = 100.0;

impl Spaces {
    /// Whether such a recording can be.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self) -> Result<(), Error> {
        if !(0.0..=20.0).contains(&self.bend_mm) {
            return Err(Error::parameter("spaces.bend_mm", "must lie between 0 and 20 mm"));
        }
        match (0.5..=2.0).contains(&self.scale) {
            true => Ok(()),
            false => Err(Error::parameter("spaces.scale", "must lie between 0.5 and 2")),
        }
    }

    /// Where a face stands in the world when the head is at rest, but for scale and bend.
    #[must_use]
    pub fn world_from_face() -> Isometry3<f64> {
        let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_euler_angles(-0.10, 0.35, 0.04));
        Isometry3::from_parts(Translation3::new(120.0, 1460.0, -240.0), turn)
    }

    /// Carries a point of the scan's space into mocap space (the head at rest), mm.
    #[must_use]
    pub fn mocap_from_face(&self, point: Point3<f64>) -> Point3<f64> {
        let q = point.coords / BEND_REACH;
        let bend = Vector3::new(
            0.6 * q.x * q.y,
            0.5 * q.y * q.z - 0.2 * q.x * q.x,
            0.8 * q.x * q.x - 0.5 * q.y * q.y,
        );
        Self::world_from_face() * Point3::from(self.scale * (point.coords + self.bend_mm * bend))
    }
}
