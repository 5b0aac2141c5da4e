//! Levenberg–Marquardt.

use crate::problem::{Normal, Problem};
use nalgebra::DVector;

/// A minimum.
pub(crate) struct Minimum {
    pub(crate) unknowns: Vec<f64>,
    pub(crate) cost: f64,
    /// The equations there.
    pub(crate) normal: Normal,
}

/// Steps down from a start until the cost falls by less than `least`, at most `steps` times.
pub(crate) fn descend(problem: &Problem<'_>, start: &[f64], steps: usize, least: f64) -> Minimum {
    let mut at = start.to_vec();
    problem.clamp(&mut at);
    let (mut cost, mut normal) = problem.normal(&at);
    let mut damping = 1e-3;
    for _ in 0..steps {
        let mut gain = None;
        for _ in 0..6 {
            let Some(trial) = step(problem, &at, &normal, damping) else { break };
            // Nearly all steps are good ones: the equations there are made with the cost.
            let (trial_cost, trial_normal) = problem.normal(&trial);
            if trial_cost < cost {
                gain = Some(cost - trial_cost);
                (at, cost, normal) = (trial, trial_cost, trial_normal);
                damping = (damping * 0.2).max(1e-7);
                break;
            }
            damping = (damping * 6.0).min(1e8);
        }
        if gain.is_none_or(|gain| gain < least) {
            break;
        }
    }
    Minimum { unknowns: at, cost, normal }
}

fn step(problem: &Problem<'_>, at: &[f64], normal: &Normal, damping: f64) -> Option<Vec<f64>> {
    let mut matrix = normal.matrix.clone();
    for k in 0..at.len() {
        matrix[(k, k)] += damping * matrix[(k, k)].max(1e-6);
    }
    let step: DVector<f64> = matrix.cholesky()?.solve(&normal.gradient);
    let mut trial: Vec<f64> = at.iter().zip(step.iter()).map(|(at, step)| at + step).collect();
    problem.clamp(&mut trial);
    trial.iter().all(|x| x.is_finite()).then_some(trial)
}
