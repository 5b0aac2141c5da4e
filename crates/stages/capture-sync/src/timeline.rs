//! When a camera's exposures were: a line in mocap frames.

use crate::cadence::Cadence;
use crate::recording::Recording;
use artifact::{Rate, SyncSource};
use serde::Serialize;
use std::ops::RangeInclusive;

/// When a camera's exposures were, in mocap frames since the take's first: exposure n at `start + step · n`.
#[derive(Debug, Clone, PartialEq)]
pub struct Timeline {
    /// Time of exposure 0 (the camera's first image), mocap frames.
    pub start: f64,
    /// Time between exposures, mocap frames.
    pub step: f64,
    /// How this was found.
    pub source: SyncSource,
    /// Standard deviation of the images' times, mocap frames, where it is known.
    pub sigma_frames: Option<f64>,
}

impl Timeline {
    /// As the take says: the image `first` shows the first frame.
    pub(crate) fn stated(recording: &Recording, take_rate: Rate) -> Self {
        let step = stated_step(recording, take_rate);
        let late = recording.images.first().map_or(0, |image| image.index - recording.first);
        Self { start: late as f64 * step, step, source: SyncSource::Stated, sigma_frames: None }
    }

    /// The time of an exposure, mocap frames.
    #[must_use]
    pub fn at(&self, exposure: f64) -> f64 {
        self.start + self.step * exposure
    }

    /// The exposure nearest to a time, mocap frames.
    #[must_use]
    pub fn nearest(&self, time: f64) -> i64 {
        ((time - self.start) / self.step).round() as i64
    }
}

/// Mocap frames between exposures, by the stated rates.
pub(crate) fn stated_step(recording: &Recording, take_rate: Rate) -> f64 {
    let Rate { frames, seconds } = recording.rate;
    f64::from(take_rate.frames) * f64::from(seconds) / (f64::from(take_rate.seconds) * f64::from(frames))
}

/// A camera whose exposures are known.
#[derive(Debug, Clone)]
pub(crate) struct Paced<'a> {
    pub(crate) recording: &'a Recording,
    pub(crate) cadence: Cadence,
    /// Whether time stamps say which images were lost.
    pub(crate) is_stamped: bool,
    /// Images that were lost as motion tells.
    pub(crate) losses: Vec<Loss>,
}

/// Images that were lost without a trace but that the camera fell out of step with the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Loss {
    /// Index of the first image after them.
    pub before_image: i64,
    /// How many images further on or back it may be.
    pub within: i64,
    /// How many were lost.
    pub images: i64,
}

impl Paced<'_> {
    pub(crate) fn id(&self) -> &str {
        &self.recording.id
    }

    /// Leaves a gap before an exposure. An image near by that repeats the one before it stands in the place of one of those
    /// that were lost: the gap is there.
    pub(crate) fn insert_gap(&mut self, exposure: i64, places: RangeInclusive<i64>, images: i64) {
        let Cadence { exposures, repeats } = &mut self.cadence;
        let near = places.start() - 1..=places.end() + 1;
        let stale = (0..exposures.len()).find(|&i| repeats[i] && near.contains(&exposures[i]));
        let at = stale.unwrap_or_else(|| exposures.partition_point(|other| *other < exposure));
        let Some(image) = self.recording.images.get(at) else { return };
        exposures[at..].iter_mut().for_each(|other| *other += images);
        let within = match stale {
            Some(_) => 0,
            None => (exposure - places.start()).max(places.end() - exposure),
        };
        self.losses.push(Loss { before_image: image.index, within, images });
    }
}
