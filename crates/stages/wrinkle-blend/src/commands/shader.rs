//! `wrinkle-blend shader`.

use stage::Run;
use std::path::PathBuf;
use wrinkle_blend::shader::{Language, text};

/// Writes the equations as functions for a shader
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Language
    #[arg(long, value_name = "LANGUAGE")]
    language: LanguageName,
    /// File to write (- for standard output)
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum LanguageName {
    Glsl,
    Hlsl,
    Wgsl,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("shader");
    let language = match arguments.language {
        LanguageName::Glsl => Language::Glsl,
        LanguageName::Hlsl => Language::Hlsl,
        LanguageName::Wgsl => Language::Wgsl,
    };
    run.parameters(&language)?;
    run.check_folders(&[&arguments.out])?;
    run.publish(vec![artifact::stage_bytes(&arguments.out, text(language).as_bytes())?])
}
