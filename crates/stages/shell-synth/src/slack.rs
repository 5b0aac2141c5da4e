//! Skin that the large-scale motion shortens or lengthens is not at odds with it.
//!
//! The large-scale motion is measured. A shell whose only rest state is the scan works against it everywhere: over a frown it
//! draws the bridge of the nose inwards by a millimetre, and where the skin is shortened it folds all over, not only beside
//! the valleys. Here a measure q (an edge's length, a triangle's area) that lies between the scan's and the large-scale motion's
//! costs next to nothing: skin that is too long for its place is a store that valleys and bulges draw from, and only what
//! goes beyond is resisted: `(q − [q])² + s (q − q₀)²`, [q] the nearest measure between both, q₀ that of the motion.

/// Stiffness between both measures, as a share of the stiffness beyond.
const WITHIN: f64 = 0.01;

/// What an edge or a triangle may measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Slack {
    low: f64,
    high: f64,
    given: f64,
    within: f64,
}

impl Slack {
    /// One measure only.
    pub(crate) fn none(rest: f64) -> Self {
        Self { low: rest, high: rest, given: rest, within: 0.0 }
    }

    /// Anything between two measures, at ease at that of the motion.
    pub(crate) fn between(rest: f64, given: f64) -> Self {
        Self { low: rest.min(given), high: rest.max(given), given, within: WITHIN }
    }

    /// Energy of a measure, for a weight of 1.
    pub(crate) fn energy(&self, measure: f64) -> f64 {
        let beyond = measure - measure.clamp(self.low, self.high);
        beyond * beyond + self.within * (measure - self.given).powi(2)
    }

    /// The parabola `share · (q − rest)²` with the same derivatives at a measure: (rest, share).
    pub(crate) fn parabola(&self, measure: f64) -> (f64, f64) {
        let nearest = measure.clamp(self.low, self.high);
        match nearest == measure && self.within > 0.0 {
            true => (self.given, self.within),
            false => ((nearest + self.within * self.given) / (1.0 + self.within), 1.0 + self.within),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parabola_has_the_energy_s_derivatives() {
        for slack in [Slack::between(1.0, 0.9), Slack::between(1.0, 1.2), Slack::none(1.0)] {
            for measure in [0.7, 0.95, 1.1, 1.4] {
                let (rest, share) = slack.parabola(measure);
                let slope = (slack.energy(measure + 1e-6) - slack.energy(measure - 1e-6)) / 2e-6;
                assert!((2.0 * share * (measure - rest) - slope).abs() < 1e-9, "{slack:?} at {measure}");
            }
        }
    }

    #[test]
    fn the_motion_without_wrinkles_is_free() {
        assert_eq!(Slack::between(1.0, 0.9).energy(0.9), 0.0);
        assert!(Slack::between(1.0, 0.9).energy(1.0) < 0.011 * Slack::none(0.9).energy(1.0));
    }
}
