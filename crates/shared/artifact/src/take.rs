//! `take/2`: the manifest of a take. It names, and refers by hash to, what many takes share.
//!
//! Version 1 had no footage; it is read as a take whose cameras have none.

use crate::ids::check_ids;
use crate::image_pattern::{check_pattern, image_path};
use crate::quantity::Rate;
use crate::{Document, FileRef, Kind, Unit, Violation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A take's manifest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Take {
    /// Who was recorded.
    pub subject: String,
    /// When the markers were painted: markers keep their place within a session.
    pub session: String,
    /// Id of the take.
    pub take: String,
    /// Frames per second of the mocap clock.
    pub rate: Rate,
    /// SMPTE time code of the first frame, `HH:MM:SS:FF`, or `HH:MM:SS;FF` for drop-frame.
    pub start_timecode: Option<String>,
    /// Number of the first frame.
    pub first_frame: i64,
    /// Where time comes from.
    pub clock: Clock,
    /// The cameras; empty for a take that came as markers.
    #[serde(default)]
    pub cameras: Vec<TakeCamera>,
    /// Unit of the scan's coordinates.
    pub mesh_unit: Unit,
    /// The scan's axis that points up.
    pub mesh_up: Axis,
    /// What the take uses, by role: `scan`, `cameras`, `warp`, `classifier`, …
    #[serde(default)]
    pub references: BTreeMap<String, FileRef>,
    /// What may be done with the recording; travels into exports.
    pub consent: Consent,
}

/// Where the time of the frames comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// A common trigger.
    Trigger,
    /// Time stamps per frame.
    Timestamps,
    /// An event seen by all cameras.
    Flash,
    /// Nothing shared; found by correlation.
    Free,
    /// The mocap system's own clock.
    Mocap,
}

/// A direction of the scan's coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// +y
    Y,
    /// +z
    Z,
}

/// A camera of the take.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TakeCamera {
    /// Camera id.
    pub id: String,
    /// Image width, height in pixels.
    pub image_size: [u32; 2],
    /// Transfer function of the footage, e.g. `srgb`, `rec709`, `linear`, `gamma 2.2`.
    pub transfer: String,
    /// Bits per channel.
    pub bit_depth: u8,
    /// Frames per second.
    pub rate: Rate,
    /// Where the images are; absent where only what was made from them is at hand.
    #[serde(default)]
    pub footage: Option<Footage>,
}

/// The images of a camera: a video file or a sequence of images, exactly one of the two.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Footage {
    /// A video file, its path relative to the manifest.
    pub file: Option<String>,
    /// Image files, their paths relative to the manifest, with the image's number as `{frame}` or, filled up with zeros
    /// to six digits, `{frame:06}`; e.g. `footage/m1/{frame:06}.png`.
    pub images: Option<String>,
    /// Number in the name of the first image file, or index of the first frame of the video that belongs to the take
    /// (the video's own first frame has index 0).
    #[serde(default)]
    pub first: i64,
    /// A CSV file, its path relative to the manifest, with the time of every image: lines `index,time_s`.
    pub timestamps: Option<String>,
}

impl Footage {
    /// The path of an image file, relative to the manifest; none where the footage is a video.
    #[must_use]
    pub fn image(&self, number: i64) -> Option<String> {
        self.images.as_ref().map(|pattern| image_path(pattern, number))
    }

    fn check(&self, place: &str) -> Result<(), Violation> {
        if self.first < 0 {
            return Err(Violation::new(place, format!("first is {}; images are counted from 0", self.first)));
        }
        match (&self.file, &self.images) {
            (Some(file), None) if file.is_empty() => Err(Violation::new(place, "the file has no name")),
            (Some(_), None) => Ok(()),
            (None, Some(pattern)) => check_pattern(place, pattern),
            _ => Err(Violation::new(place, "name either a video file or images, exactly one of the two")),
        }
    }
}

/// Consent and licence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Consent {
    /// Licence or agreement, in words.
    pub licence: String,
    /// The credit line to show.
    pub credit: Option<String>,
    /// Anything else to know.
    pub notes: Option<String>,
}

/// A take, as the artifacts made from it refer to it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TakeRef {
    /// Id of the take.
    pub take: String,
    /// Session: a warp holds for all takes of one.
    pub session: String,
    /// SHA-256 of the manifest.
    pub sha256: String,
}

impl std::fmt::Display for TakeRef {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "take {} (sha256 {}…)", self.take, self.sha256.get(..12).unwrap_or(&self.sha256))
    }
}

impl Kind for Take {
    const NAME: &'static str = "take";
    const VERSION: u32 = 2;
}

impl Document for Take {
    fn check(&self) -> Result<(), Violation> {
        self.rate.check("rate")?;
        check_ids("cameras", "camera", self.cameras.iter().map(|camera| &camera.id))?;
        for camera in &self.cameras {
            let place = format!("camera {}", camera.id);
            check_file_name(&place, &camera.id)?;
            camera.rate.check(&place)?;
            camera.footage.as_ref().map_or(Ok(()), |footage| footage.check(&format!("{place}, footage")))?;
        }
        match self.start_timecode.as_deref().map(is_timecode) {
            Some(false) => Err(Violation::new("start_timecode", "is not HH:MM:SS:FF or HH:MM:SS;FF")),
            _ => Ok(()),
        }
    }
}

/// Refuses a camera id that cannot name a folder: its images are written under it.
fn check_file_name(place: &str, id: &str) -> Result<(), Violation> {
    let is_odd = |c: char| c.is_control() || matches!(c, '/' | '\\' | ':');
    match id.starts_with('.') || id.contains(is_odd) {
        true => Err(Violation::new(
            place,
            "its id cannot name a folder; leave out slashes, colons and a dot in front",
        )),
        false => Ok(()),
    }
}

fn is_timecode(text: &str) -> bool {
    let bytes = text.as_bytes();
    bytes.len() == 11
        && bytes.iter().enumerate().all(|(i, byte)| match i {
            2 | 5 => *byte == b':',
            8 => matches!(byte, b':' | b';'),
            _ => byte.is_ascii_digit(),
        })
}
