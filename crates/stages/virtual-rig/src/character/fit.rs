//! Moves of bones that come near a motion of the skin.

use super::bones::{BONE_COUNT, Bones, HEAD, JAW};
use super::displacements;
use crate::body::Body;
use nalgebra::{DMatrix, Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

/// Moves below this are none, mm.
const LEAST_MM: f64 = 0.05;
/// Keeps bones that hold little skin still.
const RIDGE: f64 = 1e-2;

/// Per bone its move about its own place, in the head's space, mm, so that the skin comes near `posed`: the jaw by the rigid
/// motion of what hangs on it, all others by what linear least squares leave for them to carry.
pub(super) fn moves(body: &Body, bones: &Bones, posed: &[Point3<f64>]) -> Vec<Isometry3<f64>> {
    let mut moves = vec![Isometry3::identity(); BONE_COUNT];
    moves[JAW] = rigid(body, bones, posed);
    let jaw = |point: &Point3<f64>| {
        let place = bones.place(JAW);
        place + moves[JAW].translation.vector + moves[JAW].rotation * (point - place)
    };
    let mut left = displacements(body, posed);
    for (vertex, influences) in bones.influences.iter().enumerate() {
        let rest = &body.mesh.positions[vertex];
        let weight = influences.iter().find(|pair| pair.0 == JAW).map_or(0.0, |pair| pair.1);
        left[vertex] -= (jaw(rest) - rest) * weight;
    }
    let mut normal = DMatrix::<f64>::identity(BONE_COUNT, BONE_COUNT) * RIDGE;
    let mut right = DMatrix::<f64>::zeros(BONE_COUNT, 3);
    for (influences, left) in bones.influences.iter().zip(&left) {
        let free = influences.iter().filter(|pair| pair.0 != HEAD && pair.0 != JAW);
        for (bone, weight) in free.clone() {
            free.clone().for_each(|(other, theirs)| normal[(*bone, *other)] += weight * theirs);
            (0..3).for_each(|axis| right[(*bone, axis)] += weight * left[axis]);
        }
    }
    let Some(solution) = normal.cholesky().map(|factor| factor.solve(&right)) else { return moves };
    for (bone, way) in moves.iter_mut().enumerate().filter(|(bone, _)| *bone != HEAD && *bone != JAW) {
        let vector = Vector3::new(solution[(bone, 0)], solution[(bone, 1)], solution[(bone, 2)]);
        if vector.norm() >= LEAST_MM {
            way.translation = Translation3::from(vector);
        }
    }
    moves
}

/// The rigid motion of what hangs on the jaw, about the jaw's place [Horn1987].
fn rigid(body: &Body, bones: &Bones, posed: &[Point3<f64>]) -> Isometry3<f64> {
    let place = bones.place(JAW).coords;
    let carried = bones.influences.iter().enumerate().filter_map(|(vertex, influences)| {
        let weight = influences.iter().find(|pair| pair.0 == JAW)?.1;
        let (rest, posed) = (body.mesh.positions[vertex].coords - place, posed[vertex].coords - place);
        Some((rest, posed, weight * weight))
    });
    let (mut sum, mut rest_mean, mut posed_mean) = (0.0, Vector3::zeros(), Vector3::zeros());
    for (rest, posed, weight) in carried.clone() {
        sum += weight;
        rest_mean += rest * weight;
        posed_mean += posed * weight;
    }
    if sum == 0.0 {
        return Isometry3::identity();
    }
    (rest_mean, posed_mean) = (rest_mean / sum, posed_mean / sum);
    let spread: Matrix3<f64> = carried
        .map(|(rest, posed, weight)| (posed - posed_mean) * (rest - rest_mean).transpose() * weight)
        .sum();
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix(&spread));
    let shift = posed_mean - turn * rest_mean;
    match shift.norm() < LEAST_MM && turn.angle() < 1e-3 {
        true => Isometry3::identity(),
        false => Isometry3::from_parts(shift.into(), turn),
    }
}
