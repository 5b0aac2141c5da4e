//! The mesh as a surface to stand on: places on it, their normals, and the nearest place to a point.

use mesh::{Around, Mesh};
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
    around: Around,
}

impl Ground {
    /// The surface of a mesh.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let triangles = mesh.triangles();
        let around = Around::of(mesh.positions.len(), &triangles);
        Self { triangles, around }
    }

    /// All triangles.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// How many vertices positions must have.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.around.vertex_count()
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
        self.triangles[face as usize].into_iter().flat_map(|vertex| self.around.at(vertex).iter().copied())
    }

    /// The spot nearest to a point, found by going from triangle to neighbouring triangle, downhill from `from`: the nearest one of the
    /// sheet that `from` lies on, where the point is no farther from it than the surface's bends.
    #[must_use]
    pub fn nearest(&self, point: &Point3<f64>, from: u32, points: &[Point3<f64>]) -> Spot {
        let place = |face: u32| {
            let spot =
                Spot { face, barycentric: mesh::nearest_in_triangle(point, &self.corners(face, points)) };
            (spot, (point - self.at(&spot, points)).norm())
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
