//! What light a painted skin without a valley may show: a smooth surface over the paint.

use crate::problem::{Row, huber};
use crate::spline::Basis;
use nalgebra::{DMatrix, DVector};

/// Highest power of the distance from the curve.
pub(crate) const ORDER: usize = 3;
/// Distance of knots along the wrinkle, px.
const KNOTS_PX: f64 = 40.0;
/// Deviation of what bends the light across the paint, at the paint's edge, as share of the light: what a face, a nose and a sky do within
/// a centimetre. Deeper dips are valleys.
const BEND: f64 = 0.08;
/// Powers of the distance from here on bend the light.
const FIRST_BEND: usize = 2;
/// Steps of reweighting.
const STEPS: usize = 3;

/// What smooth light says of pixels.
pub(crate) struct Smooth {
    /// Their cost under the best one; infinite where there is none.
    pub(crate) cost: f64,
    /// By how much it bends across the paint, as share of the light.
    pub(crate) bend: f64,
}

/// The best smooth light over pixels: polynomials across, splines along.
pub(crate) fn smooth_light(rows: &[Row], length: f64, stations: usize, noise: f64) -> Smooth {
    let basis = Basis::new(length, KNOTS_PX, stations);
    let mut smooth = Smooth { cost: f64::INFINITY, bend: 0.0 };
    let reach = rows.iter().map(|row| row.p.abs()).fold(1.0, f64::max);
    let terms: Vec<Vec<(usize, f64)>> = rows.iter().map(|row| terms(row, &basis, reach)).collect();
    let mut weights = vec![1.0; rows.len()];
    for _ in 0..STEPS {
        let count = basis.count * (ORDER + 1);
        let Some(solution) = solve(rows, &terms, &weights, count, noise) else { break };
        let bends = || solution.iter().enumerate().filter(|(at, _)| at % (ORDER + 1) >= FIRST_BEND);
        smooth.cost = bends().map(|(_, bend)| (bend / BEND).powi(2)).sum();
        smooth.bend = bends().map(|(_, bend)| bend.abs()).fold(0.0, f64::max);
        for ((row, terms), weight) in rows.iter().zip(&terms).zip(&mut weights) {
            let light: f64 = terms.iter().map(|&(at, value)| value * solution[at]).sum();
            let (misfit, trust) = huber((row.light - light) / noise);
            smooth.cost += row.weight * misfit;
            *weight = trust;
        }
    }
    smooth
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

fn solve(
    rows: &[Row],
    terms: &[Vec<(usize, f64)>],
    weights: &[f64],
    count: usize,
    noise: f64,
) -> Option<DVector<f64>> {
    let mut matrix = DMatrix::<f64>::zeros(count, count);
    for at in 0..count {
        // Where there is little paint, the surface stays level.
        matrix[(at, at)] = if at % (ORDER + 1) >= FIRST_BEND { (noise / BEND).powi(2) } else { 1e-6 };
    }
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
