//! One-dimensional building blocks: bumps, soft steps, and curves through control points.

/// A Gaussian bump of height 1 and standard deviation 1.
pub(crate) fn bump(x: f64) -> f64 {
    (-0.5 * x * x).exp()
}

/// A round hill of height 1 over the plane.
pub(crate) fn hill(x: f64, y: f64) -> f64 {
    (-0.5 * (x * x + y * y)).exp()
}

/// ln(1 + eˣ): 0 far below, x far above, smooth between.
pub(crate) fn softplus(x: f64) -> f64 {
    if x > 30.0 { x } else { x.exp().ln_1p() }
}

/// The larger of two heights, rounded over a width `k`.
pub(crate) fn smooth_max(a: f64, b: f64, k: f64) -> f64 {
    a + k * softplus((b - a) / k)
}

/// 0 below 0, 1 above 1, with two vanishing derivatives at each end.
pub(crate) fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (x * (6.0 * x - 15.0) + 10.0)
}

/// A curve through control points (abscissae rising) with continuous tangents (Catmull–Rom, unequal spacing), constant
/// beyond them.
pub(crate) fn curve(points: &[(f64, f64)], x: f64) -> f64 {
    let last = points.len() - 1;
    let x = x.clamp(points[0].0, points[last].0);
    let next = points.partition_point(|point| point.0 <= x).min(last);
    let (i, j) = (next - 1, next);
    let slope = |k: usize| match k {
        0 => (points[1].1 - points[0].1) / (points[1].0 - points[0].0),
        k if k == last => (points[k].1 - points[k - 1].1) / (points[k].0 - points[k - 1].0),
        k => (points[k + 1].1 - points[k - 1].1) / (points[k + 1].0 - points[k - 1].0),
    };
    let width = points[j].0 - points[i].0;
    let u = (x - points[i].0) / width;
    let (u2, u3) = (u * u, u * u * u);
    (2.0 * u3 - 3.0 * u2 + 1.0) * points[i].1
        + (u3 - 2.0 * u2 + u) * width * slope(i)
        + (3.0 * u2 - 2.0 * u3) * points[j].1
        + (u3 - u2) * width * slope(j)
}
