//! Minimising a patch's energy: Gauss–Newton far from the minimum, Newton near it.

use crate::energy::Curvature;
use crate::patch::Patch;
use nalgebra::Point3;
use operators::{Factor, FactorError};
use serde::Serialize;

/// Steps, at most.
const MOST_STEPS: usize = 80;
/// From a predicted decrease of this share of the energy on, the exact Hessian is tried, until it is not positive definite once:
/// it seldom is soon after, and finding out costs as much as a step.
const EXACT_FROM: f64 = 1e-3;
/// A step of so many times the limit may be the last if steps shrink fast.
const LAST_STEP: f64 = 5.0;
/// Share of the limit that may be left to go then.
const LEFT: f64 = 0.5;
/// Share of the predicted decrease that a step must bring (Armijo's condition).
const SUFFICIENT: f64 = 1e-4;
/// The paper's relative decrease at which it stops.
const PAPER_DECREASE: f64 = 1e-5;
/// Longest step of a vertex, mm.
const LONGEST_STEP_MM: f64 = 1.0;
/// Halvings of a step before it is given up.
const HALVINGS: usize = 12;

/// When a descent stops, and what it may use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Rule {
    /// Exact Hessians near the minimum, until a step is shorter than so many mm.
    Step(f64),
    /// Gauss–Newton until the energy falls by less than [`PAPER_DECREASE`] of itself.
    Paper,
}

/// How a descent went.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Descent {
    /// Steps.
    pub steps: usize,
    /// Of these, with the exact Hessian.
    pub exact_steps: usize,
    /// Exact Hessians that were not positive definite.
    pub indefinite: usize,
    /// Energy at the start.
    pub first_energy: f64,
    /// Energy at the end.
    pub energy: f64,
    /// Longest movement of a vertex in the last step, mm.
    pub last_step_mm: f64,
    /// Whether it stopped by its rule.
    pub converged: bool,
}

/// Moves the free vertices (the first of `points`) down the energy.
pub(crate) fn minimise(
    patch: &mut Patch,
    points: &mut Vec<Point3<f64>>,
    rule: Rule,
) -> Result<Descent, FactorError> {
    let mut way = Descent::default();
    let mut system = System { order: patch.order(), factor: None };
    let mut exact = false;
    for step_number in 0..MOST_STEPS {
        let (energy, direction, slope, is_exact) = system.direction(patch, points, exact, &mut way)?;
        if step_number == 0 {
            way.first_energy = energy;
        }
        way.energy = energy;
        let Some((moved, lower)) = search(patch, points, &direction, energy, slope) else {
            if is_exact {
                exact = false;
                continue;
            }
            // Down to rounding: nothing is left to gain.
            way.converged = true;
            return Ok(way);
        };
        way.steps += 1;
        way.exact_steps += usize::from(is_exact);
        let (before_mm, step_mm) = (way.last_step_mm, longest(&direction) * moved);
        *points = stepped(points, &direction, moved);
        (way.energy, way.last_step_mm) = (lower, step_mm);
        way.converged = match rule {
            Rule::Step(limit) => moved == 1.0 && is_last(step_mm, before_mm, limit),
            Rule::Paper => energy - lower <= PAPER_DECREASE * energy,
        };
        if way.converged {
            return Ok(way);
        }
        exact = rule != Rule::Paper && way.indefinite == 0 && -0.5 * slope < EXACT_FROM * energy;
    }
    Ok(way)
}

/// Whether a step, after one of `before` mm, leads near enough to the minimum: it is short, or steps shrink so fast that what is left is.
fn is_last(step: f64, before: f64, limit: f64) -> bool {
    let left = if step < before { step * step / (before - step) } else { f64::INFINITY };
    step < limit || (step < LAST_STEP * limit && left < LEFT * limit)
}

/// The linear system of a patch; its factor's pattern is analysed once.
struct System {
    order: Vec<u32>,
    factor: Option<Factor>,
}

impl System {
    /// Energy, direction (per free vertex), the energy's slope along it, and whether it is Newton's own.
    fn direction(
        &mut self,
        patch: &mut Patch,
        points: &[Point3<f64>],
        exact: bool,
        way: &mut Descent,
    ) -> Result<(f64, Vec<f64>, f64, bool), FactorError> {
        if exact {
            let (energy, gradient) = patch.linearise(points, Curvature::Exact);
            match self.factor(patch) {
                Ok(factor) => {
                    let direction = solve(factor, &gradient);
                    let slope = dot(&direction, &gradient);
                    return Ok((energy, direction, slope, true));
                }
                Err(FactorError::NotPositive { .. }) => way.indefinite += 1,
                Err(other) => return Err(other),
            }
        }
        let (energy, gradient) = patch.linearise(points, Curvature::GaussNewton);
        let direction = solve(self.factor(patch)?, &gradient);
        let slope = dot(&direction, &gradient);
        Ok((energy, direction, slope, false))
    }

    fn factor(&mut self, patch: &Patch) -> Result<&Factor, FactorError> {
        let factor = match self.factor.take() {
            Some(mut factor) => {
                let outcome = factor.renew(patch.matrix());
                let factor = self.factor.insert(factor);
                outcome?;
                return Ok(factor);
            }
            None => Factor::new(patch.matrix(), &self.order)?,
        };
        Ok(self.factor.insert(factor))
    }
}

/// `−H⁻¹ g`, no vertex moving farther than the longest step.
fn solve(factor: &Factor, gradient: &[f64]) -> Vec<f64> {
    let mut column: Vec<f64> = factor.order().iter().map(|&unknown| -gradient[unknown as usize]).collect();
    factor.solve_in_place(&mut column, 1);
    let mut direction = vec![0.0; gradient.len()];
    factor.order().iter().zip(&column).for_each(|(&unknown, &value)| direction[unknown as usize] = value);
    let shorten = (LONGEST_STEP_MM / longest(&direction)).min(1.0);
    direction.iter_mut().for_each(|value| *value *= shorten);
    direction
}

/// The share of the direction that brings enough, and the energy there.
fn search(
    patch: &Patch,
    points: &[Point3<f64>],
    direction: &[f64],
    energy: f64,
    slope: f64,
) -> Option<(f64, f64)> {
    let mut share = 1.0;
    for _ in 0..HALVINGS {
        let lower = patch.energy(&stepped(points, direction, share));
        if lower <= energy + SUFFICIENT * share * slope {
            return Some((share, lower));
        }
        share *= 0.5;
    }
    None
}

fn stepped(points: &[Point3<f64>], direction: &[f64], share: f64) -> Vec<Point3<f64>> {
    let mut moved = points.to_vec();
    for (point, step) in moved.iter_mut().zip(direction.chunks_exact(3)) {
        (0..3).for_each(|c| point[c] += share * step[c]);
    }
    moved
}

fn longest(direction: &[f64]) -> f64 {
    direction.chunks_exact(3).map(|d| (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()).fold(0.0, f64::max)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
