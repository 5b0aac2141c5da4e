//! `wrinkle-blend weights`.

use super::model::ModelArguments;
use super::motion::MotionArguments;
use super::options::{ParamArguments, PoseArguments};
use artifact::{BlendWeights, BlendWeightsFrame, BlendWeightsHeader, FrameRange, FrameWriter};
use serde_json::json;
use stage::Run;
use std::collections::BTreeMap;
use std::path::PathBuf;
use wrinkle_blend::{Blender, Shares};

/// Tells how much of each reference pose's wrinkle map shows at each vertex, frame by frame
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    #[command(flatten)]
    poses: PoseArguments,
    /// Only what bones do: no weights of vertices
    #[arg(long)]
    bones_only: bool,
    /// Weights to write (blend-weights; - for standard output)
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
    run.subcommand("weights");
    let params = arguments.params.params()?;
    let path = &arguments.model.model;
    let model = arguments.model.read(run)?;
    let references = arguments.poses.read(run, &model, path)?;
    let motion = arguments.motion.read(run, &model, path)?;
    run.parameters(&json!({
        "model": arguments.model, "poses": arguments.poses, "motion": arguments.motion,
        "frames": arguments.frames.to_string(), "bones_only": arguments.bones_only, "comparison": params,
    }))?;
    run.check_outputs(&[&arguments.out])?;
    run.check_folders(&[&arguments.out])?;
    let blender = references.blender(&model, &params, path)?;
    let frames = motion.frames(arguments.frames)?;
    let header = BlendWeightsHeader {
        model: model.file.clone(),
        mesh: model.mesh().name.clone(),
        vertex_count: blender.vertex_count(),
        poses: blender.poses().to_vec(),
        bones: blender.bones().iter().map(|bone| bone.name.clone()).collect(),
        rate: Some(motion.rate),
    };
    let mut writer = FrameWriter::<BlendWeights>::create(&arguments.out, header)?;
    let mut progress = run.progress("weighing", Some(frames.len() as u64));
    let mut weights = Vec::new();
    for &frame in &frames {
        let pose = motion.pose(&model, frame);
        let shares = run.timed("weights", || {
            let shares = blender.shares(&pose);
            blender.vertex_weights(&shares, &mut weights);
            shares
        });
        let vertices = (!arguments.bones_only).then(|| of_vertices(&blender, &weights));
        writer.write(&BlendWeightsFrame { frame, bones: of_bones(&blender, &shares), vertices })?;
        progress.step();
    }
    drop(progress);
    run.result("frames", frames.len());
    run.result("poses", blender.poses().len());
    run.result("bones", blender.bones().len());
    run.result("vertices", blender.vertex_count());
    run.publish(vec![writer.finish()?])
}

fn of_bones(blender: &Blender, shares: &Shares) -> BTreeMap<String, BTreeMap<String, f64>> {
    let of_pose = |(pose, (id, shares)): (usize, (&String, &Vec<f64>))| {
        let bones = blender.bones().iter().zip(shares).enumerate();
        let moved = bones.filter(|(bone, _)| blender.way(pose, *bone).is_some());
        (id.clone(), moved.map(|(_, (bone, share))| (bone.name.clone(), *share)).collect())
    };
    blender.poses().iter().zip(&shares.0).enumerate().map(of_pose).collect()
}

/// Poses of which nothing shows have no entry.
fn of_vertices(blender: &Blender, weights: &[f32]) -> BTreeMap<String, Vec<f32>> {
    let rows = weights.chunks_exact(blender.vertex_count().max(1));
    let shown = blender.poses().iter().zip(rows).filter(|(_, row)| row.iter().any(|weight| *weight != 0.0));
    shown.map(|(id, row)| (id.clone(), row.to_vec())).collect()
}
