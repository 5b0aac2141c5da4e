//! Profiles of valleys: height over the distance from the crease.

/// The rounded, asymmetric profile: `z(p) = D (ũ − 1) e^(−ũ)`, `ũ = √((p / (w_s (1 ± κ)))² + ε²)`; with ε = κ = 0 it is the
/// paper's `S(p) = d (|p|/w − 1) e^(−|p|/w)` [BickelBotsch2007, Eq. 6].
///
/// Lengths in any unit, the same for all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// Mean distance from the crease to the zero crossings, `w = w_s √(1 − ε²)`.
    pub w: f64,
    /// Depth of the crease below zero, `d = D (1 − ε) e^(−ε)`.
    pub d: f64,
    /// Rounding, 0 ≤ ε < 1.
    pub epsilon: f64,
    /// Asymmetry, −1 < κ < 1; positive where the side p > 0 is the wider one.
    pub kappa: f64,
}

impl Profile {
    /// The paper's profile.
    #[must_use]
    pub fn sharp(w: f64, d: f64) -> Self {
        Self { w, d, epsilon: 0.0, kappa: 0.0 }
    }

    /// Height at a distance p from the crease.
    #[must_use]
    pub fn height(&self, p: f64) -> f64 {
        let side = self.scale() * (1.0 + self.kappa.copysign(self.kappa * p));
        let round = (p / side).hypot(self.epsilon);
        steepness(self.epsilon) * self.d * (round - 1.0) * (-round).exp()
    }

    /// The width scale w_s.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.w / (1.0 - self.epsilon * self.epsilon).sqrt()
    }
}

/// D over d.
fn steepness(epsilon: f64) -> f64 {
    epsilon.exp() / (1.0 - epsilon)
}

/// D / w_s over d / w, and its logarithmic derivative in ε.
pub(crate) fn steepness_of_scale(epsilon: f64) -> (f64, f64) {
    let rest = 1.0 - epsilon * epsilon;
    (rest.sqrt() * steepness(epsilon), 1.0 + 1.0 / (1.0 - epsilon) - epsilon / rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_crosses_zero_at_its_width_and_is_as_deep_as_its_depth() {
        let rounded = Profile { w: 5.0, d: 2.0, epsilon: 0.3, kappa: 0.2 };
        for profile in [Profile::sharp(5.0, 2.0), rounded] {
            assert!((profile.height(0.0) + 2.0).abs() < 1e-12);
            let [right, left] = [1.0 + profile.kappa, 1.0 - profile.kappa].map(|share| share * profile.w);
            assert!(profile.height(right).abs() < 1e-12 && profile.height(-left).abs() < 1e-12);
            assert!((profile.height(0.5 * right) - profile.height(-0.5 * left)).abs() < 1e-12);
        }
        let bulge = 2.0 * (-2.0f64).exp();
        assert!((Profile::sharp(5.0, 2.0).height(10.0) - bulge).abs() < 1e-12);
    }

    #[test]
    fn the_derivative_of_the_steepness_is_right() {
        for epsilon in [0.0, 0.2, 0.5, 0.8] {
            let step = 1e-6;
            let log = |epsilon: f64| steepness_of_scale(epsilon).0.ln();
            let difference = (log(epsilon + step) - log(epsilon - step)) / (2.0 * step);
            assert!((difference - steepness_of_scale(epsilon).1).abs() < 1e-6);
        }
    }
}
