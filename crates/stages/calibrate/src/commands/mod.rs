//! The subcommands.

mod board;
mod convert;
#[cfg(feature = "detect")]
mod detect;
mod doctor;
mod doctor_input;
mod footage;
mod length;
mod number;
mod refine;
mod shared;
mod shots;
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
    #[cfg(feature = "detect")]
    Detect(detect::Arguments),
    Board(Box<board::Arguments>),
    Wand(Box<wand::Arguments>),
    Refine(Box<refine::Arguments>),
    Doctor(Box<doctor::Arguments>),
    Convert(convert::Arguments),
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        #[cfg(feature = "detect")]
        Command::Detect(arguments) => detect::run(run, &arguments),
        Command::Board(arguments) => board::run(run, &arguments),
        Command::Wand(arguments) => wand::run(run, &arguments),
        Command::Refine(arguments) => refine::run(run, &arguments),
        Command::Doctor(arguments) => doctor::run(run, &arguments),
        Command::Convert(arguments) => convert::run(run, &arguments),
    }
}
