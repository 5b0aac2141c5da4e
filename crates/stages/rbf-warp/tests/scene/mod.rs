//! Marker sets for tests: face-like, and degenerate on purpose.
#![allow(dead_code, reason = "each test file uses its part")]
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "a test may fail, and looks at files")]

pub(crate) mod files;

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rbf_warp::Pairs;

pub(crate) type Points = Vec<Point3<f64>>;

pub(crate) fn rng(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// A standard normal number (sum of twelve uniform ones).
pub(crate) fn normal(rng: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0
}

pub(crate) fn normal3(rng: &mut ChaCha8Rng, sigma: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| sigma * normal(rng))
}

/// Directions on the front half of a sphere, spread evenly by a golden-angle spiral, with a little disorder.
fn front(count: usize, rng: &mut ChaCha8Rng) -> Vec<Vector3<f64>> {
    (0..count)
        .map(|i| {
            let z = 1.0 - 0.9 * (i as f64 + 0.5) / count as f64;
            let angle = 2.399_963 * i as f64 + 0.2 * rng.random::<f64>();
            let radius = (1.0 - z * z).sqrt();
            Vector3::new(radius * angle.cos(), radius * angle.sin(), z)
        })
        .collect()
}

/// Exactly on an ellipsoid of a head's size, mm.
pub(crate) fn ellipsoid(count: usize, rng: &mut ChaCha8Rng) -> Points {
    let axes = Vector3::new(70.0, 100.0, 80.0);
    front(count, rng)
        .iter()
        .map(|d| Point3::from(d.component_mul(&axes)) + Vector3::new(5.0, -8.0, 12.0))
        .collect()
}

/// Exactly on a tilted plane, mm.
pub(crate) fn plane(count: usize, rng: &mut ChaCha8Rng) -> Points {
    let tilt = rotation(0.4, -0.7, 0.2);
    front(count, rng).iter().map(|d| tilt * Point3::new(d.x * 70.0, d.y * 90.0, 0.0)).collect()
}

/// A face-like set: ellipsoid with a nose, eye hollows and a chin, mm.
pub(crate) fn face(count: usize, rng: &mut ChaCha8Rng) -> Points {
    let bump = |p: &Point3<f64>, at: [f64; 2], height: f64, width: f64| {
        height * (-((p.x - at[0]).powi(2) + (p.y - at[1]).powi(2)) / (width * width)).exp()
    };
    ellipsoid(count, rng)
        .into_iter()
        .map(|p| {
            let relief = bump(&p, [5.0, -10.0], 25.0, 18.0)
                - bump(&p, [-28.0, 20.0], 10.0, 16.0)
                - bump(&p, [38.0, 20.0], 10.0, 16.0)
                + bump(&p, [5.0, -70.0], 12.0, 22.0);
            p + Vector3::new(0.0, 0.0, relief) + normal3(rng, 0.5)
        })
        .collect()
}

pub(crate) fn rotation(roll: f64, pitch: f64, yaw: f64) -> Isometry3<f64> {
    Isometry3::from_parts(Vector3::zeros().into(), UnitQuaternion::from_euler_angles(roll, pitch, yaw))
}

pub(crate) fn rigid(rng: &mut ChaCha8Rng) -> Isometry3<f64> {
    let mut turn = rotation(normal(rng), normal(rng), normal(rng));
    turn.translation = normal3(rng, 300.0).into();
    turn
}

/// Another expression: a smooth bend of a few millimetres and picking errors.
pub(crate) fn expression(points: &Points, error_mm: f64, rng: &mut ChaCha8Rng) -> Points {
    let bend =
        |p: &Point3<f64>| Vector3::new((p.y / 40.0).sin(), (p.x / 50.0).cos(), (p.y / 60.0).cos()) * 2.5;
    points.iter().map(|p| p + bend(p) + normal3(rng, error_mm)).collect()
}

/// A point within the markers' extent, up to `off` mm off the surface.
pub(crate) fn near(points: &Points, off: f64, rng: &mut ChaCha8Rng) -> Point3<f64> {
    let (i, j) = (rng.random_range(0..points.len()), rng.random_range(0..points.len()));
    let on = points[i] + (points[j] - points[i]) * (0.3 * rng.random::<f64>());
    on + normal3(rng, 1.0).normalize() * (off * rng.random::<f64>())
}

pub(crate) fn names(count: usize) -> Vec<String> {
    (0..count).map(|i| format!("m{i}")).collect()
}

pub(crate) fn pairs<'a>(names: &'a [String], from: &'a Points, to: &'a Points) -> Pairs<'a> {
    Pairs { markers: names, from, to, space: "mocap space" }
}
