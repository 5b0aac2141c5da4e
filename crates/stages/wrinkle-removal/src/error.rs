//! What can go wrong.

/// Wrinkles could not be removed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter out of its range.
    #[error("the {name} is {value}; it must be {range}")]
    Parameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// A region that names a vertex that the mesh does not have.
    #[error("the region names vertex {vertex}, but the mesh has {vertex_count} (0 to {})", vertex_count.saturating_sub(1))]
    UnknownVertex {
        /// The vertex.
        vertex: u32,
        /// Vertices of the mesh.
        vertex_count: usize,
    },
    /// A mask was given for a mesh without texture coordinates.
    #[error(
        "the mesh has no texture coordinates, which a painted mask needs; give the region as a vertex set, or a mesh with UVs"
    )]
    NoTextureCoordinates,
    /// A mask whose values do not fill its size.
    #[error("{texels} texels make no mask of {width} × {height}")]
    MaskSize {
        /// Texels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Texels given.
        texels: usize,
    },
    /// No vertex is in the region.
    #[error("no vertex of the mesh is in the region: {why}")]
    EmptyRegion {
        /// What may be the matter.
        why: &'static str,
    },
    /// A connected part of the mesh lies wholly in the region, so that nothing says where its surface was.
    #[error(
        "the region covers a whole part of the mesh ({vertex_count} vertices, among them vertex {vertex}), so that no skin \
         around it is left to continue; paint the wrinkles only"
    )]
    NothingHeld {
        /// Lowest vertex of the part.
        vertex: u32,
        /// Vertices of the part.
        vertex_count: usize,
    },
    /// Edges with more than two triangles in or beside the region.
    #[error(
        "{count} edges in or beside the region have more than two triangles, the first between vertices {} and {}; remove them \
         with `mesh-clip --drop-non-manifold`", vertices[0], vertices[1]
    )]
    NonManifold {
        /// How many.
        count: usize,
        /// Ends of the first.
        vertices: [u32; 2],
    },
    /// Neighbouring triangles in or beside the region that face opposite ways.
    #[error(
        "{count} edges in or beside the region have triangles that face opposite ways, the first between vertices {} and {}; \
         orient the faces alike in a mesh editor", vertices[0], vertices[1]
    )]
    Flipped {
        /// How many.
        count: usize,
        /// Ends of the first.
        vertices: [u32; 2],
    },
    /// A vertex of the region is on no triangle that has an area.
    #[error(
        "vertex {vertex} of the region is on no face with an area; leave it out of the region, or repair the mesh there"
    )]
    Degenerate {
        /// The vertex.
        vertex: u32,
    },
    /// A valley that lies on a face that the mesh does not have.
    #[error("wrinkle {wrinkle} lies on face {face}, but the mesh has {face_count}")]
    UnknownFace {
        /// The wrinkle.
        wrinkle: String,
        /// The face.
        face: u32,
        /// Triangles of the mesh.
        face_count: usize,
    },
    /// The system could not be factored.
    #[error(
        "the surface cannot be solved for: {0}; triangles of no area in or beside the region are the usual cause"
    )]
    Factor(#[from] operators::FactorError),
}
