//! The binary's parts: arguments, and the run.

mod arguments;
mod region;
mod run;

pub(crate) use arguments::Arguments;
pub(crate) use run::run;
