//! Minimising a patch's energy by Gauss–Newton steps with a line search.
//!
//! Every step has a matrix of its own. Slack edges and triangles ([`crate::slack`]) are two hundred times stiffer on one side of their
//! measure than on the other, so that a matrix from the step before sends vertices many times too far, whatever was learnt
//! since.

use crate::jet::Jets;
use crate::patch::Patch;
use nalgebra::{Point3, Vector3};
use operators::{Factor, FactorError};
use serde::Serialize;

/// Steps, at most, …
const MOST_STEPS: usize = 80;
/// … and where only a start for another descent is wanted.
const GUIDE_STEPS: usize = 16;
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

/// When a descent stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Rule {
    /// When a step moves no vertex by so many mm, or steps shrink so fast that less than half of it is left to go.
    Step(f64),
    /// The same, or after so many steps: what is found is a start for another descent only.
    Guide(f64),
    /// When the energy falls by less than [`PAPER_DECREASE`] of itself.
    Paper,
}

/// How a descent went.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Descent {
    /// Steps, each with a factorisation.
    pub steps: usize,
    /// Times that energy and gradient were found.
    pub evaluations: usize,
    /// Energy at the start.
    pub first_energy: f64,
    /// Energy at the end.
    pub energy: f64,
    /// Longest movement of a vertex in the first step, mm.
    pub first_step_mm: f64,
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
    let mut way = Descent { evaluations: 1, ..Descent::default() };
    let mut factor = None;
    let (mut here, mut there) = (Jets::default(), Jets::default());
    patch.evaluate(points, &mut here);
    (way.first_energy, way.energy) = (here.energy, here.energy);
    let most = if matches!(rule, Rule::Guide(_)) { GUIDE_STEPS } else { MOST_STEPS };
    while way.steps < most && !way.converged {
        let renewed = patch.factor(points, &here, factor.take())?;
        let direction = direction(&renewed, &here.gradient);
        factor = Some(renewed);
        let Some((moved, share)) = search(patch, points, &direction, &here, &mut there, &mut way) else {
            // Down to rounding: nothing is left to gain.
            way.converged = true;
            break;
        };
        *points = moved;
        way.steps += 1;
        let (before_mm, step_mm) = (way.last_step_mm, longest(&direction) * share);
        if way.steps == 1 {
            way.first_step_mm = step_mm;
        }
        (way.energy, way.last_step_mm) = (there.energy, step_mm);
        way.converged = match rule {
            Rule::Step(limit) | Rule::Guide(limit) => share == 1.0 && is_last(step_mm, before_mm, limit),
            Rule::Paper => here.energy - there.energy <= PAPER_DECREASE * here.energy,
        };
        std::mem::swap(&mut here, &mut there);
    }
    Ok(way)
}

/// Whether what is left to go after a step is below the limit, if steps go on shrinking as they did.
fn is_last(step: f64, before: f64, limit: f64) -> bool {
    let left = if step < before { step * step / (before - step) } else { f64::INFINITY };
    step < limit || (step < LAST_STEP * limit && left < LEFT * limit)
}

/// `−H⁻¹ g`, no vertex moving farther than the longest step.
fn direction(factor: &Factor, gradient: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let place = |&unknown: &u32| (unknown as usize / 3, unknown as usize % 3);
    let mut column: Vec<f64> =
        factor.order().iter().map(place).map(|(vertex, axis)| -gradient[vertex][axis]).collect();
    factor.solve_in_place(&mut column, 1);
    let mut direction = vec![Vector3::zeros(); gradient.len()];
    for ((vertex, axis), value) in factor.order().iter().map(place).zip(column) {
        direction[vertex][axis] = value;
    }
    let shorten = LONGEST_STEP_MM / longest(&direction);
    if shorten < 1.0 {
        direction.iter_mut().for_each(|step| *step *= shorten);
    }
    direction
}

/// The points after a share of the direction that brings enough, and the share; `there` is evaluated at them.
fn search(
    patch: &Patch,
    points: &[Point3<f64>],
    direction: &[Vector3<f64>],
    here: &Jets,
    there: &mut Jets,
    way: &mut Descent,
) -> Option<(Vec<Point3<f64>>, f64)> {
    let slope: f64 = direction.iter().zip(&here.gradient).map(|(step, gradient)| step.dot(gradient)).sum();
    let mut share = 1.0;
    for _ in 0..HALVINGS {
        let mut moved = points.to_vec();
        moved.iter_mut().zip(direction).for_each(|(point, step)| *point += step * share);
        patch.evaluate(&moved, there);
        way.evaluations += 1;
        if there.energy <= here.energy + SUFFICIENT * share * slope {
            return Some((moved, share));
        }
        share *= 0.5;
    }
    None
}

fn longest(direction: &[Vector3<f64>]) -> f64 {
    direction.iter().map(Vector3::norm_squared).fold(0.0, f64::max).sqrt()
}
