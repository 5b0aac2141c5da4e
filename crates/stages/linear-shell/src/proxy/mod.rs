//! A coarser mesh in place of the scan: fewer vertices, all of them the scan's own.

mod collapse;
mod flip;

use collapse::Collapse;
use nalgebra::Point3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A coarse mesh over some of a scan's vertices, with the scan's topology: boundary loops stay boundary loops, cuts stay cut.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Proxy {
    /// Per vertex of the proxy the vertex of the scan that it is; rising.
    pub vertices: Vec<u32>,
    /// Triangles over the proxy's vertices.
    pub triangles: Vec<[u32; 3]>,
}

/// What the proxy must keep.
#[derive(Debug, Clone, Copy)]
pub struct Keep<'a> {
    /// Vertices that stay, e.g. the handles.
    pub vertices: &'a [u32],
    /// Vertices of which some must stay, since they are told to stand still: they are never merged into others.
    pub still: &'a [u32],
}

/// Edges shorter than this share of what the proxy aims at go even if there are few enough vertices.
const SHORTEST: f64 = 0.2;
/// From this distance from the kept vertices on, mm, …
const NEAR_MM: f64 = 25.0;
/// … edges may grow in proportion, up to this multiple.
const LARGEST_GROWTH: f64 = 4.0;

impl Proxy {
    /// Shortens a mesh to about `target` vertices by half-edge collapses, shortest edges first, as far as the topology,
    /// the shape of triangles and the direction of normals allow [Hoppe1996, Sec. 3.2; DeyEdelsbrunner1999], and makes it
    /// Delaunay by flips. Only what is far from the kept vertices becomes coarser than the rest.
    ///
    /// `points`: #V, mm; `triangles`: a manifold (bow ties are let alone). Vertices without triangles are left out.
    #[must_use]
    pub fn of(points: &[Point3<f64>], triangles: &[[u32; 3]], target: usize, keep: Keep<'_>) -> Self {
        let mut collapse = Collapse::new(points, triangles, keep);
        let kept: Vec<Point3<f64>> = keep.vertices.iter().map(|&vertex| points[vertex as usize]).collect();
        let growth: Vec<f64> = points.iter().map(|point| growth(&kept, point)).collect();
        let area: f64 = mesh::triangle_areas(points, triangles).iter().sum();
        let aim = target.min(collapse.vertex_count()).max(1) as f64;
        // The side of equilateral triangles of which so many vertices cover this area.
        let side = (2.0 * area / (3f64.sqrt() * aim)).sqrt();
        let cost = |a: u32, b: u32| {
            let length = (points[a as usize] - points[b as usize]).norm();
            Candidate { cost: length / growth[a as usize].max(growth[b as usize]), length, ends: [a, b] }
        };
        let mut open: BinaryHeap<Reverse<Candidate>> =
            collapse.edges().map(|[a, b]| Reverse(cost(a, b))).collect();
        while let Some(Reverse(next)) = open.pop() {
            if collapse.vertex_count() <= target && next.cost >= SHORTEST * side {
                break;
            }
            if collapse.vertex_count() > target || next.length < SHORTEST * side {
                if let Some(kept) = collapse.attempt(next.ends) {
                    open.extend(collapse.neighbors(kept).into_iter().map(|other| Reverse(cost(kept, other))));
                }
            }
        }
        Self::from_scan(points, flip::delaunay(points, collapse.triangles()))
    }

    fn from_scan(points: &[Point3<f64>], triangles: Vec<[u32; 3]>) -> Self {
        let mut used = vec![false; points.len()];
        triangles.iter().flatten().for_each(|&vertex| used[vertex as usize] = true);
        let vertices: Vec<u32> = (0..points.len() as u32).filter(|&vertex| used[vertex as usize]).collect();
        let mut renamed = vec![u32::MAX; points.len()];
        vertices.iter().enumerate().for_each(|(new, &old)| renamed[old as usize] = new as u32);
        let triangles =
            triangles.into_iter().map(|corners| corners.map(|old| renamed[old as usize])).collect();
        Self { vertices, triangles }
    }
}

/// How many times longer edges may be here.
fn growth(kept: &[Point3<f64>], at: &Point3<f64>) -> f64 {
    let nearest = kept.iter().map(|point| (point - at).norm_squared()).fold(f64::INFINITY, f64::min).sqrt();
    match nearest.is_finite() {
        true => (nearest / NEAR_MM).clamp(1.0, LARGEST_GROWTH),
        false => 1.0,
    }
}

/// An edge that may go. Sorted by cost, then by its ends, so that the result does not depend on the heap's mood.
#[derive(PartialEq)]
struct Candidate {
    cost: f64,
    length: f64,
    ends: [u32; 2],
}

impl Eq for Candidate {}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.cost.total_cmp(&other.cost).then(self.ends.cmp(&other.ends))
    }
}
