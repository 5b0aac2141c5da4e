//! The subcommands, and what they read footage with.

pub(crate) mod check;
mod extract;
mod footage_files;
mod output_folder;
pub(crate) mod run;
