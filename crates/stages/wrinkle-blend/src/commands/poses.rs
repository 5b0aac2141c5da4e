//! `wrinkle-blend poses`.

use super::model::ModelArguments;
use super::options::PoseArguments;
use anyhow::{Context, bail};
use artifact::FileRef;
use serde_json::json;
use stage::Run;
use std::path::PathBuf;
use std::str::FromStr;

/// Writes reference poses out of an animation, with their maps, to a file
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    #[command(flatten)]
    poses: PoseArguments,
    /// Wrinkle map of a pose; put it beside the file that is written
    #[arg(long = "map", value_name = "ID=PNG")]
    maps: Vec<GivenMap>,
    /// Poses to write (poses; - for standard output)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// A map on the command line.
#[derive(Debug, Clone)]
pub(crate) struct GivenMap {
    pub(crate) id: String,
    pub(crate) path: PathBuf,
}

impl FromStr for GivenMap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (id, path) = text.split_once('=').ok_or("say ID=PNG, e.g. brows-up=brows.png")?;
        Ok(Self { id: id.to_string(), path: path.into() })
    }
}

/// The place of a map's pose.
pub(crate) fn pose_of(map: &GivenMap, mut ids: impl Iterator<Item = String>) -> anyhow::Result<usize> {
    let GivenMap { id, path } = map;
    ids.position(|pose| pose == *id).with_context(|| {
        format!(
            "--map {id}={}: there is no pose '{id}'\n  to do: correct its name, or add the pose",
            path.display()
        )
    })
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("poses");
    let model = arguments.model.read(run)?;
    let mut references = arguments.poses.read(run, &model, &arguments.model.model)?;
    run.parameters(&json!({ "model": arguments.model, "poses": arguments.poses }))?;
    for map in &arguments.maps {
        let pose = pose_of(map, references.poses.iter().map(|(id, _)| id.clone()))?;
        let file: FileRef = run.input(&format!("map of {}", map.id), &map.path)?;
        references.maps[pose] = Some(file);
    }
    // What is written is read again by stages that refuse such poses.
    let rest = references.poses.iter().find(|(_, pose)| *pose == model.neutral);
    if let Some((id, _)) = rest {
        bail!("pose {id}: is the neutral pose\n  to do: choose a time at which the face moves");
    }
    run.check_folders(&[&arguments.out])?;
    run.result("poses", references.poses.len());
    run.publish(vec![artifact::write_document(&arguments.out, &references.document(&model))?])
}
