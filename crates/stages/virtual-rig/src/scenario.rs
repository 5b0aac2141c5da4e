//! What shall be filmed, by whom, with what.
mod fault;
pub use fault::{Fault, FaultKind};
