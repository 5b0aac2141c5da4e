//! The section across a valley: height over the surface as a function of the distance from the crease.

/// A rounded, asymmetric section [BickelBotsch2007, Sec. 5.2; extended]: `S(p) = D (ũ − 1) e^(−ũ)`,
/// `ũ = √((p / (w_s (1 ± κ)))² + ε²)` with `w = w_s √(1 − ε²)` and `d = D (1 − ε) e^(−ε)`; with ε = κ = 0 it is the paper's
/// S(p).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Profile {
    /// Width w, mm: from the crease to where the section crosses the surrounding skin, mean of both sides.
    pub w_mm: f64,
    /// Depth d of the crease, mm.
    pub d_mm: f64,
    /// Rounding ε, 0 ≤ ε < 1.
    pub epsilon: f64,
    /// Asymmetry κ: the side p > 0 is 1 + κ wide, the other 1 − κ.
    pub kappa: f64,
}

/// Steps of the arc length's integral between the crease and the rim.
const ARC_STEPS: usize = 24;

impl Profile {
    /// Where the section crosses the surrounding skin on the side of `p`, mm.
    #[must_use]
    pub fn side_mm(&self, p: f64) -> f64 {
        self.w_mm * if p < 0.0 { 1.0 - self.kappa } else { 1.0 + self.kappa }
    }

    /// Height and outward slope at a signed distance from the crease, mm.
    #[must_use]
    pub fn at(&self, p: f64) -> (f64, f64) {
        let scale = (1.0 - self.epsilon * self.epsilon).sqrt() / self.side_mm(p);
        let round = (scale * p).hypot(self.epsilon);
        let fall = self.d_mm * (self.epsilon - round).exp() / (1.0 - self.epsilon);
        let lean = if round > 0.0 { scale * scale * p.abs() / round } else { scale };
        ((round - 1.0) * fall, (2.0 - round) * fall * lean)
    }

    /// How much skin, mm, lies between the crease and a distance `p` ≥ 0 on a side (±1).
    #[must_use]
    pub fn arc_mm(&self, p: f64, side: f64) -> f64 {
        let step = p / ARC_STEPS as f64;
        let speed = |i: usize| self.at(side * (i as f64 + 0.5) * step).1.hypot(1.0);
        (0..ARC_STEPS).map(speed).sum::<f64>() * step
    }

    /// The distance from the crease, ≥ 0, up to which there are `arc` mm of skin: the inverse of [`Profile::arc_mm`].
    #[must_use]
    pub fn distance_of_arc(&self, arc: f64, side: f64) -> f64 {
        let mut p = arc;
        for _ in 0..8 {
            let slope = self.at(side * p).1.hypot(1.0);
            p = (p - (self.arc_mm(p, side) - arc) / slope).clamp(0.0, arc);
        }
        p
    }

    /// Between two sections.
    #[must_use]
    pub fn between(&self, other: &Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + share * (b - a);
        Self {
            w_mm: mix(self.w_mm, other.w_mm),
            d_mm: mix(self.d_mm, other.d_mm),
            epsilon: mix(self.epsilon, other.epsilon),
            kappa: mix(self.kappa, other.kappa),
        }
    }
}

/// `3x² − 2x³` between 0 and 1, constant outside.
pub(crate) fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUND: Profile = Profile { w_mm: 1.5, d_mm: 0.6, epsilon: 0.3, kappa: 0.2 };

    #[test]
    fn width_and_depth_are_those_of_the_section() {
        assert!((ROUND.at(0.0).0 + 0.6).abs() < 1e-12);
        assert!(ROUND.at(1.5 * 1.2).0.abs() < 1e-12 && ROUND.at(-1.5 * 0.8).0.abs() < 1e-12);
        let paper = Profile { epsilon: 0.0, kappa: 0.0, ..ROUND };
        assert!((paper.at(3.0).0 - 0.6 * (-2f64).exp()).abs() < 1e-12, "the bulge is d e⁻² high at 2 w");
        assert!((paper.at(0.0).1 - 2.0 * 0.6 / 1.5).abs() < 1e-12, "the crease is 2 d / w steep");
    }

    #[test]
    fn slopes_are_derivatives() {
        for p in [-2.0, -0.7, 0.4, 1.3, 4.0f64] {
            let difference = (ROUND.at(p + 1e-6).0 - ROUND.at(p - 1e-6).0) / 2e-6;
            assert!((difference - p.signum() * ROUND.at(p).1).abs() < 1e-8, "at {p}");
        }
    }

    #[test]
    fn arc_lengths_turn_back_into_distances() {
        for (p, side) in [(0.3, 1.0), (1.0, -1.0), (1.7, 1.0)] {
            let arc = ROUND.arc_mm(p, side);
            assert!(arc > p && (ROUND.distance_of_arc(arc, side) - p).abs() < 1e-6, "{p}");
        }
    }
}
