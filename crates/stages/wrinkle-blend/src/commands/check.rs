//! `wrinkle-blend check`.

use super::model::ModelArguments;
use super::options::{ParamArguments, PoseArguments};
use serde_json::json;
use stage::Run;
use wrinkle_blend::{Blender, Pose, crosstalk, recovery};

/// Tells which bones make which pose, and which poses show each other's wrinkles
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    #[command(flatten)]
    poses: PoseArguments,
    #[command(flatten)]
    params: ParamArguments,
}

/// Above this, a pose shows too much of another one's wrinkles.
const TOO_MUCH: f64 = 0.25;

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("check");
    let params = arguments.params.params()?;
    let model = arguments.model.read(run)?;
    let references = arguments.poses.read(run, &model, &arguments.model.model)?;
    run.parameters(&json!({ "model": arguments.model, "poses": arguments.poses, "comparison": params }))?;
    let blender = references.blender(&model, &params, &arguments.model.model)?;
    let poses: Vec<Pose> = references.poses.iter().map(|(_, pose)| pose.clone()).collect();
    let (matrix, own) = (crosstalk(&blender, &poses), recovery(&blender, &poses));
    for (pose, id) in blender.poses().iter().enumerate() {
        run.report(&format!("{id}: {}", bones_of(&blender, pose)))?;
    }
    run.report("at pose (row), share shown of the wrinkles of (column):")?;
    let width = blender.poses().iter().map(|id| id.chars().count()).max().unwrap_or(0).max(5);
    run.report(&row("", width, blender.poses().iter().map(String::clone)))?;
    for (id, shares) in blender.poses().iter().zip(&matrix) {
        run.report(&row(id, width, shares.iter().map(|share| format!("{share:.2}"))))?;
    }
    warn(run, &blender, &matrix);
    run.result("bones", blender.bones().len());
    run.result("own_share_min", own.iter().copied().fold(1.0, f64::min));
    run.result("own_share", own);
    run.result("crosstalk", matrix);
    Ok(())
}

/// The bones of a pose, the farthest first.
fn bones_of(blender: &Blender, pose: usize) -> String {
    let mut bones: Vec<(f64, &str)> = blender
        .bones()
        .iter()
        .enumerate()
        .filter_map(|(number, bone)| Some((blender.way(pose, number)?.norm(), bone.name.as_str())))
        .collect();
    bones.sort_by(|a, b| b.0.total_cmp(&a.0));
    let shown: Vec<String> = bones.iter().map(|(way, name)| format!("{name} {way:.1} mm")).collect();
    shown.join(", ")
}

fn row(head: &str, width: usize, cells: impl Iterator<Item = String>) -> String {
    cells.fold(format!("  {head:width$}"), |row, cell| row + &format!(" {cell:>width$}"))
}

fn warn(run: &mut Run, blender: &Blender, matrix: &[Vec<f64>]) {
    for (m, shares) in matrix.iter().enumerate() {
        for (k, share) in shares.iter().enumerate().filter(|(k, share)| *k != m && **share > TOO_MUCH) {
            let [at, of] = [m, k].map(|pose| &blender.poses()[pose]);
            run.warn(format!(
                "pose {at} shows {:.0} % of the wrinkles of {of}: they move the same bones alike; if that is not meant, use --dual, or choose poses that differ more",
                100.0 * share
            ));
        }
    }
}
