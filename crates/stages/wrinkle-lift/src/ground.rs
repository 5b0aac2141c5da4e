//! The mesh as a surface to stand on: places on it, their normals, and the nearest place to a point.

use mesh::Mesh;
use nalgebra::{Point3, Vector3};

/// A material place on the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Triangle, as `Mesh::triangles` counts them.
    pub face: u32,
    /// Shares of its three corners; they add up to 1.
    pub barycentric: [f64; 3],
}

/// Triangles and what lies beside what; positions come with each call, as the face moves.
#[derive(Debug, Clone)]
pub struct Ground {
    triangles: Vec<[u32; 3]>,
    /// `beside[starts[v]..starts[v + 1]]`: the triangles at vertex v.
    starts: Vec<u32>,
    beside: Vec<u32>,
}

impl Ground {
    /// The surface of a mesh.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let triangles = mesh.triangles();
        let mut starts = vec![0u32; mesh.positions.len() + 1];
        triangles.iter().flatten().for_each(|&vertex| starts[vertex as usize + 1] += 1);
        for vertex in 1..starts.len() {
            starts[vertex] += starts[vertex - 1];
        }
        let mut next = starts.clone();
        let mut beside = vec![0u32; 3 * triangles.len()];
        for (face, triangle) in triangles.iter().enumerate() {
            for &vertex in triangle {
                beside[next[vertex as usize] as usize] = face as u32;
                next[vertex as usize] += 1;
            }
        }
        Self { triangles, starts, beside }
    }

    /// All triangles.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// How many vertices positions must have.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.starts.len() - 1
    }

    pub(crate) fn corners(&self, face: u32, points: &[Point3<f64>]) -> [Point3<f64>; 3] {
        self.triangles[face as usize].map(|vertex| points[vertex as usize])
    }

    /// Where a spot is when the vertices are at `points` (#V, mm).
    #[must_use]
    pub fn at(&self, spot: &Spot, points: &[Point3<f64>]) -> Point3<f64> {
        let corners = self.corners(spot.face, points);
        Point3::from((0..3).map(|i| corners[i].coords * spot.barycentric[i]).sum::<Vector3<f64>>())
    }

    /// Mean length of a triangle's sides, mm.
    #[must_use]
    pub fn edge_mm(&self, face: u32, points: &[Point3<f64>]) -> f64 {
        let [a, b, c] = self.corners(face, points);
        ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0
    }

    /// The unit normal around a spot: area vectors of the connected triangles near it, weighted by a Gaussian of the distance of their
    /// middles with the standard deviation `spread_mm`. Zero where there is no area.
    ///
    /// Averaged so, relief finer than the spread does not turn the normal, which the depth of a valley is measured along.
    pub(crate) fn normal(
        &self,
        spot: &Spot,
        points: &[Point3<f64>],
        spread_mm: f64,
        seen: &mut Seen,
    ) -> Vector3<f64> {
        let center = self.at(spot, points);
        let reach = 2.5 * spread_mm;
        let mut sum = Vector3::zeros();
        seen.clear();
        seen.insert(spot.face);
        // Also the list of what is still to be looked at: its front moves on.
        let mut next = 0;
        while let Some(&face) = seen.faces.get(next) {
            next += 1;
            let [a, b, c] = self.corners(face, points);
            let off = (Point3::from((a.coords + b.coords + c.coords) / 3.0) - center).norm();
            if off > reach && face != spot.face {
                continue;
            }
            let weight = if face == spot.face { 1.0 } else { (-0.5 * (off / spread_mm).powi(2)).exp() };
            sum += weight * (b - a).cross(&(c - a));
            self.neighbors(face).for_each(|beside| seen.insert(beside));
        }
        sum.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
    }

    /// An empty set of triangles.
    pub(crate) fn none_seen(&self) -> Seen {
        Seen { bits: vec![0; self.triangles.len() / 64 + 1], faces: Vec::new() }
    }

    /// Triangles that share a corner with one, itself among them.
    fn neighbors(&self, face: u32) -> impl Iterator<Item = u32> + '_ {
        self.triangles[face as usize].into_iter().flat_map(|vertex| {
            let vertex = vertex as usize;
            self.beside[self.starts[vertex] as usize..self.starts[vertex + 1] as usize].iter().copied()
        })
    }

    /// The spot nearest to a point, found by going from triangle to neighbouring triangle, downhill from `from`: the nearest one of the
    /// sheet that `from` lies on, where the point is no farther from it than the surface's bends.
    #[must_use]
    pub fn nearest(&self, point: &Point3<f64>, from: u32, points: &[Point3<f64>]) -> Spot {
        let place = |face: u32| {
            let (barycentric, distance) = nearest_in_triangle(point, self.corners(face, points));
            (Spot { face, barycentric }, distance)
        };
        let (mut best, mut distance) = place(from);
        for _ in 0..MOST_STEPS {
            let before = best.face;
            for face in self.neighbors(before) {
                let (other, length) = place(face);
                // Of equally near ones the first in order, so that nothing hangs on the way taken.
                if length < distance || (length == distance && face < best.face) {
                    (best, distance) = (other, length);
                }
            }
            if best.face == before {
                break;
            }
        }
        best
    }
}

/// A set of triangles, to be used again: a search sees a few hundred of a million.
pub(crate) struct Seen {
    bits: Vec<u64>,
    /// In the order that they came in.
    faces: Vec<u32>,
}

impl Seen {
    fn clear(&mut self) {
        self.faces.drain(..).for_each(|face| self.bits[face as usize / 64] = 0);
    }

    fn insert(&mut self, face: u32) {
        let (word, bit) = (face as usize / 64, 1u64 << (face % 64));
        if self.bits[word] & bit == 0 {
            self.bits[word] |= bit;
            self.faces.push(face);
        }
    }
}

/// Triangles that a search for the nearest one passes at most.
const MOST_STEPS: usize = 500;

/// Shares of the corners at the point of a triangle that is nearest to a point, and how far it is: by which corner, side or inside it is nearest to.
fn nearest_in_triangle(point: &Point3<f64>, [a, b, c]: [Point3<f64>; 3]) -> ([f64; 3], f64) {
    let shares = nearest_shares(point, [a, b, c]);
    let at = a.coords * shares[0] + b.coords * shares[1] + c.coords * shares[2];
    (shares, (point.coords - at).norm())
}

fn nearest_shares(point: &Point3<f64>, [a, b, c]: [Point3<f64>; 3]) -> [f64; 3] {
    let (ab, ac, ap) = (b - a, c - a, point - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = point - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let cp = point - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let share = d1 / (d1 - d3);
        return [1.0 - share, share, 0.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let share = d2 / (d2 - d6);
        return [1.0 - share, 0.0, share];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let share = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - share, share];
    }
    let whole = va + vb + vc;
    let (v, w) = (vb / whole, vc / whole);
    [(1.0 - v - w).max(0.0), v, w]
}
