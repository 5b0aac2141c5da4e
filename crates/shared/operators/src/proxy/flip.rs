//! Edge flips towards a Delaunay mesh, so that cotangents sum to positive weights.

use mesh::Connectivity;
use nalgebra::{Point3, Vector3};
use std::collections::HashSet;

/// Times that all edges are gone over.
const SWEEPS: usize = 10;
/// Cosine of the largest angle between the triangles of an edge that is flipped, before and after: creases stay.
const LARGEST_BEND: f64 = 0.8;

/// Flips edges whose opposite angles add up to more than a half turn, where the surface is nearly flat, sweep after sweep
/// until nothing changes.
pub(super) fn delaunay(points: &[Point3<f64>], mut triangles: Vec<[u32; 3]>) -> Vec<[u32; 3]> {
    for _ in 0..SWEEPS {
        let around = Connectivity::of(points.len(), &triangles);
        let (starts, rings) = around.one_rings();
        let mut touched = vec![false; triangles.len()];
        let mut made: HashSet<[u32; 2]> = HashSet::new();
        let mut changed = false;
        for edge in around.edges() {
            let [first, second] = edge.triangles[..] else { continue };
            if touched[first as usize] || touched[second as usize] {
                continue;
            }
            let Some(flip) = Flip::of(&triangles, [first, second], edge.vertices) else { continue };
            let [c, d] = flip.opposite;
            let new = [c.min(d), c.max(d)];
            let there = rings[starts[c as usize]..starts[c as usize + 1]].binary_search(&d).is_ok();
            if there || made.contains(&new) || !flip.improves(points) {
                continue;
            }
            let [one, other] = flip.after();
            triangles[first as usize] = one;
            triangles[second as usize] = other;
            touched[first as usize] = true;
            touched[second as usize] = true;
            made.insert(new);
            changed = true;
        }
        if !changed {
            break;
        }
    }
    triangles
}

/// An edge from `ends[0]` to `ends[1]` with the first triangle on its left, and the corners opposite to it.
struct Flip {
    ends: [u32; 2],
    opposite: [u32; 2],
}

impl Flip {
    fn of(triangles: &[[u32; 3]], pair: [u32; 2], edge: [u32; 2]) -> Option<Self> {
        let [left, right] = pair.map(|triangle| triangles[triangle as usize]);
        let start = (0..3).find(|&i| left[i] != edge[0] && left[i] != edge[1])?;
        let across = right.into_iter().find(|vertex| !edge.contains(vertex))?;
        Some(Self { ends: [left[(start + 1) % 3], left[(start + 2) % 3]], opposite: [left[start], across] })
    }

    fn after(&self) -> [[u32; 3]; 2] {
        let ([a, b], [c, d]) = (self.ends, self.opposite);
        [[c, a, d], [d, b, c]]
    }

    fn improves(&self, points: &[Point3<f64>]) -> bool {
        let [a, b, c, d] =
            [self.ends[0], self.ends[1], self.opposite[0], self.opposite[1]].map(|v| points[v as usize]);
        let cotangent = |at: Point3<f64>| (a - at).dot(&(b - at)) / (a - at).cross(&(b - at)).norm();
        if cotangent(c) + cotangent(d) >= -1e-9 {
            return false;
        }
        let unit = |p: Point3<f64>, q: Point3<f64>, r: Point3<f64>| -> Option<Vector3<f64>> {
            (q - p).cross(&(r - p)).try_normalize(0.0)
        };
        let normals = [unit(a, b, c), unit(b, a, d), unit(c, a, d), unit(d, b, c)];
        let [Some(left), Some(right), Some(one), Some(other)] = normals else { return false };
        let mean = left + right;
        left.dot(&right) > LARGEST_BEND
            && one.dot(&other) > LARGEST_BEND
            && one.dot(&mean) > 0.0
            && other.dot(&mean) > 0.0
    }
}
