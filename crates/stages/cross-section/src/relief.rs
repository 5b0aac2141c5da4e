//! How the face without its wrinkle runs across it: the height of a section as a smooth function.

use nalgebra::{SMatrix, SVector};

/// Distance of the knots, px.
const KNOT_PX: f64 = 6.0;
/// Knots: the section reaches (KNOTS − 3) / 2 spans to each side.
const KNOTS: usize = 19;
/// What the third differences of coefficients count against a place's height.
const STIFFNESS: f64 = 0.3;
/// Places that a section needs.
const LEAST_PLACES: usize = 9;

/// Height over the distance from the curve, both in px of the image there; level beyond its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Relief {
    coefficients: [f64; KNOTS],
}

impl Relief {
    /// How far it reaches to both sides, px.
    pub(crate) const REACH: f64 = KNOT_PX * (KNOTS - 3) as f64 / 2.0;

    /// Through places (distance, height), by least squares; none where there are too few.
    pub(crate) fn through(places: &[[f64; 2]]) -> Option<Self> {
        if places.len() < LEAST_PLACES {
            return None;
        }
        let mut matrix = SMatrix::<f64, KNOTS, KNOTS>::identity() * 1e-9;
        let mut vector = SVector::<f64, KNOTS>::zeros();
        for &[x, z] in places.iter().filter(|place| place[0].abs() < Self::REACH) {
            let (first, [weights, ..]) = basis(x);
            for i in 0..4 {
                vector[first + i] += weights[i] * z;
                for j in 0..4 {
                    matrix[(first + i, first + j)] += weights[i] * weights[j];
                }
            }
        }
        for first in 0..KNOTS - 3 {
            let stencil = [-1.0, 3.0, -3.0, 1.0];
            for i in 0..4 {
                for j in 0..4 {
                    matrix[(first + i, first + j)] += STIFFNESS * stencil[i] * stencil[j];
                }
            }
        }
        // Where nothing is seen, it runs out level.
        for first in 0..KNOTS - 1 {
            for (i, j, value) in [(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)] {
                matrix[(first + i, first + j)] += LEVEL * value;
            }
        }
        Some(Self { coefficients: matrix.cholesky()?.solve(&vector).into() })
    }

    /// Height, slope and its change at a distance.
    pub(crate) fn at(&self, x: f64) -> [f64; 3] {
        let (first, weights) = basis(x.clamp(-Self::REACH, Self::REACH));
        let mut found =
            weights.map(|weights| (0..4).map(|k| weights[k] * self.coefficients[first + k]).sum::<f64>());
        if x.abs() >= Self::REACH {
            (found[1], found[2]) = (0.0, 0.0);
        }
        found
    }

    /// The mean of some; none of none.
    pub(crate) fn mean(all: &[Self]) -> Option<Self> {
        let mean = |k: usize| all.iter().map(|relief| relief.coefficients[k]).sum::<f64>() / all.len() as f64;
        (!all.is_empty()).then(|| Self { coefficients: std::array::from_fn(mean) })
    }
}

/// What level ground counts, against a place's height.
const LEVEL: f64 = 1e-3;

/// The first of four coefficients at a place, with their weights for the value and its two derivatives.
fn basis(x: f64) -> (usize, [[f64; 4]; 3]) {
    let along = ((x + Relief::REACH) / KNOT_PX).clamp(0.0, (KNOTS - 3) as f64);
    let first = (along as usize).min(KNOTS - 4);
    let v = along - first as f64;
    let w = 1.0 - v;
    let value = [
        w * w * w / 6.0,
        (3.0 * v * v * v - 6.0 * v * v + 4.0) / 6.0,
        (-3.0 * v * v * v + 3.0 * v * v + 3.0 * v + 1.0) / 6.0,
        v * v * v / 6.0,
    ];
    let slope = [-0.5 * w * w, 0.5 * v * (3.0 * v - 4.0), 0.5 * (1.0 + v * (2.0 - 3.0 * v)), 0.5 * v * v];
    let twist = [w, 3.0 * v - 2.0, 1.0 - 3.0 * v, v];
    (first, [value, slope.map(|x| x / KNOT_PX), twist.map(|x| x / (KNOT_PX * KNOT_PX))])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_met_with_its_derivatives() {
        let places: Vec<[f64; 2]> =
            (-40..=40).map(f64::from).map(|x| [x, 0.004 * x * x - 0.02 * x]).collect();
        let relief = Relief::through(&places).unwrap();
        for x in [-25.0, -3.0, 0.0, 10.5, 27.0] {
            let [z, slope, bend] = relief.at(x);
            assert!((z - (0.004 * x * x - 0.02 * x)).abs() < 0.05, "{x}: {z}");
            assert!((slope - (0.008 * x - 0.02)).abs() < 0.01 && (bend - 0.008).abs() < 0.002, "{x}");
            let step = 1e-5;
            let [less, more] = [-step, step].map(|step| relief.at(x + step));
            assert!(((more[0] - less[0]) / (2.0 * step) - slope).abs() < 1e-8);
            assert!(((more[1] - less[1]) / (2.0 * step) - bend).abs() < 1e-8);
        }
    }

    #[test]
    fn it_runs_out_level() {
        let places: Vec<[f64; 2]> = (-12..=12).map(f64::from).map(|x| [x, 0.3]).collect();
        let relief = Relief::through(&places).unwrap();
        assert!((relief.at(60.0)[0] - 0.3).abs() < 1e-3 && relief.at(60.0)[1] == 0.0);
    }
}
