//! What the binary does around the library: arguments, and which files are compared how.

mod arguments;
pub(crate) mod compare;
mod kind;
