//! What moves with the head only.

use mesh::Mesh;

/// A thing that hides others but carries no truth: an eyeball, the dark of the mouth.
#[derive(Debug, Clone, PartialEq)]
pub struct Prop {
    /// Triangles in the space of the face, mm.
    pub mesh: Mesh,
    /// Per vertex the linear RGB reflectance.
    pub albedo: Vec<[f32; 3]>,
}
