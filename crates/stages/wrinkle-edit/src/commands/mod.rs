//! The subcommands.

mod apply;
mod frames;
mod show;

use clap::{Parser, Subcommand};
use stage::Run;

/// Changes measured wrinkles by a list of edits: deeper, wider, gone, renamed, drawn by hand
///
/// `apply` replays the list on sections and curves, `show` draws a frame before and after.
#[derive(Parser)]
#[command(name = "wrinkle-edit", version)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: stage::Common,
}

#[derive(Subcommand)]
enum Command {
    Apply(Box<apply::Arguments>),
    Show(Box<show::Arguments>),
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Command::Apply(arguments) => apply::run(run, &arguments),
        Command::Show(arguments) => show::run(run, &arguments),
    }
}
