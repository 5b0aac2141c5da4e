//! Compares what a stage made with the truth of its take.

use anyhow::bail;
use stage::Run;

/// Compare a stage's output with the truth of the take
#[derive(clap::Args)]
pub(crate) struct Arguments {}

pub(crate) fn run(run: &mut Run, _arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("score");
    bail!("is not built yet")
}
