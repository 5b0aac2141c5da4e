//! What can go wrong.

/// What a map's vectors refer to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Space {
    /// The axes of the mesh's coordinates.
    Object,
    /// Tangent, bitangent and normal of the mesh at each place.
    Tangent,
}

impl std::fmt::Display for Space {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Object => "object",
            Self::Tangent => "tangent",
        })
    }
}

/// A scan could not be refined.
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
    /// Not one normal, or one confidence, per vertex.
    #[error("there are {count} {what} for {vertex_count} vertices; they were made for another mesh")]
    Count {
        /// What was counted.
        what: &'static str,
        /// How many.
        count: usize,
        /// Vertices of the mesh.
        vertex_count: usize,
    },
    /// A normal that is no number.
    #[error("the normal of vertex {vertex} is not finite; give (0, 0, 0) where there is none")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// A confidence outside 0–1.
    #[error("the confidence of vertex {vertex} is {value}; it must be from 0 to 1")]
    Confidence {
        /// The vertex.
        vertex: usize,
        /// Its value.
        value: f64,
    },
    /// A map was given for a mesh without texture coordinates.
    #[error(
        "the mesh has no texture coordinates, which a map of normals needs; give normals per vertex, or a mesh with UVs"
    )]
    NoTextureCoordinates,
    /// A map whose values do not fill its size.
    #[error("{values} values make no map of {width} × {height}")]
    MapSize {
        /// Texels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Values given.
        values: usize,
    },
    /// No vertex got a normal.
    #[error("no vertex gets a normal: {why}")]
    NothingMeasured {
        /// What may be the matter.
        why: &'static str,
    },
    /// A map whose vectors do not have unit length.
    #[error(
        "the map's vectors have a median length of {median:.2}, not 1: it is no normal map, or was converted from or to sRGB; \
         export it as plain data"
    )]
    NotUnit {
        /// The median length.
        median: f64,
    },
    /// A map that says the same everywhere.
    #[error(
        "the map is flat: all its vectors are within {degrees:.1}° of each other, so that there is nothing to refine by"
    )]
    Flat {
        /// The widest angle from the mean, degrees.
        degrees: f64,
    },
    /// A map in the other space than was said.
    #[error(
        "as {stated} space the map is {stated_degrees:.0}° off the scan's normals in the mean, as {other} space {other_degrees:.0}°: \
         it is a map in {other} space"
    )]
    OtherSpace {
        /// What was said.
        stated: Space,
        /// What fits.
        other: Space,
        /// Mean angle to the scan's normals as stated, degrees.
        stated_degrees: f64,
        /// Mean angle as the other, degrees.
        other_degrees: f64,
    },
    /// Normals that are not those of the mesh.
    #[error(
        "the measured normals are {degrees:.0}° off the scan's in the mean: they belong to another mesh or pose, are turned \
         inside out, or have other axes"
    )]
    Disagree {
        /// The mean angle, degrees.
        degrees: f64,
    },
    /// Edges with more than two triangles.
    #[error(
        "{count} edges have more than two triangles, the first between vertices {} and {}; remove them with \
         `mesh-clip --drop-non-manifold`", vertices[0], vertices[1]
    )]
    NonManifold {
        /// How many.
        count: usize,
        /// Ends of the first.
        vertices: [u32; 2],
    },
    /// Neighbouring triangles that face opposite ways.
    #[error(
        "{count} edges have triangles that face opposite ways, the first between vertices {} and {}; orient the faces alike \
         in a mesh editor", vertices[0], vertices[1]
    )]
    Flipped {
        /// How many.
        count: usize,
        /// Ends of the first.
        vertices: [u32; 2],
    },
    /// The system could not be factored.
    #[error("the positions cannot be solved for: {0}")]
    Factor(#[from] operators::FactorError),
}
