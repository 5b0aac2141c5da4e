//! The binary's parts: arguments, saved solves, outputs, and the run that ties them together.

mod arguments;
mod cache;
mod output;
mod run;
mod solver;
mod take;

pub(crate) use arguments::Arguments;
pub(crate) use run::run;
