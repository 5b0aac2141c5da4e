//! Rigid alignment that never makes things worse.

use nalgebra::{Isometry3, Point3};

/// The rigid motion, without scale, that carries `source` onto `target` with the least squared distance; none where
/// the points do not determine one. Points that lie on each other already stay exactly where they are.
pub(super) fn rigid(source: &[Point3<f64>], target: &[Point3<f64>]) -> Option<Isometry3<f64>> {
    let fitted = camera::fit_rigid(source, target, None).ok()?;
    let squares = |motion: &Isometry3<f64>| {
        source.iter().zip(target).map(|(from, to)| (motion * from - to).norm_squared()).sum::<f64>()
    };
    // Rounding makes the fit of equal points differ from the identity in the last digits.
    let still = Isometry3::identity();
    Some(if squares(&still) <= squares(&fitted) { still } else { fitted })
}
