//! What can be scored, and how each kind is.

use super::comparison::Comparison;
use super::{pictures, streams, surfaces};
use anyhow::bail;
use artifact::{
    HeadPose, HeadTrajectories, Sections, TimeBase, Tracks2d, Trajectories3d, Valleys, Wrinkles2d,
};
use clap::ValueEnum;
use virtual_rig::score::{self, Metric};

/// What a stage can have made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Kind {
    /// Markers in the images
    #[value(name = "tracks-2d")]
    Tracks2d,
    /// Markers in the world
    #[value(name = "trajectories-3d")]
    Trajectories3d,
    /// Markers without the head's motion, up to one rigid motion for the whole take
    HeadTrajectories,
    /// The head's motion since the first frame
    HeadPose,
    /// Calibrated cameras, by what they do to markers
    Cameras,
    /// The time base
    Sync,
    /// The surface without wrinkles
    LargeScale,
    /// The surface with wrinkles
    Wrinkled,
    /// Valley curves in the images
    #[value(name = "wrinkles-2d")]
    Wrinkles2d,
    /// Cross-sections of wrinkles in the images
    Sections,
    /// Valley curves on the mesh
    Valleys,
    /// Pictures that say where paint is
    Masks,
    /// Pictures of normals in camera space, or a mesh sequence by the normals of its vertices
    Normals,
}

impl Kind {
    /// The name that users say.
    pub(super) fn name(self) -> String {
        self.to_possible_value().map(|value| value.get_name().to_string()).unwrap_or_default()
    }

    /// The stage that usually makes such a result.
    pub(super) fn stage(self) -> &'static str {
        match self {
            Self::Tracks2d => "marker-track",
            Self::Trajectories3d => "triangulate",
            Self::HeadTrajectories | Self::HeadPose => "stabilize",
            Self::Cameras => "calibrate",
            Self::Sync => "capture-sync",
            Self::LargeScale => "linear-shell",
            Self::Wrinkles2d | Self::Masks => "wrinkle-track",
            Self::Sections => "cross-section",
            Self::Valleys | Self::Wrinkled => "shell-synth",
            Self::Normals => "scan-refine",
        }
    }

    /// Reads truth and result, and compares them.
    pub(super) fn score(self, comparison: &mut Comparison) -> anyhow::Result<Vec<Metric>> {
        self.check_options(comparison)?;
        let metrics = match self {
            Self::Tracks2d => {
                streams::score::<Tracks2d, Tracks2d>(comparison, "tracks-2d.jsonl", score::tracks_2d)
            }
            Self::Trajectories3d => {
                streams::markers::<Trajectories3d>(comparison, "markers.jsonl", score::trajectories_3d)
            }
            Self::HeadTrajectories => {
                streams::markers::<HeadTrajectories>(comparison, "head.jsonl", score::head_trajectories)
            }
            Self::HeadPose => {
                streams::score::<HeadPose, HeadPose>(comparison, "pose.jsonl", score::head_pose)
            }
            Self::Cameras => streams::cameras(comparison),
            Self::Sync => streams::score::<TimeBase, TimeBase>(comparison, "sync.jsonl", score::sync),
            Self::LargeScale => surfaces::large_scale(comparison),
            Self::Wrinkled => surfaces::wrinkled(comparison),
            // The sections stand densely along every visible valley; the curves of the truth would only say the same.
            Self::Wrinkles2d => {
                streams::score::<Sections, Wrinkles2d>(comparison, "sections.jsonl", score::wrinkles_2d)
            }
            Self::Sections => {
                streams::score::<Sections, Sections>(comparison, "sections.jsonl", score::sections)
            }
            Self::Valleys => streams::score::<Valleys, Valleys>(comparison, "valleys.jsonl", score::valleys),
            Self::Masks => pictures::masks(comparison),
            Self::Normals if comparison.result_is_sequence() => surfaces::normals(comparison),
            Self::Normals => pictures::normals(comparison),
        };
        metrics.map_err(|error| comparison.explain(error))
    }

    /// Refuses options that would change nothing.
    fn check_options(self, comparison: &Comparison) -> anyhow::Result<()> {
        let name = self.name();
        let with_against = [Self::Cameras, Self::Wrinkled, Self::Masks, Self::Normals];
        if comparison.against.is_some() && !with_against.contains(&self) {
            bail!(
                "--against: the kind {name} is compared with the truth folder alone\n  to do: leave --against out"
            );
        }
        if comparison.unit.is_some() && ![Self::Trajectories3d, Self::HeadTrajectories].contains(&self) {
            bail!("--marker-unit: the kind {name} says its unit itself\n  to do: leave --marker-unit out");
        }
        Ok(())
    }
}
