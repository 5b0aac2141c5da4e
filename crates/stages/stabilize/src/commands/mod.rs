//! The binary's parts: arguments, input, and the run that ties them together.

mod arguments;
mod input;
mod run;

pub(crate) use arguments::Arguments;
pub(crate) use run::run;
