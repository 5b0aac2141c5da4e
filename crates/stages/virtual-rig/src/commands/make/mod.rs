//! Makes a take.

mod choice;

pub(crate) use choice::Choice;

use anyhow::bail;
use stage::Run;
use std::path::PathBuf;

/// Make a take: footage as a user would bring it, and the truth
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    choice: Choice,
    /// Folder to make; gets take/ and truth/
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub(crate) fn run(run: &mut Run, _arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("make");
    bail!("is not built yet")
}
