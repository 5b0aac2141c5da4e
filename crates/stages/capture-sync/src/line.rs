//! Robust lines.

/// y = `at_zero` + `slope` · x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    pub(crate) at_zero: f64,
    pub(crate) slope: f64,
}

/// Rounds of reweighting; the weights stand after a few.
const ROUNDS: usize = 30;

impl Line {
    pub(crate) fn at(&self, x: f64) -> f64 {
        self.at_zero + self.slope * x
    }

    /// The line through points (x, y) with weights: least squares with Huber's reweighting [Huber1964] at 1.345 times the
    /// spread (1.4826 × the median residual). `prior`: an expected slope and its standard deviation, for points whose weight
    /// is 1 / variance. None for less than one point, or one and no prior.
    pub(crate) fn fit(points: &[(f64, f64)], weights: &[f64], prior: Option<(f64, f64)>) -> Option<Self> {
        let mut factors = vec![1.0; points.len()];
        let mut line = least_squares(points, weights, &factors, prior)?;
        for _ in 0..ROUNDS {
            let sizes: Vec<f64> = points
                .iter()
                .zip(weights)
                .map(|((x, y), weight)| (y - line.at(*x)).abs() * weight.sqrt())
                .collect();
            let limit = 1.345 * 1.4826 * median(&sizes);
            if limit <= 1e-12 {
                break;
            }
            factors
                .iter_mut()
                .zip(&sizes)
                .for_each(|(factor, size)| *factor = (limit / size.max(limit)).min(1.0));
            line = least_squares(points, weights, &factors, prior)?;
        }
        Some(line)
    }
}

fn least_squares(
    points: &[(f64, f64)],
    weights: &[f64],
    factors: &[f64],
    prior: Option<(f64, f64)>,
) -> Option<Line> {
    let weight = |i: usize| weights[i] * factors[i];
    let total: f64 = (0..points.len()).map(weight).sum();
    let mean =
        |value: &dyn Fn(usize) -> f64| (0..points.len()).map(|i| weight(i) * value(i)).sum::<f64>() / total;
    let (x, y) = (mean(&|i| points[i].0), mean(&|i| points[i].1));
    let (mut xx, mut xy) = (0.0, 0.0);
    for (i, point) in points.iter().enumerate() {
        xx += weight(i) * (point.0 - x).powi(2);
        xy += weight(i) * (point.0 - x) * (point.1 - y);
    }
    if let Some((slope, sigma)) = prior {
        xx += 1.0 / sigma.powi(2);
        xy += slope / sigma.powi(2);
    }
    let slope = xy / xx;
    (total > 0.0 && slope.is_finite()).then_some(Line { at_zero: y - slope * x, slope })
}

/// The (upper) median; 0 of nothing.
pub(crate) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

/// The lower median: one of the values, so that cameras in step with it are exactly at 0.
pub(crate) fn lower_median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(sorted.len().saturating_sub(1) / 2).copied().unwrap_or(0.0)
}
