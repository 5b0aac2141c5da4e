//! Learning a paint: which cost and kernel fit, how well it is told, and the machine.

use crate::Error;
use crate::params::TrainParams;
use crate::samples::Chosen;
use crate::svm::{Sample, Svm, SvmParams};
use rayon::prelude::*;

/// A paint's machine, and what is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Learnt {
    /// The machine.
    pub machine: Svm,
    /// Cost and kernel, given or found.
    pub c: f64,
    /// The kernel.
    pub gamma: f64,
    /// Share of held-out pixels off the edges that are told rightly, the mean of paint and others.
    pub score: f64,
}

/// What is tried.
const COSTS: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];
const GAMMAS: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
/// Pixels for that: enough to see differences of a share of [`EQUAL`].
const TRIAL_PIXELS: usize = 1200;
const TRIAL_TOLERANCE: f64 = 1e-3;
/// Choices whose scores differ by less are equal; of these the smoothest is taken.
const EQUAL: f64 = 0.002;
/// The image's parts are shared out into so many folds.
const FOLDS: u64 = 5;
/// Of the final machine; decisions are as exact.
const TOLERANCE: f64 = 1e-9;

/// Learns one paint.
///
/// # Errors
/// [`Error::Indistinct`] where the machine tells fewer held-out pixels rightly than `params` ask for; what training refuses.
pub fn learn(paint: &str, chosen: &[Chosen], params: &TrainParams) -> Result<Learnt, Error> {
    let trials: Vec<Chosen> = thinned(chosen, TRIAL_PIXELS);
    let gammas = params.gamma.map_or(GAMMAS.to_vec(), |gamma| vec![gamma]);
    let costs = params.c.map_or(COSTS.to_vec(), |c| vec![c]);
    let pairs: Vec<[f64; 2]> = gammas.iter().flat_map(|gamma| costs.iter().map(|c| [*gamma, *c])).collect();
    let scores: Vec<[f64; 2]> = pairs
        .par_iter()
        .map(|[gamma, c]| held_out(&trials, SvmParams { c: *c, gamma: *gamma, tolerance: TRIAL_TOLERANCE }))
        .collect::<Result<_, Error>>()?;
    let best = scores.iter().map(|score| score[0]).fold(0.0, f64::max);
    // Gammas and costs rise: the first that will do is the smoothest.
    let index = scores.iter().position(|score| score[0] >= best - EQUAL).unwrap_or(0);
    let ([gamma, c], score) = (pairs[index], scores[index][1]);
    if score < params.least_score {
        return Err(Error::Indistinct { paint: paint.to_string(), score, least: params.least_score });
    }
    let samples: Vec<Sample> = chosen.iter().map(|chosen| chosen.sample).collect();
    let machine = Svm::train(&samples, SvmParams { c, gamma, tolerance: TOLERANCE })?;
    Ok(Learnt { machine, c, gamma, score })
}

/// Every so manyth, so that about `most` are left, paint and others alike.
fn thinned(chosen: &[Chosen], most: usize) -> Vec<Chosen> {
    let every = chosen.len().div_ceil(most).max(1);
    chosen.iter().step_by(every).copied().collect()
}

/// The share of pixels told rightly by machines that have not seen their parts of the image, paint and others weighing the same:
/// of all pixels, and of those off the edges.
fn held_out(chosen: &[Chosen], params: SvmParams) -> Result<[f64; 2], Error> {
    let (mut all, mut inner) = (Tally::default(), Tally::default());
    for fold in 0..FOLDS {
        let (held, seen): (Vec<&Chosen>, Vec<&Chosen>) =
            chosen.iter().partition(|chosen| chosen.part % FOLDS == fold);
        let samples: Vec<Sample> = seen.iter().map(|chosen| chosen.sample).collect();
        let machine = match Svm::train(&samples, params) {
            // All of the paint lies in one part.
            Err(Error::OneClass) => continue,
            machine => machine?,
        };
        for one in held {
            let is_right = (machine.decide(one.sample.ratios) > 0.0) == one.sample.paint;
            all.add(one.sample.paint, is_right);
            if !one.on_edge {
                inner.add(one.sample.paint, is_right);
            }
        }
    }
    Ok([all.score(), inner.score()])
}

#[derive(Default)]
struct Tally {
    /// Of other pixels and of paint: rightly told, all.
    counts: [[usize; 2]; 2],
}

impl Tally {
    fn add(&mut self, paint: bool, is_right: bool) {
        let count = &mut self.counts[usize::from(paint)];
        *count = [count[0] + usize::from(is_right), count[1] + 1];
    }

    fn score(&self) -> f64 {
        let share = |[right, all]: [usize; 2]| right as f64 / all.max(1) as f64;
        0.5 * (share(self.counts[0]) + share(self.counts[1]))
    }
}
