//! How errors are spread: root mean square, mean, percentiles.

/// A pool of non-negative errors, kept whole: percentiles are exact.
#[derive(Debug, Clone, Default)]
pub(super) struct Pool(Vec<f64>);

impl Pool {
    pub(super) fn add(&mut self, error: f64) {
        self.0.push(error);
    }

    pub(super) fn join(&mut self, other: &Self) {
        self.0.extend_from_slice(&other.0);
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// √(Σ e² / n), or `nothing` where the pool is empty.
    pub(super) fn rms(&self, nothing: &str) -> Result<f64, String> {
        self.some(nothing)?;
        Ok((self.0.iter().map(|error| error * error).sum::<f64>() / self.0.len() as f64).sqrt())
    }

    /// The error that a share of all do not exceed, linear between neighbours in order (as NumPy's `percentile`).
    pub(super) fn percentile(&self, share: f64, nothing: &str) -> Result<f64, String> {
        self.some(nothing)?;
        let mut sorted = self.0.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let place = share * (sorted.len() - 1) as f64;
        let (low, high) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
        Ok(low + (high - low) * place.fract())
    }

    pub(super) fn median(&self, nothing: &str) -> Result<f64, String> {
        self.percentile(0.5, nothing)
    }

    pub(super) fn max(&self, nothing: &str) -> Result<f64, String> {
        self.some(nothing)?;
        Ok(self.0.iter().copied().fold(0.0, f64::max))
    }

    fn some(&self, nothing: &str) -> Result<(), String> {
        if self.0.is_empty() { Err(nothing.to_string()) } else { Ok(()) }
    }
}

/// Errors below this count as none in a [`Histogram`]'s percentiles.
const SMALLEST: f64 = 1e-9;
/// Each bin of a [`Histogram`] is this much wider than the last, so a percentile is off by at most half of it.
const STEP: f64 = 1e-3;
/// ln(1e13) / STEP: up to 1e4.
const BINS: usize = 29_934;

/// A pool of non-negative errors too many to keep, such as all vertices of all frames: root mean square, mean and
/// maximum are exact, percentiles within 0.05 %.
#[derive(Debug, Clone)]
pub(super) struct Histogram {
    pub(super) count: usize,
    sum: f64,
    squares: f64,
    max: f64,
    below: usize,
    bins: Vec<u64>,
}

impl Default for Histogram {
    fn default() -> Self {
        Self { count: 0, sum: 0.0, squares: 0.0, max: 0.0, below: 0, bins: vec![0; BINS] }
    }
}

impl Histogram {
    pub(super) fn add(&mut self, error: f64) {
        self.count += 1;
        self.sum += error;
        self.squares += error * error;
        self.max = self.max.max(error);
        match error < SMALLEST {
            true => self.below += 1,
            false => self.bins[(((error / SMALLEST).ln() / STEP) as usize).min(BINS - 1)] += 1,
        }
    }

    pub(super) fn rms(&self, nothing: &str) -> Result<f64, String> {
        self.some(nothing)?;
        Ok((self.squares / self.count as f64).sqrt())
    }

    pub(super) fn mean(&self, nothing: &str) -> Result<f64, String> {
        self.some(nothing)?;
        Ok(self.sum / self.count as f64)
    }

    pub(super) fn max(&self, nothing: &str) -> Result<f64, String> {
        self.some(nothing)?;
        Ok(self.max)
    }

    /// The error that a share of all do not exceed.
    pub(super) fn percentile(&self, share: f64, nothing: &str) -> Result<f64, String> {
        self.some(nothing)?;
        let wanted = (share * self.count as f64).ceil() as u64;
        let mut passed = self.below as u64;
        if passed >= wanted {
            return Ok(0.0);
        }
        for (bin, &count) in self.bins.iter().enumerate() {
            passed += count;
            if passed >= wanted {
                return Ok((SMALLEST * ((bin as f64 + 0.5) * STEP).exp()).min(self.max));
            }
        }
        Ok(self.max)
    }

    fn some(&self, nothing: &str) -> Result<(), String> {
        if self.count == 0 { Err(nothing.to_string()) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_histogram_agrees_with_the_whole_pool() {
        let (mut pool, mut histogram) = (Pool::default(), Histogram::default());
        for i in 0..10_000 {
            let error = 0.01 * (1.0 + f64::from(i)).sqrt() * (1.0 + (f64::from(i) * 0.7).sin());
            pool.add(error);
            histogram.add(error);
        }
        assert_eq!(pool.max("").unwrap(), histogram.max("").unwrap());
        for share in [0.05, 0.5, 0.9, 0.95, 0.999] {
            let (exact, binned) =
                (pool.percentile(share, "").unwrap(), histogram.percentile(share, "").unwrap());
            assert!((exact - binned).abs() <= 2e-3 * exact, "{share}: {exact} and {binned}");
        }
        assert!((pool.rms("").unwrap() - histogram.rms("").unwrap()).abs() < 1e-12);
    }

    #[test]
    fn an_empty_pool_says_why() {
        assert_eq!(Pool::default().rms("nothing was seen"), Err("nothing was seen".to_string()));
        assert!(Histogram::default().percentile(0.5, "x").is_err());
    }
}
