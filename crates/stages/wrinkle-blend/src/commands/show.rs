//! `wrinkle-blend show`.

use super::model::ModelArguments;
use super::motion::MotionArguments;
use super::options::{ParamArguments, PoseArguments};
use artifact::{FrameRange, Unit};
use mesh::Mesh;
use serde_json::json;
use stage::Run;
use std::path::PathBuf;
use wrinkle_blend::player::COLORS;
use wrinkle_blend::skinned;

/// Colours the posed mesh by the poses whose wrinkles show: red the first, green the second, then blue, yellow, …
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    #[command(flatten)]
    poses: PoseArguments,
    /// Mesh to write, in mm (.ply)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    motion: MotionArguments,
    /// The frame
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    frame: i64,
    #[command(flatten)]
    params: ParamArguments,
}

/// Skin without wrinkles.
const PLAIN: [f32; 3] = [0.75; 3];

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("show");
    let params = arguments.params.params()?;
    let path = &arguments.model.model;
    let model = arguments.model.read(run)?;
    let references = arguments.poses.read(run, &model, path)?;
    let motion = arguments.motion.read(run, &model, path)?;
    run.parameters(&json!({
        "model": arguments.model, "poses": arguments.poses, "motion": arguments.motion,
        "frame": arguments.frame, "comparison": params,
    }))?;
    let frame = motion.frames(FrameRange { first: arguments.frame, last: arguments.frame })?[0];
    let blender = references.blender(&model, &params, path)?;
    let pose = motion.pose(&model, frame);
    let mut weights = Vec::new();
    blender.vertex_weights(&blender.shares(&pose), &mut weights);
    let points = skinned(&model.character, model.mesh(), &pose);
    let points = points.into_iter().map(|point| (point * model.mm_per_unit).into()).collect();
    let mut mesh = Mesh::from_triangles(points, &model.mesh().triangles);
    let count = blender.vertex_count();
    mesh.colors = (0..count).map(|vertex| color(weights.iter().skip(vertex).step_by(count))).collect();
    run.check_folders(&[&arguments.out])?;
    run.result("frame", frame);
    run.publish(vec![artifact::write_mesh(&arguments.out, &mesh, Unit::Mm)?])
}

/// The mean colour of the poses by weight, over as much of the plain one as is left.
fn color<'a>(weights: impl Iterator<Item = &'a f32> + Clone) -> [f32; 3] {
    let sum: f32 = weights.clone().sum();
    let share = 1.0 / sum.max(1.0);
    std::array::from_fn(|channel| {
        let colored: f32 =
            weights.clone().zip(COLORS.iter().cycle()).map(|(weight, color)| weight * color[channel]).sum();
        share * colored + (1.0 - share * sum) * PLAIN[channel]
    })
}
