//! Skin that the large-scale motion shortens or lengthens is not at odds with it.
//!
//! The large-scale motion is measured. A shell whose only rest state is the scan works against it everywhere: over a frown it
//! draws the bridge of the nose inwards by a millimetre, and where the skin is shortened it folds all over, not only beside
//! the valleys. Here a measure q (an edge's length, a triangle's area) that lies between the scan's and the large-scale motion's
//! costs next to nothing: skin that is too long for its place is a store that valleys and bulges draw from, and only what
//! goes beyond is resisted in full: `(1 − s) (q − [q])² + s (q − q̄)²`, [q] the nearest measure between both, q̄ the scan's, and
//! s a small share. With s = 1 it is the paper's. Over the first half per cent beyond, the square sets in by a cubic.

/// Share of the measure at rest over which the resistance beyond sets in: a step of the stiffness would let Newton's steps circle
/// around it.
const ONSET: f64 = 0.005;

/// What an edge or a triangle may measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Slack {
    rest: f64,
    given: f64,
    share: f64,
    onset: f64,
}

/// An energy and its first and second derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cost {
    pub(crate) energy: f64,
    pub(crate) slope: f64,
    pub(crate) curvature: f64,
}

impl Slack {
    /// Between the measure at rest and that under the motion without wrinkles; `share`: s, above 0 and up to 1.
    pub(crate) fn new(rest: f64, given: f64, share: f64) -> Self {
        Self { rest, given, share, onset: ONSET * rest }
    }

    pub(crate) fn rest(&self) -> f64 {
        self.rest
    }

    /// What a measure costs, for a weight of 1.
    pub(crate) fn cost(&self, measure: f64) -> Cost {
        let beyond = measure - measure.clamp(self.rest.min(self.given), self.rest.max(self.given));
        let (far, onset) = (beyond.abs(), self.onset);
        let [energy, slope, curvature] = match far < onset {
            true => [far * far * far / (3.0 * onset), far * far / onset, 2.0 * far / onset],
            false => [far * far - onset * far + onset * onset / 3.0, 2.0 * far - onset, 2.0],
        };
        let (other, from) = (1.0 - self.share, measure - self.rest);
        Cost {
            energy: other * energy + self.share * from * from,
            slope: other * slope.copysign(beyond) + 2.0 * self.share * from,
            curvature: other * curvature + 2.0 * self.share,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_agree_with_differences() {
        for slack in [Slack::new(1.0, 0.9, 0.01), Slack::new(1.0, 1.2, 0.1), Slack::new(1.0, 0.8, 1.0)] {
            for measure in [0.7, 0.797, 0.897, 0.95, 1.003, 1.1, 1.4] {
                let (up, down) = (slack.cost(measure + 1e-6), slack.cost(measure - 1e-6));
                let cost = slack.cost(measure);
                assert!(
                    (cost.slope - (up.energy - down.energy) / 2e-6).abs() < 1e-9,
                    "{slack:?} at {measure}"
                );
                assert!(
                    (cost.curvature - (up.slope - down.slope) / 2e-6).abs() < 1e-6,
                    "{slack:?} at {measure}"
                );
            }
        }
    }

    #[test]
    fn without_slack_it_is_the_papers() {
        for measure in [0.7, 0.95, 1.3] {
            assert_eq!(Slack::new(1.0, 0.8, 1.0).cost(measure).energy, (measure - 1.0f64).powi(2));
        }
    }

    #[test]
    fn between_both_measures_it_costs_little() {
        let energy = |share: f64| Slack::new(1.0, 0.9, share).cost(0.92).energy;
        assert!(energy(0.01) < 0.011 * energy(1.0));
    }
}
