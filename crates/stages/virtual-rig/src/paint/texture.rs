//! Uneven paint.

/// Distances of the lattices of noise, mm, and their shares: what a brush and a sponge leave.
const LATTICES: [(f64, f64); 2] = [(0.9, 0.6), (0.35, 0.8)];
/// Deviation of smoothed noise on a lattice: values even in −1 to 1, and what blending leaves of them.
const SMOOTHED: f64 = 0.429;

/// How a stroke's reflectance varies over it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Texture {
    /// Standard deviation, as a share of the reflectance; 0: even paint.
    pub deviation: f64,
    /// Decides where it is bright.
    pub seed: u64,
}

impl Texture {
    /// The reflectance at a place (mm) over the mean one. Never negative.
    pub(super) fn factor(&self, at: [f64; 2]) -> f64 {
        let octave = |(lattice, (cell, share)): (usize, (f64, f64))| {
            share * self.noise(lattice as u64, at.map(|x| x / cell))
        };
        let sum: f64 = LATTICES.into_iter().enumerate().map(octave).sum();
        (1.0 + self.deviation / SMOOTHED * sum).max(0.0)
    }

    /// Smooth noise between −1 and 1 on a unit lattice.
    fn noise(&self, lattice: u64, [x, y]: [f64; 2]) -> f64 {
        let (i, j) = (x.floor(), y.floor());
        let ease = |v: f64| v * v * (3.0 - 2.0 * v);
        let (u, v) = (ease(x - i), ease(y - j));
        let at = |di: i64, dj: i64| self.value(lattice, [i as i64 + di, j as i64 + dj]);
        let across = |dj: i64| at(0, dj) + u * (at(1, dj) - at(0, dj));
        across(0) + v * (across(1) - across(0))
    }

    /// A value between −1 and 1 that hangs on nothing but the place (SplitMix64).
    fn value(&self, lattice: u64, [i, j]: [i64; 2]) -> f64 {
        let mut state = self.seed.wrapping_add(lattice.wrapping_mul(0xd1b5_4a32_d192_ed03));
        for part in [i as u64, j as u64] {
            state = state.wrapping_add(part).wrapping_add(0x9e37_79b9_7f4a_7c15);
            state = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            state = (state ^ (state >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            state ^= state >> 31;
        }
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_deviates_by_as_much_as_is_said() {
        let texture = Texture { deviation: 0.01, seed: 7 };
        let places = (0..40_000).map(|i| [0.173 * f64::from(i % 200), 0.191 * f64::from(i / 200)]);
        let factors: Vec<f64> = places.map(|at| texture.factor(at)).collect();
        let count = factors.len() as f64;
        let mean = factors.iter().sum::<f64>() / count;
        let deviation = (factors.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt();
        assert!((mean - 1.0).abs() < 1e-3 && (deviation / 0.01 - 1.0).abs() < 0.1, "{mean} {deviation}");
    }

    #[test]
    fn it_is_smooth_and_hangs_on_its_seed() {
        let texture = Texture { deviation: 0.01, seed: 7 };
        for i in 0..1000 {
            let at = [0.0371 * f64::from(i), 0.9];
            let step = texture.factor([at[0] + 1e-4, 0.9]) - texture.factor(at);
            assert!(step.abs() < 1e-4, "{at:?}: {step}");
        }
        assert_ne!(texture.factor([0.5; 2]), Texture { seed: 8, ..texture }.factor([0.5; 2]));
    }
}
