//! Why a shell could not be solved.

/// A failure of the stage, in the words of meshes and handles.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter out of range.
    #[error("the {name} is {value}; it must be a positive number")]
    Parameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A softening that leaves no stiffness, or adds some.
    #[error("the softening is {value}; it must be a share of the stiffness, from 0 to below 1")]
    Softening {
        /// Its value.
        value: f64,
    },
    /// No handle at all.
    #[error("there is no handle; at least one vertex must be told where to go")]
    NoHandles,
    /// A handle or held vertex that the mesh does not have.
    #[error("vertex {vertex} is a handle, but the mesh has {vertex_count} vertices")]
    UnknownVertex {
        /// The vertex.
        vertex: u32,
        /// Vertices of the mesh.
        vertex_count: usize,
    },
    /// Two handles on one vertex.
    #[error("two handles sit on vertex {vertex}; move one of the picks to another vertex")]
    SharedVertex {
        /// The vertex.
        vertex: u32,
    },
    /// A handle on a vertex that no face uses.
    #[error("the handle vertex {vertex} belongs to no face; pick a vertex on the surface")]
    LooseHandle {
        /// The vertex.
        vertex: u32,
    },
    /// Edges with more than two triangles.
    #[error(
        "{count} edges have more than two triangles, the first between vertices {} and {}; \
         remove them with `mesh-clip --drop-non-manifold`", vertices[0], vertices[1]
    )]
    NonManifold {
        /// How many.
        count: usize,
        /// Ends of the first.
        vertices: [u32; 2],
    },
    /// Neighbouring triangles that face opposite ways.
    #[error(
        "{count} edges have triangles that face opposite ways, the first between vertices {} and {}; \
         orient the faces alike in a mesh editor", vertices[0], vertices[1]
    )]
    Flipped {
        /// How many.
        count: usize,
        /// Ends of the first.
        vertices: [u32; 2],
    },
    /// Bow-tie vertices.
    #[error(
        "{count} vertices are bow ties (fans of triangles that meet in a point only), the first is vertex {vertex}; \
         remove them with `mesh-clip --drop-non-manifold`, or hinge them with `--bow-ties join`"
    )]
    BowTies {
        /// How many.
        count: usize,
        /// The first.
        vertex: u32,
    },
    /// A part of the mesh that nothing holds.
    #[error(
        "{count} parts of the mesh have no handle, the largest with {vertex_count} vertices, among them vertex {vertex}; \
         remove them with `mesh-clip --keep-largest-component`, or keep them still with `--free-components hold`"
    )]
    FreeComponent {
        /// How many parts.
        count: usize,
        /// Lowest vertex of the largest.
        vertex: u32,
        /// Vertices of the largest.
        vertex_count: usize,
    },
    /// The system could not be factored.
    #[error(
        "the shell cannot be solved with these handles; with a larger --stretching, or more handles, the surface is \
         better determined"
    )]
    Factor(#[from] operators::FactorError),
    /// A saved order of another mesh.
    #[error("the saved elimination order does not fit the mesh")]
    Ordering(#[from] operators::NotAPermutation),
    /// A frame without a single marker.
    #[error("no handle has a value")]
    NothingPrescribed,
}
