//! Why edits cannot be made.

/// Why edits cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter out of its range.
    #[error("{name} is {value}; {allowed}")]
    Parameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What would do.
        allowed: &'static str,
    },
    /// A line of a list of edits.
    #[error("line {line}: {what}")]
    Edit {
        /// Its number, from 1.
        line: usize,
        /// What is wrong there, and what to do.
        what: String,
    },
    /// Captions cannot be drawn.
    #[error(transparent)]
    Font(#[from] artifact::canvas::FontError),
}
