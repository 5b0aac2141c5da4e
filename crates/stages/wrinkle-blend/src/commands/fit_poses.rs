//! `wrinkle-blend fit-poses`.

use super::model::ModelArguments;
use super::motion::MotionArguments;
use super::options::{ParamArguments, References};
use anyhow::Context;
use artifact::FrameRange;
use serde_json::json;
use stage::Run;
use std::path::PathBuf;
use wrinkle_blend::{Goal, Modulation, Pose, fit_poses};

/// Proposes the smallest set of reference poses that explains a performance: the frames to draw wrinkle maps for
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// How far any bone of any frame may lie from what the poses explain
    #[arg(long, value_name = "MM", default_value_t = 1.0)]
    tolerance_mm: f64,
    /// The most poses
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u16).range(1..=64))]
    most: u16,
    /// Poses to write (poses; - for standard output)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    motion: MotionArguments,
    /// Only these frames, e.g. 1001-1100
    #[arg(
        long,
        value_name = "A-B",
        default_value = "-",
        hide_default_value = true,
        allow_hyphen_values = true
    )]
    frames: FrameRange,
    #[command(flatten)]
    params: ParamArguments,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("fit-poses");
    let params = arguments.params.params()?;
    anyhow::ensure!(
        arguments.tolerance_mm.is_finite() && arguments.tolerance_mm > 0.0,
        "--tolerance-mm {}: must be positive",
        arguments.tolerance_mm
    );
    let model = arguments.model.read(run)?;
    let motion = arguments.motion.read(run, &model, &arguments.model.model)?;
    let goal = Goal { tolerance_mm: arguments.tolerance_mm, most: usize::from(arguments.most) };
    run.parameters(&json!({
        "model": arguments.model, "motion": arguments.motion, "frames": arguments.frames.to_string(),
        "tolerance_mm": goal.tolerance_mm, "most": goal.most, "comparison": params,
    }))?;
    run.check_folders(&[&arguments.out])?;
    let frames = motion.frames(arguments.frames)?;
    let poses: Vec<Pose> = frames.iter().map(|&frame| motion.pose(&model, frame)).collect();
    let chosen = run
        .timed("fit", || fit_poses(model.setting(), &poses, goal, &params))
        .with_context(|| arguments.model.model.display().to_string())?;
    let named = chosen.frames.iter().map(|&at| (format!("frame-{}", frames[at]), poses[at].clone()));
    let references = References {
        poses: named.collect(),
        modulation: Modulation::Cosine,
        maps: vec![None; chosen.frames.len()],
        folder: PathBuf::new(),
    };
    run.result("frames", frames.len());
    run.result("poses", chosen.frames.len());
    run.result("chosen", chosen.frames.iter().map(|&at| frames[at]).collect::<Vec<_>>());
    run.result("error_mm", chosen.error_mm);
    run.result("errors_mm", &chosen.errors_mm);
    run.publish(vec![artifact::write_document(&arguments.out, &references.document(&model))?])
}
