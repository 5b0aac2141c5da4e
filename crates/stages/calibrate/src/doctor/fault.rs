//! Which single fault explains what a camera sees.

use super::clock::{Lateness, lateness};
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
pub(super) struct Explanation {
    pub(super) rms_px: f64,
    /// Whether it is certain although it explains little.
    pub(super) is_sure: bool,
    pub(super) kind: Kind,
    pub(super) number: f64,
    pub(super) unit: &'static str,
    pub(super) what: String,
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
    all: &[Patient],
    data: &[Datum],
    trajectories: &Trajectories,
    noise_px: f64,
    params: &Params,
) -> Verdict {
    let camera = &patient.camera;
    let rms_px = rms(camera, data);
    let lateness = lateness(camera, data, trajectories);
    let late = lateness.as_ref().filter(|late| late.is_told).map(|late| late.frames);
    let mut verdict = Verdict { rms_px, left_px: rms_px, late, finding: None };
    let mut explanations: Vec<Explanation> = Vec::new();
    explanations.extend(lateness.map(Lateness::explanation));
    explanations.extend(zoomed(camera, data));
    explanations.extend(mirrored(camera, data));
    explanations.extend(exchanged(patient, all, data));
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

/// Another camera's calibration, if it does better.
fn exchanged(patient: &Patient, all: &[Patient], data: &[Datum]) -> Option<Explanation> {
    let is_like =
        |other: &&Patient| other.id != patient.id && other.camera.image_size == patient.camera.image_size;
    let error = |other: &'_ Patient| (rms(&other.camera, data), other.id.clone());
    let best = all.iter().filter(is_like).map(error).min_by(|a, b| a.0.total_cmp(&b.0));
    let (rms_px, id) = best?;
    let what = format!("its images are those of the camera that is calibrated as {id}");
    Some(Explanation { rms_px, is_sure: false, kind: Kind::Exchanged, number: rms_px, unit: "px", what })
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
