//! `linear-shell`: a scan and handle displacements become an animated mesh.

mod commands;

use clap::Parser;
use std::process::ExitCode;

/// Deforms a scan so that it follows marker displacements, as a linear thin shell.
///
/// Reads a mesh and `handles`; writes a sequence: a PC2 vertex cache in the mesh's unit and an index
/// (`large-scale`) with its frame numbers.
#[derive(Parser)]
#[command(name = "linear-shell", version)]
struct Cli {
    #[command(flatten)]
    deform: commands::Arguments,
    #[command(flatten)]
    common: stage::Common,
}

impl stage::Arguments for Cli {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

fn main() -> ExitCode {
    stage::run::<Cli>(|run, cli| commands::deform(run, &cli.deform))
}
