//! The subcommands.

mod geometry;
mod measure;
mod options;
mod show;

use clap::{Parser, Subcommand};
use stage::Run;

/// Measures width and depth of painted wrinkles from the shadow that they throw into themselves
///
/// `measure` makes sections from curves and images, `show` draws them.
#[derive(Parser)]
#[command(name = "cross-section", version)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: stage::Common,
}

#[derive(Subcommand)]
enum Command {
    Measure(Box<measure::Arguments>),
    Show(Box<show::Arguments>),
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Command::Measure(arguments) => measure::run(run, &arguments),
        Command::Show(arguments) => show::run(run, &arguments),
    }
}
