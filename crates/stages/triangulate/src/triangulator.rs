//! The whole stage: frames of tracks in, frames of markers out, a window of frames in memory.

use crate::exchange::ExchangeWatch;
use crate::fill::{Filler, Place, Placed};
use crate::paper::Rest;
use crate::point::Scale;
use crate::report::Tally;
use crate::skew::{Aligner, drop_doubled};
use crate::solve::{Found, Rig, Solved};
use crate::strain::StrainWatch;
use crate::{Error, Filter, Params, Report, Timeline, filter, noise};
use artifact::{
    Accuracy, CameraRig, MarkerFrame, MarkerHeader, MeasuredFrame, SampleStatus, SyncFrame, SyncHeader,
    Tracks2dFrame, Tracks2dHeader, Unit,
};
use rayon::prelude::*;
use std::collections::VecDeque;

/// Frames that are worked on at once.
const BATCH: usize = 32;

/// Triangulates a take frame by frame. Feed it all frames with [`Triangulator::push`], then [`Triangulator::finish`].
pub struct Triangulator {
    rig: Rig,
    tracks: Tracks2dHeader,
    header: MarkerHeader,
    params: Params,
    /// Standard deviation of the filter's weight over time, frames.
    sigma: f64,
    aligner: Aligner,
    /// Aligned frames that wait for a batch to be full.
    waiting: Vec<Tracks2dFrame>,
    scale: Option<Scale>,
    window: VecDeque<Solved>,
    /// Position in the window of the frame that is filtered next.
    next: usize,
    rest: Rest,
    strain: StrainWatch,
    exchange: ExchangeWatch,
    filler: Filler,
    tally: Tally,
}

/// What a whole take came to.
pub struct Outcome {
    /// The last frames.
    pub frames: Vec<MeasuredFrame>,
    /// What is said of the take.
    pub report: Report,
    /// Errors and coverage over time.
    pub timeline: Timeline,
}

impl Triangulator {
    /// Prepares for tracks with this header. With a time base, tracks are interpolated to the frames' times.
    ///
    /// # Errors
    /// [`Error`] if the rig or the time base lacks a camera of the tracks, there are fewer than two, no frame rate is known
    /// though times in ms are asked for, or a parameter makes no sense.
    pub fn new(
        rig: &CameraRig,
        tracks: &Tracks2dHeader,
        sync: Option<&SyncHeader>,
        params: &Params,
    ) -> Result<Self, Error> {
        params.check()?;
        let rate = tracks.rate.or(sync.map(|sync| sync.rate));
        let hz = match rate {
            Some(rate) => rate.hz(),
            None if params.needs_rate() => return Err(Error::NoRate),
            None => 0.0,
        };
        let markers = tracks.markers.clone();
        let count = markers.len();
        let take = tracks.take.clone();
        Ok(Self {
            rig: Rig::new(rig, tracks)?,
            header: MarkerHeader { unit: Unit::Mm, rate, markers, take },
            tracks: tracks.clone(),
            params: params.clone(),
            sigma: params.smooth_ms * 1e-3 * hz,
            aligner: Aligner::new(tracks, sync)?,
            waiting: Vec::new(),
            scale: None,
            window: VecDeque::new(),
            next: 0,
            rest: Rest::new(count),
            strain: StrainWatch::new(count),
            exchange: ExchangeWatch::default(),
            filler: Filler::new(count, (params.fill_ms * 1e-3 * hz + 1e-9).floor() as i64),
            tally: Tally::new(tracks.cameras.len(), count),
        })
    }

    /// The header of what comes out.
    #[must_use]
    pub fn header(&self) -> &MarkerHeader {
        &self.header
    }

    /// Takes the next frame, and what its time base says of it; returns the frames that are finished, if any.
    ///
    /// # Errors
    /// [`Error::OutsideImage`].
    pub fn push(
        &mut self,
        mut frame: Tracks2dFrame,
        sync: Option<&SyncFrame>,
    ) -> Result<Vec<MeasuredFrame>, Error> {
        self.rig.check(&self.tracks, &frame)?;
        if let Some(sync) = sync {
            drop_doubled(&self.tracks, &mut frame, sync);
        }
        self.waiting.extend(self.aligner.push(frame));
        let enough = if self.scale.is_some() { BATCH } else { noise::FRAMES };
        Ok(if self.waiting.len() < enough { Vec::new() } else { self.work(false) })
    }

    /// The rest, after the last frame.
    ///
    /// # Errors
    /// [`Error`] if there were no frames, or no marker could be triangulated.
    pub fn finish(mut self) -> Result<Outcome, Error> {
        self.waiting.extend(self.aligner.finish());
        let frames = self.work(true);
        let mut report = self.tally.report(&self.tracks.cameras, &self.tracks.markers);
        match (report.frames, self.tally.seen_twice(), self.tally.measured()) {
            (0, ..) => return Err(Error::NoFrames),
            (_, 0, _) => return Err(Error::NothingSeenTwice),
            (_, seen, 0) => return Err(Error::NothingAgrees(seen)),
            _ => {}
        }
        if let Some(share) = report.contradiction() {
            let name =
                |(camera, size, reach): (usize, _, _)| (self.tracks.cameras[camera].clone(), size, reach);
            let beyond = self.rig.beyond().map(name);
            return Err(Error::Contradiction { percent: 100.0 * share, beyond });
        }
        let scale = self.scale.unwrap_or(Scale { noise: 0.0, spread: 0.0, outlier: 0.0 });
        (report.noise_px, report.outlier_px) = (scale.noise, scale.outlier);
        report.unaligned_views = self.aligner.left_out;
        report.swaps = self.strain.finish(&self.header.markers);
        report.swaps.extend(self.exchange.finish(&self.tracks.cameras, &self.header.markers));
        Ok(Outcome { frames, report, timeline: self.tally.timeline })
    }

    /// Works off what waits; `all`: nothing follows.
    fn work(&mut self, all: bool) -> Vec<MeasuredFrame> {
        let waiting = std::mem::take(&mut self.waiting);
        let count = self.tracks.markers.len();
        let scale =
            *self.scale.get_or_insert_with(|| noise::measure(&self.rig, &waiting, count, &self.params));
        let solved: Vec<Solved> =
            waiting.par_iter().map(|frame| self.rig.solve(frame, count, scale)).collect();
        for frame in solved {
            self.tally.see_solved(&frame);
            self.strain.see(&frame);
            self.exchange.see(&frame, &self.rig, scale);
            self.rest.see(&frame);
            self.window.push_back(frame);
        }
        let mut placed = Vec::new();
        for frame in self.filtered(all) {
            placed.extend(self.filler.push(frame));
        }
        if all {
            placed.extend(self.filler.finish());
        }
        placed.iter().for_each(|frame| self.tally.see_placed(frame));
        placed.into_par_iter().map(|frame| self.measured(frame)).collect()
    }

    /// Frames before and after that the filter looks at.
    fn reach(&self) -> usize {
        match self.params.filter {
            Filter::Off => 0,
            _ => (filter::REACH * self.sigma).ceil() as usize,
        }
    }

    /// Filters the frames of the window that are surrounded, and forgets what lies too far back.
    fn filtered(&mut self, all: bool) -> Vec<Placed> {
        let reach = self.reach();
        let window: Vec<&Solved> = self.window.iter().collect();
        let end = if all { window.len() } else { window.len().saturating_sub(reach) };
        let frame = |at: usize| {
            let around = &window[at.saturating_sub(reach)..(at + reach + 1).min(window.len())];
            self.place(around, at.min(reach))
        };
        let placed: Vec<Placed> = (self.next.min(end)..end).into_par_iter().map(frame).collect();
        self.next = self.next.max(end);
        while self.next > reach {
            self.window.pop_front();
            self.next -= 1;
        }
        placed
    }

    fn place(&self, around: &[&Solved], center: usize) -> Placed {
        let solved = around[center];
        let count = solved.found.len();
        let position = |marker: usize| match self.params.filter {
            _ if self.sigma == 0.0 => None,
            Filter::Off => None,
            Filter::Affine => filter::smooth(around, center, marker, self.sigma),
            Filter::Paper => self.rest.smooth(around, center, marker, self.sigma),
        };
        let place = |marker: usize| {
            let fix = solved.fix(marker)?;
            Some(Place {
                position: position(marker).unwrap_or(fix.position),
                status: SampleStatus::Measured,
                covariance: Some(fix.covariance * fix.doubt),
                cameras: fix.used.iter().map(|(camera, _)| *camera).collect(),
            })
        };
        let ray = |found: &Found| match found {
            Found::Ray(ray) => Some(*ray),
            _ => None,
        };
        Placed {
            frame: solved.frame,
            places: (0..count).map(place).collect(),
            rays: solved.found.iter().map(ray).collect(),
        }
    }

    fn measured(&self, frame: Placed) -> MeasuredFrame {
        let accuracy = |place: &Place| {
            let c = place.covariance?;
            let covariance_mm2 = [c.m11, c.m12, c.m13, c.m22, c.m23, c.m33].map(four_digits);
            let views = place.cameras.iter().map(|&camera| self.tracks.cameras[camera].clone()).collect();
            Some(Accuracy { covariance_mm2, views })
        };
        let accuracy = frame.places.iter().map(|place| place.as_ref().and_then(accuracy)).collect();
        let status =
            frame.places.iter().map(|place| place.as_ref().map_or(SampleStatus::Measured, |p| p.status));
        let status = status.collect();
        let points = frame.places.iter().map(|place| place.as_ref().map(|place| place.position)).collect();
        MeasuredFrame { markers: MarkerFrame { frame: frame.frame, points, status }, accuracy }
    }
}

/// Covariances are estimates: four significant digits say all that is known, and keep files small.
fn four_digits(value: f64) -> f64 {
    let places = 3 - value.abs().log10().floor() as i32;
    // A power of ten up to this is exact, and so is the quotient as a decimal number.
    if !(0..=22).contains(&places) {
        return format!("{value:.3e}").parse().unwrap_or(value);
    }
    let power = 10f64.powi(places);
    (value * power).round() / power
}

/// Triangulates a whole take in memory; see [`Triangulator`].
///
/// # Errors
/// As [`Triangulator::new`], [`Triangulator::push`] and [`Triangulator::finish`].
pub fn triangulate(
    rig: &CameraRig,
    tracks: &Tracks2dHeader,
    frames: impl IntoIterator<Item = Tracks2dFrame>,
    sync: Option<&SyncHeader>,
    params: &Params,
) -> Result<(MarkerHeader, Outcome), Error> {
    let mut work = Triangulator::new(rig, tracks, sync, params)?;
    let header = work.header().clone();
    let mut done = Vec::new();
    for frame in frames {
        done.extend(work.push(frame, None)?);
    }
    let mut outcome = work.finish()?;
    done.append(&mut outcome.frames);
    outcome.frames = done;
    Ok((header, outcome))
}
