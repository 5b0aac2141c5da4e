//! Curves through samples that overshoot nowhere.

/// A curve through samples, monotone wherever they are [FritschButland1984]: one continuous derivative, and never
/// beyond the two samples that it runs between. Before the first and after the last sample it stays.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cubic {
    times: Vec<f64>,
    values: Vec<f64>,
    slopes: Vec<f64>,
}

impl Cubic {
    /// `times` rise strictly and are as many as `values`, at least one.
    pub(super) fn through(times: Vec<f64>, values: Vec<f64>) -> Self {
        let secants: Vec<f64> =
            (1..times.len()).map(|i| (values[i] - values[i - 1]) / (times[i] - times[i - 1])).collect();
        let slopes = (0..times.len())
            .map(|i| match i {
                // The ends are level, so that the curve goes on smoothly where it stays.
                0 => 0.0,
                i if i == secants.len() => 0.0,
                i if secants[i - 1] * secants[i] <= 0.0 => 0.0,
                // A weighted harmonic mean: monotone for any spacing.
                i => {
                    let (before, after) = (times[i] - times[i - 1], times[i + 1] - times[i]);
                    let (w1, w2) = (2.0 * after + before, after + 2.0 * before);
                    (w1 + w2) / (w1 / secants[i - 1] + w2 / secants[i])
                }
            })
            .collect();
        Self { times, values, slopes }
    }

    /// The value at a time.
    pub(super) fn at(&self, time: f64) -> f64 {
        let last = self.times.len() - 1;
        let time = time.clamp(self.times[0], self.times[last]);
        let next = self.times.partition_point(|&sample| sample <= time).clamp(1, last.max(1)).min(last);
        let Some(before) = next.checked_sub(1) else { return self.values[0] };
        let width = self.times[next] - self.times[before];
        let u = (time - self.times[before]) / width;
        let (u2, u3) = (u * u, u * u * u);
        (2.0 * u3 - 3.0 * u2 + 1.0) * self.values[before]
            + (u3 - 2.0 * u2 + u) * width * self.slopes[before]
            + (3.0 * u2 - 2.0 * u3) * self.values[next]
            + (u3 - u2) * width * self.slopes[next]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn stays_between_its_samples(
            values in prop::collection::vec(0.0..1.0f64, 1..12),
            gaps in prop::collection::vec(0.01..2.0f64, 12),
        ) {
            let times: Vec<f64> = gaps.iter().scan(0.0, |at, gap| { *at += gap; Some(*at) }).take(values.len()).collect();
            let curve = Cubic::through(times.clone(), values.clone());
            for (i, &value) in values.iter().enumerate() {
                prop_assert!((curve.at(times[i]) - value).abs() < 1e-12);
            }
            for i in 1..values.len() {
                let (low, high) = (values[i - 1].min(values[i]), values[i - 1].max(values[i]));
                for step in 0..=20 {
                    let x = curve.at(times[i - 1] + (times[i] - times[i - 1]) * f64::from(step) / 20.0);
                    prop_assert!(x >= low - 1e-12 && x <= high + 1e-12);
                }
            }
            prop_assert_eq!(curve.at(-1.0), values[0]);
            prop_assert!((curve.at(1e3) - values[values.len() - 1]).abs() < 1e-12);
        }
    }
}
