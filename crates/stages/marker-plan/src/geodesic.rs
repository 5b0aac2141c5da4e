//! Distances along the surface, in a metric that may vary from place to place.

use mesh::{Around, Connectivity};
use nalgebra::Point3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Distances on a mesh by fast marching [KimmelSethian1998]: a front goes out from the sources, and each triangle hands it on as if it
/// were straight there. On obtuse corners it goes along the edge instead, which makes distances a little too long.
pub(crate) struct Marching<'a> {
    points: &'a [Point3<f64>],
    triangles: &'a [[u32; 3]],
    around: Around,
    /// Length of a millimetre in the metric, per vertex.
    density: &'a [f64],
}

impl<'a> Marching<'a> {
    pub(crate) fn new(points: &'a [Point3<f64>], triangles: &'a [[u32; 3]], density: &'a [f64]) -> Self {
        let around = Around::of(points.len(), triangles);
        Self { points, triangles, around, density }
    }

    /// Lowers `distance` where one of the sources is nearer than what it says, and sets `owner` there to the source's label.
    pub(crate) fn spread(&self, sources: &[(u32, u32)], distance: &mut [f64], owner: &mut [u32]) {
        let mut open = BinaryHeap::new();
        for &(vertex, label) in sources {
            distance[vertex as usize] = 0.0;
            owner[vertex as usize] = label;
            open.push(Reverse((Length(0.0), vertex)));
        }
        while let Some(Reverse((Length(reached), vertex))) = open.pop() {
            if reached > distance[vertex as usize] {
                continue;
            }
            let label = owner[vertex as usize];
            for &triangle in self.around.at(vertex) {
                for &next in self.triangles[triangle as usize].iter().filter(|&&next| next != vertex) {
                    let third =
                        self.triangles[triangle as usize].into_iter().find(|&v| v != vertex && v != next);
                    let length = self.arrive(vertex, third.unwrap_or(vertex), next, distance, owner);
                    if length < distance[next as usize] {
                        distance[next as usize] = length;
                        owner[next as usize] = label;
                        open.push(Reverse((Length(length), next)));
                    }
                }
            }
        }
    }

    /// When the front arrives at `next`, which it reaches from `vertex`, and from `third` if it has been there.
    fn arrive(&self, vertex: u32, third: u32, next: u32, distance: &[f64], owner: &[u32]) -> f64 {
        let at = |vertex: u32| self.points[vertex as usize];
        let density = 0.5 * (self.density[vertex as usize] + self.density[next as usize]);
        let (a, b) = (at(vertex) - at(next), at(third) - at(next));
        let along = distance[vertex as usize] + density * a.norm();
        let (ta, tb) = (distance[vertex as usize] / density, distance[third as usize] / density);
        if owner[third as usize] != owner[vertex as usize] || tb > ta || a.dot(&b) < 0.0 {
            return along;
        }
        // A straight front over the triangle: its gradient g (unit) with g·(−a) = t − ta, g·(−b) = t − tb.
        let (aa, ab, bb) = (a.norm_squared(), a.dot(&b), b.norm_squared());
        let det = aa * bb - ab * ab;
        if det <= 1e-12 * aa * bb {
            return along;
        }
        let (qa, qb, qc) = (
            bb - 2.0 * ab + aa,
            (ab - bb) * ta + (ab - aa) * tb,
            bb * ta * ta - 2.0 * ab * ta * tb + aa * tb * tb - det,
        );
        let root = qb * qb - qa * qc;
        if root < 0.0 {
            return along;
        }
        let t = (-qb + root.sqrt()) / qa;
        // The front must come from inside the triangle.
        let (ua, ub) = (bb * (t - ta) - ab * (t - tb), aa * (t - tb) - ab * (t - ta));
        if t < ta || ua < 0.0 || ub < 0.0 {
            return along;
        }
        along.min(t * density)
    }
}

/// Distance along the surface from the nearest of some vertices, mm.
pub(crate) fn distances(points: &[Point3<f64>], triangles: &[[u32; 3]], from: &[u32]) -> Vec<f64> {
    let density = vec![1.0; points.len()];
    let (mut distance, mut owner) = (vec![f64::INFINITY; points.len()], vec![0; points.len()]);
    let sources: Vec<(u32, u32)> = from.iter().map(|&vertex| (vertex, 0)).collect();
    Marching::new(points, triangles, &density).spread(&sources, &mut distance, &mut owner);
    distance
}

/// The vertices of all boundary loops that are not among some.
pub(crate) fn outer_rims(around: &Connectivity, inner: &[&[u32]]) -> Vec<u32> {
    let loops = around.boundary_loops();
    loops.into_iter().filter(|rim| !inner.iter().any(|inner| inner.contains(&rim[0]))).flatten().collect()
}

/// A length that sorts.
#[derive(PartialEq)]
struct Length(f64);

impl Eq for Length {}

impl PartialOrd for Length {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Length {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::shapes;

    #[test]
    fn distances_on_a_plane_are_straight() {
        let mesh = shapes::grid(40, 1.0);
        let triangles = mesh.triangles();
        let middle = 20 * 41 + 20;
        let found = distances(&mesh.positions, &triangles, &[middle]);
        for (at, distance) in found.iter().enumerate() {
            let straight = (mesh.positions[at] - mesh.positions[middle as usize]).norm();
            // First order near a point source; along edges alone it would be up to 40 % too long.
            assert!((distance - straight).abs() < 0.05 * straight + 0.35, "{at}: {distance} for {straight}");
        }
    }
}
