//! The reference poses, and how they are compared.

use super::model::{Model, animation};
use anyhow::{Context, bail};
use artifact::{FileRef, Poses, ReferencePose};
use serde::Serialize;
use stage::Run;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use wrinkle_blend::{Blender, Mask, Modulation, NamedPose, Params, Probe, combined, placed, sample, written};

#[derive(clap::Args, Serialize)]
#[group(skip)]
#[command(group = clap::ArgGroup::new("references").required(true).multiple(true))]
pub(crate) struct PoseArguments {
    /// Reference poses (poses)
    #[arg(long, value_name = "FILE", group = "references")]
    #[serde(skip)]
    poses: Option<PathBuf>,
    /// A reference pose out of an animation of the character: its name and a time in seconds, or several times (A+B), whose poses
    /// are laid over each other; may be given again and again
    #[arg(long = "pose", value_name = "ID=SECONDS", group = "references")]
    given: Vec<GivenPose>,
    /// The animation that --pose means [default: the only one]
    #[arg(long, value_name = "NAME")]
    pose_animation: Option<String>,
}

/// A pose on the command line.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct GivenPose {
    id: String,
    seconds: Vec<f64>,
}

impl FromStr for GivenPose {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (id, times) = text.split_once('=').ok_or("say ID=SECONDS, e.g. brows-up=3 or smile=44+45")?;
        let time = |part: &str| {
            let time: f64 = part.trim().parse().map_err(|_| format!("'{part}' is no time in seconds"))?;
            time.is_finite().then_some(time).ok_or_else(|| format!("'{part}' is no time in seconds"))
        };
        let seconds = times.split('+').map(time).collect::<Result<_, _>>()?;
        match id.is_empty() {
            true => Err("the pose has no name: say ID=SECONDS".to_string()),
            false => Ok(Self { id: id.to_string(), seconds }),
        }
    }
}

/// The reference poses, as they were read.
pub(crate) struct References {
    pub(crate) poses: Vec<NamedPose>,
    pub(crate) modulation: Modulation,
    /// Per pose its map, if the file names one.
    pub(crate) maps: Vec<Option<FileRef>>,
    /// Where the file is.
    pub(crate) folder: PathBuf,
}

impl PoseArguments {
    /// Their file, if there is one.
    pub(crate) fn file(&self) -> Option<&Path> {
        self.poses.as_deref()
    }

    pub(crate) fn read(&self, run: &mut Run, model: &Model, model_path: &Path) -> anyhow::Result<References> {
        let mut found = References {
            poses: Vec::new(),
            modulation: Modulation::Cosine,
            maps: Vec::new(),
            folder: PathBuf::new(),
        };
        let nodes = &model.character.nodes;
        if let Some(path) = &self.poses {
            let file: Poses = artifact::read_document(path)?;
            run.input("poses", path)?;
            found.folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
            if let Some(points) = file.modulation {
                found.modulation = Modulation::Curve(points);
            }
            for pose in file.poses {
                let placed =
                    placed(&pose.id, &pose.bones, nodes).with_context(|| path.display().to_string())?;
                found.poses.push((pose.id, placed));
                found.maps.push(pose.map);
            }
        }
        if self.given.is_empty() {
            return Ok(found);
        }
        let clip = animation(model_path, &model.character, self.pose_animation.as_deref())?;
        for pose in &self.given {
            if found.poses.iter().any(|(id, _)| *id == pose.id) {
                bail!("--pose {}: there are two poses of that name\n  to do: rename one", pose.id);
            }
            let parts: Vec<_> = pose.seconds.iter().map(|time| sample(nodes, clip, *time)).collect();
            found.poses.push((pose.id.clone(), combined(&model.neutral, &parts)));
            found.maps.push(None);
        }
        Ok(found)
    }
}

impl References {
    pub(crate) fn blender(&self, model: &Model, params: &Params, path: &Path) -> anyhow::Result<Blender> {
        Blender::new(model.setting(), &self.poses, self.modulation.clone(), params)
            .with_context(|| path.display().to_string())
    }

    /// The same as a file says it.
    pub(crate) fn document(&self, model: &Model) -> Poses {
        let pose = |((id, pose), map): (&NamedPose, &Option<FileRef>)| ReferencePose {
            id: id.clone(),
            bones: written(pose, &model.character.nodes),
            map: map.clone(),
        };
        let modulation = match &self.modulation {
            Modulation::Cosine => None,
            Modulation::Curve(points) => Some(points.clone()),
        };
        let poses = self.poses.iter().zip(&self.maps).map(pose).collect();
        Poses { model: Some(model.file.clone()), poses, modulation }
    }
}

#[derive(clap::Args)]
#[command(next_help_heading = "Comparison of poses")]
pub(crate) struct ParamArguments {
    /// The point of a bone that is watched: the centroid of its skin, or its joint as in the paper
    #[arg(long, value_name = "WHERE", default_value = "skin")]
    probe: ProbeName,
    /// How bones reach vertices: smoothly, by skin weights, or wholly wherever a weight is not 0, as in the paper
    #[arg(long, value_name = "HOW", default_value = "smooth")]
    mask: MaskName,
    /// Share a bone's move out among the poses: similar poses no longer show each other's wrinkles
    #[arg(long)]
    dual: bool,
    /// A bone that moves less in a pose is not of that pose
    #[arg(long, value_name = "MM", default_value_t = Params::default().least_mm)]
    least_mm: f64,
    /// The same, as a share of the pose's farthest bone
    #[arg(long, value_name = "SHARE", default_value_t = Params::default().least_share)]
    least_share: f64,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum ProbeName {
    Skin,
    Joint,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum MaskName {
    Smooth,
    Paper,
}

impl ParamArguments {
    pub(crate) fn params(&self) -> anyhow::Result<Params> {
        let params = Params {
            probe: match self.probe {
                ProbeName::Skin => Probe::Skin,
                ProbeName::Joint => Probe::Joint,
            },
            mask: match self.mask {
                MaskName::Smooth => Mask::Smooth,
                MaskName::Paper => Mask::Paper,
            },
            dual: self.dual,
            least_mm: self.least_mm,
            least_share: self.least_share,
        };
        params.check()?;
        Ok(params)
    }
}
