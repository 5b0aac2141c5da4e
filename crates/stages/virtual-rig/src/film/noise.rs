//! Random numbers that depend on nothing but their address.

use super::params::Sensor;
use std::sync::LazyLock;

/// Linear light of a mid-grey, at which noise is stated.
const MID_GREY: f64 = 0.18;
/// Entries of the table of normal quantiles.
const QUANTILES: usize = 1024;
const QUANTILE_BITS: u32 = QUANTILES.ilog2();

/// Normal quantiles, of variance ½.
static QUANTILE_TABLE: LazyLock<Vec<f32>> = LazyLock::new(quantiles);

/// Which image a noise belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grain {
    /// The take's seed.
    pub seed: u64,
    /// Number of the camera.
    pub camera: u32,
    /// Frame.
    pub frame: i64,
}

/// Shot and read noise of one image.
pub(super) struct Noise {
    key: u64,
    quantiles: &'static [f32],
    read_variance: f32,
    shot_variance_per_light: f32,
}

impl Noise {
    pub(super) fn of(sensor: &Sensor, grain: Grain) -> Self {
        let variance = (MID_GREY * sensor.noise_at_mid_grey).powi(2);
        let key = [grain.seed, u64::from(grain.camera), grain.frame as u64]
            .into_iter()
            .fold(0, |key, part| mix(key ^ part).wrapping_add(part));
        Self {
            key,
            quantiles: &QUANTILE_TABLE,
            read_variance: (0.5 * variance) as f32,
            shot_variance_per_light: (0.5 * variance / MID_GREY) as f32,
        }
    }

    /// The noisy light of a pixel's channels.
    #[inline(always)]
    pub(super) fn add(&self, light: [f32; 3], pixel: u64) -> [f32; 3] {
        let bits = mix(self.key.wrapping_add(pixel.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        std::array::from_fn(|channel| {
            let quantile =
                |index: u32| self.quantiles[(bits >> (QUANTILE_BITS * index)) as usize & (QUANTILES - 1)];
            // The sum of two normal numbers is one, with finer steps and longer tails than the table.
            let normal = quantile(2 * channel as u32) + quantile(2 * channel as u32 + 1);
            let variance = self.read_variance + self.shot_variance_per_light * light[channel].max(0.0);
            light[channel] + variance.sqrt() * normal
        })
    }
}

/// A 64-bit mixer all of whose output bits depend on all input bits (the finaliser of SplitMix64).
#[inline(always)]
fn mix(mut bits: u64) -> u64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

/// Quantiles of the normal distribution in the middles of equal shares, scaled to a variance of ½.
fn quantiles() -> Vec<f32> {
    let raw: Vec<f64> =
        (0..QUANTILES).map(|index| quantile((index as f64 + 0.5) / QUANTILES as f64)).collect();
    let variance = raw.iter().map(|x| x * x).sum::<f64>() / QUANTILES as f64;
    raw.iter().map(|x| (x * (0.5 / variance).sqrt()) as f32).collect()
}

/// The x below which a share of the standard normal distribution lies, by halving.
fn quantile(share: f64) -> f64 {
    let (mut low, mut high) = (-6.0, 6.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        *(if below(middle) < share { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}

/// The share of the standard normal distribution below x: ½ + φ(x) (x + x³/3 + x⁵/(3·5) + …).
fn below(x: f64) -> f64 {
    let (mut term, mut sum) = (x, x);
    for k in 1..120 {
        term *= x * x / f64::from(2 * k + 1);
        sum += term;
    }
    0.5 + sum * (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_the_normal_distributions() {
        for (share, x) in [(0.5, 0.0), (0.841_344_746, 1.0), (0.977_249_868, 2.0), (0.001_349_898, -3.0)] {
            assert!((quantile(share) - x).abs() < 1e-6, "{share}: {}", quantile(share));
        }
    }
}
