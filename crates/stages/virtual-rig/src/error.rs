//! What can go wrong.

/// Why a take could not be made or scored.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A parameter makes no sense.
    #[error("{place}: {what}")]
    Parameter {
        /// Where in the scenario, e.g. `cameras.m1.focal_px`.
        place: String,
        /// What is wrong with it, and what would do.
        what: String,
    },
}
