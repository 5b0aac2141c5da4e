//! Which vertices a crease reaches, and where they lie beside it: distances from a line on the surface.

use crate::curve::{Curve, Foot, nearest_from};
use crate::surface::Surface;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A vertex beside a crease, at rest.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Beside {
    pub(crate) vertex: u32,
    pub(crate) foot: Foot,
    /// Signed distance from the crease, mm; positive on its right.
    pub(crate) across_mm: f64,
}

/// The vertices within `limit_mm` of a crease, rising. The surface is walked over from the crease on, so what is near in space
/// only (the other lip) is not reached; distances are straight, which over `limit_mm` differs from the way along the skin by
/// less than one part in a hundred.
pub(crate) fn reach(surface: &Surface, curve: &Curve, limit_mm: f64) -> Vec<Beside> {
    if curve.points.len() < 2 {
        return Vec::new();
    }
    let mut found: Vec<Option<Foot>> = vec![None; surface.rest.len()];
    let mut open = BinaryHeap::new();
    let mut offer = |open: &mut BinaryHeap<Reverse<Open>>, vertex: u32, hint: u32| {
        let foot = nearest_from(&curve.points, hint, &surface.rest[vertex as usize]);
        let known = &mut found[vertex as usize];
        if foot.distance <= limit_mm && known.is_none_or(|known| foot.distance < known.distance) {
            *known = Some(foot);
            open.push(Reverse(Open { distance: foot.distance, vertex, segment: foot.segment }));
        }
    };
    for (k, place) in curve.places.iter().enumerate() {
        let corners = surface.triangles[place.triangle as usize];
        corners.iter().for_each(|&vertex| offer(&mut open, vertex, k as u32));
    }
    while let Some(Reverse(next)) = open.pop() {
        surface.for_neighbors(next.vertex, |other| offer(&mut open, other, next.segment));
    }
    let beside = |(vertex, foot): (usize, Option<Foot>)| {
        let foot = foot?;
        let side = (surface.rest[vertex] - foot.point(&curve.points)).dot(&foot.direction(&curve.across));
        Some(Beside { vertex: vertex as u32, foot, across_mm: foot.distance.copysign(side) })
    };
    found.into_iter().enumerate().filter_map(beside).collect()
}

/// A vertex to go on from, nearest first.
#[derive(PartialEq)]
struct Open {
    distance: f64,
    vertex: u32,
    segment: u32,
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.distance
            .total_cmp(&other.distance)
            .then(self.vertex.cmp(&other.vertex))
            .then(self.segment.cmp(&other.segment))
    }
}
