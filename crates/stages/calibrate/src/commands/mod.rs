//! The subcommands.

use clap::Parser;
use stage::Run;

/// Finds lenses and poses of all cameras from pictures of a board or a waved point
#[derive(Parser)]
#[command(name = "calibrate", version)]
pub(crate) struct Arguments {
    #[command(flatten)]
    common: stage::Common,
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

pub(crate) fn run(_run: &mut Run, _arguments: Arguments) -> anyhow::Result<()> {
    Ok(())
}
