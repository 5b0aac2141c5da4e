//! What makes one person differ from another: proportions drawn from a seed.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Proportions of a face. Factors are 1 and offsets 0 mm for the average face.
#[derive(Debug, Clone, PartialEq)]
pub struct Person {
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) jaw_width: f64,
    pub(crate) chin: f64,
    pub(crate) chin_drop: f64,
    pub(crate) cheekbone: f64,
    pub(crate) cheek_hollow: f64,
    pub(crate) brow: f64,
    pub(crate) brow_height: f64,
    pub(crate) eye_spacing: f64,
    pub(crate) eye_tilt: f64,
    pub(crate) nose_height: f64,
    pub(crate) nose_width: f64,
    pub(crate) nose_hook: f64,
    pub(crate) nose_tip: f64,
    pub(crate) lip_fullness: f64,
    pub(crate) mouth_half_width: f64,
    pub(crate) forehead_slope: f64,
    /// Amplitudes of four slow waves that make left and right differ, mm.
    pub(crate) asymmetry: [f64; 4],
    /// Pigment of the skin, 0 to 1.
    pub(crate) melanin: f64,
    /// How much a beard darkens the skin.
    pub(crate) beard: f64,
    /// Colour of the iris: 0 blue to 1 brown.
    pub(crate) iris: f64,
    /// Seed of all that is random on the skin.
    pub(crate) seed: u64,
}

impl Person {
    /// The person of a seed; seed 0 is the average face.
    #[must_use]
    pub fn of_seed(seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let spread = if seed == 0 { 0.0 } else { 1.0 };
        let mut vary = |middle: f64, range: f64| middle + spread * range * rng.random_range(-1.0..1.0);
        Self {
            width: vary(1.0, 0.04),
            height: vary(1.0, 0.03),
            jaw_width: vary(1.0, 0.07),
            chin: vary(1.0, 0.4),
            chin_drop: vary(0.0, 3.0),
            cheekbone: vary(1.0, 0.4),
            cheek_hollow: vary(1.0, 0.5),
            brow: vary(1.0, 0.35),
            brow_height: vary(0.0, 1.5),
            eye_spacing: vary(0.0, 1.5),
            eye_tilt: vary(0.05, 0.05),
            nose_height: vary(1.0, 0.14),
            nose_width: vary(1.0, 0.12),
            nose_hook: vary(0.0, 1.5),
            nose_tip: vary(1.0, 0.4),
            lip_fullness: vary(1.0, 0.25),
            mouth_half_width: vary(25.0, 2.0),
            forehead_slope: vary(0.0, 4.0),
            asymmetry: std::array::from_fn(|_| vary(0.0, 0.6)),
            melanin: vary(0.38, 0.38),
            beard: vary(0.07, 0.07),
            iris: vary(0.6, 0.4),
            seed: 0x5eed_5c1f ^ seed,
        }
    }
}
