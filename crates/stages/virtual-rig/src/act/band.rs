//! Motion within a band of frequencies: sums of a few sines, the same for the same seed.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Sines in a sum: few enough that the sum comes near its bounds now and then.
const SINES: usize = 3;

/// A smooth function of time between −1 and 1, with all its frequencies within a band.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Band {
    /// (amplitude, rad/s, phase)
    sines: [(f64, f64, f64); SINES],
}

impl Band {
    /// A function of a seed and a channel; each third of the band (Hz) has one frequency, drawn evenly by pitch.
    pub(super) fn new(seed: u64, channel: u64, [low, high]: [f64; 2]) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(channel);
        let pitch = (high / low).powf(1.0 / SINES as f64);
        let drawn: [(f64, f64, f64); SINES] = std::array::from_fn(|third| {
            let frequency = low * pitch.powf(third as f64 + rng.random_range(0.0..1.0));
            // Slower swings are wider.
            let amplitude = rng.random_range(0.6..1.0) * low / frequency;
            (amplitude, TAU * frequency, rng.random_range(0.0..TAU))
        });
        let total: f64 = drawn.iter().map(|sine| sine.0).sum();
        Self { sines: drawn.map(|(amplitude, pulse, phase)| (amplitude / total, pulse, phase)) }
    }

    /// The value at a time.
    pub(super) fn at(&self, time_s: f64) -> f64 {
        self.sines.iter().map(|(amplitude, pulse, phase)| amplitude * (pulse * time_s + phase).sin()).sum()
    }

    /// The value at a time, shifted to 0 at time 0 and scaled to stay between −1 and 1.
    pub(super) fn since_rest(&self, time_s: f64) -> f64 {
        let rest = self.at(0.0);
        (self.at(time_s) - rest) / (1.0 + rest.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounded_moving_and_of_its_seed() {
        let band = Band::new(7, 0, [2.0, 6.0]);
        let values: Vec<f64> = (0..4000).map(|i| band.at(f64::from(i) * 0.005)).collect();
        assert!(values.iter().all(|x| x.abs() <= 1.0));
        assert!(values.iter().fold(0.0f64, |most, x| most.max(x.abs())) > 0.7);
        assert_eq!(band, Band::new(7, 0, [2.0, 6.0]));
        assert_ne!(band, Band::new(7, 1, [2.0, 6.0]));
        assert_ne!(band, Band::new(8, 0, [2.0, 6.0]));
    }

    #[test]
    fn frequencies_stay_in_the_band() {
        for seed in 0..50 {
            let band = Band::new(seed, 3, [2.0, 6.0]);
            assert!(band.sines.iter().all(|sine| (2.0..=6.0).contains(&(sine.1 / TAU))), "{band:?}");
        }
    }

    #[test]
    fn rest_is_at_time_zero() {
        let band = Band::new(1, 2, [0.2, 0.6]);
        assert_eq!(band.since_rest(0.0), 0.0);
        assert!((0..1000).all(|i| band.since_rest(f64::from(i) * 0.1).abs() <= 1.0));
    }
}
