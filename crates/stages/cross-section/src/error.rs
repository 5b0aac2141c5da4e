//! Why sections cannot be measured.

/// Why sections cannot be measured.
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
}
