//! The subcommands.

mod check;
mod fit_poses;
mod map_files;
mod maps;
mod model;
mod motion;
mod options;
mod play;
mod poses;
mod shader;
mod show;
mod weights;

use clap::{Parser, Subcommand};
use stage::Run;

/// Shows each wrinkle of a skinned character as its bones come near the pose that has it
///
/// `weights` tells how much of each reference pose's wrinkle map shows at each vertex, `maps` blends the maps by these weights,
/// `play` shows them on the moving character, `shader` prints the same equations for a graphics card.
#[derive(Parser)]
#[command(name = "wrinkle-blend", version)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    common: stage::Common,
}

#[derive(Subcommand)]
enum Command {
    Check(Box<check::Arguments>),
    Poses(Box<poses::Arguments>),
    FitPoses(Box<fit_poses::Arguments>),
    Weights(Box<weights::Arguments>),
    Maps(Box<maps::Arguments>),
    Show(Box<show::Arguments>),
    Play(Box<play::Arguments>),
    Shader(shader::Arguments),
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        Command::Check(arguments) => check::run(run, &arguments),
        Command::Poses(arguments) => poses::run(run, &arguments),
        Command::FitPoses(arguments) => fit_poses::run(run, &arguments),
        Command::Weights(arguments) => weights::run(run, &arguments),
        Command::Maps(arguments) => maps::run(run, &arguments),
        Command::Show(arguments) => show::run(run, &arguments),
        Command::Play(arguments) => play::run(run, &arguments),
        Command::Shader(arguments) => shader::run(run, &arguments),
    }
}
