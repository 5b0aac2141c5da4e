//! A calibrated camera.

use crate::lens::Lens;
use crate::pinhole::Pinhole;
use nalgebra::{Isometry3, Point3, Unit, Vector2, Vector3};

/// A calibrated camera, OpenCV's model: `x_cam = cam_from_world · x_world`, z forward, x right, y down, then the lens.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    /// Image width, height, px.
    pub image_size: [u32; 2],
    /// Intrinsics.
    pub lens: Lens,
    /// World to camera.
    pub cam_from_world: Isometry3<f64>,
}

impl Camera {
    /// The pose of a camera at `eye` that looks at `target`, with `up` upwards in the image. `up` must not run along the
    /// view.
    #[must_use]
    pub fn pose_looking_at(eye: Point3<f64>, target: Point3<f64>, up: Vector3<f64>) -> Isometry3<f64> {
        Pinhole::looking_at(eye, target, up, 1.0, Vector2::zeros()).cam_from_world
    }

    /// The pixel of a point in world space; none behind the camera.
    #[must_use]
    pub fn project(&self, point_in_world: &Point3<f64>) -> Option<Vector2<f64>> {
        let cam = self.cam_from_world * point_in_world;
        (cam.z > 0.0).then(|| self.lens.project(cam.coords))
    }

    /// The centre of projection in world space.
    #[must_use]
    pub fn eye_in_world(&self) -> Point3<f64> {
        self.cam_from_world.inverse_transform_point(&Point3::origin())
    }

    /// The direction in world space that lands on a pixel; none where the lens folds.
    #[must_use]
    pub fn ray_in_world(&self, pixel: Vector2<f64>) -> Option<Unit<Vector3<f64>>> {
        let direction = self.lens.unproject(pixel)?;
        Some(Unit::new_normalize(self.cam_from_world.inverse_transform_vector(&direction)))
    }

    /// Whether a pixel position lies on the image: within half a pixel of a pixel's centre.
    #[must_use]
    pub fn contains(&self, pixel: Vector2<f64>) -> bool {
        let [width, height] = self.image_size.map(f64::from);
        (-0.5..width - 0.5).contains(&pixel.x) && (-0.5..height - 0.5).contains(&pixel.y)
    }
}
