//! Width and form of the sections along one line.

use crate::wrinkle::lines::WrinkleLine;
use crate::wrinkle::params::{Family, Params};
use crate::wrinkle::profile::Shape;
use crate::wrinkle::smooth::smooth_step;
use crate::wrinkle::wave::Wave;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Share of a line over which each of its ends tapers.
const TAPER_SHARE: f64 = 0.3;
/// No end tapers over more than this, mm.
const TAPER_MAX: f64 = 14.0;
/// Width at the very ends as a share of that in the core.
const END_WIDTH: f64 = 0.6;
/// How much the width of a line varies at variation 1, as a share.
const WIDTH_RANGE: f64 = 0.28;

/// What a line's seed decides.
pub(super) struct Form {
    family: Family,
    width: f64,
    is_fixed: bool,
    length: f64,
    variation: f64,
    /// For width and form, in this order.
    waves: [Wave; 4],
    /// Four numbers from −1 to 1 that make this line's form differ from others'.
    traits: [f64; 4],
}

impl Form {
    pub(super) fn of(line: &WrinkleLine, params: &Params, length: f64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(line.seed);
        let traits = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
        let waves = std::array::from_fn(|_| Wave::new(rng.random(), 8.0, 45.0));
        let width = params.fixed.map_or(line.width_mm, |fixed| fixed.w_mm);
        let (family, is_fixed) = (params.family, params.fixed.is_some());
        Self { family, width, is_fixed, length, variation: line.variation, waves, traits }
    }

    /// Which share of the compression a fold takes up: 1 in the core, 0 at the ends.
    pub(super) fn uptake(&self, x: f64) -> f64 {
        let taper = (TAPER_SHARE * self.length).min(TAPER_MAX);
        // Depth goes with the root of this.
        (smooth_step(x / taper) * smooth_step((self.length - x) / taper)).powi(2)
    }

    pub(super) fn width(&self, x: f64) -> f64 {
        if self.is_fixed {
            return self.width;
        }
        let slender = END_WIDTH + (1.0 - END_WIDTH) * self.uptake(x).sqrt();
        self.width * slender * (1.0 + WIDTH_RANGE * self.wave(0, x))
    }

    pub(super) fn shape(&self, x: f64) -> Shape {
        let trait_at = |i: usize| self.traits[i] + 0.5 * self.wave(i.min(2) + 1, x);
        match self.family {
            Family::S => Shape::S,
            Family::Rounded => {
                Shape::Rounded { epsilon: 0.3 + 0.12 * trait_at(0), kappa: 0.22 * trait_at(1) }
            }
            Family::Foreign => Shape::Foreign {
                valley: [0.52 + 0.055 * trait_at(0), 0.52 + 0.055 * trait_at(1)],
                bulge: [2.0 + 0.22 * trait_at(2), 2.0 + 0.22 * trait_at(3)],
            },
        }
    }

    fn wave(&self, which: usize, x: f64) -> f64 {
        self.variation * self.waves[which].at(x)
    }
}
