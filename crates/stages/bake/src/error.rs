//! What can go wrong.

/// The maps could not be baked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter is out of its range.
    #[error("{name} is {value}, not {range}\n  to do: give another --{name}")]
    Parameter {
        /// The option.
        name: &'static str,
        /// What it was.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// There is nothing to bake onto, or nothing to bake.
    #[error("the {which} mesh has no triangles\n  to do: check that it is the right file")]
    Empty {
        /// Low-resolution or wrinkled.
        which: &'static str,
    },
    /// A corner has no texture coordinate.
    #[error(
        "face {face} (counted from 1) has no texture coordinates\n  to do: unwrap the low-resolution mesh, and export it with them"
    )]
    NoTextureCoordinates {
        /// The polygon, 1-based as in the file.
        face: usize,
    },
    /// A face lies on two tiles.
    #[error(
        "face {face} (counted from 1) lies on tiles {first} and {second}\n  to do: move its corners to one UDIM tile"
    )]
    AcrossTiles {
        /// The polygon, 1-based as in the file.
        face: usize,
        /// A tile.
        first: u32,
        /// The other.
        second: u32,
    },
    /// A texture coordinate is on no tile.
    #[error(
        "face {face} (counted from 1) has texture coordinates ({u}, {v}), which lie on no UDIM tile\n  to do: move it to u between 0 and 10, v at least 0"
    )]
    NoTile {
        /// The polygon, 1-based as in the file.
        face: usize,
        /// u
        u: f64,
        /// v
        v: f64,
    },
    /// The two surfaces do not lie on each other.
    #[error(
        "{missed} of {samples} places of the low-resolution mesh have no wrinkled surface within {reach_mm} mm\n  \
         to do: check that both meshes have the same unit and pose (--large-scale moves a neutral one along); or raise --reach-mm"
    )]
    Apart {
        /// Places without a surface.
        missed: usize,
        /// All places.
        samples: usize,
        /// How far was looked, mm.
        reach_mm: f64,
    },
    /// A mesh in two poses has two numbers of vertices.
    #[error(
        "the wrinkled mesh has {rest} vertices at rest, but {moved} in the frame\n  to do: give the mesh that the sequence was made for"
    )]
    VertexCount {
        /// At rest.
        rest: usize,
        /// In the frame.
        moved: usize,
    },
    /// The tangent space could not be made.
    #[error("no tangents could be found\n  to do: check the low-resolution mesh's texture coordinates")]
    Tangents,
}
