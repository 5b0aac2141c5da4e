//! What makes a comparison senseless.

/// Why a result could not be compared with the truth.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ScoreError {
    /// The result was made from another take.
    #[error(
        "the result comes from {result}, the truth from {truth}; score it against the truth of its own take"
    )]
    OtherTake {
        /// The truth's take.
        truth: String,
        /// The result's take.
        result: String,
    },
    /// The result names things that the take does not have.
    #[error("the result has {thing} {id}, which the truth does not know; it knows {known}")]
    UnknownId {
        /// What is named: `marker`, `camera`, `wrinkle`.
        thing: &'static str,
        /// The unknown id.
        id: String,
        /// Some of the ids that there are.
        known: String,
    },
    /// The result is measured in another unit, rate or size than the truth.
    #[error("{place}: the result has {result}, the truth {truth}")]
    Differs {
        /// What differs, e.g. `unit` or `camera m1, image size`.
        place: String,
        /// The truth's value.
        truth: String,
        /// The result's value.
        result: String,
    },
    /// Truth and result have no frame in common.
    #[error("no frame of the result ({result}) is in the truth ({truth}); frame numbers are absolute")]
    NoCommonFrame {
        /// The truth's frames.
        truth: String,
        /// The result's frames.
        result: String,
    },
}
