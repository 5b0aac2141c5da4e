//! `cameras` against the cameras that filmed.

use super::head_pose::angle;
use super::same::{check_equal, check_ids, check_take};
use super::spread::Pool;
use super::tracks_2d::Tracks;
use super::{Metric, ScoreError};
use artifact::{CameraRig, TrackState, Trajectories};
use camera::Camera;
use nalgebra::{Isometry3, Matrix3, Point3, Vector2, Vector3};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Scores a calibration: `marker_mm`, `marker_p95_mm` (3D marker error caused by calibration), `angle_deg`, `position_mm`,
/// `focal_rel` (the worst camera; each camera in the context) and `cameras_missing`.
///
/// The true markers are projected by the true cameras, and both rigs triangulate these pixels: each point is the one with
/// the least squared distance to its rays. What the tested rig makes of them is carried onto what the true one makes, by a
/// rigid motion without scale; what is left is the error.
///
/// Poses are compared after the rigid motion with the least sum of distances between the cameras (not of squares), so that
/// one bad camera is found, and not spread over all. Of two cameras nobody can say which is the bad one: they share it.
///
/// A camera sees a marker where `seen` says so; without it, where the pixel lies on the image. Markers that fewer than two
/// cameras of the tested rig see are counted as `points_lost`.
///
/// # Errors
/// A result of another take, with unknown cameras, or for images of another size.
pub fn cameras(
    truth: &CameraRig,
    result: &CameraRig,
    markers: &Trajectories,
    seen: Option<Tracks>,
) -> Result<Vec<Metric>, ScoreError> {
    check_take(truth.take.as_ref(), result.take.as_ref())?;
    let known: Vec<&str> = truth.cameras.keys().map(String::as_str).collect();
    check_ids("camera", &known, result.cameras.keys().map(String::as_str))?;
    let pairs: Vec<Pair> = truth
        .cameras
        .iter()
        .filter_map(|(id, camera)| {
            Some(Pair { id, truth: &camera.camera, result: &result.cameras.get(id)?.camera })
        })
        .collect();
    for pair in &pairs {
        let size = |camera: &Camera| format!("{} × {} px", camera.image_size[0], camera.image_size[1]);
        check_equal(&format!("camera {}, image size", pair.id), &size(pair.truth), &size(pair.result))?;
    }
    let (points, lost) = triangulated(&pairs, markers, seen);
    let (from, to): (Vec<_>, Vec<_>) = points.iter().map(|&(truth, result)| (result, truth)).unzip();
    let aligned = super::align::rigid(&from, &to);
    let counts = [("points", points.len()), ("points_lost", lost), ("cameras", pairs.len())];
    let context: Map<String, Value> =
        counts.into_iter().map(|(key, count)| (key.to_string(), count.into())).collect();
    let mut metrics = marker_metrics(&points, aligned.as_ref());
    metrics.extend(camera_metrics(&pairs, &points));
    metrics.push(Metric::count("cameras_missing", truth.cameras.len() - pairs.len()));
    Ok(metrics.into_iter().map(|metric| metric.with_all(&context)).collect())
}

/// A camera in both rigs.
struct Pair<'a> {
    id: &'a str,
    truth: &'a Camera,
    result: &'a Camera,
}

/// What the true rig makes of a marker, and what the tested one does.
type PointPair = (Point3<f64>, Point3<f64>);

const UNALIGNED: &str = "fewer than three points off a line were triangulated, so nothing can be aligned";

const ALONE: &str =
    "fewer than two cameras of the truth are in the result, so there is nothing to compare them with";

fn marker_metrics(points: &[PointPair], aligned: Option<&Isometry3<f64>>) -> Vec<Metric> {
    let mut errors = Pool::default();
    if let Some(motion) = aligned {
        points.iter().for_each(|(truth, result)| errors.add((motion * result - truth).norm()));
    }
    vec![
        Metric::error("marker_mm", "mm", errors.rms(UNALIGNED)),
        Metric::error("marker_p95_mm", "mm", errors.percentile(0.95, UNALIGNED)),
    ]
}

fn camera_metrics(pairs: &[Pair], points: &[PointPair]) -> Vec<Metric> {
    let aligned = align_cameras(pairs, points);
    let angle_deg = |pair: &Pair, motion: &Isometry3<f64>| {
        // cam ← true world ← tested world
        let expected = pair.truth.cam_from_world.rotation * motion.rotation;
        angle(&expected, &pair.result.cam_from_world.rotation).to_degrees()
    };
    let position_mm = |pair: &Pair, motion: &Isometry3<f64>| {
        (motion * pair.result.eye_in_world() - pair.truth.eye_in_world()).norm()
    };
    let focal_rel = |pair: &Pair, _: &Isometry3<f64>| {
        let (truth, result) = (pair.truth.lens.focal_px, pair.result.lens.focal_px);
        (result - truth).component_div(&truth).amax()
    };
    let worst =
        |name, unit, error: &dyn Fn(&Pair, &Isometry3<f64>) -> f64, motion: Option<&Isometry3<f64>>| {
            let errors: Vec<(&str, f64)> = motion
                .iter()
                .flat_map(|motion| pairs.iter().map(|pair| (pair.id, error(pair, motion))))
                .collect();
            let worst = errors.iter().map(|(_, error)| *error).reduce(f64::max);
            let each: Map<String, Value> =
                errors.iter().map(|(id, error)| (id.to_string(), json!(error))).collect();
            Metric::error(name, unit, worst.ok_or_else(|| ALONE.to_string())).with("per_camera", each)
        };
    let still = Isometry3::identity();
    vec![
        worst("angle_deg", "deg", &angle_deg, aligned.as_ref()),
        worst("position_mm", "mm", &position_mm, aligned.as_ref()),
        worst("focal_rel", "ratio", &focal_rel, Some(&still)),
    ]
}

/// Steps of the reweighted alignment: it gains more than a digit a step, and the last ones stand still.
const STEPS: usize = 60;
/// Cameras closer than this count as equal, mm.
const CLOSE: f64 = 1e-9;

/// The motion from the tested world to the true one with the least sum of distances between the cameras, by reweighted least
/// squares. A camera's distance is that of its eye and of three points as far before and beside it as the markers are.
fn align_cameras(pairs: &[Pair], points: &[PointPair]) -> Option<Isometry3<f64>> {
    if pairs.len() < 2 {
        return None;
    }
    let middle =
        points.iter().map(|(truth, _)| truth.coords).sum::<Vector3<f64>>() / points.len().max(1) as f64;
    let reach = |camera: &Camera| (camera.eye_in_world().coords - middle).norm().max(1.0);
    let place = |camera: &Camera, reach: f64| {
        [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()]
            .map(|axis| camera.cam_from_world.inverse_transform_point(&Point3::from(reach * axis)))
    };
    let (from, to): (Vec<_>, Vec<_>) = pairs
        .iter()
        .map(|pair| (place(pair.result, reach(pair.truth)), place(pair.truth, reach(pair.truth))))
        .unzip();
    let (from, to) = (from.concat(), to.concat());
    let mut motion = super::align::rigid(&from, &to)?;
    for _ in 0..STEPS {
        let distances: Vec<f64> =
            (0..from.len()).map(|at| (motion * from[at] - to[at]).norm_squared()).collect();
        let camera = |at: usize| distances[at / 4 * 4..at / 4 * 4 + 4].iter().sum::<f64>().sqrt();
        if (0..from.len()).all(|at| camera(at) <= CLOSE) {
            break;
        }
        let weights: Vec<f64> = (0..from.len()).map(|at| 1.0 / camera(at).max(CLOSE)).collect();
        motion = camera::fit_rigid(&from, &to, Some(&weights)).ok()?;
    }
    Some(motion)
}

/// Per marker and frame what the true rig and the tested one triangulate, and how many the tested one cannot.
fn triangulated(pairs: &[Pair], markers: &Trajectories, seen: Option<Tracks>) -> (Vec<PointPair>, usize) {
    let sight = seen.map(Sight::of);
    let (mut points, mut lost) = (Vec::new(), 0);
    for frame in &markers.frames {
        for (id, point) in markers.header.markers.iter().zip(&frame.points) {
            let Some(point) = point else { continue };
            let sees = |pair: &Pair, pixel| match &sight {
                Some(sight) => sight.sees(frame.frame, pair.id, id),
                None => pair.truth.contains(pixel),
            };
            let views: Vec<(&Pair, Vector2<f64>)> = pairs
                .iter()
                .filter_map(|pair| Some((pair, pair.truth.project(point)?)))
                .filter(|(pair, pixel)| sees(pair, *pixel))
                .collect();
            let by = |camera: for<'a> fn(&Pair<'a>) -> &'a Camera| {
                nearest_to_rays(views.iter().map(|(pair, pixel)| (camera(pair), *pixel)))
            };
            match (by(|pair| pair.truth), by(|pair| pair.result)) {
                (Some(truth), Some(result)) => points.push((truth, result)),
                _ => lost += 1,
            }
        }
    }
    (points, lost)
}

/// Rays whose sine of angle is below this count as parallel: the point's distance then says nothing.
const PARALLEL: f64 = 1e-6;

/// The point with the least squared distance to the rays of all pixels: `Σ (I − d dᵀ) x = Σ (I − d dᵀ) o` over rays from o
/// along d; none for fewer than two rays, or parallel ones.
fn nearest_to_rays<'a>(views: impl Iterator<Item = (&'a Camera, Vector2<f64>)>) -> Option<Point3<f64>> {
    let (mut sum, mut right, mut rays) = (Matrix3::zeros(), Vector3::zeros(), 0);
    for (camera, pixel) in views {
        let Some(direction) = camera.ray_in_world(pixel) else { continue };
        let across = Matrix3::identity() - direction.into_inner() * direction.transpose();
        sum += across;
        right += across * camera.eye_in_world().coords;
        rays += 1;
    }
    let smallest = sum.symmetric_eigenvalues().min();
    (rays >= 2 && smallest > PARALLEL * PARALLEL)
        .then(|| sum.try_inverse().map(|inverse| Point3::from(inverse * right)))?
}

/// Which camera sees which marker when.
struct Sight<'a> {
    tracks: Tracks<'a>,
    cameras: BTreeMap<&'a str, usize>,
    markers: BTreeMap<&'a str, usize>,
}

impl<'a> Sight<'a> {
    fn of(tracks: Tracks<'a>) -> Self {
        let places =
            |ids: &'a [String]| ids.iter().enumerate().map(|(place, id)| (id.as_str(), place)).collect();
        Self { tracks, cameras: places(&tracks.0.cameras), markers: places(&tracks.0.markers) }
    }

    fn sees(&self, frame: i64, camera: &str, marker: &str) -> bool {
        let sample = || {
            let place = self.tracks.1.binary_search_by_key(&frame, |frame| frame.frame).ok()?;
            let samples = self.tracks.1[place].cameras[*self.cameras.get(camera)?].as_ref()?;
            samples[*self.markers.get(marker)?]
        };
        sample().is_some_and(|sample| sample.state == TrackState::Seen)
    }
}
