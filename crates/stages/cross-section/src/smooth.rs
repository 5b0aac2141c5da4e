//! What light a painted skin without a valley may show: a smooth surface over the paint.

use crate::problem::{Row, huber};
use crate::spline::Basis;
use nalgebra::{DMatrix, DVector};

/// Highest power of the distance from the curve.
pub(crate) const ORDER: usize = 3;
/// Distance of knots along the wrinkle, px.
const KNOTS_PX: f64 = 40.0;
/// Steps of reweighting.
const STEPS: usize = 3;

/// The cost of the pixels under the best smooth light, by their stations: polynomials across, splines along.
pub(crate) fn smooth_costs(rows: &[Row], length: f64, stations: usize, noise: f64) -> Vec<f64> {
    let basis = Basis::new(length, KNOTS_PX, stations);
    let mut costs = vec![0.0; stations];
    let reach = rows.iter().map(|row| row.p.abs()).fold(1.0, f64::max);
    let terms: Vec<Vec<(usize, f64)>> = rows.iter().map(|row| terms(row, &basis, reach)).collect();
    let mut weights = vec![1.0; rows.len()];
    for _ in 0..STEPS {
        let Some(solution) = solve(rows, &terms, &weights, basis.count * (ORDER + 1)) else { return costs };
        costs.fill(0.0);
        for ((row, terms), weight) in rows.iter().zip(&terms).zip(&mut weights) {
            let light: f64 = terms.iter().map(|&(at, value)| value * solution[at]).sum();
            let (cost, trust) = huber((row.light - light) / noise);
            costs[row.station] += row.weight * cost;
            *weight = trust;
        }
    }
    costs
}

fn terms(row: &Row, basis: &Basis, reach: f64) -> Vec<(usize, f64)> {
    let mut along = vec![];
    for (station, share) in [(row.station, 1.0 - row.share), (row.station + 1, row.share)] {
        let (first, weights) = basis.stations[station];
        for (k, weight) in weights.into_iter().enumerate() {
            match along.iter_mut().find(|(at, _)| *at == first + k) {
                Some((_, sum)) => *sum += share * weight,
                None => along.push((first + k, share * weight)),
            }
        }
    }
    let across = row.p / reach;
    (0..=ORDER)
        .flat_map(|power| {
            along
                .iter()
                .map(move |&(at, weight)| (at * (ORDER + 1) + power, weight * across.powi(power as i32)))
        })
        .collect()
}

fn solve(rows: &[Row], terms: &[Vec<(usize, f64)>], weights: &[f64], count: usize) -> Option<DVector<f64>> {
    // Where there is little paint, the surface stays level.
    let mut matrix = DMatrix::<f64>::identity(count, count) * 1e-6;
    let mut vector = DVector::<f64>::zeros(count);
    for ((row, terms), weight) in rows.iter().zip(terms).zip(weights) {
        let weight = weight * row.weight;
        for &(i, value) in terms {
            vector[i] += weight * value * row.light;
            for &(j, other) in terms {
                matrix[(i, j)] += weight * value * other;
            }
        }
    }
    Some(matrix.cholesky()?.solve(&vector))
}
