//! Six cameras around a curved sheet of markers, seen with noise.
#![allow(dead_code, reason = "each test file uses a part of it")]

use artifact::{CameraRig, MeasuredFrame, Rate, Sample2d, Tracks2dFrame, Tracks2dHeader};
use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

pub(crate) const MARKERS: usize = 42;

/// Cameras like those of the studio, 1.5 m away.
pub(crate) fn rig() -> CameraRig {
    let distortion = BrownConrady { k1: -0.11, k2: 0.08, p1: 3e-4, p2: -2e-4, k3: 0.0 };
    let lens =
        Lens { focal_px: Vector2::new(1450., 1455.), center_px: Vector2::new(327.5, 244.5), distortion };
    let camera = |i: usize| {
        let angle = -0.6 + 0.24 * i as f64;
        let eye = Point3::new(
            1500. * angle.sin(),
            if i.is_multiple_of(2) { 150. } else { -200. },
            1500. * angle.cos(),
        );
        let cam_from_world = Camera::pose_looking_at(eye, Point3::origin(), Vector3::y());
        Camera { image_size: [656, 490], lens, cam_from_world }
    };
    CameraRig { cameras: (0..6).map(|i| (format!("m{}", i + 1), camera(i).into())).collect(), take: None }
}

/// The rig, moved.
pub(crate) fn moved(rig: &CameraRig, by: &Isometry3<f64>) -> CameraRig {
    let mut rig = rig.clone();
    rig.cameras.values_mut().for_each(|camera| camera.camera.cam_from_world *= by.inverse());
    rig
}

/// Markers at rest, mm: seven columns, six rows, curved like a face.
pub(crate) fn rest() -> Vec<Point3<f64>> {
    let place = |i: usize| {
        let (x, y) = ((i % 7) as f64 * 20.0 - 60.0, (i / 7) as f64 * 20.0 - 50.0);
        Point3::new(x, y, 60.0 - 0.008 * x * x - 0.003 * y * y)
    };
    (0..MARKERS).map(place).collect()
}

pub(crate) fn header() -> Tracks2dHeader {
    Tracks2dHeader {
        cameras: (1..=6).map(|i| format!("m{i}")).collect(),
        markers: (0..MARKERS).map(|i| format!("p{i}")).collect(),
        rate: Some(Rate::per_second(50)),
        take: None,
    }
}

/// What the cameras see of points, frame by frame from 1001 on, with radial errors of `noise_px` root mean square.
pub(crate) fn tracks(
    rig: &CameraRig,
    points: &[Vec<Point3<f64>>],
    noise_px: f64,
    seed: u64,
) -> Vec<Tracks2dFrame> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let frame = |(f, points): (usize, &Vec<Point3<f64>>)| {
        let mut see = |camera: &Camera, point: &Point3<f64>| {
            let noise = Vector2::new(normal(&mut rng), normal(&mut rng)) * noise_px / 2f64.sqrt();
            Some(Sample2d::seen((camera.project(point)? + noise).into()))
        };
        let cameras = rig.cameras.values();
        let cameras = cameras.map(|c| Some(points.iter().map(|p| see(&c.camera, p)).collect())).collect();
        Tracks2dFrame { frame: 1001 + f as i64, cameras }
    };
    points.iter().enumerate().map(frame).collect()
}

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * rng.random_range(f64::MIN_POSITIVE..1.0f64).ln()).sqrt();
    radius * (TAU * rng.random_range(0.0..1.0f64)).cos()
}

/// A take in which nothing moves.
pub(crate) fn still(frames: usize) -> Vec<Vec<Point3<f64>>> {
    vec![rest(); frames]
}

/// Root mean square distance of the samples that are there.
pub(crate) fn rms(found: &[MeasuredFrame], truth: &[Vec<Point3<f64>>]) -> f64 {
    let pairs = found.iter().zip(truth).flat_map(|(found, truth)| found.markers.points.iter().zip(truth));
    let squares: Vec<f64> =
        pairs.filter_map(|(found, truth)| Some((found.as_ref()? - truth).norm_squared())).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Takes a marker from a camera in a frame.
pub(crate) fn hide(tracks: &mut [Tracks2dFrame], frame: usize, camera: usize, marker: usize) {
    if let Some(samples) = &mut tracks[frame].cameras[camera] {
        samples[marker] = None;
    }
}
