//! The subcommands.

mod footage;
mod track;

use clap::{Parser, Subcommand};
use stage::Run;

/// Follows painted markers through the images of each camera
#[derive(Parser)]
#[command(name = "marker-track", version)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: stage::Common,
}

#[derive(Subcommand)]
enum Command {
    Track(Box<track::Arguments>),
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Command::Track(arguments) => track::run(run, &arguments),
    }
}
