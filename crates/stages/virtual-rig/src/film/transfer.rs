//! From linear light to stored values.

use super::params::Transfer;

/// Steps of the table that a value's code is first looked up in.
const STEPS: usize = 4096;

impl Transfer {
    /// The stored value, 0 to 1, of linear light, which is clamped to 0 to 1.
    #[must_use]
    pub fn encode(self, light: f64) -> f64 {
        let light = light.clamp(0.0, 1.0);
        match self {
            Self::Linear => light,
            Self::Gamma(gamma) => light.powf(gamma.recip()),
            Self::Srgb if light <= 0.003_130_8 => 12.92 * light,
            Self::Srgb => 1.055 * light.powf(1.0 / 2.4) - 0.055,
        }
    }

    /// The linear light of a stored value.
    #[must_use]
    pub fn decode(self, stored: f64) -> f64 {
        match self {
            Self::Linear => stored,
            Self::Gamma(gamma) => stored.powf(gamma),
            Self::Srgb if stored <= 0.040_45 => stored / 12.92,
            Self::Srgb => ((stored + 0.055) / 1.055).powf(2.4),
        }
    }
}

/// The 8-bit codes of linear light, rounded to the nearest as the formula would, without its powers.
pub(super) struct Codes {
    /// The least light of each code; the last is out of reach.
    least: [f32; 257],
    /// The code at the lower end of each of the steps from 0 to 1.
    first: Vec<u8>,
}

impl Codes {
    pub(super) fn of(transfer: Transfer) -> Self {
        let mut least = [f32::INFINITY; 257];
        least[0] = f32::NEG_INFINITY;
        for code in 1..256 {
            least[code] = transfer.decode((code as f64 - 0.5) / 255.0) as f32;
        }
        let code = |light: f32| (least.partition_point(|&least| light >= least) - 1) as u8;
        let first = (0..=STEPS).map(|step| code(step as f32 / STEPS as f32)).collect();
        Self { least, first }
    }

    #[inline(always)]
    pub(super) fn of_light(&self, light: f32) -> u8 {
        let step = ((light * STEPS as f32) as usize).min(STEPS);
        let mut code = self.first[step];
        while light >= self.least[usize::from(code) + 1] {
            code += 1;
        }
        code
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Transfer; 4] = [Transfer::Srgb, Transfer::Linear, Transfer::Gamma(2.2), Transfer::Gamma(0.5)];

    #[test]
    fn mid_values_of_srgb_are_the_standards() {
        for (light, code) in [(0.0, 0.0), (0.003, 9.884), (0.18, 117.646), (0.5, 187.516), (1.0, 255.0)] {
            assert!((255.0 * Transfer::Srgb.encode(light) - code).abs() < 0.01, "{light}");
        }
    }

    #[test]
    fn decoding_undoes_encoding() {
        for (transfer, step) in
            ALL.into_iter().flat_map(|transfer| (0..=255).map(move |step| (transfer, step)))
        {
            let stored = f64::from(step) / 255.0;
            assert!(
                (transfer.encode(transfer.decode(stored)) - stored).abs() < 1e-7,
                "{transfer:?} {stored}"
            );
        }
    }

    #[test]
    fn the_table_gives_the_codes_of_the_formula() {
        for transfer in ALL {
            let codes = Codes::of(transfer);
            for step in -2_000..60_000 {
                let light = f64::from(step) / 50_000.0;
                let exact = 255.0 * transfer.encode(light);
                let off = (f64::from(codes.of_light(light as f32)) - exact).abs();
                assert!(off <= 0.5 + 1e-3, "{transfer:?} {light}");
            }
        }
    }
}
