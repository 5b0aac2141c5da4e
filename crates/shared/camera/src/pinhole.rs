//! The pinhole camera.

use nalgebra::{Isometry3, Point3, Vector2, Vector3};

/// A camera without distortion: `x_cam = cam_from_world · x_world`, z forward, x right, y down; pixel (0, 0) is the
/// *centre* of the top-left pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Pinhole {
    /// World to camera.
    pub cam_from_world: Isometry3<f64>,
    /// Focal length, pixels.
    pub focal_px: f64,
    /// Principal point, pixels.
    pub center_px: Vector2<f64>,
}

impl Pinhole {
    /// A camera at `eye` that looks at `target`, with `up` upwards in the image. `up` must not run along the view.
    #[must_use]
    pub fn looking_at(
        eye: Point3<f64>,
        target: Point3<f64>,
        up: Vector3<f64>,
        focal_px: f64,
        center_px: Vector2<f64>,
    ) -> Self {
        // `look_at_rh` looks along −z with y up; half a turn about x makes that z forward, y down.
        let turn = Isometry3::rotation(Vector3::x() * std::f64::consts::PI);
        Self { cam_from_world: turn * Isometry3::look_at_rh(&eye, &target, &up), focal_px, center_px }
    }

    /// The image point and the depth along the view; the image point means nothing where the depth is not positive.
    #[must_use]
    pub fn project(&self, point: &Point3<f64>) -> (Vector2<f64>, f64) {
        let cam = self.cam_from_world * point;
        (Vector2::new(cam.x, cam.y) / cam.z * self.focal_px + self.center_px, cam.z)
    }
}
