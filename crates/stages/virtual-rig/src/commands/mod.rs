//! The subcommands.

mod character;
mod groove;
mod make;
mod pair;
mod scenario;
mod score;

use clap::{Parser, Subcommand};
use stage::Run;

/// Makes takes whose every intermediate is known, and scores stages against them
#[derive(Parser)]
#[command(name = "virtual-rig", version)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: stage::Common,
}

#[derive(Subcommand)]
enum Command {
    Make(Box<make::Arguments>),
    Scenario(scenario::Arguments),
    Score(score::Arguments),
    Groove(groove::Arguments),
    Pair(pair::Arguments),
    Character(character::Arguments),
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Command::Make(arguments) => make::run(run, &arguments),
        Command::Scenario(arguments) => scenario::run(run, &arguments),
        Command::Score(arguments) => score::run(run, &arguments),
        Command::Groove(arguments) => groove::run(run, &arguments),
        Command::Pair(arguments) => pair::run(run, &arguments),
        Command::Character(arguments) => character::run(run, &arguments),
    }
}
