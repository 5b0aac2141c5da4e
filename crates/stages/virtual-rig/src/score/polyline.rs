//! Distances to polylines, in images and in space.

use nalgebra::SVector;

/// The place of a polyline that is nearest to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Foot {
    pub(super) distance: f64,
    /// The segment from point `segment` to the next …
    pub(super) segment: usize,
    /// … and how far along it, 0–1.
    pub(super) share: f64,
    /// Whether the polyline ends here and the point lies beyond its end: then it has no counterpart on the line.
    pub(super) beyond: bool,
}

impl Foot {
    /// A quantity given at the polyline's points, here.
    pub(super) fn value(&self, at_points: impl Fn(usize) -> f64) -> f64 {
        let from = at_points(self.segment);
        if self.share == 0.0 {
            return from;
        }
        from + self.share * (at_points(self.segment + 1) - from)
    }
}

/// How far beyond an end a point still counts as beside it, as a share of its distance: rounding.
const BEYOND: f64 = 1e-9;

/// The nearest place of a polyline; none of a polyline without points.
pub(super) fn nearest<const D: usize>(line: &[SVector<f64, D>], point: &SVector<f64, D>) -> Option<Foot> {
    let (first, last) = (line.first()?, line.len() - 1);
    let mut best = Foot { distance: (first - point).norm(), segment: 0, share: 0.0, beyond: last == 0 };
    for segment in 0..last {
        let (from, along) = (line[segment], line[segment + 1] - line[segment]);
        let length = along.norm_squared();
        let place = if length > 0.0 { (point - from).dot(&along) / length } else { 0.0 };
        let share = place.clamp(0.0, 1.0);
        // The ends themselves, not what interpolation makes of them.
        let foot = if share == 1.0 { line[segment + 1] } else { from + share * along };
        let distance = (foot - point).norm();
        let beyond = (segment == 0 && place < -BEYOND) || (segment + 1 == last && place > 1.0 + BEYOND);
        if distance < best.distance || segment == 0 {
            best = Foot { distance, segment, share, beyond };
        }
    }
    Some(best)
}
