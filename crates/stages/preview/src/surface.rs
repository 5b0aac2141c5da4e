//! What is drawn.

use mesh::Mesh;
use nalgebra::{Point3, Vector3};

/// A surface to draw: #V vertices, #T triangles.
#[derive(Debug, Clone)]
pub struct Surface {
    /// #V points, mm.
    pub positions: Vec<Point3<f64>>,
    /// #V unit normals; zero where a vertex has no triangle.
    pub normals: Vec<Vector3<f64>>,
    /// #T triangles, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Per triangle which of its sides (0–1, 1–2, 2–0) are sides of a polygon; empty: all.
    pub polygon_sides: Vec<[bool; 3]>,
    /// #V values that colour the surface, or none: plain clay.
    pub values: Vec<f64>,
    /// Vertices that get a marker dot.
    pub dots: Vec<u32>,
}

impl Surface {
    /// A plain surface of a mesh.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let (triangles, polygon_sides) = fans(mesh);
        let normals = mesh::vertex_normals(&mesh.positions, &triangles);
        let positions = mesh.positions.clone();
        Self { positions, normals, triangles, polygon_sides, values: Vec::new(), dots: Vec::new() }
    }

    /// Moves the vertices, one position each.
    ///
    /// # Panics
    /// If the counts differ: that is a bug of the caller.
    pub fn deform(&mut self, positions: Vec<Point3<f64>>) {
        assert_eq!(positions.len(), self.positions.len(), "a deformed surface keeps its vertices");
        self.normals = mesh::vertex_normals(&positions, &self.triangles);
        self.positions = positions;
    }
}

/// The triangles of [`Mesh::triangles`], each with the sides that are not diagonals.
fn fans(mesh: &Mesh) -> (Vec<[u32; 3]>, Vec<[bool; 3]>) {
    let mut triangles = Vec::with_capacity(mesh.polygons.len());
    let mut sides = Vec::with_capacity(mesh.polygons.len());
    for polygon in mesh.polygons.iter() {
        for second in 1..polygon.len().saturating_sub(1) {
            let triangle = [polygon[0], polygon[second], polygon[second + 1]];
            let [a, b, c] = triangle;
            if a != b && b != c && c != a {
                triangles.push(triangle);
                sides.push([second == 1, true, second + 2 == polygon.len()]);
            }
        }
    }
    (triangles, sides)
}
