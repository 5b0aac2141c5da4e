//! Why two artifacts cannot be compared.

/// Two artifacts have nothing that could be compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// Vertices have no counterparts.
    #[error("{count} vertices cannot be compared with {other}")]
    VertexCount {
        /// Vertices of the one.
        count: usize,
        /// Vertices of the other.
        other: usize,
    },
    /// A region names a vertex that the mesh lacks.
    #[error("region {region} names vertex {vertex}; the mesh has {count}")]
    Region {
        /// The region's name.
        region: String,
        /// The vertex.
        vertex: u32,
        /// Vertices of the mesh.
        count: usize,
    },
    /// Images of different size.
    #[error("{}×{} pixels cannot be compared with {}×{}", size[0], size[1], other[0], other[1])]
    ImageSize {
        /// Width and height of the one.
        size: [u32; 2],
        /// Width and height of the other.
        other: [u32; 2],
    },
    /// Images whose pixels mean something else.
    #[error("{format} pixels cannot be compared with {other} pixels")]
    PixelFormat {
        /// Pixels of the one.
        format: String,
        /// Pixels of the other.
        other: String,
    },
    /// Nothing stands on both sides.
    #[error("they share no {0}")]
    NothingShared(&'static str),
}
