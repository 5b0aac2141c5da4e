//! How a marker's neighbours move: the local affine motion of the markers nearest to it.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::{Matrix3, Matrix3x2, Vector2, Vector3};
use std::num::NonZero;

/// Neighbours that a motion is taken from.
const NEIGHBORS: NonZero<usize> = NonZero::new(8).unwrap();
/// Gradients of the motion are held back as if a marker one such distance away, in middle distances of the neighbours, stood
/// still against the others: few or collinear neighbours then say how all move, not how the motion changes.
const STIFFNESS: f64 = 0.5;
/// Neighbours that differ from the others by more than this count less, px.
const DISAGREEMENT_PX: f64 = 1.5;
/// Rounds of reweighting.
const ROUNDS: usize = 2;

/// Motions known at places, to be asked for elsewhere.
pub(crate) struct MotionField {
    places: Vec<[f64; 2]>,
    motions: Vec<[f64; 2]>,
    tree: Option<ImmutableKdTree<f64, 2>>,
}

impl MotionField {
    /// `motions[i]` is what happened at `places[i]`, px.
    pub(crate) fn new(places: Vec<[f64; 2]>, motions: Vec<[f64; 2]>) -> Self {
        let tree = match places.is_empty() {
            true => None,
            // Refuses only very many markers on one point, of which no motion could be learnt.
            false => ImmutableKdTree::new_from_slice(&places).ok(),
        };
        Self { places, motions, tree }
    }

    /// The motion at a place, from what its neighbours did; a sample at the place itself does not count. None without
    /// neighbours.
    pub(crate) fn at(&self, place: [f64; 2]) -> Option<[f64; 2]> {
        let found = self.tree.as_ref()?.query(&place).nearest_n::<SquaredEuclidean<f64>>(NEIGHBORS).execute();
        let near: Vec<usize> =
            found.iter().filter(|hit| hit.distance > 0.0).map(|hit| hit.item as usize).collect();
        let distance = |i: usize| {
            let [x, y] = self.places[i];
            (x - place[0]).hypot(y - place[1])
        };
        let scale = near.iter().map(|&i| distance(i)).sum::<f64>() / near.len().max(1) as f64;
        if near.is_empty() || scale <= 0.0 {
            return None;
        }
        let mut weights: Vec<f64> =
            near.iter().map(|&i| 1.0 / (1.0 + (distance(i) / scale).powi(2))).collect();
        let mut motion = Vector2::zeros();
        for _ in 0..=ROUNDS {
            let affine = self.affine(place, scale, &near, &weights)?;
            motion = affine.row(0).transpose();
            for (weight, &i) in weights.iter_mut().zip(&near) {
                let off = self.residual(place, scale, i, &affine);
                *weight =
                    1.0 / (1.0 + (distance(i) / scale).powi(2)) / (1.0 + (off / DISAGREEMENT_PX).powi(2));
            }
        }
        Some(motion.into())
    }

    fn basis(&self, place: [f64; 2], scale: f64, i: usize) -> Vector3<f64> {
        let [x, y] = self.places[i];
        Vector3::new(1.0, (x - place[0]) / scale, (y - place[1]) / scale)
    }

    /// Rows: motion at the place, its change along x and along y, per `scale` px.
    fn affine(&self, place: [f64; 2], scale: f64, near: &[usize], weights: &[f64]) -> Option<Matrix3x2<f64>> {
        let mut normal = Matrix3::from_diagonal(&Vector3::new(0.0, STIFFNESS, STIFFNESS));
        let mut right = Matrix3x2::zeros();
        for (&i, &weight) in near.iter().zip(weights) {
            let basis = self.basis(place, scale, i);
            normal += weight * basis * basis.transpose();
            right += weight * basis * Vector2::from(self.motions[i]).transpose();
        }
        Some(normal.try_inverse()? * right)
    }

    fn residual(&self, place: [f64; 2], scale: f64, i: usize, affine: &Matrix3x2<f64>) -> f64 {
        let predicted = affine.transpose() * self.basis(place, scale, i);
        (Vector2::from(self.motions[i]) - predicted).norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_uniform_motion_is_found_and_a_stray_neighbour_is_not_followed() {
        let places: Vec<[f64; 2]> =
            (0..9).map(|i| [f64::from(i % 3) * 10.0, f64::from(i / 3) * 10.0]).collect();
        let mut motions = vec![[2.0, -1.0]; 9];
        motions[0] = [30.0, 30.0];
        let [x, y] = MotionField::new(places, motions).at([11.0, 12.0]).unwrap();
        assert!((x - 2.0).abs() < 0.2 && (y + 1.0).abs() < 0.2, "{x} {y}");
    }

    #[test]
    fn an_affine_motion_is_nearly_found() {
        let places: Vec<[f64; 2]> =
            (0..25).map(|i| [f64::from(i % 5) * 10.0, f64::from(i / 5) * 10.0]).collect();
        let motion = |[x, y]: [f64; 2]| [1.0 + 0.05 * x, -0.03 * y];
        let field = MotionField::new(places.clone(), places.iter().map(|p| motion(*p)).collect());
        let [x, y] = field.at([21.0, 19.0]).unwrap();
        let [tx, ty] = motion([21.0, 19.0]);
        assert!((x - tx).abs() < 0.1 && (y - ty).abs() < 0.1, "{x} {y} {tx} {ty}");
        assert!(MotionField::new(Vec::new(), Vec::new()).at([0.0, 0.0]).is_none());
    }
}
