//! Whether the scan already has the valley that is to be put on it.

use crate::curve::Curve;
use crate::reach::Beside;
use crate::surface::Surface;
use artifact::ProfileShape;
use nalgebra::{Matrix4, Vector4};

/// Depth, mm, of a valley at rest along a crease: the skin's height over the tangent plane, fitted by a parabola and a section of
/// width `width_mm`. Negative where the skin stands out.
pub(crate) fn depth(surface: &Surface, curve: &Curve, reach: &[Beside], width_mm: f64) -> f64 {
    let (mut normal, mut right) = (Matrix4::<f64>::zeros(), Vector4::<f64>::zeros());
    let section = ProfileShape { w: width_mm, d: 1.0, epsilon: 0.3, kappa: 0.0 };
    for beside in reach.iter().filter(|beside| beside.foot.distance < 2.5 * width_mm) {
        let from = surface.rest[beside.vertex as usize] - beside.foot.point(&curve.points);
        let height = from.dot(&beside.foot.direction(&curve.normals));
        let q = beside.across_mm;
        let row = Vector4::new(1.0, q, q * q, section.at(q).0);
        normal += row * row.transpose();
        right += row * height;
    }
    normal.lu().solve(&right).map_or(0.0, |solution| solution[3])
}
