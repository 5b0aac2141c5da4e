//! Where the light comes from, from the neutral photograph and the face's rough shape.

use crate::params::Light;
use crate::plane::{Plane, median};
use crate::warp::{Pair, Warp};
use crate::{Error, warp::Field};
use nalgebra::{Matrix4, Vector4};

/// The depth of landmarks is smoothed more than their places.
const SMOOTHING: f64 = 1e-2;
/// Rounds of the robust fit.
const ROUNDS: usize = 8;

/// Rough normals of the face from landmarks whose depth is known: x right, y up, z towards the camera.
///
/// `points`: place and depth (growing away from the camera), px.
///
/// # Errors
/// If there are too few landmarks, or they lie on a line.
pub fn rough_normals(
    points: &[([f64; 2], f64)],
    io: f64,
    first: [usize; 2],
    size: [usize; 2],
) -> Result<[Plane; 3], Error> {
    let pair = |(at, depth): &([f64; 2], f64)| Pair { id: String::new(), from: *at, to: [*depth, 0.0] };
    let pairs: Vec<Pair> = points.iter().map(pair).collect();
    let depth = Field::of(&Warp::fit(&pairs, io, SMOOTHING)?, first, size[0], size[1]).x;
    let [dx, dy] = depth.gradient();
    let z = dx.with(&dy, |dx, dy| 1.0 / (1.0 + dx * dx + dy * dy).sqrt());
    // Height is depth backwards; rows run down.
    Ok([z.with(&dx, |z, dx| z * dx), z.with(&dy, |z, dy| -z * dy), z])
}

/// The light that explains how brightness hangs on normals: robust least squares of `I = a + b·n`; the flash's share is
/// `b_z / (a + b_z)`, its tilt `b_xy / b_z`. None where the skin faces all the same way.
#[must_use]
pub fn estimated_light(light: &Plane, normals: &[Plane; 3], weight: &Plane) -> Option<Light> {
    let step = (light.values.len() / 40_000).max(1);
    let places = (0..light.values.len()).step_by(step).filter(|at| weight.values[*at] > 0.5);
    let rows: Vec<(Vector4<f64>, f64)> = places
        .map(|at| {
            let [x, y, z] = [0, 1, 2].map(|axis| normals[axis].values[at]);
            (Vector4::new(1.0, x, y, z), light.values[at])
        })
        .collect();
    let mut trust = vec![1.0; rows.len()];
    let mut found = Vector4::zeros();
    for _ in 0..ROUNDS {
        let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
        for ((row, value), trust) in rows.iter().zip(&trust) {
            normal += *trust * row * row.transpose();
            right += *trust * *value * row;
        }
        found = normal.cholesky()?.solve(&right);
        let left: Vec<f64> = rows.iter().map(|(row, value)| value - row.dot(&found)).collect();
        let spread = 1.4826 * median(left.iter().map(|value| value.abs()).collect::<Vec<_>>().iter()) + 1e-9;
        trust = left.iter().map(|value| 1.0 / (1.0 + (value / (2.0 * spread)).powi(4))).collect();
    }
    let [a, x, y, z] = <[f64; 4]>::from(found);
    if a + z <= 0.0 || !found.iter().all(|value| value.is_finite()) {
        return None;
    }
    let share = z / (a + z);
    let tilt = if share > 0.1 { [x / z, y / z].map(|tilt| tilt.clamp(-0.5, 0.5)) } else { [0.0; 2] };
    Some(Light { flash_share: share.clamp(0.0, 1.0), tilt })
}
