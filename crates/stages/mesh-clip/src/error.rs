//! What can go wrong.

/// A mesh could not be clipped.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter makes no sense.
    #[error("{0}")]
    Parameter(String),
    /// A set or a path names a vertex that the mesh does not have.
    #[error("vertex {vertex} is picked, but the mesh has {vertex_count} (0 to {})", vertex_count.saturating_sub(1))]
    VertexOutOfRange {
        /// The vertex.
        vertex: u32,
        /// Vertices of the mesh.
        vertex_count: usize,
    },
    /// No edges lead from one vertex of a cut to the next.
    #[error("no way along edges leads from vertex {from} to vertex {to}; they are on different components")]
    NoWay {
        /// Start.
        from: u32,
        /// Where no way leads.
        to: u32,
    },
    /// A mask was given for a mesh without texture coordinates.
    #[error("the mesh has no texture coordinates, which a mask needs")]
    NoTextureCoordinates,
    /// Nothing is left.
    #[error("no face is left of {face_count}: {why}")]
    NothingLeft {
        /// Faces before.
        face_count: usize,
        /// What removed the last ones.
        why: &'static str,
    },
}
