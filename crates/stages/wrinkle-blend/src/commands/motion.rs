//! The motion that wrinkles follow: an animation, frame by frame.

use super::model::{Model, animation};
use anyhow::bail;
use artifact::gltf::Animation;
use artifact::{FrameRange, Rate};
use serde::Serialize;
use stage::Run;
use std::path::PathBuf;
use wrinkle_blend::{Pose, duration, retargeted, sample};

#[derive(clap::Args, Serialize)]
#[command(next_help_heading = "Motion")]
pub(crate) struct MotionArguments {
    /// File of the animation (.glb, .gltf), whose bones are found by name [default: the character's]
    #[arg(long, value_name = "FILE")]
    #[serde(skip)]
    motion: Option<PathBuf>,
    /// The animation [default: the only one]
    #[arg(long, value_name = "NAME")]
    animation: Option<String>,
    /// Frames per second
    #[arg(long, value_name = "HZ", default_value_t = 30.0)]
    rate: f64,
    /// Number of the frame at 0 s
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    first_frame: i64,
}

/// Frames of an animation.
pub(crate) struct Motion {
    clip: Animation,
    pub(crate) rate: Rate,
    first: i64,
    last: i64,
}

impl MotionArguments {
    pub(crate) fn read(
        &self,
        run: &mut Run,
        model: &Model,
        model_path: &std::path::Path,
    ) -> anyhow::Result<Motion> {
        let Some(rate) = Rate::from_hz(self.rate) else {
            bail!("--rate {}: is no rate\n  to do: say frames per second, e.g. 30 or 29.97", self.rate);
        };
        let clip = match &self.motion {
            None => animation(model_path, &model.character, self.animation.as_deref())?.clone(),
            Some(path) => {
                let (character, _) = artifact::gltf::read(path)?;
                run.input("motion", path)?;
                let own = animation(path, &character, self.animation.as_deref())?;
                let (clip, strangers) = retargeted(&character, own, &model.character.nodes);
                self.report(run, path, &strangers, clip.channels.is_empty())?;
                clip
            }
        };
        let count = (duration(&clip) * rate.hz() + 1e-6).floor() as i64;
        Ok(Motion { clip, rate, first: self.first_frame, last: self.first_frame.saturating_add(count) })
    }

    fn report(
        &self,
        run: &mut Run,
        path: &std::path::Path,
        strangers: &[String],
        nothing: bool,
    ) -> anyhow::Result<()> {
        let names = strangers.iter().take(5).cloned().collect::<Vec<_>>().join(", ");
        if nothing {
            bail!(
                "{}: moves no bone of the character (it moves {names})\n  to do: export both with the same names of bones",
                path.display()
            );
        }
        if !strangers.is_empty() {
            run.warn(format!(
                "{}: {} of its bones are not the character's ({names})",
                path.display(),
                strangers.len()
            ));
        }
        Ok(())
    }
}

impl Motion {
    /// The frames of a range.
    pub(crate) fn frames(&self, range: FrameRange) -> anyhow::Result<Vec<i64>> {
        let frames: Vec<i64> = (self.first.max(range.first)..=self.last.min(range.last)).collect();
        match frames.is_empty() {
            true => bail!(
                "--frames {range}: the animation has none of them\n  to do: choose from {}-{}",
                self.first,
                self.last
            ),
            false => Ok(frames),
        }
    }

    pub(crate) fn pose(&self, model: &Model, frame: i64) -> Pose {
        sample(&model.character.nodes, &self.clip, (frame - self.first) as f64 / self.rate.hz())
    }
}
