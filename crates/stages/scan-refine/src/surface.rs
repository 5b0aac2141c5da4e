//! The scan's surface: looked over, with its edges and areas.

use crate::Error;
use mesh::{Connectivity, Mesh};
use nalgebra::Point3;

/// What the solve needs to know of a mesh; none of it changes while vertices move.
pub(crate) struct Surface {
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Edges with their weights, about 1 each: half the sum of the opposite angles' cotangents, kept positive.
    pub(crate) edges: Vec<([u32; 2], f64)>,
    /// Lumped areas, mm².
    pub(crate) mass: Vec<f64>,
}

/// Weights of edges are kept in this range: a scan's noise makes slivers, of which the normals know nothing.
const WEIGHTS: (f64, f64) = (0.1, 5.0);

impl Surface {
    /// # Errors
    /// [`Error::NonManifold`], [`Error::Flipped`].
    pub(crate) fn of(mesh: &Mesh) -> Result<Self, Error> {
        let triangles = mesh.triangles();
        let around = Connectivity::of(mesh.positions.len(), &triangles);
        if let [first, ..] = &around.non_manifold_edges()[..] {
            return Err(Error::NonManifold {
                count: around.non_manifold_edges().len(),
                vertices: first.vertices,
            });
        }
        if let [first, ..] = &around.flipped_edges()[..] {
            return Err(Error::Flipped { count: around.flipped_edges().len(), vertices: first.vertices });
        }
        let weight = |edge: &mesh::Edge| -> f64 {
            let opposite = edge.triangles.iter().map(|&t| triangles[t as usize]);
            0.5 * opposite.map(|triangle| cotangent(&mesh.positions, triangle, edge.vertices)).sum::<f64>()
        };
        let edges =
            around.edges().map(|edge| (edge.vertices, weight(&edge).clamp(WEIGHTS.0, WEIGHTS.1))).collect();
        let mass = operators::lumped_mass(&mesh.positions, &triangles);
        Ok(Self { triangles, edges, mass })
    }
}

/// The cotangent of a triangle's angle opposite to an edge.
fn cotangent(points: &[Point3<f64>], triangle: [u32; 3], edge: [u32; 2]) -> f64 {
    let apex = triangle.into_iter().find(|vertex| !edge.contains(vertex)).unwrap_or(triangle[0]);
    let [a, b] = edge.map(|vertex| points[vertex as usize] - points[apex as usize]);
    a.dot(&b) / a.cross(&b).norm().max(1e-9 * (a.norm_squared() + b.norm_squared())).max(f64::MIN_POSITIVE)
}
