//! Time stamps by a common clock.

use crate::line::{Line, median};
use crate::timeline::{Paced, Timeline, stated_step};
use crate::{Error, Params, Recording};
use artifact::{Rate, SyncSource};

/// A camera whose stamps come at another rate than the take says, by more than this share, is not the one that it describes.
const RATE_TOLERANCE: f64 = 0.05;
/// Stamps are not better than this, s: they are written with microseconds.
const FINEST_S: f64 = 1e-6;

/// The step between a camera's stamps, s: the usual one of those that rise, which losses make longer, or the mean of all
/// where that is shorter than half of it, as of stamps that stand still. None of fewer than three stamps.
pub(crate) fn typical_step_s(recording: &Recording) -> Option<f64> {
    let times: Vec<f64> = recording.images.iter().filter_map(|image| image.time_s).collect();
    let (first, last) = (times.first()?, times.last()?);
    let rising: Vec<f64> =
        times.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    let mean = (last - first) / (times.len() - 1) as f64;
    let usual = median(&rising);
    // Stamps that come in bursts have a short usual step, and a mean that is right.
    let step = if mean < 0.5 * usual { mean } else { usual.max(mean.min(1.0 / recording.rate.hz())) };
    (times.len() > 2).then_some(step)
}

/// Refuses cameras of which one ends before another begins: their stamps are not of one clock.
fn check_common_time(cameras: &[Paced]) -> Result<(), Error> {
    let span = |camera: &Paced| {
        let images = &camera.recording.images;
        Some((images.first()?.time_s?, images.last()?.time_s? + 1.0 / camera.recording.rate.hz()))
    };
    let spans: Vec<(&Paced, (f64, f64))> =
        cameras.iter().filter_map(|camera| Some((camera, span(camera)?))).collect();
    let late = spans.iter().max_by(|a, b| a.1.0.total_cmp(&b.1.0));
    let early = spans.iter().min_by(|a, b| a.1.1.total_cmp(&b.1.1));
    match (early, late) {
        (Some((early, (_, end_s))), Some((late, (begin_s, _)))) if end_s < begin_s => {
            let [early, late] = [early, late].map(|camera| camera.id().to_string());
            Err(Error::NoCommonTime { early, end_s: *end_s, late, begin_s: *begin_s })
        }
        _ => Ok(()),
    }
}

/// When the cameras' exposures were: a robust line through each camera's stamps over its exposures.
///
/// The take's first frame is at 0 s where a camera has a stamp within half a frame of it, else at the first stamp of all;
/// that zero is returned beside the lines.
pub(crate) fn timelines(
    cameras: &[Paced],
    take_rate: Rate,
    params: &Params,
) -> Result<(Vec<Timeline>, f64), Error> {
    let stamps = |camera: &Paced| -> Vec<f64> {
        camera.recording.images.iter().filter_map(|image| image.time_s).collect()
    };
    if let Some(camera) = cameras.iter().find(|camera| !camera.recording.is_stamped()) {
        return Err(Error::NoStamps(camera.id().to_string()));
    }
    check_common_time(cameras)?;
    let zero = zero_s(&cameras.iter().map(stamps).collect::<Vec<_>>(), take_rate);
    let timeline = |camera: &Paced| {
        let nominal = stated_step(camera.recording, take_rate) / take_rate.hz();
        let exposures = camera.cadence.exposures.iter().map(|exposure| *exposure as f64);
        let points: Vec<(f64, f64)> = exposures.zip(stamps(camera)).collect();
        line(&points, nominal, params).map_or_else(
            // A single image says when its camera began; its rate is the stated one.
            || {
                Ok(Timeline {
                    start: points.first().map_or(0.0, |(_, time)| (time - zero) * take_rate.hz()),
                    source: SyncSource::Timestamps,
                    ..Timeline::stated(camera.recording, take_rate)
                })
            },
            |(line, sigma_s)| {
                if (line.slope / nominal - 1.0).abs() > RATE_TOLERANCE {
                    let (camera, stated) = (camera.id().to_string(), camera.recording.rate);
                    return Err(Error::Rate { camera, found_hz: 1.0 / line.slope, stated });
                }
                Ok(Timeline {
                    start: (line.at_zero - zero) * take_rate.hz(),
                    step: line.slope * take_rate.hz(),
                    source: SyncSource::Timestamps,
                    sigma_frames: Some(sigma_s * take_rate.hz()),
                })
            },
        )
    };
    Ok((cameras.iter().map(timeline).collect::<Result<_, _>>()?, zero))
}

fn zero_s(stamps: &[Vec<f64>], take_rate: Rate) -> f64 {
    let is_near = |time: &f64| time.abs() * take_rate.hz() <= 0.5;
    match stamps.iter().flatten().any(is_near) {
        true => 0.0,
        false => stamps.iter().filter_map(|times| times.first().copied()).reduce(f64::min).unwrap_or(0.0),
    }
}

/// The line, and the spread of the stamps about it, s.
fn line(points: &[(f64, f64)], nominal: f64, params: &Params) -> Option<(Line, f64)> {
    let plain = Line::fit(points, &vec![1.0; points.len()], None)?;
    let residuals: Vec<f64> = points.iter().map(|(x, y)| (y - plain.at(*x)).abs()).collect();
    let sigma = (1.4826 * median(&residuals)).max(FINEST_S);
    // The prior is about the clock's drift, not about a rate that was stated roughly: it centers on the latter only where
    // the stamps agree with it.
    let drift = params.drift_prior_ppm * 1e-6 * nominal;
    let is_near = (plain.slope - nominal).abs() < 10.0 * drift;
    let prior = is_near.then_some((nominal, drift));
    Some((Line::fit(points, &vec![sigma.powi(-2); points.len()], prior)?, sigma))
}
