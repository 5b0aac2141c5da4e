//! Profiles of valleys: height over the distance from the crease [BickelBotsch2007, Sec. 5.2].

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A family of valley profiles: height over the distance p from the crease.
///
/// *s*: `S(p) = d (|p|/w − 1) e^(−|p|/w)` [BickelBotsch2007, Eq. 6]. *rounded*: `z(p) = D (ũ − 1) e^(−ũ)` with
/// `ũ = √((p / (w_s (1 ± κ)))² + ε²)`, `+` on the right side (p > 0); width `w = w_s √(1 − ε²)` and depth `d = D (1 − ε) e^(−ε)`.
/// With ε = κ = 0 it is *s*.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Profile {
    /// The paper's profile, with a sharp crease.
    S,
    /// Rounded at the bottom and of unequal sides.
    Rounded,
}

/// One profile: [`Profile::Rounded`], of which [`Profile::S`] is the one with ε = κ = 0 [BickelBotsch2007, Eq. 6; extended]. Lengths in
/// any unit, the same for all.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ProfileShape {
    /// Width w: from the crease to where the profile crosses the surrounding skin, mean of both sides.
    pub w: f64,
    /// Depth d of the crease; 0 where there is no valley.
    pub d: f64,
    /// Rounding ε, 0 ≤ ε < 1.
    pub epsilon: f64,
    /// Asymmetry κ, −1 < κ < 1: the side p > 0 is 1 + κ as wide, the other 1 − κ.
    pub kappa: f64,
}

impl ProfileShape {
    /// Where the profile crosses the surrounding skin on the side of `p`.
    #[must_use]
    pub fn side(&self, p: f64) -> f64 {
        self.w * if p < 0.0 { 1.0 - self.kappa } else { 1.0 + self.kappa }
    }

    /// Height and outward slope at a signed distance from the crease; below the surrounding skin the height is negative.
    #[must_use]
    pub fn at(&self, p: f64) -> (f64, f64) {
        if self.d == 0.0 {
            return (0.0, 0.0);
        }
        let scale = (1.0 - self.epsilon * self.epsilon).sqrt() / self.side(p);
        let round = (scale * p).hypot(self.epsilon);
        let fall = self.d * (self.epsilon - round).exp() / (1.0 - self.epsilon);
        let lean = if round > 0.0 { scale * scale * p.abs() / round } else { scale };
        ((round - 1.0) * fall, (2.0 - round) * fall * lean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUND: ProfileShape = ProfileShape { w: 1.5, d: 0.6, epsilon: 0.3, kappa: 0.2 };

    #[test]
    fn it_is_as_deep_and_as_wide_as_it_says() {
        assert!((ROUND.at(0.0).0 + 0.6).abs() < 1e-12);
        assert!(ROUND.at(1.5 * 1.2).0.abs() < 1e-12 && ROUND.at(-1.5 * 0.8).0.abs() < 1e-12);
        assert!((ROUND.at(0.9).0 - ROUND.at(-0.6).0).abs() < 1e-12, "half of the way on either side");
        let paper = ProfileShape { epsilon: 0.0, kappa: 0.0, ..ROUND };
        assert!((paper.at(3.0).0 - 0.6 * (-2f64).exp()).abs() < 1e-12, "the bulge is d e⁻² high at 2 w");
        assert!((paper.at(0.0).1 - 2.0 * 0.6 / 1.5).abs() < 1e-12, "the crease is 2 d / w steep");
        assert_eq!(ProfileShape { d: 0.0, w: 0.0, ..ROUND }.at(1.0), (0.0, 0.0), "no valley");
    }

    #[test]
    fn slopes_are_derivatives() {
        for p in [-2.0, -0.7, 0.4, 1.3, 4.0f64] {
            let difference = (ROUND.at(p + 1e-6).0 - ROUND.at(p - 1e-6).0) / 2e-6;
            assert!((difference - p.signum() * ROUND.at(p).1).abs() < 1e-8, "at {p}");
        }
    }
}
