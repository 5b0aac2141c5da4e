//! The lens: from directions before the camera to pixels, and back.

use nalgebra::{Matrix2, Vector2, Vector3};

/// Lens distortion [Brown1971], in OpenCV's form and order: for a normalised point (x, y) with r² = x² + y²,
/// x_d = x (1 + k₁r² + k₂r⁴ + k₃r⁶) + 2 p₁xy + p₂(r² + 2x²), and y_d alike with p₁ and p₂ changed over.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BrownConrady {
    /// Radial, r².
    pub k1: f64,
    /// Radial, r⁴.
    pub k2: f64,
    /// Tangential.
    pub p1: f64,
    /// Tangential.
    pub p2: f64,
    /// Radial, r⁶.
    pub k3: f64,
}

/// Newton steps that undistorting takes at most; it converges in 3 to 5 wherever the lens is not folded.
const MAX_STEPS: usize = 20;
/// A step below this has converged; at focal lengths of thousands of pixels it is below 1e-9 px.
const CONVERGED: f64 = 1e-13;

impl BrownConrady {
    /// Where a normalised point (x / z, y / z) lands on the normalised image.
    #[must_use]
    pub fn distort(&self, point: Vector2<f64>) -> Vector2<f64> {
        let (x, y) = (point.x, point.y);
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3));
        Vector2::new(
            x * radial + 2.0 * self.p1 * x * y + self.p2 * (r2 + 2.0 * x * x),
            y * radial + self.p1 * (r2 + 2.0 * y * y) + 2.0 * self.p2 * x * y,
        )
    }

    /// ∂ distort / ∂ point.
    #[must_use]
    pub fn jacobian(&self, point: Vector2<f64>) -> Matrix2<f64> {
        let (x, y) = (point.x, point.y);
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3));
        let slope = 2.0 * (self.k1 + r2 * (2.0 * self.k2 + 3.0 * r2 * self.k3));
        let mixed = slope * x * y + 2.0 * (self.p1 * x + self.p2 * y);
        Matrix2::new(
            radial + slope * x * x + 2.0 * self.p1 * y + 6.0 * self.p2 * x,
            mixed,
            mixed,
            radial + slope * y * y + 6.0 * self.p1 * y + 2.0 * self.p2 * x,
        )
    }

    /// The normalised point that lands at `image`; none where the lens folds before it gets there, which no real lens
    /// does inside its image.
    #[must_use]
    pub fn undistort(&self, image: Vector2<f64>) -> Option<Vector2<f64>> {
        let mut point = image;
        for _ in 0..MAX_STEPS {
            let slopes = self.jacobian(point);
            if slopes.determinant() <= 0.0 {
                return None;
            }
            let step = slopes.try_inverse()? * (image - self.distort(point));
            point += step;
            if step.norm() < CONVERGED * (1.0 + point.norm()) {
                let unfolded = self.jacobian(point).determinant() > 0.0;
                return (unfolded && point.iter().all(|x| x.is_finite())).then_some(point);
            }
        }
        None
    }
}

/// Intrinsics: pixels per unit of the normalised image, principal point, distortion. Pixel (0, 0) is the *centre* of the
/// top-left pixel; x runs right, y down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Focal lengths along x and y, px.
    pub focal_px: Vector2<f64>,
    /// Principal point, px.
    pub center_px: Vector2<f64>,
    /// Distortion.
    pub distortion: BrownConrady,
}

impl Lens {
    /// The pixel of a point in camera space (z forward); means nothing where z is not positive.
    #[must_use]
    pub fn project(&self, point_in_cam: Vector3<f64>) -> Vector2<f64> {
        let image = self.distortion.distort(point_in_cam.xy() / point_in_cam.z);
        self.focal_px.component_mul(&image) + self.center_px
    }

    /// The direction (x, y, 1) in camera space that lands on a pixel; none where the lens folds.
    #[must_use]
    pub fn unproject(&self, pixel: Vector2<f64>) -> Option<Vector3<f64>> {
        let image = (pixel - self.center_px).component_div(&self.focal_px);
        self.distortion.undistort(image).map(|point| Vector3::new(point.x, point.y, 1.0))
    }
}
