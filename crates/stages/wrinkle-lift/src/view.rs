//! A camera as it sees the head at one moment.

use camera::Camera;
use nalgebra::{Isometry3, Matrix2x3, Point3, Vector2, Vector3};

/// A calibrated camera, with the head where it was when the image was taken.
#[derive(Debug, Clone)]
pub struct View<'a> {
    camera: &'a Camera,
    cam_from_head: Isometry3<f64>,
}

impl<'a> View<'a> {
    /// `world_from_head`: the pose of the head at the image's time.
    #[must_use]
    pub fn new(camera: &'a Camera, world_from_head: &Isometry3<f64>) -> Self {
        Self { camera, cam_from_head: camera.cam_from_world * world_from_head }
    }

    /// The centre of projection in head space, mm.
    #[must_use]
    pub fn eye(&self) -> Point3<f64> {
        self.cam_from_head.inverse_transform_point(&Point3::origin())
    }

    /// The unit direction in head space that lands on a pixel; none where the lens folds.
    #[must_use]
    pub fn ray(&self, pixel: Vector2<f64>) -> Option<Vector3<f64>> {
        let direction = self.camera.lens.unproject(pixel)?;
        Some(self.cam_from_head.inverse_transform_vector(&direction).normalize())
    }

    /// The pixel of a point in head space; none behind the camera.
    #[must_use]
    pub fn project(&self, point_in_head: &Point3<f64>) -> Option<Vector2<f64>> {
        let cam = self.cam_from_head * point_in_head;
        (cam.z > 0.0).then(|| self.camera.lens.project(cam.coords))
    }

    /// ∂ pixel / ∂ point in head space, px/mm; none behind the camera.
    #[must_use]
    pub fn slope(&self, point_in_head: &Point3<f64>) -> Option<Matrix2x3<f64>> {
        let cam = self.cam_from_head * point_in_head;
        if cam.z <= 0.0 {
            return None;
        }
        let image = cam.coords.xy() / cam.z;
        let flat = Matrix2x3::new(1.0, 0.0, -image.x, 0.0, 1.0, -image.y) / cam.z;
        let lens = &self.camera.lens;
        let mut slope = lens.distortion.jacobian(image) * flat;
        for axis in 0..2 {
            slope.row_mut(axis).scale_mut(lens.focal_px[axis]);
        }
        Some(slope * self.cam_from_head.rotation.to_rotation_matrix().matrix())
    }

    /// Whether a pixel lies on the image.
    #[must_use]
    pub fn contains(&self, pixel: Vector2<f64>) -> bool {
        self.camera.contains(pixel)
    }
}
