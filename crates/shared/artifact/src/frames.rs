//! `frames/1`: the images of a take, extracted and named by mocap frame.

use crate::image_pattern::{check_pattern, image_path};
use crate::{Document, Kind, TakeRef, Violation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Where the images of a take are, camera by camera.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Frames {
    /// The take.
    pub take: Option<TakeRef>,
    /// Per camera id its images.
    pub cameras: BTreeMap<String, CameraFrames>,
}

/// The images of a camera.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CameraFrames {
    /// Image files, their paths relative to this file, with the mocap frame's number as `{frame}` or, filled up with zeros
    /// to six digits, `{frame:06}`; e.g. `m1/{frame:06}.png`.
    pub images: String,
    /// Image width, height in pixels.
    pub image_size: [u32; 2],
    /// Transfer function of the code values, e.g. `srgb`, `rec709`, `linear`, `gamma 2.2`.
    pub transfer: String,
    /// Bits per channel.
    pub bit_depth: u8,
    /// The mocap frames that have an image: runs, rising; gaps stay gaps.
    pub frames: Vec<FrameRun>,
}

/// Frames at equal distances, the last one included.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FrameRun {
    /// First frame.
    pub first: i64,
    /// Last frame.
    pub last: i64,
    /// From one frame to the next; 1 where nothing is said.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub step: u32,
}

fn one() -> u32 {
    1
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn is_one(step: &u32) -> bool {
    *step == 1
}

impl FrameRun {
    /// The runs that rising frame numbers fall into, each as long as it gets.
    #[must_use]
    pub fn runs(frames: &[i64]) -> Vec<Self> {
        let mut runs: Vec<Self> = Vec::new();
        for &frame in frames {
            let Some(run) = runs.last_mut() else {
                runs.push(Self { first: frame, last: frame, step: 1 });
                continue;
            };
            let step = frame.abs_diff(run.last);
            if run.first == run.last && u32::try_from(step).is_ok() {
                *run = Self { first: run.first, last: frame, step: step as u32 };
            } else if step == u64::from(run.step) {
                run.last = frame;
            } else {
                runs.push(Self { first: frame, last: frame, step: 1 });
            }
        }
        runs
    }

    /// The frame numbers, rising.
    pub fn iter(self) -> impl Iterator<Item = i64> {
        (self.first..=self.last).step_by(self.step.max(1) as usize)
    }
}

impl CameraFrames {
    /// The path of the image of a frame, relative to the artifact; none where the frame has no image.
    #[must_use]
    pub fn image(&self, frame: i64) -> Option<String> {
        let holds = |run: &FrameRun| {
            (run.first..=run.last).contains(&frame)
                && frame.abs_diff(run.first).is_multiple_of(u64::from(run.step.max(1)))
        };
        self.frames.iter().any(holds).then(|| image_path(&self.images, frame))
    }

    /// Every frame that has an image, rising, with the image's path relative to the artifact.
    pub fn images(&self) -> impl Iterator<Item = (i64, String)> {
        self.frames.iter().flat_map(|run| run.iter()).map(|frame| (frame, image_path(&self.images, frame)))
    }
}

impl Kind for Frames {
    const NAME: &'static str = "frames";
    const VERSION: u32 = 1;
}

impl Document for Frames {
    fn check(&self) -> Result<(), Violation> {
        if self.cameras.contains_key("") {
            return Err(Violation::new("cameras", "a camera has an empty id"));
        }
        for (id, camera) in &self.cameras {
            let place = format!("camera {id}");
            check_pattern(&format!("{place}, images"), &camera.images)?;
            if camera.image_size.contains(&0) {
                let [width, height] = camera.image_size;
                return Err(Violation::new(place, format!("the images have no size: {width} × {height} px")));
            }
            check_runs(&format!("{place}, frames"), &camera.frames)?;
        }
        Ok(())
    }
}

fn check_runs(place: &str, runs: &[FrameRun]) -> Result<(), Violation> {
    for FrameRun { first, last, step } in runs {
        if first > last || *step == 0 || !last.abs_diff(*first).is_multiple_of(u64::from(*step)) {
            let what = format!("no steps of {step} lead from frame {first} to frame {last}");
            return Err(Violation::new(place, what));
        }
    }
    match runs.windows(2).find(|pair| pair[0].last >= pair[1].first) {
        Some(pair) => {
            let what = format!("frame {} follows frame {}; they must rise", pair[1].first, pair[0].last);
            Err(Violation::new(place, what))
        }
        None => Ok(()),
    }
}
