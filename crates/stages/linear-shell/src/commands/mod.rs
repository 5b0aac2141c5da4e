//! The binary's parts: arguments, saved solves, outputs, and the run that ties them together.

mod arguments;
mod cache;
mod deform;
mod output;
mod solver;
mod take;

pub(crate) use arguments::Arguments;
pub(crate) use deform::deform;
