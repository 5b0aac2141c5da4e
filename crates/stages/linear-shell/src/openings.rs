//! Is the mouth open where it should be? A scan whose lips are fused costs millimetres, and nothing else shows it.

use crate::Surface;
use mesh::shortest_way;
use nalgebra::{Point3, Vector3};

/// Neighbours of a handle that are watched.
const NEIGHBORS: usize = 4;
/// Two handles tear the surface when their distance grows to more than this multiple (a lid that closes gets twice as far
/// from the brow, lips get several times as far from each other) …
const STRETCH: f64 = 2.2;
/// … and by more than this, mm, …
const GROWTH_MM: f64 = 10.0;
/// … although the way along the surface is no longer than this multiple of the straight one: between the lips of an
/// open mouth it leads round the corner.
const DETOUR: f64 = 1.5;

/// Two handles that move apart over a closed surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Tear {
    /// The two handles, by index.
    pub handles: [usize; 2],
    /// Their distance at rest, mm.
    pub rest_mm: f64,
    /// Their largest distance, mm.
    pub largest_mm: f64,
}

/// Share of the frames over which a pair must be torn: a label that slips for a moment tears nothing.
const SHARE: f64 = 0.02;

/// Watches neighbouring handles over the frames.
pub struct TearWatch {
    rest: Vec<Point3<f64>>,
    pairs: Vec<Watched>,
    frames: usize,
}

/// A pair of neighbours.
struct Watched {
    handles: [usize; 2],
    rest_mm: f64,
    largest_mm: f64,
    torn_frames: usize,
}

impl TearWatch {
    /// For handles at `vertices` of a surface.
    #[must_use]
    pub fn new(surface: &Surface, vertices: &[u32]) -> Self {
        let rest: Vec<Point3<f64>> = vertices.iter().map(|&vertex| surface.points[vertex as usize]).collect();
        let mut pairs: Vec<[usize; 2]> = Vec::new();
        for i in 0..rest.len() {
            let mut others: Vec<usize> = (0..rest.len()).filter(|&j| j != i).collect();
            others.sort_by(|&a, &b| (rest[a] - rest[i]).norm().total_cmp(&(rest[b] - rest[i]).norm()));
            pairs.extend(others.into_iter().take(NEIGHBORS).map(|j| [i.min(j), i.max(j)]));
        }
        pairs.sort_unstable();
        pairs.dedup();
        let watched = |handles: [usize; 2]| {
            let rest_mm = (rest[handles[0]] - rest[handles[1]]).norm();
            Watched { handles, rest_mm, largest_mm: 0.0, torn_frames: 0 }
        };
        let pairs = pairs.into_iter().map(watched).collect();
        Self { rest, pairs, frames: 0 }
    }

    /// Adds a frame: the displacements of all handles, mm.
    pub fn add(&mut self, handles: &[Vector3<f64>]) {
        self.frames += 1;
        for pair in &mut self.pairs {
            let [a, b] = pair.handles.map(|handle| self.rest[handle] + handles[handle]);
            let distance = (a - b).norm();
            let torn = distance > STRETCH * pair.rest_mm && distance > pair.rest_mm + GROWTH_MM;
            pair.torn_frames += usize::from(torn);
            pair.largest_mm = pair.largest_mm.max(distance);
        }
    }

    /// The pairs that tear a closed surface, worst first.
    #[must_use]
    pub fn tears(&self, surface: &Surface, vertices: &[u32]) -> Vec<Tear> {
        let enough = (SHARE * self.frames as f64).ceil().max(1.0) as usize;
        let torn = |pair: &&Watched| {
            let ends = pair.handles.map(|handle| vertices[handle]);
            pair.torn_frames >= enough && joined_within(surface, ends, DETOUR * pair.rest_mm)
        };
        let tear = |pair: &Watched| Tear {
            handles: pair.handles,
            rest_mm: pair.rest_mm,
            largest_mm: pair.largest_mm,
        };
        let mut tears: Vec<Tear> = self.pairs.iter().filter(torn).map(tear).collect();
        tears.sort_by(|a, b| (b.largest_mm - b.rest_mm).total_cmp(&(a.largest_mm - a.rest_mm)));
        tears
    }
}

/// Whether edges of the surface lead from one vertex to another within a length. Edge paths are up to a tenth longer
/// than the shortest way on the meshes at hand; the caller's limit leaves room for that.
fn joined_within(surface: &Surface, ends: [u32; 2], limit_mm: f64) -> bool {
    let (starts, all) = surface.around.one_rings();
    let neighbors = |vertex: u32| &all[starts[vertex as usize]..starts[vertex as usize + 1]];
    shortest_way(&surface.points, neighbors, ends[0], ends[1], limit_mm).is_some()
}
