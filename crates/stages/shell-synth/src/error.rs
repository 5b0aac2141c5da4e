//! What can go wrong.

/// Wrinkles could not be put on the mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter is out of its range.
    #[error("the {name} is {value}, which is out of its range\n  to do: see --help")]
    Parameter {
        /// What it is.
        name: &'static str,
        /// What it was.
        value: f64,
    },
    /// A valley point names a triangle that the mesh does not have.
    #[error(
        "frame {frame}, wrinkle {wrinkle}, point {point}: lies on triangle {face}, but the mesh has {count}\n  to do: give the \
         mesh that the valleys were made for"
    )]
    NoSuchTriangle {
        /// Frame.
        frame: i64,
        /// Wrinkle id.
        wrinkle: String,
        /// Point of the curve, from 0.
        point: usize,
        /// The triangle.
        face: u32,
        /// How many there are.
        count: usize,
    },
    /// A frame has another number of vertices than the rest mesh.
    #[error(
        "the frame has {found} vertices, the rest mesh {expected}\n  to do: give the mesh that the sequence was made for"
    )]
    VertexCount {
        /// Vertices of the frame.
        found: usize,
        /// Vertices of the rest mesh.
        expected: usize,
    },
    /// More than two triangles share an edge.
    #[error("edge {0}–{1} has more than two triangles\n  to do: repair the scan (non-manifold edges)")]
    NonManifold(u32, u32),
    /// A triangle in a wrinkle's reach is a point or a line at rest.
    #[error(
        "triangle {triangle} (vertex {vertex}) has no area at rest, and a wrinkle reaches it\n  to do: repair the scan (degenerate triangles)"
    )]
    Degenerate {
        /// The triangle.
        triangle: u32,
        /// One of its vertices.
        vertex: u32,
    },
    /// The energy could not be minimised.
    #[error(
        "the shell's system cannot be solved: {0}\n  to do: check the mesh near the wrinkle for degenerate triangles"
    )]
    Solve(#[from] operators::FactorError),
}
