//! The subcommands.

mod acquire;
mod film;
mod fit_modulation;
mod inputs;
mod options;
mod output;

use clap::{Parser, Subcommand};
use stage::Run;

/// Makes normal maps of wrinkles from two photographs of a face, at rest and with an expression
#[derive(Parser)]
#[command(name = "normalmap-acquire", version)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: stage::Common,
}

#[derive(Subcommand)]
enum Command {
    Acquire(Box<acquire::Arguments>),
    FitModulation(Box<fit_modulation::Arguments>),
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Command::Acquire(arguments) => acquire::run(run, &arguments),
        Command::FitModulation(arguments) => fit_modulation::run(run, &arguments),
    }
}
