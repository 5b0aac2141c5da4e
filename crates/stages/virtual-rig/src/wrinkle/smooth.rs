//! Smooth steps, and smoothing of lists.

use std::ops::{Add, Mul};

/// 0 below 0, 1 above 1, with two vanishing derivatives at each end.
pub(super) fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (x * (6.0 * x - 15.0) + 10.0)
}

/// The derivative of [`smooth_step`].
pub(super) fn smooth_step_slope(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    30.0 * x * x * (1.0 - x) * (1.0 - x)
}

/// One pass of (¼, ½, ¼) over values `stride` apart for each stride. Ends stay; what is linear stays linear.
///
/// Strides 1, 2, 4, … give nearly a Gaussian of variance ½ Σ stride² steps².
pub(super) fn smoothed<T>(values: &[T], strides: &[usize]) -> Vec<T>
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    let mut values = values.to_vec();
    for &stride in strides {
        let before = values.clone();
        for (i, value) in values.iter_mut().enumerate() {
            let step = stride.min(i).min(before.len() - 1 - i);
            *value = before[i] * 0.5 + (before[i - step] + before[i + step]) * 0.25;
        }
    }
    values
}

/// Strides for a standard deviation of about `steps` (at least; none for 0).
pub(super) fn strides(steps: f64) -> Vec<usize> {
    let (mut strides, mut variance, mut stride) = (Vec::new(), 0.0, 1usize);
    while variance < 0.75 * steps * steps {
        strides.push(stride);
        variance += 0.5 * (stride * stride) as f64;
        stride *= 2;
    }
    strides
}

/// The least value within `radius` places.
pub(super) fn eroded(values: &[f64], radius: usize) -> Vec<f64> {
    let window = |i: usize| &values[i.saturating_sub(radius)..(i + radius + 1).min(values.len())];
    (0..values.len()).map(|i| window(i).iter().copied().fold(f64::INFINITY, f64::min)).collect()
}
