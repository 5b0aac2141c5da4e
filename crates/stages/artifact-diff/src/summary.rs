//! Many differences in a few numbers.

use serde::Serialize;

/// What a set of differences comes to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// How many differences.
    pub count: u64,
    /// Mean.
    pub mean: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// 95 % of the differences are at most this (nearest rank).
    pub p95: f64,
    /// Largest.
    pub max: f64,
    /// Where the largest is: the first such place; empty where nothing differs.
    pub max_at: String,
}

impl Summary {
    /// Summarises differences in memory; `place` names the place of the i-th.
    #[must_use]
    pub fn of(differences: &[f64], place: impl Fn(usize) -> String) -> Self {
        let mut running = Moments::default();
        differences.iter().for_each(|&difference| running.add(difference));
        let mut ranked = differences.to_vec();
        let p95 = match differences.len() {
            0 => 0.0,
            count => *ranked.select_nth_unstable_by(rank95(count as u64) as usize, f64::total_cmp).1,
        };
        let first_max = differences.iter().position(|&difference| difference == running.max);
        running.summary(p95, first_max.map(place).unwrap_or_default())
    }
}

/// Index of the 95th percentile in rising order, by nearest rank.
pub(crate) fn rank95(count: u64) -> u64 {
    (count * 95).div_ceil(100).saturating_sub(1)
}

/// Count, sums and maximum, one difference at a time.
#[derive(Debug, Clone, Default)]
pub(crate) struct Moments {
    pub(crate) count: u64,
    sum: f64,
    square_sum: f64,
    pub(crate) max: f64,
}

impl Moments {
    /// Differences are never negative.
    pub(crate) fn add(&mut self, difference: f64) {
        self.count += 1;
        self.sum += difference;
        self.square_sum += difference * difference;
        self.max = self.max.max(difference);
    }

    pub(crate) fn absorb(&mut self, other: &Self) {
        self.count += other.count;
        self.sum += other.sum;
        self.square_sum += other.square_sum;
        self.max = self.max.max(other.max);
    }

    /// Where nothing differs, no place is the worst.
    pub(crate) fn summary(&self, p95: f64, max_at: String) -> Summary {
        let max_at = if self.max > 0.0 { max_at } else { String::new() };
        let count = self.count.max(1) as f64;
        let (mean, rms) = (self.sum / count, (self.square_sum / count).sqrt());
        Summary { count: self.count, mean, rms, p95, max: self.max, max_at }
    }
}
