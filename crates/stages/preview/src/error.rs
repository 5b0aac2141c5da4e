//! What can go wrong before a picture is drawn.

/// Why a picture or a sheet cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter is out of its range.
    #[error("{name} is {value}, but must be {range}")]
    Parameter {
        /// The parameter.
        name: &'static str,
        /// What it is.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// Two meshes cannot be compared vertex by vertex.
    #[error("{count} vertices cannot be compared with {other} vertex by vertex")]
    VertexCount {
        /// Vertices of the one.
        count: usize,
        /// Vertices of the other.
        other: usize,
    },
    /// Up and front lie on one axis.
    #[error("up {up} and front {front} lie on the same axis")]
    Axes {
        /// Where up is.
        up: String,
        /// Where the face looks.
        front: String,
    },
    /// The sheet would not fit a picture.
    #[error("the sheet would have {width} × {height} pixels; {limit} are the most on each side")]
    SheetSize {
        /// Its width.
        width: usize,
        /// Its height.
        height: usize,
        /// The longest side that is drawn.
        limit: usize,
    },
    /// The font that the program carries is damaged.
    #[error(transparent)]
    Font(#[from] artifact::canvas::FontError),
}
