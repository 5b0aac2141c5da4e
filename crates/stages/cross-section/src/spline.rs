//! Values along a wrinkle, as uniform cubic B-splines of its length.

/// A spline's weights at even stations.
#[derive(Debug, Clone)]
pub(crate) struct Basis {
    /// Number of coefficients.
    pub(crate) count: usize,
    /// Per station its first coefficient and the weights from it on.
    pub(crate) stations: Vec<(usize, [f64; 4])>,
}

impl Basis {
    /// Knots about every `spacing` px over `length` px, at `count` stations from its start to its end.
    pub(crate) fn new(length: f64, spacing: f64, count: usize) -> Self {
        let spans = (length / spacing).round().max(1.0);
        let station = |i: usize| {
            let along = spans * i as f64 / (count - 1).max(1) as f64;
            let first = (along as usize).min(spans as usize - 1);
            (first, weights(along - first as f64))
        };
        Self { count: spans as usize + 3, stations: (0..count).map(station).collect() }
    }

    /// The same value at all stations.
    pub(crate) fn constant(count: usize) -> Self {
        Self { count: 1, stations: vec![(0, [1.0, 0.0, 0.0, 0.0]); count] }
    }

    pub(crate) fn at(&self, station: usize, coefficients: &[f64]) -> f64 {
        let (first, weights) = self.stations[station];
        coefficients[first..].iter().zip(weights).map(|(value, weight)| value * weight).sum()
    }
}

fn weights(v: f64) -> [f64; 4] {
    let w = 1.0 - v;
    [
        w * w * w / 6.0,
        (3.0 * v * v * v - 6.0 * v * v + 4.0) / 6.0,
        (-3.0 * v * v * v + 3.0 * v * v + 3.0 * v + 1.0) / 6.0,
        v * v * v / 6.0,
    ]
}
