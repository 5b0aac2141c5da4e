//! The binary's parts: arguments, the run that ties them together, the table, the picture.

mod arguments;
mod chart;
mod run;
mod sync;
mod table;

pub(crate) use arguments::Arguments;
pub(crate) use run::run;
