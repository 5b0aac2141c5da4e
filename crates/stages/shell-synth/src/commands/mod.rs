//! The binary's parts: arguments, what the frames showed, and the run that ties them together.

mod arguments;
mod findings;
mod refined;
mod run;

pub(crate) use arguments::Arguments;
pub(crate) use run::run;
