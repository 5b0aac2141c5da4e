//! Samples of a second pass that nothing but the first pass bears out.
//!
//! A 3D marker that was placed by a camera's own sample says of that camera what that sample said, right or wrong: a swap of the
//! first pass guides the second one to itself. What breaks the circle are the other cameras, and time.

use crate::doubt::take_back;
use crate::predict::MotionField;
use artifact::{Sample2d, TrackState, Tracks2dFrame};

/// So many images on end, through which a dot goes with its neighbours, bear themselves out. What is shorter is worth little: 0.2 s at
/// 50 images per second are filled from neighbours in 3D as well.
const LONG: usize = 10;

/// Takes samples back that nothing bears out, in place, and returns how many. `borne_out[frame][camera][marker]` says where the
/// guide rests on other cameras ([`bears_out`](crate::bears_out)); nothing is borne out in an empty list.
///
/// From image to image a dot goes within `gate_px` of where the local affine motion of its neighbours takes it, or it is another
/// one from there on. Of each such run, one borne out sample, or the labelled image (`labelled`, place of its frame), stands for all;
/// a run without is kept if it is long.
pub fn drop_untied(
    frames: &mut [Tracks2dFrame],
    borne_out: &[Vec<Vec<bool>>],
    labelled: usize,
    gate_px: f64,
) -> usize {
    let cameras = frames.first().map_or(0, |frame| frame.cameras.len());
    let mut dropped = 0;
    for camera in 0..cameras {
        let images: Vec<usize> = (0..frames.len()).filter(|&i| frames[i].cameras[camera].is_some()).collect();
        let ties: Vec<Vec<bool>> =
            images.windows(2).map(|pair| ties(frames, camera, [pair[0], pair[1]], gate_px)).collect();
        let is_sure = |index: usize, marker: usize| {
            let said = borne_out.get(index).and_then(|frame| frame.get(camera)?.get(marker));
            index == labelled || said.is_some_and(|said| *said)
        };
        for marker in 0..images.first().map_or(0, |&index| samples(frames, camera, index).len()) {
            let is_seen = |at: usize| seen(frames, camera, images[at], marker).is_some();
            let seen: Vec<usize> = (0..images.len()).filter(|at| is_seen(*at)).collect();
            let untied: Vec<usize> = seen
                .chunk_by(|&a, &b| b == a + 1 && ties[a][marker])
                .filter(|run| run.len() < LONG.min(images.len()))
                .filter(|run| !run.iter().any(|&at| is_sure(images[at], marker)))
                .flatten()
                .map(|&at| images[at])
                .collect();
            dropped += untied.len();
            untied.into_iter().for_each(|index| take_back(&mut frames[index], camera, marker));
        }
    }
    dropped
}

/// Per marker whether it is seen in both of two images, and went with its neighbours.
fn ties(frames: &[Tracks2dFrame], camera: usize, pair: [usize; 2], gate_px: f64) -> Vec<bool> {
    let markers = samples(frames, camera, pair[0]).len();
    let both = |marker: usize| {
        let [from, to] = pair.map(|index| seen(frames, camera, index, marker));
        Some((from?, to?))
    };
    let steps: Vec<Option<([f64; 2], [f64; 2])>> = (0..markers).map(both).collect();
    let motion = |(from, to): &([f64; 2], [f64; 2])| [0, 1].map(|axis| to[axis] - from[axis]);
    let places = steps.iter().flatten().map(|(from, _)| *from).collect();
    let field = MotionField::new(places, steps.iter().flatten().map(motion).collect());
    let is_tied = |step: &([f64; 2], [f64; 2])| {
        let (own, by) = (motion(step), field.at(step.0).unwrap_or_default());
        (own[0] - by[0]).hypot(own[1] - by[1]) <= gate_px
    };
    steps.iter().map(|step| step.as_ref().is_some_and(is_tied)).collect()
}

fn samples(frames: &[Tracks2dFrame], camera: usize, index: usize) -> &[Option<Sample2d>] {
    frames[index].cameras[camera].as_deref().unwrap_or_default()
}

fn seen(frames: &[Tracks2dFrame], camera: usize, index: usize, marker: usize) -> Option<[f64; 2]> {
    let sample = samples(frames, camera, index).get(marker).copied().flatten()?;
    (sample.state != TrackState::Predicted).then(|| sample.at.into())
}
