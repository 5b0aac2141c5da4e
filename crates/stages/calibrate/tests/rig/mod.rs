//! A rig like the studio's: six cameras around a face, two closer ones for wrinkles, and what they see of points.
#![allow(dead_code, reason = "each test file uses a part of it")]
#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub(crate) const IDS: [&str; 8] = ["m1", "m2", "m3", "m4", "m5", "m6", "w1", "w2"];

/// The cameras of a seed; their principal points are off the middle by up to 1 %.
pub(crate) fn cameras(seed: u64) -> Vec<Camera> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x51a7);
    let directions = [
        [-48.0, 10.0],
        [-28.0, -14.0],
        [-9.0, 16.0],
        [9.0, -16.0],
        [28.0, 14.0],
        [48.0, -10.0],
        [-22.0, 3.0],
        [22.0, 3.0],
    ];
    let place = |(i, [azimuth, elevation]): (usize, [f64; 2])| {
        let mut vary = |middle: f64, range: f64| middle + range * rng.random_range(-1.0..1.0);
        let (size, focal, distance, target) = match i {
            0..6 => ([656, 490], 1450.0, 850.0, Vector3::new(0.0, 12.0, 45.0)),
            _ => ([1384, 1038], 4740.0, 900.0, Vector3::new(0.0, 34.0, 60.0)),
        };
        let (azimuth, elevation) =
            (vary(azimuth, 1.5_f64).to_radians(), vary(elevation, 1.5_f64).to_radians());
        let towards =
            Vector3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
        let eye = target + towards * vary(distance, 15.0);
        let upright = Camera::pose_looking_at(eye.into(), target.into(), Vector3::y());
        let [width, height] = size.map(f64::from);
        let roll = vary(0.0, 2.0_f64).to_radians();
        Camera {
            image_size: size,
            lens: Lens {
                focal_px: Vector2::repeat(vary(focal, 0.01 * focal)),
                center_px: Vector2::new(
                    vary(0.5 * width - 0.5, 0.01 * width),
                    vary(0.5 * height - 0.5, 0.01 * height),
                ),
                distortion: BrownConrady {
                    k1: vary(-0.12, 0.03),
                    k2: vary(0.08, 0.03),
                    p1: vary(0.0, 4e-4),
                    p2: vary(0.0, 4e-4),
                    k3: 0.0,
                },
            },
            cam_from_world: Isometry3::rotation(Vector3::z() * roll) * upright,
        }
    };
    directions.into_iter().enumerate().map(place).collect()
}

/// A wand's path through a ball of the radius around the face, 25 frames a sweep, mm.
pub(crate) fn wand_path(frames: usize, radius_mm: f64, seed: u64) -> Vec<Point3<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x3a4d);
    let mut wave = |_| {
        let turn = std::f64::consts::PI / 25.0 * rng.random_range(0.6..1.4);
        (turn, rng.random_range(0.0..std::f64::consts::TAU), rng.random_range(0.5..1.0))
    };
    let waves: [[(f64, f64, f64); 3]; 3] = std::array::from_fn(|_| std::array::from_fn(&mut wave));
    let at = |frame: usize| {
        let sum = |waves: &[(f64, f64, f64); 3]| {
            waves.iter().map(|(turn, phase, high)| high * (turn * frame as f64 + phase).sin()).sum::<f64>()
        };
        let step = Vector3::from(waves.each_ref().map(sum));
        Point3::from(Vector3::new(0.0, 15.0, 45.0) + radius_mm * step / (1.0 + step.norm_squared()).sqrt())
    };
    (0..frames).map(at).collect()
}

/// What a camera sees of the points: none outside its image; with noise of this deviation per coordinate, px.
pub(crate) fn track(
    camera: &Camera,
    points: &[Point3<f64>],
    noise_px: f64,
    rng: &mut ChaCha8Rng,
) -> Vec<Option<Vector2<f64>>> {
    let mut see = |point: &Point3<f64>| {
        let noise = Vector2::new(gauss(rng), gauss(rng)) * noise_px;
        camera.project(point).filter(|pixel| camera.contains(*pixel)).map(|pixel| pixel + noise)
    };
    points.iter().map(&mut see).collect()
}

/// A normal deviate.
pub(crate) fn gauss(rng: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * rng.random::<f64>()).cos()
}

/// Points like a face's markers: a curved patch, mm.
pub(crate) fn face() -> Vec<Point3<f64>> {
    let mut points = Vec::new();
    for row in 0..9 {
        for column in 0..9 {
            let (x, y) = (-64.0 + 16.0 * f64::from(column), -70.0 + 20.0 * f64::from(row));
            points.push(Point3::new(x, y, 75.0 - x * x / 110.0 - y * y / 260.0));
        }
    }
    points
}

/// RMS distance between what two rigs make of the face's points, after a rigid motion, mm.
pub(crate) fn marker_error(truth: &[Camera], found: &[Camera]) -> f64 {
    let (from, to) = markers(truth, found);
    let motion = camera::fit_rigid(&from, &to, None).unwrap();
    let squares: f64 = from.iter().zip(&to).map(|(from, to)| (motion * from - to).norm_squared()).sum();
    (squares / from.len() as f64).sqrt()
}

/// The same after a rigid motion and a scale.
pub(crate) fn shape_error(truth: &[Camera], found: &[Camera]) -> f64 {
    let (from, to) = markers(truth, found);
    let motion = camera::fit_similarity(&from, &to, None).unwrap();
    let squares: f64 = from.iter().zip(&to).map(|(from, to)| (motion * from - to).norm_squared()).sum();
    (squares / from.len() as f64).sqrt()
}

/// The face's points as the second rig sees them, and as they are.
fn markers(truth: &[Camera], found: &[Camera]) -> (Vec<Point3<f64>>, Vec<Point3<f64>>) {
    let (mut from, mut to) = (Vec::new(), Vec::new());
    for point in face() {
        let views: Vec<(usize, Vector2<f64>)> = truth
            .iter()
            .enumerate()
            .filter_map(|(c, camera)| {
                Some((c, camera.project(&point).filter(|pixel| camera.contains(*pixel))?))
            })
            .collect();
        if let Some(place) = Camera::nearest_to_rays(views.iter().map(|(c, pixel)| (&found[*c], *pixel))) {
            from.push(place);
            to.push(point);
        }
    }
    (from, to)
}
