//! The wrinkled mesh, ready to be looked up.

use crate::Error;
use mesh::{Mesh, RayTree};
use nalgebra::{Point3, Vector3};

/// The surface whose relief is baked.
pub struct High {
    triangles: Vec<[u32; 3]>,
    normals: Vec<Vector3<f64>>,
    tree: RayTree,
}

/// What lies over a place.
pub(crate) struct Relief {
    /// Unit normal of the wrinkled surface.
    pub(crate) normal: Vector3<f64>,
    /// How far it lies along the direction that was looked along, mm.
    pub(crate) height_mm: f64,
}

impl High {
    /// A mesh with its vertices at `points` (#V, mm).
    ///
    /// # Errors
    /// If it has no triangles, or the counts differ.
    pub fn of(mesh: &Mesh, points: &[Point3<f64>]) -> Result<Self, Error> {
        let triangles = mesh.triangles();
        if triangles.is_empty() {
            return Err(Error::Empty { which: "wrinkled" });
        }
        if points.len() != mesh.positions.len() {
            return Err(Error::VertexCount { rest: mesh.positions.len(), moved: points.len() });
        }
        let normals = mesh::vertex_normals(points, &triangles);
        let tree = RayTree::over(points, &triangles, |_| true);
        Ok(Self { triangles, normals, tree })
    }

    /// The outermost sheet that faces outwards within `reach` mm of a place, along a unit direction: what an eye would see of a fold
    /// that closes over itself.
    pub(crate) fn over(&self, place: &Point3<f64>, outwards: &Vector3<f64>, reach: f64) -> Option<Relief> {
        let start = place + outwards * reach;
        let is_near = |hit: &mesh::Hit| hit.from_outside && hit.distance <= 2.0 * reach;
        let hit = self.tree.cast_where(&start, &-outwards, is_near)?;
        let corners = self.triangles[hit.face as usize];
        let normal: Vector3<f64> = corners
            .iter()
            .zip(hit.barycentric)
            .map(|(&vertex, share)| self.normals[vertex as usize] * share)
            .sum();
        Some(Relief { normal: normal.try_normalize(1e-12)?, height_mm: reach - hit.distance })
    }
}
