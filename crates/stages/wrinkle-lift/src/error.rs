//! Why wrinkles could not be brought onto the face.

/// Results of this stage.
pub type Result<T> = std::result::Result<T, Error>;

/// What stops this stage.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter makes no sense.
    #[error("{0}")]
    Parameter(String),
    /// A deformed mesh has another number of vertices than the rest mesh.
    #[error(
        "frame {frame} has {found} vertices, but the rest mesh has {wanted}\n  to do: give the sequence that was made for this mesh"
    )]
    OtherMesh {
        /// Absolute frame number.
        frame: i64,
        /// Vertices of the frame.
        found: usize,
        /// Vertices of the rest mesh.
        wanted: usize,
    },
    /// The warp leads nowhere on this mesh.
    #[error(
        "frame {frame}: the warp leads none of the {vertices} vertices back to mocap space\n  to do: give the warp that was fitted on this mesh"
    )]
    NothingMapped {
        /// Absolute frame number.
        frame: i64,
        /// Vertices of the mesh.
        vertices: usize,
    },
}
