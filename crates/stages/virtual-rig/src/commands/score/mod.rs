//! Compares what a stage made with the truth of its take.

mod comparison;
mod kind;
mod pictures;
mod streams;
mod surfaces;
mod truth;

use artifact::{FrameRange, Unit};
use comparison::Comparison;
use kind::Kind;
use serde_json::json;
use stage::Run;
use std::path::PathBuf;
use virtual_rig::score::Table;

/// Compare a stage's output with the truth of the take
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// What RESULT is
    #[arg(value_enum)]
    kind: Kind,
    /// What the stage made: a file; of masks and normals also a folder with <camera>/<frame:06>.png, or a pattern
    /// such as 'out/{camera}-{frame:06}.png'
    result: PathBuf,
    /// The take's folder truth/, as `virtual-rig make` writes it
    #[arg(long, value_name = "DIR")]
    truth: PathBuf,
    /// What else to compare with. wrinkled: the large-scale sequence that RESULT was made from; cameras: other
    /// true cameras than cameras-calibrated.json; masks, normals: the true picture of a single one
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
    /// Compare only these frames, e.g. 1001-1100
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    frames: Option<FrameRange>,
    /// Unit of RESULT, for markers in a format that does not say it
    #[arg(long = "marker-unit", visible_alias = "unit", value_name = "mm|cm|m")]
    unit: Option<Unit>,
    /// What stands before the slash of each metric [default: the stage that usually makes such a result]
    #[arg(long, value_name = "NAME")]
    stage: Option<String>,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("score");
    let (kind, stage) = (arguments.kind, arguments.stage.as_deref().unwrap_or(arguments.kind.stage()));
    let frames = arguments.frames.unwrap_or(FrameRange::ALL);
    run.parameters(&json!({ "kind": kind.name(), "stage": stage, "frames": frames.to_string() }))?;
    let metrics = kind.score(&mut Comparison::open(run, arguments)?)?;
    let table = Table::new(stage, metrics);
    run.say(table.to_string().trim_end());
    run.result("metrics", table.to_json());
    Ok(())
}
