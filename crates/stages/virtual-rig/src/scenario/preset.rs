//! The frozen scenarios, and the lengths of takes.

use super::{Extent, Scenario};
use crate::calibration::{BoardViews, Wand};
use serde::Deserialize;
use std::str::FromStr;

/// The published scenarios: name without version, and file. A change makes a new version; old ones stay.
pub const PRESETS: [(&str, &str); 3] = [
    ("clean", include_str!("../../scenarios/clean-1.json")),
    ("standard", include_str!("../../scenarios/standard-1.json")),
    ("hard", include_str!("../../scenarios/hard-1.json")),
];

/// A published scenario, by its name with or without version.
#[must_use]
pub fn preset(name: &str) -> Option<Scenario> {
    #[derive(Deserialize)]
    struct File {
        data: Scenario,
    }
    let (_, text) = PRESETS.iter().find(|(known, _)| {
        let rest = name.strip_prefix(known);
        rest.is_some_and(|rest| rest.is_empty() || rest == "-1")
    })?;
    serde_json::from_str::<File>(text).ok().map(|file| file.data)
}

/// How long a take is: frames of the mocap cameras, and of the wrinkle cameras. A length also says how large all is: it
/// sets the whole of the extent but for the first frame's number and the rate, and vertices, image scale, and how much is
/// filmed for calibration, whatever the scenario said of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Length {
    /// 3 and 1, small images and a coarse face: for files that are kept.
    Tiny,
    /// 25 and 7: the length of the published scenarios as they stand.
    Short,
    /// 500 and 125: everything that a performance holds.
    Long,
}

impl FromStr for Length {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "tiny" => Ok(Self::Tiny),
            "short" => Ok(Self::Short),
            "long" => Ok(Self::Long),
            _ => Err(format!("'{text}' is no length; say tiny, short or long")),
        }
    }
}

/// Vertices of a tiny face.
const TINY_VERTICES: usize = 5_000;
/// Vertices of a face in a short take.
const SHORT_VERTICES: usize = 150_000;
/// Vertices of a face in a long take, whose meshes are kept for every frame.
const LONG_VERTICES: usize = 60_000;
/// A wrinkle camera takes every so-many-th frame [BickelBotsch2007, §3].
const WRINKLE_EVERY: u32 = 4;
/// Size of a tiny take's images in thousandths, about.
const TINY_SCALE: i32 = 500;
/// How far to either side a scale is looked for that makes all sides even, as videos need them.
const SCALE_STEPS: i32 = 100;

impl Length {
    /// Makes a scenario so long and so large.
    pub fn apply(self, scenario: &mut Scenario) {
        let (frames, wrinkle_phase, pace, vertices) = match self {
            // The one wrinkle frame is the last, where the face is strongest.
            Self::Tiny => (3, 2, 10.0, TINY_VERTICES),
            Self::Short => (25, 0, 1.0, SHORT_VERTICES),
            Self::Long => (500, 0, 1.0, LONG_VERTICES),
        };
        let wrinkle_every = WRINKLE_EVERY;
        scenario.extent = Extent { frames, wrinkle_every, wrinkle_phase, pace, ..scenario.extent };
        scenario.vertices = vertices;
        scenario.image_scale = 1.0;
        let (boards, wand) = (&mut scenario.calibration.boards, &mut scenario.calibration.wand);
        (boards.count, wand.frames) = match self {
            Self::Tiny => (0, 0),
            _ => (BoardViews::default().count, Wand::default().frames),
        };
        if self == Self::Tiny {
            scenario.image_scale = even_scale(scenario);
        }
    }
}

/// The scale nearest to [`TINY_SCALE`] at which the images of all cameras have even sides; that one if there is none near.
fn even_scale(scenario: &Scenario) -> f64 {
    let share = |thousandths: i32| f64::from(thousandths) / 1000.0;
    let mut scales = (0..=SCALE_STEPS).flat_map(|step| [TINY_SCALE + step, TINY_SCALE - step]).map(share);
    let is_even = |scale: &f64| {
        let placed = Scenario { image_scale: *scale, ..scenario.clone() }.placements();
        placed.values().all(|camera| camera.image_size.iter().all(|side| side % 2 == 0))
    };
    scales.find(is_even).unwrap_or(share(TINY_SCALE))
}
