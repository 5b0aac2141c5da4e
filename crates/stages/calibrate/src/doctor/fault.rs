//! Which single fault explains what a camera sees.

use super::model::{self, ALL, Datum, FOCAL, POSE, TURN, direct_pose, fit, rms, trimmed_rms};
use super::trajectory::Trajectories;
use super::{Finding, Kind, Params, Patient};
use camera::Camera;
use nalgebra::{Vector2, Vector3};

/// What a camera's sightings say about it.
#[derive(Debug, Clone)]
pub(super) struct Verdict {
    /// RMS as it stands, px.
    pub(super) rms_px: f64,
    /// The least RMS that any explanation leaves, px.
    pub(super) left_px: f64,
    /// Frames.
    pub(super) late: Option<f64>,
    pub(super) finding: Option<Finding>,
}

/// An explanation: how little it leaves, and what it would be.
struct Explanation {
    rms_px: f64,
    /// Whether it is certain although it explains little.
    is_sure: bool,
    kind: Kind,
    number: f64,
    unit: &'static str,
    what: String,
}

/// An explanation is taken if none leaves less than this share of what it leaves.
const AS_GOOD: f64 = 1.0 / 1.3;
/// What is left may be as many times the other cameras' noise.
const NOISE: f64 = 4.0;
/// What no camera is blamed for, px.
const NOISE_FLOOR_PX: f64 = 0.1;

/// Judges a camera by points that others placed. `noise_px`: how far off cameras are that have no fault.
pub(super) fn judge(
    patient: &Patient,
    data: &[Datum],
    trajectories: &Trajectories,
    noise_px: f64,
    params: &Params,
) -> Verdict {
    let camera = &patient.camera;
    let rms_px = rms(camera, data);
    let lateness = lateness(camera, data, trajectories);
    let late = lateness.as_ref().map(|late| late.frames);
    let mut verdict = Verdict { rms_px, left_px: rms_px, late, finding: None };
    let mut explanations: Vec<Explanation> = Vec::new();
    explanations.extend(lateness.map(Lateness::explanation));
    explanations.extend(zoomed(camera, data));
    explanations.extend(mirrored(camera, data));
    explanations.extend(turned(camera, data));
    explanations.extend(moved(camera, data));
    let best = explanations.iter().map(|one| one.rms_px).fold(rms_px, f64::min);
    verdict.left_px = best;
    let noise = NOISE * noise_px.max(NOISE_FLOOR_PX);
    let explained = |left: f64| (rms_px * rms_px - left * left).max(0.0).sqrt() > params.tolerance_px;
    let is_good = |one: &&Explanation| AS_GOOD * one.rms_px <= best && (one.is_sure || explained(one.rms_px));
    verdict.finding = match explanations.iter().find(is_good) {
        Some(one) if best <= noise => {
            Some(Finding::of(patient, one.kind, one.number, one.unit, one.what.clone()))
        }
        _ if rms_px > noise + params.tolerance_px => {
            let what = format!(
                "its images are {rms_px:.2} px off where the others see the points; the best single explanation leaves \
                 {best:.2} px"
            );
            Some(Finding::of(patient, Kind::Unexplained, rms_px, "px", what))
        }
        _ => hidden_focal(patient, data, params),
    };
    verdict
}

/// How far images are out of step.
struct Lateness {
    frames: f64,
    /// RMS of all sightings with the clock set right, px.
    rms_px: f64,
    is_sure: bool,
}

impl Lateness {
    fn explanation(self) -> Explanation {
        let Self { frames, rms_px, is_sure } = self;
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
const LEAST_SPEED_PX: f64 = 0.3;
/// A clock that is off by less is not blamed, frames.
const LEAST_LATE: f64 = 0.3;
/// By how much of the noise's variance the sum of squares must fall: a chi-square that chance does not reach.
const CLEAR: f64 = 60.0;

/// By how many frames the images come late; none where nothing moves.
///
/// The residuals of the fastest sightings are compared about their mean, so that a pose that is slightly off is not taken for a
/// clock when all that moves moves one way.
fn lateness(camera: &Camera, data: &[Datum], trajectories: &Trajectories) -> Option<Lateness> {
    let speed = |datum: &Datum| {
        let [before, after] =
            [-1.0, 1.0].map(|step| camera.project(&trajectories.at(datum.name, datum.frame as f64 + step)?));
        Some((after? - before?).norm() / 2.0)
    };
    let mut fast: Vec<(f64, &Datum)> = data.iter().filter_map(|datum| Some((speed(datum)?, datum))).collect();
    fast.sort_by(|a, b| b.0.total_cmp(&a.0));
    fast.truncate(((FAST * fast.len() as f64) as usize).max(LEAST_FAST));
    if fast.len() < LEAST_FAST || fast[fast.len() / 2].0 < LEAST_SPEED_PX {
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
    let gain = fast.len() as f64 * ((error(0.0) / least).powi(2) - 1.0);
    let all: Vec<&Datum> = data.iter().collect();
    let rms_px = shifted_rms(camera, &all, trajectories, frames, false);
    let is_sure = frames.abs() > LEAST_LATE && gain > CLEAR;
    least.is_finite().then_some(Lateness { frames, rms_px, is_sure })
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

fn share(fitted: &Camera, camera: &Camera) -> f64 {
    camera.lens.focal_px.x / fitted.lens.focal_px.x - 1.0
}

fn zoomed(camera: &Camera, data: &[Datum]) -> Option<Explanation> {
    let found = fit(camera, data, FOCAL)?;
    let off = share(&found.camera, camera);
    let what = format!("its focal length is {:+.2} % off what its images show", 100.0 * off);
    Some(Explanation {
        rms_px: found.rms_px,
        is_sure: false,
        kind: Kind::Zoomed,
        number: off,
        unit: "share",
        what,
    })
}

fn mirrored(camera: &Camera, data: &[Datum]) -> Vec<Explanation> {
    let [width, height] = camera.image_size.map(|side| f64::from(side) - 1.0);
    let ways: [(&str, [bool; 2]); 3] = [
        ("its images are mirrored left to right", [true, false]),
        ("its images are mirrored top to bottom", [false, true]),
        ("its images stand on their head", [true, true]),
    ];
    let explain = |(what, [across, down]): (&str, [bool; 2])| {
        let back = |datum: &Datum<'_>| {
            let [x, y] = datum.pixel.into();
            Vector2::new(if across { width - x } else { x }, if down { height - y } else { y })
        };
        let lengths = data
            .iter()
            .map(|datum| camera.project(&datum.point).map_or(1e4, |pixel| (pixel - back(datum)).norm()));
        Some(Explanation {
            rms_px: trimmed_rms(lengths)?,
            is_sure: false,
            kind: Kind::Mirrored,
            number: 1.0,
            unit: "",
            what: what.to_string(),
        })
    };
    ways.into_iter().filter_map(explain).collect()
}

/// Between the pose that fits and the one that is stated: the turn.
fn turn(fitted: &Camera, camera: &Camera) -> Vector3<f64> {
    (camera.cam_from_world.rotation * fitted.cam_from_world.rotation.inverse()).scaled_axis()
}

fn turned(camera: &Camera, data: &[Datum]) -> Option<Explanation> {
    let found = fit(camera, data, TURN)?;
    let angle = turn(&found.camera, camera).norm().to_degrees();
    let what = format!("it is turned by {angle:.2}° against its images");
    Some(Explanation {
        rms_px: found.rms_px,
        is_sure: false,
        kind: Kind::Turned,
        number: angle,
        unit: "deg",
        what,
    })
}

/// The pose alone, then pose and focal length, each from the stated pose and from scratch.
fn moved(camera: &Camera, data: &[Datum]) -> Vec<Explanation> {
    let starts = [Some(camera.clone()), direct_pose(camera, data)];
    let best = |free: &[usize]| {
        let fits = starts.iter().flatten().filter_map(|start| fit(start, data, free));
        fits.min_by(|a, b| a.rms_px.total_cmp(&b.rms_px))
    };
    let mut found = Vec::new();
    if let Some(fit) = best(POSE) {
        found.push(posed(camera, &fit, data));
    }
    if let Some(fit) = best(ALL) {
        let mut explanation = posed(camera, &fit, data);
        let off = 100.0 * share(&fit.camera, camera);
        explanation.what += &format!(", and its focal length is {off:+.2} % off");
        found.push(explanation);
    }
    found
}

/// A flat board's other pose turns the scene by at least this, rad.
const LEAST_FLIP: f64 = 0.05;
/// ... about an axis across the line of sight, and leaves the middle of the scene where it is, as shares.
const FLIP_ALONG: f64 = 0.35;
const FLIP_SHIFT: f64 = 0.05;

/// What a wrong pose is called. A flat board seen from afar has two poses that fit, which are mirrored about the line of sight; the
/// wrong one turns the scene about an axis across that line, and leaves its middle where it is.
fn posed(camera: &Camera, found: &model::Fit, data: &[Datum]) -> Explanation {
    let turn = turn(&found.camera, camera);
    let mean = data.iter().map(|datum| datum.point.coords).sum::<Vector3<f64>>() / data.len() as f64;
    let [stated, right] =
        [camera, &found.camera].map(|camera| (camera.cam_from_world * nalgebra::Point3::from(mean)).coords);
    let degrees = turn.norm().to_degrees();
    let along = turn.normalize().dot(&right.normalize()).abs();
    let is_flip =
        turn.norm() > LEAST_FLIP && along < FLIP_ALONG && (stated - right).norm() < FLIP_SHIFT * right.norm();
    let away = (camera.eye_in_world() - found.camera.eye_in_world()).norm();
    let (kind, number, unit, what) = match is_flip {
        true => (
            Kind::Flipped,
            degrees,
            "deg",
            format!(
                "its pose is tipped over by {degrees:.1}° about the scene's middle, as a flat board's other pose is"
            ),
        ),
        false => (Kind::Moved, away, "mm", format!("it stands {away:.1} mm off, turned by {degrees:.2}°")),
    };
    Explanation { rms_px: found.rms_px, is_sure: false, kind, number, unit, what }
}

/// Standard deviations that a hidden focal length must be off.
const SURE: f64 = 5.0;

/// A focal length that is wrong although the images fit: the pose makes up for most of it, but not in the depth.
fn hidden_focal(patient: &Patient, data: &[Datum], params: &Params) -> Option<Finding> {
    let found = fit(&patient.camera, data, ALL)?;
    let off = share(&found.camera, &patient.camera);
    (off.abs() > params.hidden_focal && off.abs() > SURE * found.focal_deviation).then(|| {
        let what = format!(
            "its focal length is {:+.2} % off, which its pose hides: the images fit, the depth does not",
            100.0 * off
        );
        Finding::of(patient, Kind::Zoomed, off, "share", what)
    })
}
