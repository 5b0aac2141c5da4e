//! A point from its images.

use crate::Camera;
use nalgebra::{Matrix3, Point3, Unit, Vector2, Vector3};

/// Rays whose normal matrix has an eigenvalue below this, as a share of their number, are parallel.
const PARALLEL: f64 = 1e-10;

/// The point nearest to rays (an origin and a direction each), in the sense of least squares of its distances to their lines
/// [HartleyZisserman2004, § 12]. None from fewer than two rays or parallel ones. It may lie behind an origin.
#[must_use]
pub fn nearest_to_lines(
    rays: impl IntoIterator<Item = (Point3<f64>, Unit<Vector3<f64>>)>,
) -> Option<Point3<f64>> {
    let (mut normal, mut right, mut count) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
    for (origin, direction) in rays {
        // Takes away what runs along the ray.
        let across = Matrix3::identity() - direction.into_inner() * direction.transpose();
        normal += across;
        right += across * origin.coords;
        count += 1.0;
    }
    if least_eigenvalue(&normal) <= PARALLEL * count {
        return None;
    }
    Some(Point3::from(normal.cholesky()?.solve(&right)))
}

/// The least eigenvalue of a positive semi-definite matrix, where it is far below the others: the product of all three over the
/// sum of their products in pairs. Elsewhere up to three times too small.
fn least_eigenvalue(matrix: &Matrix3<f64>) -> f64 {
    let minor = |i: usize, j: usize| matrix[(i, i)] * matrix[(j, j)] - matrix[(i, j)] * matrix[(j, i)];
    let pairs = minor(0, 1) + minor(1, 2) + minor(0, 2);
    if pairs > 0.0 { matrix.determinant() / pairs } else { 0.0 }
}

impl Camera {
    /// The point in world space nearest to the rays through the given pixels, in the sense of least squares of its distances
    /// to them [HartleyZisserman2004, § 12]; where a reprojection error is minimised, it is where to start. None from fewer
    /// than two rays, parallel rays, or if the point lies behind one of the cameras.
    #[must_use]
    pub fn nearest_to_rays<'a>(
        views: impl IntoIterator<Item = (&'a Self, Vector2<f64>), IntoIter: Clone>,
    ) -> Option<Point3<f64>> {
        let mut views = views.into_iter();
        let ray = |(camera, pixel): (&Self, _)| Some((camera.eye_in_world(), camera.ray_in_world(pixel)?));
        let rays: Vec<_> = views.clone().map(ray).collect::<Option<_>>()?;
        let point = nearest_to_lines(rays)?;
        views.all(|(camera, _)| (camera.cam_from_world * point).z > 0.0).then_some(point)
    }
}
