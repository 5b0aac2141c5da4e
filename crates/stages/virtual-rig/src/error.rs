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

impl Error {
    /// A parameter at `place` makes no sense.
    pub fn parameter(place: impl Into<String>, what: impl Into<String>) -> Self {
        Self::Parameter { place: place.into(), what: what.into() }
    }
}
