//! Skin that the large-scale motion shortens or lengthens is not at odds with it.
//!
//! The large-scale motion is measured. A shell whose only rest state is the scan works against it everywhere: over a frown it
//! draws the bridge of the nose inwards by a millimetre, and where the skin is shortened it folds all over, not only beside
//! the valleys. Here a measure q (an edge's length, a triangle's area) that lies between the scan's and the large-scale motion's
//! costs next to nothing: skin that is too long for its place is a store that valleys and bulges draw from, and only what
//! goes beyond is resisted in full: `(1 − s) (q − [q])² + s (q − q̄)²`, [q] the nearest measure between both, q̄ the scan's, and
//! s a small share. With s = 1 it is the paper's.

/// What an edge or a triangle may measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Slack {
    rest: f64,
    given: f64,
    share: f64,
}

impl Slack {
    /// Between the measure at rest and that under the motion without wrinkles; `share`: s, above 0 and up to 1.
    pub(crate) fn new(rest: f64, given: f64, share: f64) -> Self {
        Self { rest, given, share }
    }

    pub(crate) fn rest(&self) -> f64 {
        self.rest
    }

    fn nearest(&self, measure: f64) -> f64 {
        measure.clamp(self.rest.min(self.given), self.rest.max(self.given))
    }

    /// Energy of a measure, for a weight of 1.
    pub(crate) fn energy(&self, measure: f64) -> f64 {
        let beyond = measure - self.nearest(measure);
        (1.0 - self.share) * beyond * beyond + self.share * (measure - self.rest).powi(2)
    }

    /// The parabola `weight · (q − rest)²` with the same derivatives at a measure: (rest, weight).
    pub(crate) fn parabola(&self, measure: f64) -> (f64, f64) {
        let nearest = self.nearest(measure);
        match nearest == measure {
            true => (self.rest, self.share),
            false => (nearest + self.share * (self.rest - nearest), 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parabola_has_the_energy_s_derivatives() {
        for slack in [Slack::new(1.0, 0.9, 0.01), Slack::new(1.0, 1.2, 0.1), Slack::new(1.0, 0.8, 1.0)] {
            for measure in [0.7, 0.95, 1.1, 1.4] {
                let (rest, weight) = slack.parabola(measure);
                let slope = (slack.energy(measure + 1e-6) - slack.energy(measure - 1e-6)) / 2e-6;
                assert!((2.0 * weight * (measure - rest) - slope).abs() < 1e-9, "{slack:?} at {measure}");
            }
        }
    }

    #[test]
    fn without_slack_it_is_the_papers() {
        for measure in [0.7, 0.95, 1.3] {
            assert_eq!(Slack::new(1.0, 0.8, 1.0).energy(measure), (measure - 1.0f64).powi(2));
        }
    }

    #[test]
    fn between_both_measures_it_costs_little() {
        assert!(Slack::new(1.0, 0.9, 0.01).energy(0.92) < 0.011 * Slack::new(1.0, 0.9, 1.0).energy(0.92));
    }
}
