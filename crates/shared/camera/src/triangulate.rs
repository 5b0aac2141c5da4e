//! A point from its images.

use crate::Camera;
use nalgebra::{Matrix3, Point3, Vector2, Vector3};

/// Rays whose normal matrix is worse conditioned than this are parallel.
const PARALLEL: f64 = 1e-10;

impl Camera {
    /// The point in world space nearest to the rays through the given pixels, in the sense of least squares of its distances
    /// to them [HartleyZisserman2004, § 12]; where a reprojection error is minimised, it is where to start. None from fewer
    /// than two rays, parallel rays, or if the point lies behind one of the cameras.
    #[must_use]
    pub fn nearest_to_rays<'a>(
        views: impl IntoIterator<Item = (&'a Self, Vector2<f64>), IntoIter: Clone>,
    ) -> Option<Point3<f64>> {
        let views = views.into_iter();
        let mut normal = Matrix3::zeros();
        let mut right = Vector3::zeros();
        let mut count = 0;
        for (camera, pixel) in views.clone() {
            let direction = camera.ray_in_world(pixel)?.into_inner();
            // Takes away what runs along the ray.
            let across = Matrix3::identity() - direction * direction.transpose();
            normal += across;
            right += across * camera.eye_in_world().coords;
            count += 1;
        }
        let eigenvalues = normal.symmetric_eigenvalues();
        if count < 2 || eigenvalues.min() <= PARALLEL * eigenvalues.max() {
            return None;
        }
        let point = Point3::from(normal.cholesky()?.solve(&right));
        let mut views = views;
        views.all(|(camera, _)| (camera.cam_from_world * point).z > 0.0).then_some(point)
    }
}
