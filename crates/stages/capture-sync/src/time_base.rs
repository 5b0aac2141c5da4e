//! The time base: which image of which camera shows each mocap frame.

use crate::timeline::{Paced, Timeline, stated_step};
use crate::{Error, extent};
use artifact::{Clock, Rate, Shown, SyncCamera, SyncFrame, SyncHeader};
use std::collections::BTreeMap;

/// Rates whose ratio is this near to a whole number are meant to be in step.
const WHOLE_RATIO: f64 = 5e-3;
/// So that an image exactly between two frames is not lost to rounding, frames.
const SLACK: f64 = 1e-9;

/// What a take says of its clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TakeClock {
    /// Frames per second of the mocap clock.
    pub rate: Rate,
    /// Number of the first frame.
    pub first_frame: i64,
    /// Where time comes from.
    pub clock: Clock,
}

/// A time base in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Synchronized {
    /// What holds for all frames; it refers to no take yet.
    pub header: SyncHeader,
    /// The frames.
    pub frames: Vec<SyncFrame>,
    /// What was found, by camera.
    pub report: BTreeMap<String, crate::CameraReport>,
    /// The time of the first frame by the stamps' clock, s, where that was used.
    pub zero_s: Option<f64>,
}

/// How many mocap frames from one image to the next, for `sync`: 1 where the ratio is not whole.
pub(crate) fn every(camera: &Paced, take_rate: Rate) -> u32 {
    let ratio = stated_step(camera.recording, take_rate);
    let whole = ratio.round().max(1.0);
    if (ratio / whole - 1.0).abs() < WHOLE_RATIO { whole as u32 } else { 1 }
}

/// How a camera's clock stands to the mocap clock, as `sync` says it.
pub(crate) fn sync_camera(camera: &Paced, line: &Timeline, clock: &TakeClock) -> SyncCamera {
    let every = every(camera, clock.rate);
    let ratio = stated_step(camera.recording, clock.rate);
    // The exposure nearest to the first frame says in which frames the camera is due.
    let near = line.at(line.nearest(0.0) as f64);
    let phase = (near.round() as i64).rem_euclid(i64::from(every));
    let exposure = ((phase as f64 - line.start) / line.step).round();
    // Where it does not come to whole frames, another camera may be in its place; the offset is that of the nearest.
    SyncCamera {
        rate: camera.recording.rate,
        every,
        phase: clock.first_frame + phase,
        offset_frames: line.at(exposure) - phase as f64,
        drift_ppm: 1e6 * (line.step / ratio - 1.0),
        source: line.source,
    }
}

/// What a camera shows, exposure by exposure: the first image of each, which is whole; its copies stand in no frame. An
/// image that repeats the one before it in the place of a lost one shows nothing.
fn shown(camera: &Paced) -> BTreeMap<i64, Shown> {
    let mut shown: BTreeMap<i64, Shown> = BTreeMap::new();
    for (i, image) in camera.recording.images.iter().enumerate() {
        let (exposure, repeats) = (camera.cadence.exposures[i], camera.cadence.repeats[i]);
        if !repeats {
            let image = Shown { index: image.index, time_s: image.time_s, doubled: false };
            shown.entry(exposure).or_insert(image);
        }
    }
    shown
}

/// The frames from the take's first to the last that a mocap camera shows.
pub(crate) fn frames(
    cameras: &[Paced],
    lines: &[Timeline],
    header: &SyncHeader,
    clock: &TakeClock,
) -> Result<Vec<SyncFrame>, Error> {
    let images: Vec<BTreeMap<i64, Shown>> = cameras.iter().map(shown).collect();
    let last = last_frame(cameras, lines, header);
    extent::check_frames(cameras, lines, clock, last)?;
    let frame = |since: i64| {
        let number = clock.first_frame + since;
        let shows = cameras.iter().enumerate().filter_map(|(c, camera)| {
            let sync = &header.cameras[camera.id()];
            sync.is_due(number).then(|| {
                let exposure = lines[c].nearest(since as f64);
                let lag = lines[c].at(exposure as f64) - since as f64;
                let is_near = lag.abs() <= 0.5 * f64::from(sync.every) + SLACK;
                (camera.id().to_string(), is_near.then(|| images[c].get(&exposure).copied()).flatten())
            })
        });
        SyncFrame { frame: number, shows: shows.collect() }
    };
    Ok((0..=last).map(frame).collect())
}

fn last_frame(cameras: &[Paced], lines: &[Timeline], header: &SyncHeader) -> i64 {
    let every = |c: usize| header.cameras[cameras[c].id()].every;
    let least = (0..cameras.len()).map(every).min().unwrap_or(1);
    let last = |c: usize| {
        lines[c].at(cameras[c].cadence.exposures.last().copied().unwrap_or(0) as f64).round() as i64
    };
    (0..cameras.len()).filter(|&c| every(c) == least).map(last).max().unwrap_or(0)
}
