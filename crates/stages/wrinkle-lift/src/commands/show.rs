//! `wrinkle-lift show`.

use stage::Run;

/// Draws valleys over an image, and over the mesh as the camera sees it
#[derive(clap::Args)]
pub(crate) struct Arguments {}

pub(crate) fn run(run: &mut Run, _: &Arguments) -> anyhow::Result<()> {
    run.subcommand("show");
    Ok(())
}
