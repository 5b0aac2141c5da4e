//! The frozen scenarios, and the lengths of takes.

use super::Scenario;
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

/// How long a take is: frames of the mocap cameras, and of the wrinkle cameras.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Length {
    /// 3 and 1, small images and a coarse face: for files that are kept.
    Tiny,
    /// 25 and 7.
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
/// Vertices of a face in a long take, whose meshes are kept for every frame.
const LONG_VERTICES: usize = 60_000;

impl Length {
    /// Makes a scenario so long. `short` is the length of the published scenarios as they stand.
    pub fn apply(self, scenario: &mut Scenario) {
        match self {
            Self::Short => {}
            Self::Long => {
                scenario.extent.frames = 500;
                scenario.vertices = LONG_VERTICES;
            }
            Self::Tiny => {
                scenario.extent.frames = 3;
                // The one wrinkle frame is the last, where the face is strongest.
                scenario.extent.wrinkle_phase = 2;
                scenario.extent.pace = 10.0;
                scenario.vertices = TINY_VERTICES;
                scenario.image_scale = 0.5;
                scenario.calibration.boards.count = 0;
                scenario.calibration.wand.frames = 0;
            }
        }
    }
}
