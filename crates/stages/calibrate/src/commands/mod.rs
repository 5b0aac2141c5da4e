//! The subcommands.

mod wand;
mod wand_input;

use clap::{Parser, Subcommand};
use stage::Run;

/// Finds lenses and poses of all cameras from pictures of a board or a waved point
#[derive(Parser)]
#[command(name = "calibrate", version)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: stage::Common,
}

#[derive(Subcommand)]
enum Command {
    Wand(Box<wand::Arguments>),
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Command::Wand(arguments) => wand::run(run, &arguments),
    }
}
