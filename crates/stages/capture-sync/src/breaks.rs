//! Where two cameras fall out of step: images were lost, and neither stamps nor numbers tell.
//!
//! The canonical variates of all changes say how likely each exposure is at each lag of whole exposures; the likeliest course
//! of lags that changes seldom is found by dynamic programming [Viterbi1967]. Lost images make the lag jump: up where the
//! camera lost them, down where the other one did.

use crate::canonical::Variate;
use std::ops::RangeInclusive;

/// What a jump of the lag costs, nats. On virtual takes 25 invent no loss; 15 find more single ones, and split some into two.
const JUMP_NATS: f64 = 25.0;
/// Changes of neighbouring exposures overlap and share their noise: so much of their likelihood counts.
const SHARE: f64 = 0.5;
/// An exposure says no more than this, nats: a flicker must not outvote a second of motion.
const MOST_NATS: f64 = 4.0;
/// Places less likely than the best by this, nats, are not where the images were lost.
const PLACE_NATS: f64 = 3.0;

/// A jump of the lag.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Jump {
    /// First exposure after it.
    pub(crate) exposure: i64,
    /// Where else it may be.
    pub(crate) places: RangeInclusive<i64>,
    /// By how many exposures; above 0 where the camera lost images.
    pub(crate) exposures: i64,
    /// How much likelier than none, nats.
    pub(crate) nats: f64,
}

/// How likely each exposure is, by lag: rows of `reach` exposures early to `reach` late.
pub(crate) struct Scores {
    rows: Vec<Vec<f64>>,
}

impl Scores {
    /// `pair`: the changes of both cameras at an exposure and a lag beside the usual, if both are seen.
    pub(crate) fn new<P>(
        count: usize,
        reach: i64,
        variates: &[Variate],
        pair: impl Fn(i64, i64) -> Option<(P, P)>,
    ) -> Self
    where
        P: AsRef<[f64]>,
    {
        let score = |exposure: usize, lag: i64| {
            pair(exposure as i64, lag).map_or(0.0, |(x, y)| {
                let nats: f64 = variates.iter().map(|variate| variate.nats(x.as_ref(), y.as_ref())).sum();
                SHARE * nats.clamp(-MOST_NATS, MOST_NATS)
            })
        };
        let rows = (0..count).map(|n| (-reach..=reach).map(|lag| score(n, lag)).collect()).collect();
        Self { rows }
    }

    /// The jumps of the likeliest course of lags.
    pub(crate) fn jumps(&self) -> Vec<Jump> {
        let course = self.course();
        let ends: Vec<usize> = (1..course.len()).filter(|&n| course[n] != course[n - 1]).collect();
        let jump = |(i, &at): (usize, &usize)| {
            let from = if i == 0 { 0 } else { ends[i - 1] };
            let to = ends.get(i + 1).copied().unwrap_or(course.len());
            self.jump([from, to], [course[at - 1], course[at]])
        };
        ends.iter().enumerate().map(jump).collect()
    }

    /// Per exposure its lag, as a column.
    fn course(&self) -> Vec<usize> {
        let width = self.rows.first().map_or(0, Vec::len);
        let mut best = vec![0.0_f64; width];
        let mut from: Vec<Vec<usize>> = Vec::with_capacity(self.rows.len());
        for row in &self.rows {
            let top = largest(&best);
            let before: Vec<usize> =
                (0..width).map(|lag| if best[top] - JUMP_NATS > best[lag] { top } else { lag }).collect();
            best = (0..width).map(|lag| row[lag] + best[lag].max(best[top] - JUMP_NATS)).collect();
            from.push(before);
        }
        let mut course = vec![0; self.rows.len()];
        let mut lag = largest(&best);
        for n in (0..self.rows.len()).rev() {
            course[n] = lag;
            lag = from[n][lag];
        }
        course
    }

    /// The jump from one lag to another between two exposures, where it is likeliest.
    fn jump(&self, [from, to]: [usize; 2], [before, after]: [usize; 2]) -> Jump {
        let mut nats = vec![0.0];
        for row in &self.rows[from..to] {
            nats.push(nats.last().copied().unwrap_or(0.0) + row[before] - row[after]);
        }
        let best = largest(&nats);
        let place = |i: usize| (from + i) as i64;
        let is_likely = |i: &usize| nats[*i] > nats[best] - PLACE_NATS;
        let first = (0..=best).rev().take_while(is_likely).last().unwrap_or(best);
        let last = (best..nats.len()).take_while(is_likely).last().unwrap_or(best);
        Jump {
            exposure: place(best),
            places: place(first)..=place(last),
            exposures: after as i64 - before as i64,
            nats: nats[best] - nats[0].max(nats[nats.len() - 1]),
        }
    }
}

/// The first of the largest.
fn largest(values: &[f64]) -> usize {
    (0..values.len()).fold(0, |best, i| if values[i] > values[best] { i } else { best })
}
