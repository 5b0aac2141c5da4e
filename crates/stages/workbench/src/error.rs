//! What can go wrong.

/// What was asked for cannot be made.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum Error {
    /// A camera is not among the calibrated ones.
    #[error("camera {camera} is not calibrated")]
    NoCamera {
        /// Its id.
        camera: String,
    },
    /// A mesh has more vertices than 32 bits count.
    #[error("a mesh of {vertices} vertices is too large for a page")]
    TooLarge {
        /// How many.
        vertices: usize,
    },
}
