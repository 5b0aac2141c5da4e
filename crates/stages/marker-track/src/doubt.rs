//! Samples that are taken back: they are another marker's dots.

use crate::naming::{AGREEING, AROUND, Model, Models, WORST_PX, apart, middle, places};
use artifact::{Sample2d, TrackState, Tracks2dFrame};
use nalgebra::Point2;

/// A sample farther than this from where all pairs of other cameras place its marker is another one's, px,
const MISFIT_PX: f64 = 3.0 * WORST_PX;
/// … if there are so many pairs: of three cameras nobody knows which one errs.
const PAIRS: usize = 3;
/// What was taken back is less sure than what is seen.
const UNSURE: f64 = 0.25;

/// Takes samples back that no pair of other cameras agrees with, in place, and returns how many: dots of other markers. Each
/// becomes a prediction where the others place it.
pub fn drop_misfits(frames: &mut [Tracks2dFrame]) -> usize {
    let cameras = frames.first().map_or(0, |frame| frame.cameras.len());
    let mut models = Models::new();
    for third in 0..cameras {
        for first in (0..cameras).filter(|first| *first != third) {
            for second in (first + 1..cameras).filter(|second| *second != third) {
                let triple = [first, second, third];
                models.insert(triple, Model::learn(frames, triple));
            }
        }
    }
    let mut dropped = 0;
    for frame in frames {
        for (camera, marker, at) in misfits(frame, cameras, &models) {
            if let Some(samples) = frame.cameras[camera].as_mut() {
                let at = Point2::from(at);
                samples[marker] = Some(Sample2d { at, state: TrackState::Predicted, confidence: UNSURE });
                dropped += 1;
            }
        }
    }
    dropped
}

/// Camera and marker of each misfit of a frame, and where the other cameras place it.
fn misfits(frame: &Tracks2dFrame, cameras: usize, models: &Models) -> Vec<(usize, usize, [f64; 2])> {
    let mut found = Vec::new();
    for camera in 0..cameras {
        for (marker, sample) in frame.cameras[camera].iter().flatten().enumerate() {
            let Some(sample) = sample.filter(|sample| sample.state != TrackState::Predicted) else {
                continue;
            };
            let places = places(frame, camera, marker, cameras, models);
            let is_off = |place: &[f64; 2]| apart(sample.at.into(), *place) > MISFIT_PX;
            if places.len() >= PAIRS && places.iter().all(is_off) {
                found.push((camera, marker, middle(&places)));
            }
        }
    }
    found
}

/// Takes samples back of a second pass whose marker is seen in too few of the images around, in place, and returns how many: dots of
/// other markers, which pass where it is hidden.
pub fn drop_passing(frames: &mut [Tracks2dFrame]) -> usize {
    let cameras = frames.first().map_or(0, |frame| frame.cameras.len());
    (0..cameras).map(|camera| drop_passing_in(frames, camera)).sum()
}

fn drop_passing_in(frames: &mut [Tracks2dFrame], camera: usize) -> usize {
    let mut images: Vec<&mut Vec<Option<Sample2d>>> =
        frames.iter_mut().filter_map(|frame| frame.cameras[camera].as_mut()).collect();
    let enough = AGREEING.min(images.len());
    let mut dropped = 0;
    for marker in 0..images.first().map_or(0, |samples| samples.len()) {
        let is_seen = |sample: &Option<Sample2d>| sample.is_some_and(|s| s.state != TrackState::Predicted);
        let seen: Vec<bool> = images.iter().map(|samples| is_seen(&samples[marker])).collect();
        for (at, samples) in images.iter_mut().enumerate().filter(|(at, _)| seen[*at]) {
            let around = &seen[at.saturating_sub(AROUND)..(at + AROUND + 1).min(seen.len())];
            let is_passing = around.iter().filter(|seen| **seen).count() < enough;
            if let Some(sample) = samples[marker].as_mut().filter(|_| is_passing) {
                doubt(sample);
                dropped += 1;
            }
        }
    }
    dropped
}

/// Makes a sample a prediction where it is.
pub(crate) fn take_back(frame: &mut Tracks2dFrame, camera: usize, marker: usize) {
    let sample = frame.cameras[camera].as_mut().and_then(|samples| samples[marker].as_mut());
    sample.into_iter().for_each(doubt);
}

fn doubt(sample: &mut Sample2d) {
    (sample.state, sample.confidence) = (TrackState::Predicted, UNSURE);
}
