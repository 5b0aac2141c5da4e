//! Whether a camera's clock is right.

use super::Kind;
use super::fault::Explanation;
use super::model::{Datum, trimmed_rms};
use super::trajectory::Trajectories;
use camera::Camera;
use nalgebra::Vector2;

/// How far images are out of step.
pub(super) struct Lateness {
    pub(super) frames: f64,
    /// Whether what moves tells the clock at all: a frame more or less would be clearly worse.
    pub(super) is_told: bool,
    /// RMS of all sightings with the clock set right, px.
    rms_px: f64,
    is_sure: bool,
}

impl Lateness {
    /// The same as an explanation.
    pub(super) fn explanation(self) -> Explanation {
        let Self { frames, rms_px, is_sure, .. } = self;
        let word = if frames > 0.0 { "late" } else { "early" };
        let what = format!("its images come {:.2} frames {word}", frames.abs());
        Explanation { rms_px, is_sure, kind: Kind::Late, number: frames, unit: "frames", what }
    }
}

/// How far images may be out of step, frames.
const MOST_LATE: f64 = 12.0;
/// First the clock is tried in steps of half a frame.
const CLOCK_STEP: f64 = 0.5;
/// Share of the points that must be known at the shifted time.
const LEAST_SHARE: f64 = 0.5;
/// The clock is told by the fastest of the sightings: their share, and the least number.
const FAST: f64 = 0.3;
const LEAST_FAST: usize = 20;
/// Motion below this tells nothing about time, px a frame.
const LEAST_SPEED_PX: f64 = 0.1;
/// A clock that moves the fastest sightings by less is not blamed, px: lenses are not known better.
const LEAST_SHIFT_PX: f64 = 0.1;
/// A clock that is off by less is not blamed, frames.
const LEAST_LATE: f64 = 0.3;
/// By how much of the noise's variance the sum of squares must fall: a chi-square that chance does not reach.
const CLEAR: f64 = 60.0;

/// By how many frames the images come late; none where nothing moves.
///
/// The residuals of the fastest sightings are compared about their mean, so that a pose that is slightly off is not taken for a
/// clock when all that moves moves one way.
pub(super) fn lateness(camera: &Camera, data: &[Datum], trajectories: &Trajectories) -> Option<Lateness> {
    let speed = |datum: &Datum| {
        let [before, after] =
            [-1.0, 1.0].map(|step| camera.project(&trajectories.at(datum.name, datum.frame as f64 + step)?));
        Some((after? - before?).norm() / 2.0)
    };
    let mut fast: Vec<(f64, &Datum)> = data.iter().filter_map(|datum| Some((speed(datum)?, datum))).collect();
    fast.sort_by(|a, b| b.0.total_cmp(&a.0));
    fast.truncate(((FAST * fast.len() as f64) as usize).max(LEAST_FAST));
    let typical = fast.get(fast.len() / 2)?.0;
    if fast.len() < LEAST_FAST || typical < LEAST_SPEED_PX {
        return None;
    }
    let fast: Vec<&Datum> = fast.into_iter().map(|(_, datum)| datum).collect();
    let error = |late: f64| shifted_rms(camera, &fast, trajectories, late, true);
    let count = (2.0 * MOST_LATE / CLOCK_STEP) as usize;
    let times = (0..=count).map(|k| k as f64 * CLOCK_STEP - MOST_LATE);
    let (mut frames, mut least) = times.map(|late| (late, error(late))).min_by(|a, b| a.1.total_cmp(&b.1))?;
    let mut step = CLOCK_STEP / 2.0;
    while step > 0.005 {
        for late in [frames - step, frames + step] {
            let next = error(late);
            if next < least {
                (frames, least) = (late, next);
            }
        }
        step /= 2.0;
    }
    let rise = |worse: f64| fast.len() as f64 * ((worse / least).powi(2) - 1.0);
    let gain = rise(error(0.0));
    let beside = [frames - 1.0, frames + 1.0].map(error);
    let is_told = beside.into_iter().all(|error| error.is_finite() && rise(error) > CLEAR);
    let all: Vec<&Datum> = data.iter().collect();
    let rms_px = shifted_rms(camera, &all, trajectories, frames, false);
    let is_sure = frames.abs() > LEAST_LATE && frames.abs() * typical > LEAST_SHIFT_PX && gain > CLEAR;
    least.is_finite().then_some(Lateness { frames, is_told, rms_px, is_sure })
}

/// RMS of the residuals with the points where they were `late` frames before; infinite where too few are known.
fn shifted_rms(
    camera: &Camera,
    data: &[&Datum],
    trajectories: &Trajectories,
    late: f64,
    about_mean: bool,
) -> f64 {
    let residuals: Vec<Vector2<f64>> = data
        .iter()
        .filter_map(|datum| {
            let point = trajectories.at(datum.name, datum.frame as f64 - late)?;
            Some(camera.project(&point)? - datum.pixel)
        })
        .collect();
    if (residuals.len() as f64) < LEAST_SHARE * data.len() as f64 {
        return f64::INFINITY;
    }
    let mean = match about_mean {
        true => residuals.iter().sum::<Vector2<f64>>() / residuals.len() as f64,
        false => Vector2::zeros(),
    };
    trimmed_rms(residuals.iter().map(|r| (r - mean).norm())).unwrap_or(f64::INFINITY)
}
