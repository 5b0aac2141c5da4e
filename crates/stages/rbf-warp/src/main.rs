//! `rbf-warp`: arguments → read → call → write; one file per subcommand.

mod commands;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Maps marker motion from mocap space onto a face scan
///
/// correspond: picks → correspondence. fit: markers + correspondence + scan → warp. handles: markers through the warp →
/// displacements of the scan's vertices. apply: points of a mesh through the warp, or back.
#[derive(Parser)]
#[command(name = "rbf-warp", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: stage::Common,
}

#[derive(Subcommand)]
enum Command {
    Correspond(commands::correspond::Correspond),
    Fit(commands::fit::Fit),
    Apply(commands::apply::Apply),
    Handles(commands::handles::Handles),
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

fn main() -> ExitCode {
    stage::run::<Arguments>(|run, arguments| match arguments.command {
        Command::Correspond(command) => command.run(run),
        Command::Fit(command) => command.run(run),
        Command::Apply(command) => command.run(run),
        Command::Handles(command) => command.run(run),
    })
}
