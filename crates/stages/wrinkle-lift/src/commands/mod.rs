//! The subcommands.

mod faces;
mod options;
mod run;
mod show;
mod tell;

use clap::{Parser, Subcommand};
use stage::Run;

/// Brings wrinkles measured in the images onto the animated face
///
/// `run` makes valleys on the mesh from sections in the images, `show` draws them over an image and over the mesh.
#[derive(Parser)]
#[command(name = "wrinkle-lift", version)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: stage::Common,
}

#[derive(Subcommand)]
enum Command {
    Run(Box<run::Arguments>),
    Show(Box<show::Arguments>),
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Command::Run(arguments) => run::run(run, &arguments),
        Command::Show(arguments) => show::run(run, &arguments),
    }
}
