//! Smoothing over time without lag: a quadratic fitted around each sample.

use crate::samples::Samples;
use nalgebra::{Matrix3, Matrix3xX, Point3, Vector3};

/// Samples further away than this many standard deviations of the window have no weight worth counting.
const REACH: f64 = 3.0;
/// A quadratic through three samples smooths nothing.
const LEAST_SAMPLES: usize = 4;

/// Every marker smoothed over time by local quadratic regression with a Gaussian window of standard deviation
/// `sigma` frames [FanGijbels1996, §3]. Symmetric in time, hence without lag; it keeps positions, speeds and
/// accelerations. `None` where a sample is missing or has too few others around it.
pub(crate) fn smooth(samples: &Samples, sigma: f64) -> Samples {
    let columns: Vec<_> =
        (0..samples.marker_count()).map(|marker| smooth_marker(samples, marker, sigma)).collect();
    let points =
        (0..samples.frame_count()).map(|f| columns.iter().map(|column| column[f]).collect()).collect();
    Samples { numbers: samples.numbers.clone(), points }
}

fn smooth_marker(samples: &Samples, marker: usize, sigma: f64) -> Vec<Option<Point3<f64>>> {
    let seen = samples.seen(marker);
    let at: Vec<f64> = seen.iter().map(|&f| samples.numbers[f] as f64).collect();
    let places: Vec<Vector3<f64>> = samples.of(marker);
    let mut smoothed = vec![None; samples.frame_count()];
    let (mut first, mut last) = (0, 0);
    for (k, &f) in seen.iter().enumerate() {
        while at[k] - at[first] > REACH * sigma {
            first += 1;
        }
        while last + 1 < at.len() && at[last + 1] - at[k] <= REACH * sigma {
            last += 1;
        }
        smoothed[f] = quadratic_at(at[k], sigma, &at[first..=last], &places[first..=last]);
    }
    smoothed
}

/// The value at `t` of the weighted quadratic.
fn quadratic_at(t: f64, sigma: f64, at: &[f64], places: &[Vector3<f64>]) -> Option<Point3<f64>> {
    if at.len() < LEAST_SAMPLES {
        return None;
    }
    let mut normal = Matrix3::zeros();
    let mut right = Matrix3xX::zeros(3);
    for (&time, place) in at.iter().zip(places) {
        let u = (time - t) / sigma;
        let powers = Vector3::new(1.0, u, u * u);
        let weight = (-0.5 * u * u).exp();
        normal += weight * powers * powers.transpose();
        right += weight * powers * place.transpose();
    }
    let fitted = normal.cholesky()?.solve(&right);
    Some(Point3::new(fitted[(0, 0)], fitted[(0, 1)], fitted[(0, 2)]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_stays_as_it_is_even_at_the_ends_and_beside_gaps() {
        let place = |t: f64| Point3::new(t, 3.0 - 0.1 * t * t, 0.5 * t);
        let numbers: Vec<i64> = (100..130).filter(|n| !(110..114).contains(n)).collect();
        let points = numbers.iter().map(|&n| vec![Some(place(n as f64 - 115.0))]).collect();
        let samples = Samples { numbers, points };
        for (row, smoothed) in samples.points.iter().zip(&smooth(&samples, 3.0).points) {
            assert!((row[0].unwrap() - smoothed[0].unwrap()).norm() < 1e-9);
        }
    }

    #[test]
    fn a_lone_sample_is_not_smoothed() {
        let samples = Samples { numbers: vec![1], points: vec![vec![Some(Point3::origin())]] };
        assert_eq!(smooth(&samples, 3.0).points[0][0], None);
    }
}
