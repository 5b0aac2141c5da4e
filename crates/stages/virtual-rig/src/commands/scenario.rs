//! Prints a scenario, to start one's own from.

use super::make::Choice;
use stage::Run;
use std::path::PathBuf;

/// Print a scenario: a published one, or what the options make of it
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    choice: Choice,
    /// File to write; - for standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("scenario");
    let scenario = arguments.choice.scenario(run)?;
    run.parameters(&scenario)?;
    run.publish(vec![artifact::write_document(&arguments.out, &scenario)?])
}
