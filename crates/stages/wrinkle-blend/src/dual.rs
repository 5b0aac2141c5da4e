//! A bone's move shared out among the poses that move it.
//!
//! Per bone: `α ≥ 0` that minimises `‖AB − Σ α_k AC_k‖` (notation of [DutreveMeyer2011, Eq. 4]). Bones have three coordinates and
//! faces more poses than that, so that many α may do equally well; of those, the one of the shortest way, `Σ α_k ‖AC_k‖`. By the
//! triangle inequality no detour is as short as the pose itself: at each reference pose its own weight is 1 and all others
//! are 0, unless another pose moves the bone the same way.

use nalgebra::Vector3;

/// Price of the way, as a share of the move: breaks ties, and is taken out again.
const PRICE: f64 = 1e-3;
/// Keeps the problem strictly convex, so that the result has no jumps.
const RIDGE: f64 = 1e-7;

/// The shares of a move `b` among the directions `ways` (one per pose, none zero).
pub(crate) fn shares(ways: &[Vector3<f64>], b: &Vector3<f64>) -> Vec<f64> {
    let length = b.norm();
    if length == 0.0 {
        return vec![0.0; ways.len()];
    }
    let units: Vec<Vector3<f64>> = ways.iter().map(|way| way / way.norm()).collect();
    let b = b / length;
    let found = priced(&units, &b, PRICE);
    let lengths = unpriced(&units, &b, &found).unwrap_or(found);
    lengths.iter().zip(ways).map(|(part, way)| part * length / way.norm()).collect()
}

/// `x ≥ 0` that minimises `½‖b − Σ x_k u_k‖² + price Σ x_k + ½ ridge ‖x‖²`, by the active set method of [LawsonHanson1974].
fn priced(units: &[Vector3<f64>], b: &Vector3<f64>, price: f64) -> Vec<f64> {
    let count = units.len();
    let mut x = vec![0.0; count];
    let mut chosen: Vec<usize> = Vec::new();
    for _ in 0..3 * count {
        let rest = units.iter().zip(&x).fold(*b, |rest, (unit, part)| rest - unit * *part);
        let gain = |k: usize| units[k].dot(&rest) - price - RIDGE * x[k];
        let best = (0..count)
            .filter(|k| !chosen.contains(k))
            .max_by(|&i, &j| gain(i).total_cmp(&gain(j)).then(j.cmp(&i)));
        let Some(best) = best.filter(|&k| gain(k) > 1e-12) else { break };
        chosen.push(best);
        while let Some(goal) = solve(units, b, price, RIDGE, &chosen) {
            if goal.iter().all(|part| *part > 0.0) {
                chosen.iter().zip(&goal).for_each(|(&k, part)| x[k] = *part);
                break;
            }
            let step = chosen
                .iter()
                .zip(&goal)
                .filter(|(_, part)| **part <= 0.0)
                .map(|(&k, part)| x[k] / (x[k] - part))
                .fold(1.0, f64::min);
            chosen.iter().zip(&goal).for_each(|(&k, part)| x[k] += step * (part - x[k]));
            chosen.retain(|&k| x[k] > 1e-14);
            (0..count)
                .filter(|k| !chosen.contains(k))
                .collect::<Vec<_>>()
                .into_iter()
                .for_each(|k| x[k] = 0.0);
        }
    }
    x
}

/// The same without the price, on the poses that were found; none where that leads below 0 or to more than three.
fn unpriced(units: &[Vector3<f64>], b: &Vector3<f64>, found: &[f64]) -> Option<Vec<f64>> {
    let chosen: Vec<usize> = (0..found.len()).filter(|&k| found[k] > 0.0).collect();
    if chosen.is_empty() || chosen.len() > 3 {
        return None;
    }
    let parts = solve(units, b, 0.0, 0.0, &chosen)?;
    // Directions that nearly agree have no sums of their own.
    let sane =
        parts.iter().zip(&chosen).all(|(part, &k)| (part - found[k]).abs() <= 10.0 * PRICE && *part >= 0.0);
    sane.then(|| {
        let mut x = vec![0.0; found.len()];
        chosen.iter().zip(parts).for_each(|(&k, part)| x[k] = part);
        x
    })
}

/// The unconstrained minimum over the chosen poses; none if they depend on each other.
fn solve(
    units: &[Vector3<f64>],
    b: &Vector3<f64>,
    price: f64,
    ridge: f64,
    chosen: &[usize],
) -> Option<Vec<f64>> {
    let count = chosen.len();
    let gram = nalgebra::DMatrix::from_fn(count, count, |i, j| {
        units[chosen[i]].dot(&units[chosen[j]]) + if i == j { ridge } else { 0.0 }
    });
    let right = nalgebra::DVector::from_fn(count, |i, _| units[chosen[i]].dot(b) - price);
    Some(gram.cholesky()?.solve(&right).iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn way() -> impl Strategy<Value = Vector3<f64>> {
        [-9.0..9.0f64, -9.0..9.0, -9.0..9.0]
            .prop_map(Vector3::from)
            .prop_filter("moves", |way| way.norm() > 1.0)
    }

    #[test]
    fn orthogonal_poses_are_those_of_the_paper() {
        let ways = [Vector3::new(2.0, 0.0, 0.0), Vector3::new(0.0, 0.5, 0.0), Vector3::new(0.0, 0.0, -3.0)];
        let found = shares(&ways, &Vector3::new(1.0, 0.1, -6.0));
        for (found, wanted) in found.iter().zip([0.5, 0.2, 2.0]) {
            assert!((found - wanted).abs() < 1e-9);
        }
        assert_eq!(shares(&ways, &Vector3::zeros()), [0.0; 3]);
    }

    #[test]
    fn what_lies_behind_all_poses_shows_none() {
        let ways = [Vector3::new(2.0, 0.0, 0.0), Vector3::new(1.0, 1.0, 0.0)];
        assert_eq!(shares(&ways, &Vector3::new(-1.0, 0.0, 0.0)), [0.0; 2]);
    }

    proptest! {
        /// However many poses: each is itself, as long as no other one goes the same way.
        #[test]
        fn each_pose_is_itself(ways in proptest::collection::vec(way(), 1..9), pick in 0usize..9) {
            let pick = pick % ways.len();
            let apart = |other: &Vector3<f64>| other.angle(&ways[pick]) > 0.05;
            prop_assume!(ways.iter().enumerate().all(|(k, way)| k == pick || apart(way)));
            for (k, share) in shares(&ways, &ways[pick]).iter().enumerate() {
                prop_assert!((share - f64::from(u8::from(k == pick))).abs() < 1e-6, "{k}: {share}");
            }
        }

        /// A small change of the move is a small change of the shares.
        #[test]
        fn nothing_jumps(ways in proptest::collection::vec(way(), 1..7), b in way(), step in way()) {
            let near = b + 1e-6 * step;
            for (one, other) in shares(&ways, &b).iter().zip(shares(&ways, &near)) {
                prop_assert!((one - other).abs() < 0.12, "{one} {other}");
            }
        }
    }
}
