//! Images that were not taken at the frame's time: tracks are interpolated to it.

use crate::Error;
use artifact::{Sample2d, SyncFrame, SyncHeader, TrackState, Tracks2dFrame, Tracks2dHeader};
use nalgebra::{Point2, Vector2};
use std::collections::VecDeque;

/// Frames before and after that are looked at.
const REACH: usize = 2;
/// Delays below this change nothing that can be measured, frames.
const NEGLIGIBLE: f64 = 1e-6;
/// Without a sample on the other side, tracks are continued by this much at most, frames.
const LONGEST_EXTRAPOLATION: f64 = 0.5;

/// When each camera's image of a frame was taken.
struct Delay {
    offset: f64,
    drift: f64,
    phase: i64,
}

impl Delay {
    /// How much later than the frame, frames.
    fn at(&self, frame: i64) -> f64 {
        self.offset + self.drift * (frame - self.phase) as f64
    }
}

/// Brings tracks to the times of the frames; works on a sliding window.
pub(crate) struct Aligner {
    /// Per camera; empty without a time base.
    delays: Vec<Delay>,
    window: VecDeque<Tracks2dFrame>,
    /// Position in the window of the frame that is due next.
    next: usize,
    /// Samples left out because nothing near them tells where the marker was at the frame's time.
    pub(crate) left_out: usize,
}

impl Aligner {
    pub(crate) fn new(header: &Tracks2dHeader, sync: Option<&SyncHeader>) -> Result<Self, Error> {
        let delay = |id: &String, sync: &SyncHeader| match sync.cameras.get(id) {
            Some(camera) => {
                let drift = camera.drift_ppm * 1e-6;
                Ok(Delay { offset: camera.offset_frames, drift, phase: camera.phase })
            }
            None => Err(Error::UnsyncedCamera(id.clone())),
        };
        let delays = match sync {
            Some(sync) => header.cameras.iter().map(|id| delay(id, sync)).collect::<Result<_, _>>()?,
            None => Vec::new(),
        };
        Ok(Self { delays, window: VecDeque::new(), next: 0, left_out: 0 })
    }

    /// Takes a frame; returns the one that is now surrounded.
    pub(crate) fn push(&mut self, frame: Tracks2dFrame) -> Option<Tracks2dFrame> {
        if self.delays.is_empty() {
            return Some(frame);
        }
        self.window.push_back(frame);
        (self.window.len() > self.next + REACH).then(|| self.advance())
    }

    /// The frames at the end, after which none follow.
    pub(crate) fn finish(&mut self) -> Vec<Tracks2dFrame> {
        let mut rest = Vec::new();
        while self.next < self.window.len() {
            rest.push(self.advance());
        }
        rest
    }

    fn advance(&mut self) -> Tracks2dFrame {
        let frame = self.window[self.next].frame;
        let camera = |(camera, samples): (usize, &Option<Vec<Option<Sample2d>>>)| {
            let delay = self.delays[camera].at(frame);
            let samples = samples.as_ref()?;
            let align = |(marker, sample): (usize, &Option<Sample2d>)| {
                let sample = sample.as_ref()?;
                if delay.abs() < NEGLIGIBLE {
                    return Some(*sample);
                }
                Some(Sample2d { at: self.at_time(camera, marker)?, ..*sample })
            };
            Some(samples.iter().enumerate().map(align).collect::<Vec<_>>())
        };
        let cameras: Vec<_> = self.window[self.next].cameras.iter().enumerate().map(camera).collect();
        let count =
            |cameras: &[Option<Vec<Option<Sample2d>>>]| cameras.iter().flatten().flatten().flatten().count();
        self.left_out += count(&self.window[self.next].cameras) - count(&cameras);
        self.next += 1;
        while self.next > REACH {
            self.window.pop_front();
            self.next -= 1;
        }
        Tracks2dFrame { frame, cameras }
    }

    /// Where a marker was in a camera's image at the time of the frame that is due: Lagrange's polynomial through the
    /// nearest two samples before and after, or as many as there are; none where the time lies too far outside them.
    fn at_time(&self, camera: usize, marker: usize) -> Option<Point2<f64>> {
        let due = self.window[self.next].frame;
        let near = self.window.iter().filter(|frame| frame.frame.abs_diff(due) <= REACH as u64);
        let nodes = near.filter_map(|frame| {
            let sample = frame.cameras[camera].as_ref()?[marker].as_ref()?;
            let time = (frame.frame - due) as f64 + self.delays[camera].at(frame.frame);
            (sample.state != TrackState::Predicted).then_some((time, sample.at.coords))
        });
        let (before, after): (Vec<_>, Vec<_>) = nodes.partition(|(time, _)| *time <= 0.0);
        let after = &after[..after.len().min(2)];
        let before = &before[before.len().saturating_sub(2)..];
        let nodes: Vec<(f64, Vector2<f64>)> = before.iter().chain(after).copied().collect();
        let outside = nodes.iter().map(|(time, _)| time.abs()).fold(f64::INFINITY, f64::min);
        let is_inside = !before.is_empty() && !after.is_empty();
        if nodes.len() < 2 || (!is_inside && outside > LONGEST_EXTRAPOLATION) {
            return None;
        }
        Some(Point2::from(lagrange(if is_inside { &nodes } else { nearest_two(&nodes, before.is_empty()) })))
    }
}

/// To the future the first two samples lead, to the past the last two: a higher degree would swing.
fn nearest_two<T>(nodes: &[T], first: bool) -> &[T] {
    if first { &nodes[..2] } else { &nodes[nodes.len() - 2..] }
}

/// The value at time 0 of the polynomial through the nodes.
fn lagrange(nodes: &[(f64, Vector2<f64>)]) -> Vector2<f64> {
    let weight = |i: usize| -> f64 {
        let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, (time, _))| time / (time - nodes[i].0)).product()
    };
    nodes.iter().enumerate().map(|(i, (_, at))| at * weight(i)).sum()
}

/// Takes out what a camera's doubled images show: they only repeat the frame before.
pub(crate) fn drop_doubled(header: &Tracks2dHeader, frame: &mut Tracks2dFrame, sync: &SyncFrame) {
    for (id, samples) in header.cameras.iter().zip(&mut frame.cameras) {
        if sync.shows.get(id).copied().flatten().is_some_and(|shown| shown.doubled) {
            *samples = None;
        }
    }
}
