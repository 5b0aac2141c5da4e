//! What the binary does around the library: arguments, files, the order of work.

mod arguments;
pub(crate) mod draw;
mod shots;
