//! A camera as triangulation uses it: the pose as a matrix, and how the pixel answers to the point.

use camera::{Camera, Lens};
use nalgebra::{Matrix2, Matrix2x3, Matrix3, Point3, Unit, Vector2, Vector3};

/// A camera of the rig, prepared.
#[derive(Debug, Clone)]
pub(crate) struct View {
    rotation: Matrix3<f64>,
    translation: Vector3<f64>,
    lens: Lens,
    pub(crate) eye: Point3<f64>,
    pub(crate) image_size: [u32; 2],
}

impl View {
    pub(crate) fn of(camera: &Camera) -> Self {
        Self {
            rotation: camera.cam_from_world.rotation.to_rotation_matrix().into_inner(),
            translation: camera.cam_from_world.translation.vector,
            lens: camera.lens,
            eye: camera.eye_in_world(),
            image_size: camera.image_size,
        }
    }

    /// The direction in world space that lands on a pixel; none where the lens folds.
    pub(crate) fn ray(&self, pixel: Vector2<f64>) -> Option<Unit<Vector3<f64>>> {
        Some(Unit::new_normalize(self.rotation.tr_mul(&self.lens.unproject(pixel)?)))
    }

    /// The pixel of a point, and ∂ pixel / ∂ point, px/mm; none behind the camera.
    pub(crate) fn project(&self, point: &Point3<f64>) -> Option<(Vector2<f64>, Matrix2x3<f64>)> {
        let cam = self.rotation * point.coords + self.translation;
        if cam.z <= 0.0 {
            return None;
        }
        let image = cam.xy() / cam.z;
        let to_image = (self.rotation.fixed_rows::<2>(0) - image * self.rotation.row(2)) / cam.z;
        let to_pixel = Matrix2::from_diagonal(&self.lens.focal_px) * self.lens.distortion.jacobian(image);
        Some((self.lens.project(cam), to_pixel * to_image))
    }

    /// The pixel of a point alone.
    pub(crate) fn pixel(&self, point: &Point3<f64>) -> Option<Vector2<f64>> {
        let cam = self.rotation * point.coords + self.translation;
        (cam.z > 0.0).then(|| self.lens.project(cam))
    }

    /// Whether a pixel may be a point of this camera's image, `margin` px outside it included.
    pub(crate) fn may_show(&self, pixel: Vector2<f64>, margin: f64) -> bool {
        let [width, height] = self.image_size.map(f64::from);
        let inside = |x: f64, size: f64| (-margin..size + margin).contains(&x);
        inside(pixel.x, width) && inside(pixel.y, height)
    }
}
