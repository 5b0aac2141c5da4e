//! Smooth random fields on the plane.

use crate::body::face::profile::smooth_step;

/// Value noise from −1 to 1 with one free value per unit of the lattice; the same seed gives the same field.
pub(crate) fn noise(seed: u64, x: f64, y: f64) -> f64 {
    let (column, row) = (x.floor(), y.floor());
    let (u, v) = (smooth_step(x - column), smooth_step(y - row));
    let value = |i: i64, j: i64| lattice(seed, column as i64 + i, row as i64 + j);
    let low = value(0, 0) + (value(1, 0) - value(0, 0)) * u;
    let high = value(0, 1) + (value(1, 1) - value(0, 1)) * u;
    low + (high - low) * v
}

/// A number from −1 to 1 for a point of the lattice (the finalizer of SplitMix64).
fn lattice(seed: u64, i: i64, j: i64) -> f64 {
    let mut bits = seed
        ^ (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ (j as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f).rotate_left(31);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^= bits >> 31;
    (bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

#[cfg(test)]
mod tests {
    use super::noise;

    #[test]
    fn is_bounded_without_mean_and_continuous() {
        let values: Vec<f64> = (0..10_000)
            .map(|i| noise(3, f64::from(i % 100) * 0.37, f64::from(i / 100) * 0.41 - 20.0))
            .collect();
        assert!(values.iter().all(|value| value.abs() <= 1.0));
        assert!(values.iter().sum::<f64>().abs() / 1e4 < 0.05);
        for i in 0..1000 {
            let x = f64::from(i) * 0.01 - 5.0;
            assert!((noise(3, x, 0.3) - noise(3, x + 1e-4, 0.3)).abs() < 1e-3);
        }
    }
}
