//! Images that were not taken at the frame's time: tracks are interpolated to it.

use crate::Error;
use artifact::{Sample2d, SyncCamera, SyncFrame, SyncHeader, TrackState, Tracks2dFrame, Tracks2dHeader};
use nalgebra::Point2;
use std::collections::VecDeque;

/// Frames before and after that are looked at.
const REACH: usize = 2;
/// Lags below this change nothing that can be measured, frames.
const NEGLIGIBLE: f64 = 1e-6;

/// Brings tracks to the times of the frames; works on a sliding window.
pub(crate) struct Aligner {
    /// How each camera's clock stands; empty without a time base.
    clocks: Vec<SyncCamera>,
    window: VecDeque<Tracks2dFrame>,
    /// Position in the window of the frame that is due next.
    next: usize,
    /// Samples left out because nothing near them tells where the marker was at the frame's time.
    pub(crate) left_out: usize,
}

impl Aligner {
    pub(crate) fn new(header: &Tracks2dHeader, sync: Option<&SyncHeader>) -> Result<Self, Error> {
        let clock = |id: &String, sync: &SyncHeader| match sync.cameras.get(id) {
            Some(camera) => Ok(camera.clone()),
            None => Err(Error::UnsyncedCamera(id.clone())),
        };
        let clocks = match sync {
            Some(sync) => header.cameras.iter().map(|id| clock(id, sync)).collect::<Result<_, _>>()?,
            None => Vec::new(),
        };
        Ok(Self { clocks, window: VecDeque::new(), next: 0, left_out: 0 })
    }

    /// Takes a frame; returns the one that is now surrounded.
    pub(crate) fn push(&mut self, frame: Tracks2dFrame) -> Option<Tracks2dFrame> {
        if self.clocks.is_empty() {
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
            let lag = self.clocks[camera].lag_frames(frame);
            let samples = samples.as_ref()?;
            let align = |(marker, sample): (usize, &Option<Sample2d>)| {
                let sample = sample.as_ref()?;
                if lag.abs() < NEGLIGIBLE {
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

    /// Where a marker was in a camera's image at the time of the frame that is due.
    fn at_time(&self, camera: usize, marker: usize) -> Option<Point2<f64>> {
        let due = self.window[self.next].frame;
        let near = self.window.iter().filter(|frame| frame.frame.abs_diff(due) <= REACH as u64);
        let samples = near.filter_map(|frame| {
            let sample = frame.cameras[camera].as_ref()?[marker].as_ref()?;
            let time = (frame.frame - due) as f64 + self.clocks[camera].lag_frames(frame.frame);
            (sample.state != TrackState::Predicted).then_some((time, sample.at.coords))
        });
        camera::place_at_zero(&samples.collect::<Vec<_>>()).map(Point2::from)
    }
}

/// Takes out what a camera's doubled images show: they only repeat the frame before.
pub(crate) fn drop_doubled(header: &Tracks2dHeader, frame: &mut Tracks2dFrame, sync: &SyncFrame) {
    for (id, samples) in header.cameras.iter().zip(&mut frame.cameras) {
        if sync.shows.get(id).copied().flatten().is_some_and(|shown| shown.doubled) {
            *samples = None;
        }
    }
}
