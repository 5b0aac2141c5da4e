//! `sync/1`: one time base. Which image of which camera shows each mocap frame.

use crate::{Clock, Kind, Rate, Stream, TakeRef, Violation, finite};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The kind of time bases.
pub struct TimeBase;

/// What holds for all frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SyncHeader {
    /// Frames per second of the mocap clock, which all frames are counted in.
    pub rate: Rate,
    /// Where time comes from, as the take says.
    pub clock: Clock,
    /// Per camera id how its clock stands to the mocap clock.
    pub cameras: BTreeMap<String, SyncCamera>,
    /// The take.
    pub take: Option<TakeRef>,
}

/// How a camera's clock stands to the mocap clock. The image that shows mocap frame `f` was taken at the mocap time
/// `f + offset_frames + drift_ppm · 10⁻⁶ · (f − phase)`, in frames, less the whole steps of `every` frames by which the
/// clocks have come apart meanwhile: each frame shows the image that is nearest in time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SyncCamera {
    /// Frames per second of the camera.
    pub rate: Rate,
    /// The camera is due in every so manyth mocap frame …
    pub every: u32,
    /// … from this one on.
    pub phase: i64,
    /// How much later than the mocap frame that it shows the camera takes its image, in mocap frames, at `phase`.
    pub offset_frames: f64,
    /// How much this grows over time, parts per million: positive where the camera's clock is slow.
    pub drift_ppm: f64,
    /// How this was found.
    pub source: SyncSource,
}

impl SyncCamera {
    /// Whether the camera should have an image of a mocap frame.
    #[must_use]
    pub fn is_due(&self, frame: i64) -> bool {
        frame >= self.phase && frame.abs_diff(self.phase).is_multiple_of(u64::from(self.every.max(1)))
    }

    /// How much later than a mocap frame the image was taken that shows it, mocap frames: within half of `every`.
    #[must_use]
    pub fn lag_frames(&self, frame: i64) -> f64 {
        let every = f64::from(self.every.max(1));
        let lag = self.offset_frames + self.drift_ppm * 1e-6 * (frame - self.phase) as f64;
        lag - every * (lag / every).round()
    }
}

/// How the time of a camera's images was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SyncSource {
    /// Stated, not measured.
    Stated,
    /// A time stamp per image.
    Timestamps,
    /// A log of the common trigger.
    Trigger,
    /// An event that all cameras saw.
    Flash,
    /// Correlation of the images' brightness or motion.
    Correlation,
}

/// What the cameras show in a mocap frame, in memory and in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SyncFrame {
    /// Absolute number of the mocap frame.
    pub frame: i64,
    /// Per camera id the image that shows the frame; null where it is due but missing; no entry where it is not due.
    pub shows: BTreeMap<String, Option<Shown>>,
}

/// An image of a camera's footage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shown {
    /// Number of the image, as its footage counts: the number in the file name, or the index in the video (from 0).
    pub index: i64,
    /// When the image was taken, by its time stamp, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_s: Option<f64>,
    /// Whether the image only repeats the one before it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub doubled: bool,
}

impl Kind for TimeBase {
    const NAME: &'static str = "sync";
    const VERSION: u32 = 1;
}

impl Stream for TimeBase {
    type Header = SyncHeader;
    type Frame = SyncFrame;
    type Line = SyncFrame;

    fn check(header: &SyncHeader) -> Result<(), Violation> {
        header.rate.check("rate")?;
        if header.cameras.contains_key("") {
            return Err(Violation::new("cameras", "a camera has an empty id"));
        }
        for (id, camera) in &header.cameras {
            let place = format!("camera {id}");
            camera.rate.check(&place)?;
            finite(&place, [&camera.offset_frames, &camera.drift_ppm])?;
            if camera.every == 0 {
                return Err(Violation::new(place, "cannot be due in every 0th frame"));
            }
        }
        Ok(())
    }

    fn encode(header: &SyncHeader, frame: &SyncFrame) -> Result<SyncFrame, Violation> {
        check_frame(header, frame)?;
        Ok(frame.clone())
    }

    fn decode(header: &SyncHeader, line: SyncFrame) -> Result<SyncFrame, Violation> {
        check_frame(header, &line)?;
        Ok(line)
    }

    fn number(frame: &SyncFrame) -> i64 {
        frame.frame
    }
}

fn check_frame(header: &SyncHeader, frame: &SyncFrame) -> Result<(), Violation> {
    let refuse =
        |id: &String, what: &str| Err(Violation::new(format!("frame {}, camera {id}", frame.frame), what));
    if let Some(id) = frame.shows.keys().find(|&id| !header.cameras.contains_key(id)) {
        return refuse(id, "is not among the header's cameras");
    }
    for (id, camera) in &header.cameras {
        let due = camera.is_due(frame.frame);
        match frame.shows.get(id) {
            Some(_) if !due => return refuse(id, "is not due in this frame"),
            None if due => return refuse(id, "is due in this frame; say null where its image is missing"),
            Some(Some(shown)) => {
                finite(&format!("frame {}, camera {id}, time_s", frame.frame), &shown.time_s)?;
            }
            _ => {}
        }
    }
    Ok(())
}
