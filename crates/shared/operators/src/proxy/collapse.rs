//! Half-edge collapses on a triangle mesh.

use super::Keep;
use mesh::Connectivity;
use nalgebra::{Point3, Vector3};

/// A vertex of more neighbours than this is not made.
const LARGEST_VALENCE: usize = 11;
/// Least shape of new triangles: 1 is equilateral, 0 degenerate.
const LEAST_SHAPE: f64 = 0.25;
/// Cosine of the largest turn of a triangle's normal.
const LARGEST_TURN: f64 = 0.3;
/// Cosine of the sharpest turn of a boundary at a vertex that may go: corners of the mouth stay.
const LARGEST_BOUNDARY_TURN: f64 = 0.6;

/// What may become of a vertex.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Freedom {
    /// It may be merged into any other.
    Free,
    /// Only into another of this kind.
    Still,
    /// It stays.
    Fixed,
}

/// A mesh from which vertices are taken one by one.
pub(super) struct Collapse<'a> {
    points: &'a [Point3<f64>],
    triangles: Vec<[u32; 3]>,
    alive: Vec<bool>,
    /// Live triangles around every vertex.
    around: Vec<Vec<u32>>,
    boundary: Vec<bool>,
    freedom: Vec<Freedom>,
    vertex_count: usize,
}

impl<'a> Collapse<'a> {
    pub(super) fn new(points: &'a [Point3<f64>], triangles: &[[u32; 3]], keep: Keep<'_>) -> Self {
        let connectivity = Connectivity::of(points.len(), triangles);
        let mut freedom = vec![Freedom::Free; points.len()];
        keep.still.iter().for_each(|&vertex| freedom[vertex as usize] = Freedom::Still);
        let fixed = keep.vertices.iter().copied().chain(connectivity.bow_ties());
        fixed.for_each(|vertex| freedom[vertex as usize] = Freedom::Fixed);
        let mut around = vec![Vec::new(); points.len()];
        for (number, triangle) in triangles.iter().enumerate() {
            triangle.iter().for_each(|&vertex| around[vertex as usize].push(number as u32));
        }
        let mut boundary = vec![false; points.len()];
        for edge in connectivity.edges().filter(|edge| edge.triangles.len() == 1) {
            edge.vertices.iter().for_each(|&vertex| boundary[vertex as usize] = true);
        }
        let vertex_count = around.iter().filter(|triangles| !triangles.is_empty()).count();
        Self {
            points,
            triangles: triangles.to_vec(),
            alive: vec![true; triangles.len()],
            around,
            boundary,
            freedom,
            vertex_count,
        }
    }

    /// Vertices that are left.
    pub(super) fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Whether nothing has been merged.
    pub(super) fn is_untouched(&self) -> bool {
        self.alive.iter().all(|&alive| alive)
    }

    /// Every edge of the mesh as it is now, lower end first.
    pub(super) fn edges(&self) -> impl Iterator<Item = [u32; 2]> {
        let rising = |vertex: u32| {
            self.neighbors(vertex)
                .into_iter()
                .filter(move |&other| other > vertex)
                .map(move |other| [vertex, other])
        };
        (0..self.points.len() as u32).flat_map(rising)
    }

    /// The triangles that are left.
    pub(super) fn triangles(self) -> Vec<[u32; 3]> {
        self.triangles
            .into_iter()
            .zip(self.alive)
            .filter_map(|(triangle, alive)| alive.then_some(triangle))
            .collect()
    }

    /// The one-ring of a vertex, rising.
    pub(super) fn neighbors(&self, of: u32) -> Vec<u32> {
        let triangles = self.around[of as usize].iter().map(|&triangle| self.triangles[triangle as usize]);
        let mut ring: Vec<u32> = triangles.flatten().filter(|&vertex| vertex != of).collect();
        ring.sort_unstable();
        ring.dedup();
        ring
    }

    /// Merges one end of an edge into the other, if that can be done; returns the end that stays.
    pub(super) fn attempt(&mut self, [a, b]: [u32; 2]) -> Option<u32> {
        let shapes = [[a, b], [b, a]].map(|[gone, kept]| self.shape_after(gone, kept));
        let (gone, kept) = match shapes {
            [None, None] => return None,
            [Some(first), Some(second)] if second > first => (b, a),
            [None, Some(_)] => (b, a),
            _ => (a, b),
        };
        self.merge(gone, kept);
        Some(kept)
    }

    fn merge(&mut self, gone: u32, kept: u32) {
        for triangle in std::mem::take(&mut self.around[gone as usize]) {
            let corners = self.triangles[triangle as usize];
            if corners.contains(&kept) {
                self.alive[triangle as usize] = false;
                for vertex in corners {
                    self.around[vertex as usize].retain(|&other| other != triangle);
                }
            } else {
                self.triangles[triangle as usize] =
                    corners.map(|vertex| if vertex == gone { kept } else { vertex });
                self.around[kept as usize].push(triangle);
            }
        }
        self.vertex_count -= 1;
    }

    /// The worst shape of a triangle after `gone` is merged into `kept`; `None` where that cannot be done.
    fn shape_after(&self, gone: u32, kept: u32) -> Option<f64> {
        let shared = self.around[gone as usize].iter().filter(|&&triangle| self.has(triangle, kept)).count();
        let may = shared > 0 && self.may_merge(gone, kept) && self.keeps_topology(gone, kept, shared);
        if !may {
            return None;
        }
        let moved = self.around[gone as usize].iter().filter(|&&triangle| !self.has(triangle, kept));
        let mut worst = f64::INFINITY;
        for &triangle in moved {
            let before = self.triangles[triangle as usize].map(|vertex| self.points[vertex as usize]);
            let after = self.triangles[triangle as usize]
                .map(|vertex| self.points[if vertex == gone { kept } else { vertex } as usize]);
            let (old, new) = (double_area(before), double_area(after));
            let shape = shape(after);
            if shape < LEAST_SHAPE.min(0.9 * self::shape(before))
                || old.dot(&new) < LARGEST_TURN * old.norm() * new.norm()
            {
                return None;
            }
            worst = worst.min(shape);
        }
        Some(worst)
    }

    fn has(&self, triangle: u32, vertex: u32) -> bool {
        self.triangles[triangle as usize].contains(&vertex)
    }

    fn may_merge(&self, gone: u32, kept: u32) -> bool {
        match self.freedom[gone as usize] {
            Freedom::Free => true,
            Freedom::Still => self.freedom[kept as usize] == Freedom::Still,
            Freedom::Fixed => false,
        }
    }

    /// The link condition [DeyEdelsbrunner1999]: the ends have no neighbour in common but those across the edge, a boundary vertex
    /// goes along the boundary only, and a loop keeps its corners.
    fn keeps_topology(&self, gone: u32, kept: u32, shared: usize) -> bool {
        let (of_gone, of_kept) = (self.neighbors(gone), self.neighbors(kept));
        let common = of_gone.iter().filter(|vertex| of_kept.binary_search(vertex).is_ok()).count();
        let valence = of_gone.len() + of_kept.len() - 2 - common;
        if common != shared || valence > LARGEST_VALENCE {
            return false;
        }
        if !self.boundary[gone as usize] {
            // A closed surface must not fold up into two triangles.
            return shared == 2 && of_gone.len() > 3;
        }
        let along = |&&other: &&u32| {
            let triangles = self.around[gone as usize].iter();
            triangles.filter(|&&triangle| self.has(triangle, other)).count() == 1
        };
        let Some(previous) = of_gone.iter().filter(along).find(|&&other| other != kept) else { return false };
        let at = |vertex: u32| self.points[vertex as usize];
        let (arrive, leave) = (at(gone) - at(*previous), at(kept) - at(gone));
        let turn = arrive.dot(&leave) / (arrive.norm() * leave.norm());
        shared == 1
            && of_gone.len() > 2
            && of_kept.binary_search(previous).is_err()
            && turn > LARGEST_BOUNDARY_TURN
    }
}

fn double_area([a, b, c]: [Point3<f64>; 3]) -> Vector3<f64> {
    (b - a).cross(&(c - a))
}

/// 4 √3 area over the sum of the squared sides: 1 for an equilateral triangle.
fn shape([a, b, c]: [Point3<f64>; 3]) -> f64 {
    let squares = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
    2.0 * 3f64.sqrt() * double_area([a, b, c]).norm() / squares.max(f64::MIN_POSITIVE)
}
