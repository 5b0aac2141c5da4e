//! The subcommands.

mod detect;
mod follow;
mod guide;
mod label;
mod show;
mod start;
mod track;

use clap::{Parser, Subcommand};
use stage::Run;

/// Follows painted markers through the images of each camera
///
/// Number the dots of one frame with `detect`, write their names into the tables, make labels of these with `label`, `track`
/// them, and look at the tracks with `show`.
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
    Detect(detect::Arguments),
    Label(label::Arguments),
    Show(show::Arguments),
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Command::Track(arguments) => track::run(run, &arguments),
        Command::Detect(arguments) => detect::run(run, &arguments),
        Command::Label(arguments) => label::run(run, &arguments),
        Command::Show(arguments) => show::run(run, &arguments),
    }
}
