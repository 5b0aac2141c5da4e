//! `capture-sync`: arguments → read → call → write; one file per subcommand.

mod commands;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Finds one time base for all cameras, and extracts their images by mocap frame
///
/// run: take manifest and footage → sync, frames. check: how far the cameras are apart, in ms and in mm.
#[derive(Parser)]
#[command(name = "capture-sync", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: stage::Common,
}

#[derive(Subcommand)]
enum Command {
    Run(commands::run::Run),
    Check(commands::check::Check),
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

fn main() -> ExitCode {
    stage::run::<Arguments>(|run, arguments| match arguments.command {
        Command::Run(command) => command.run(run),
        Command::Check(command) => command.run(run),
    })
}
