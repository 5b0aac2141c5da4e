//! A talking head: six head markers, thirty face markers, noise, and motions to plant.
#![allow(dead_code, reason = "each test file uses a part of it")]

use artifact::{MarkerFrame, MarkerHeader, Rate, SampleStatus, Trajectories, Unit};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

pub(crate) const RATE: u32 = 100;
pub(crate) const HEAD_COUNT: usize = 6;

/// Places of all markers at rest, mm: the head's first.
pub(crate) fn rest() -> Vec<Point3<f64>> {
    let head = [
        [-70., 60., 20.],
        [70., 60., 20.],
        [-75., 0., -10.],
        [75., 0., -10.],
        [-25., 95., 40.],
        [30., 95., 40.],
    ];
    let face = [45., 20., -10., -35., -55., -75.].into_iter().flat_map(|y: f64| {
        [-40., -20., 0., 20., 40.].map(move |x: f64| [x, y, 85. - 0.008 * x * x - 0.003 * y * y])
    });
    head.into_iter().chain(face).map(Point3::from).collect()
}

pub(crate) fn ids() -> Vec<String> {
    (0..rest().len())
        .map(|i| if i < HEAD_COUNT { format!("head-{i}") } else { format!("face-{}", i - HEAD_COUNT) })
        .collect()
}

/// A take of the talking face, its head still: lips and chin move up to 12 mm at 2 Hz. `noise_mm` per axis.
pub(crate) fn talking(frame_count: usize, noise_mm: f64, seed: u64) -> Trajectories {
    let rest = rest();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let frames = (0..frame_count)
        .map(|f| {
            let open = 6.0 * (1.0 - (TAU * 2.0 * f as f64 / f64::from(RATE)).cos());
            let points = rest.iter().enumerate().map(|(m, place)| {
                let share = if m < HEAD_COUNT { 0.0 } else { ((-place.y - 5.0) / 70.0).clamp(0.0, 1.0) };
                Some(place + Vector3::new(0.0, -open, -0.3 * open) * share + noise_mm * normal(&mut rng))
            });
            let points: Vec<_> = points.collect();
            MarkerFrame { frame: 1001 + f as i64, status: vec![SampleStatus::Measured; points.len()], points }
        })
        .collect();
    let header =
        MarkerHeader { unit: Unit::Mm, rate: Some(Rate::per_second(RATE)), markers: ids(), take: None };
    Trajectories { header, frames }
}

/// Three normal numbers (Box and Muller's way).
pub(crate) fn normal(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| {
        let radius = (-2.0 * rng.random_range(f64::MIN_POSITIVE..1.0f64).ln()).sqrt();
        radius * (TAU * rng.random_range(0.0..1.0f64)).cos()
    })
}

/// Nods and turns about the neck: 15° at up to 3 Hz, 30 mm.
pub(crate) fn nodding(frame: usize) -> Isometry3<f64> {
    let t = frame as f64 / f64::from(RATE);
    let angles =
        Vector3::new((TAU * 3.0 * t).sin(), (TAU * 1.1 * t + 1.0).sin(), 0.5 * (TAU * 2.0 * t).cos());
    about_neck(
        angles * 15f64.to_radians(),
        30.0 * Vector3::new((TAU * 0.7 * t).cos(), (TAU * 2.0 * t).sin(), 0.2),
    )
}

pub(crate) fn about_neck(angles: Vector3<f64>, shift: Vector3<f64>) -> Isometry3<f64> {
    let neck = Translation3::new(0.0, -120.0, -60.0);
    let turn = UnitQuaternion::from_scaled_axis(angles);
    Translation3::from(shift) * neck * turn * neck.inverse()
}

/// The take with a motion planted on it.
pub(crate) fn moved(take: &Trajectories, motion: impl Fn(usize) -> Isometry3<f64>) -> Trajectories {
    let mut take = take.clone();
    for (f, frame) in take.frames.iter_mut().enumerate() {
        for point in frame.points.iter_mut().flatten() {
            *point = motion(f) * *point;
        }
    }
    take
}

/// Hides a marker in a run of frames (positions in the take).
pub(crate) fn hide(take: &mut Trajectories, marker: usize, frames: std::ops::Range<usize>) {
    frames.for_each(|f| take.frames[f].points[marker] = None);
}

pub(crate) fn named() -> stabilize::Params {
    stabilize::Params { head_markers: vec!["head-*".into()], ..Default::default() }
}

/// Largest distance of two sets of frames; infinite if other samples are missing.
pub(crate) fn largest_difference(a: &Trajectories, b: &Trajectories, a_from_b: &Isometry3<f64>) -> f64 {
    let pairs = a.frames.iter().zip(&b.frames).flat_map(|(a, b)| a.points.iter().zip(&b.points));
    pairs
        .map(|pair| match pair {
            (Some(a), Some(b)) => (a - a_from_b * b).norm(),
            (None, None) => 0.0,
            _ => f64::INFINITY,
        })
        .fold(0.0, f64::max)
}
