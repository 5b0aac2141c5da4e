//! Middles that a few wild samples do not move.

use nalgebra::Vector3;

/// The median; 0 of nothing. Reorders the values.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Standard deviation of a normal distribution per axis, from the median length of its 3-vectors: the median of a
/// χ distribution with three degrees of freedom is 1.538.
pub(crate) fn axis_deviation(lengths: &mut [f64]) -> f64 {
    median(lengths) / 1.538
}

/// The point with the smallest sum of distances to the given ones (Weiszfeld's iteration), which turns with them,
/// unlike a median per axis; `None` of nothing.
pub(crate) fn geometric_median(points: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    const ROUNDS: usize = 40;
    if points.is_empty() {
        return None;
    }
    let mut middle = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    for _ in 0..ROUNDS {
        let (mut sum, mut total) = (Vector3::zeros(), 0.0);
        for point in points {
            // The floor (mm) keeps a point that is hit from holding the iteration there.
            let weight = 1.0 / (point - middle).norm().max(1e-3);
            sum += weight * point;
            total += weight;
        }
        let next = sum / total;
        let step = (next - middle).norm();
        middle = next;
        if step < 1e-6 {
            break;
        }
    }
    Some(middle)
}

/// Huber's mean [Huber1964]: samples further than `2 · scale` from it count less, as the inverse of their distance.
pub(crate) fn huber_mean(points: &[Vector3<f64>], scale: f64) -> Option<Vector3<f64>> {
    const ROUNDS: usize = 8;
    let mut mean = geometric_median(points)?;
    for _ in 0..ROUNDS {
        let (mut sum, mut total) = (Vector3::zeros(), 0.0);
        for point in points {
            let weight = huber_weight((point - mean).norm(), 2.0 * scale);
            sum += weight * point;
            total += weight;
        }
        mean = sum / total;
    }
    Some(mean)
}

/// 1 up to the limit, then falling as its inverse.
pub(crate) fn huber_weight(residual: f64, limit: f64) -> f64 {
    if residual <= limit { 1.0 } else { limit / residual }
}

/// Tukey's biweight: 1 at zero, none from the limit on.
pub(crate) fn tukey_weight(residual: f64, limit: f64) -> f64 {
    let x = residual / limit;
    if x >= 1.0 { 0.0 } else { (1.0 - x * x).powi(2) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_of_wild_points_hardly_moves_the_middle() {
        let mut points = vec![Vector3::new(1.0, 2.0, 3.0); 6];
        points.extend([Vector3::new(900.0, 0.0, 0.0); 3]);
        let middle = geometric_median(&points).unwrap();
        assert!((middle - points[0]).norm() < 0.01, "{middle}");
        let mean = huber_mean(&points, 0.1).unwrap();
        assert!((mean - points[0]).norm() < 0.2, "{mean}");
    }
}
