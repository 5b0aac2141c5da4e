//! The binary's parts: arguments, inputs, and the run.

mod arguments;
mod input;
mod run;

pub(crate) use arguments::Arguments;
pub(crate) use run::run;
