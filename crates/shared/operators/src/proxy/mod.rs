//! A coarser mesh in place of the scan: fewer vertices, all of them the scan's own.

mod collapse;
mod flip;
mod queue;

use collapse::Collapse;
use nalgebra::Point3;
use queue::{Candidate, Queue};

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
const SHORTEST: f64 = 0.02;

impl Proxy {
    /// Shortens a mesh to about `target` vertices by half-edge collapses, shortest edges first, as far as the topology,
    /// the shape of triangles and the direction of normals allow [Hoppe1996, Sec. 3.2; DeyEdelsbrunner1999], and makes it
    /// Delaunay by flips. A mesh that is small enough and has no tiny edge comes back as it is.
    ///
    /// `points`: #V, mm; `triangles`: a manifold (bow ties are let alone); `spacing`: #V, how long edges should be at
    /// each vertex, in relation to the others. Vertices without triangles are left out.
    ///
    /// # Panics
    /// If there is not one spacing per vertex.
    #[must_use]
    pub fn of(
        points: &[Point3<f64>],
        triangles: &[[u32; 3]],
        target: usize,
        spacing: &[f64],
        keep: Keep<'_>,
    ) -> Self {
        assert_eq!(spacing.len(), points.len(), "one spacing per vertex");
        let mut collapse = Collapse::new(points, triangles, keep);
        let area: f64 = mesh::triangle_areas(points, triangles).iter().sum();
        let aim = target.min(collapse.vertex_count()).max(1) as f64;
        // The side of equilateral triangles of which so many vertices cover this area.
        let side = (2.0 * area / (3f64.sqrt() * aim)).sqrt();
        let finest = spacing.iter().copied().fold(f64::INFINITY, f64::min);
        let length = |[a, b]: [u32; 2]| (points[a as usize] - points[b as usize]).norm();
        let candidate = |ends: [u32; 2]| {
            let [a, b] = ends.map(|vertex| spacing[vertex as usize]);
            Candidate { cost: length(ends) / (0.5 * (a + b)), ends }
        };
        let mut open = Queue::new(collapse.edges().map(candidate).collect());
        while let Some(next) = open.pop() {
            let enough = collapse.vertex_count() <= target;
            if enough && next.cost >= SHORTEST * side / finest {
                break;
            }
            if (!enough || length(next.ends) < SHORTEST * side)
                && let Some(kept) = collapse.attempt(next.ends)
            {
                collapse.neighbors(kept).into_iter().for_each(|other| open.push(candidate([kept, other])));
            }
        }
        match collapse.is_untouched() {
            true => Self::from_scan(points, triangles.to_vec()),
            false => Self::from_scan(points, flip::delaunay(points, collapse.triangles())),
        }
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
