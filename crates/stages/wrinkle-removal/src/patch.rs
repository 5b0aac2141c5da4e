//! The part of a mesh that a region's removal needs to see.

use crate::Error;
use mesh::{Connectivity, Mesh};
use nalgebra::Point3;

/// A region with a margin around it, as a small mesh of its own.
///
/// The triangles are all those that touch a *core* vertex (in the region or its margin), so that the rings of core vertices
/// are whole. The others only frame them.
pub(crate) struct Patch {
    /// Per patch vertex the mesh's; rising.
    pub(crate) vertices: Vec<u32>,
    /// mm.
    pub(crate) points: Vec<Point3<f64>>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// How much of the removal a vertex takes part in, 0 to 1.
    pub(crate) weights: Vec<f64>,
    /// Vertices whose ring is cut short, by the mesh's boundary or by the patch's frame. They stay where they are.
    pub(crate) open: Vec<bool>,
    /// Whether a vertex is on the mesh's boundary.
    pub(crate) rim: Vec<bool>,
}

impl Patch {
    /// Cuts out what lies within `margin` mm (and three rings) of the vertices with a weight.
    ///
    /// # Errors
    /// [`Error::NonManifold`], [`Error::Flipped`], [`Error::Degenerate`], [`Error::NothingHeld`].
    pub(crate) fn cut(
        mesh: &Mesh,
        triangles: &[[u32; 3]],
        weights: &[f64],
        margin: f64,
    ) -> Result<Self, Error> {
        let core = grown(&mesh.positions, triangles, weights, margin);
        let touching = |triangle: &&[u32; 3]| triangle.iter().any(|&vertex| core[vertex as usize]);
        let kept: Vec<[u32; 3]> = triangles.iter().filter(touching).copied().collect();
        let mut used: Vec<bool> = weights.iter().map(|&weight| weight > 0.0).collect();
        kept.iter().flatten().for_each(|&vertex| used[vertex as usize] = true);
        let map = mesh::VertexMap::keeping(&used);
        let local = |vertex: u32| map.new_from_old[vertex as usize].unwrap_or(0);
        let kept: Vec<[u32; 3]> = kept.into_iter().map(|triangle| triangle.map(local)).collect();
        let vertices = map.old_from_new.clone();
        let is_core: Vec<bool> = vertices.iter().map(|&vertex| core[vertex as usize]).collect();
        let around = Connectivity::of(vertices.len(), &kept);
        check_surface(&around, &is_core, &vertices)?;
        let rim = rim(&around, &is_core);
        let open: Vec<bool> = rim.iter().zip(&is_core).map(|(&rim, &core)| rim || !core).collect();
        let patch = Self {
            points: vertices.iter().map(|&vertex| mesh.positions[vertex as usize]).collect(),
            weights: vertices.iter().map(|&vertex| weights[vertex as usize]).collect(),
            triangles: kept,
            open,
            rim,
            vertices,
        };
        patch.check_held(&around)?;
        patch.check_areas()?;
        Ok(patch)
    }

    /// The vertices that may move when the wrinkles go.
    pub(crate) fn free(&self) -> Vec<bool> {
        self.weights.iter().zip(&self.open).map(|(&weight, &open)| weight > 0.0 && !open).collect()
    }

    /// Every part needs skin around the region: a part whose every vertex is in it is refused.
    fn check_held(&self, around: &Connectivity) -> Result<(), Error> {
        let (part, part_count) = around.components();
        let mut held = vec![false; part_count];
        let mut sizes = vec![0usize; part_count];
        for (vertex, &part) in part.iter().enumerate() {
            held[part as usize] |= self.weights[vertex] == 0.0;
            sizes[part as usize] += 1;
        }
        match part.iter().position(|&part| !held[part as usize]) {
            Some(vertex) => Err(Error::NothingHeld {
                vertex: self.vertices[vertex],
                vertex_count: sizes[part[vertex] as usize],
            }),
            None => Ok(()),
        }
    }

    fn check_areas(&self) -> Result<(), Error> {
        let areas = mesh::mixed_voronoi_areas(&self.points, &self.triangles);
        let is_bare = |vertex: &usize| self.weights[*vertex] > 0.0 && areas[*vertex] <= 0.0;
        match (0..areas.len()).find(is_bare) {
            Some(vertex) => Err(Error::Degenerate { vertex: self.vertices[vertex] }),
            None => Ok(()),
        }
    }
}

/// The fewest rings that a margin has: the fill reads two.
const RINGS: usize = 3;

/// The vertices within `margin` mm along edges, or three rings, of those with a weight.
fn grown(points: &[Point3<f64>], triangles: &[[u32; 3]], weights: &[f64], margin: f64) -> Vec<bool> {
    let start = weights.iter().map(|&weight| if weight > 0.0 { 0.0 } else { f64::INFINITY }).collect();
    let distances = distances(points, triangles, start, margin);
    let mut core: Vec<bool> = weights.iter().map(|&weight| weight > 0.0).collect();
    for _ in 0..RINGS {
        let before = core.clone();
        for triangle in triangles.iter().filter(|triangle| triangle.iter().any(|&v| before[v as usize])) {
            triangle.iter().for_each(|&vertex| core[vertex as usize] = true);
        }
    }
    core.iter().zip(distances).map(|(&near, distance)| near || distance <= margin).collect()
}

/// Lengths of the shortest ways along edges from where `start` is 0, followed up to `limit`; beyond it they are infinite or only
/// upper bounds [Bellman1958].
pub(crate) fn distances(
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    start: Vec<f64>,
    limit: f64,
) -> Vec<f64> {
    let mut distance = start;
    let mut changed = true;
    while changed {
        changed = false;
        for triangle in triangles {
            let [a, b, c] = triangle.map(|vertex| vertex as usize);
            if distance[a].min(distance[b]).min(distance[c]) >= limit {
                continue;
            }
            for (from, to) in [(a, b), (b, a), (b, c), (c, b), (c, a), (a, c)] {
                let reached = distance[from] + (points[to] - points[from]).norm();
                if distance[from] < limit && reached < distance[to] {
                    (distance[to], changed) = (reached, true);
                }
            }
        }
    }
    distance
}

/// Refuses edges at core vertices that the operators are not defined on.
fn check_surface(around: &Connectivity, is_core: &[bool], vertices: &[u32]) -> Result<(), Error> {
    let concerns = |edge: &&mesh::Edge| edge.vertices.iter().any(|&vertex| is_core[vertex as usize]);
    let ends = |edge: &mesh::Edge| edge.vertices.map(|vertex| vertices[vertex as usize]);
    let torn = around.non_manifold_edges();
    if let Some(first) = torn.iter().find(concerns) {
        return Err(Error::NonManifold {
            count: torn.iter().filter(concerns).count(),
            vertices: ends(first),
        });
    }
    let flipped = around.flipped_edges();
    match flipped.iter().find(concerns) {
        Some(first) => {
            Err(Error::Flipped { count: flipped.iter().filter(concerns).count(), vertices: ends(first) })
        }
        None => Ok(()),
    }
}

/// The vertices on boundary edges of the mesh: those of the patch's that have a core end, whose triangles are all here.
fn rim(around: &Connectivity, is_core: &[bool]) -> Vec<bool> {
    let mut rim = vec![false; is_core.len()];
    let boundary = around.edges().filter(|edge| edge.triangles.len() == 1);
    for edge in boundary.filter(|edge| edge.vertices.iter().any(|&vertex| is_core[vertex as usize])) {
        edge.vertices.iter().for_each(|&vertex| rim[vertex as usize] = true);
    }
    rim
}
