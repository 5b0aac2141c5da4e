//! Performances for takes of any length.

use super::timeline::Timeline;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Length of one round of all events, s.
const ROUND_S: f64 = 10.0;
/// Shorter takes show a brow raise with a smile only, s.
const SHORT_S: f64 = 5.0;
/// The face is still for so long, s; in very short takes for a sixth of them.
const STILL_S: f64 = 0.04;
/// A blink closes and opens in 60 ms; it is half closed for 30 ms.
const BLINK: [f64; 3] = [0.03, 0.0, 0.03];

/// What happens in a round: action, start, [rise, hold, fall], strength.
const ROUND: [(&str, f64, [f64; 3], f64); 6] = [
    ("brow_raise", 0.25, [0.35, 0.45, 0.40], 1.0),
    ("frown", 1.65, [0.35, 0.50, 0.35], 1.0),
    ("smile", 3.00, [0.40, 0.70, 0.45], 1.0),
    ("squint", 4.70, [0.25, 0.40, 0.30], 1.0),
    ("jaw", 5.80, [0.30, 0.20, 0.35], 1.0),
    ("speech", 6.80, [0.20, 2.40, 0.30], 1.0),
];
/// When eyes blink in a round.
const BLINKS_S: [f64; 4] = [1.50, 3.60, 6.70, 8.90];
/// How much later or earlier other seeds begin, s; how much weaker they are.
const JITTER_S: f64 = 0.08;
const WEAKER: f64 = 0.15;

impl Timeline {
    /// A performance that fills `length_s`: brow raise, frown, smile, squint, jaw, speech and blinks of 60 ms, again
    /// every ten seconds (takes of five to ten seconds do it faster). Shorter takes raise the brows and smile, strongest
    /// at their end. All weights are 0 for the first 40 ms, or for the first sixth of a take that is shorter than 240 ms.
    #[must_use]
    pub fn standard(length_s: f64, seed: u64) -> Self {
        let timeline = Self { seed, ..Self::default() };
        if length_s < SHORT_S {
            let still = STILL_S.min(length_s / 6.0);
            let rise = [(length_s - still).clamp(0.01, 0.6), length_s, 0.4];
            return timeline.with("brow_raise", still, rise, 1.0).with("smile", still, rise, 0.9);
        }
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut vary = |range: f64| rng.random_range(-range..range);
        let rounds = (length_s / ROUND_S).floor().max(1.0);
        let pace = (length_s / (rounds * ROUND_S)).min(1.0);
        (0..rounds as u32).fold(timeline, |timeline, round| {
            let begin = f64::from(round) * ROUND_S;
            let timeline = ROUND.iter().fold(timeline, |timeline, &(action, start, times, strength)| {
                let start = begin + pace * (start + vary(JITTER_S));
                let weaker = 0.5 * (vary(WEAKER) + WEAKER);
                timeline.with(action, start, times.map(|time| pace * time), strength - weaker)
            });
            BLINKS_S.iter().fold(timeline, |timeline, start| {
                timeline.with("blink", begin + pace * (start + vary(JITTER_S)), BLINK, 1.0)
            })
        })
    }
}
