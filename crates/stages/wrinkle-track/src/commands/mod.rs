//! The subcommands.

mod apply;
mod masks;
mod names;
mod shots;
mod show;
mod start;
mod track;
mod train;

use clap::{Parser, Subcommand};
use stage::Run;

/// Follows painted wrinkles through the images of each camera, as valley curves
///
/// Mark the paint in the first image of each camera, `train` on it, `track` the wrinkles, and look at the curves with `show`.
#[derive(Parser)]
#[command(name = "wrinkle-track", version)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: stage::Common,
}

#[derive(Subcommand)]
enum Command {
    Train(train::Arguments),
    Apply(apply::Arguments),
    Track(Box<track::Arguments>),
    Show(show::Arguments),
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Command::Train(arguments) => train::run(run, &arguments),
        Command::Apply(arguments) => apply::run(run, &arguments),
        Command::Track(arguments) => track::run(run, &arguments),
        Command::Show(arguments) => show::run(run, &arguments),
    }
}
