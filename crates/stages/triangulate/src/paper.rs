//! The paper's filter: one weighted mean of displacements from rest, which smooths less where the motion is large.
//!
//! m'ᵢ(t) = mᵢ(0) + Σ w uⱼ(t+s) / Σ w over neighbours j (the marker itself included) and times s, with u = m(t) − m(0);
//! w falls with the distance at rest, with |s|, and with the range ‖uⱼ(t+s) − uᵢ(t)‖. Fast motion shortens the reach over
//! time.

use crate::affine::NEIGHBORS;
use crate::solve::Solved;
use nalgebra::{Point3, Vector3};

/// Standard deviation of the spatial weight, as a share of the distance to the last neighbour.
const SPATIAL_SHARE: f64 = 0.5;
/// Standard deviation of the range weight, in standard deviations of the marker's noise.
const RANGE: f64 = 3.0;
/// Speed at which the weight over time has half its width, in standard deviations of the noise per frame.
const HALF_SPEED: f64 = 6.0;

/// Each marker's rest place: where it was first seen.
pub(crate) struct Rest {
    places: Vec<Option<Point3<f64>>>,
}

impl Rest {
    pub(crate) fn new(marker_count: usize) -> Self {
        Self { places: vec![None; marker_count] }
    }

    pub(crate) fn see(&mut self, frame: &Solved) {
        for (marker, fix) in frame.fixes() {
            self.places[marker].get_or_insert(fix.position);
        }
    }

    /// The filtered position of a marker in the frame `center` of the window; `sigma` is the standard deviation of the
    /// weight over time, frames.
    pub(crate) fn smooth(
        &self,
        window: &[&Solved],
        center: usize,
        marker: usize,
        sigma: f64,
    ) -> Option<Point3<f64>> {
        let fix = window[center].fix(marker)?;
        let rest = self.places[marker]?;
        let here = fix.position - rest;
        let noise = (fix.covariance.trace() / 3.0).sqrt();
        let neighbors = self.neighbors(marker, &rest);
        let sigma = sigma / (1.0 + self.speed(window, center, marker).norm() / (HALF_SPEED * noise));
        let (mut sum, mut weights) = (Vector3::zeros(), 0.0);
        for solved in window {
            let time = (solved.frame - window[center].frame) as f64 / sigma;
            for (other, near) in &neighbors {
                let (Some(fix), Some(rest)) = (solved.fix(*other), self.places[*other]) else { continue };
                let moved = fix.position - rest;
                let range = (moved - here).norm() / (RANGE * noise);
                let weight = near * (-0.5 * (time * time + range * range)).exp();
                sum += weight * moved;
                weights += weight;
            }
        }
        (weights > 0.0).then(|| rest + sum / weights)
    }

    /// The nearest markers at rest with their spatial weights, the marker itself first.
    fn neighbors(&self, marker: usize, rest: &Point3<f64>) -> Vec<(usize, f64)> {
        let known = self.places.iter().enumerate().filter_map(|(other, place)| Some((other, (*place)?)));
        let mut distances: Vec<(f64, usize)> =
            known.map(|(other, place)| ((place - rest).norm(), other)).collect();
        distances.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        distances.truncate(NEIGHBORS + 1);
        let width = SPATIAL_SHARE * distances.last().map_or(1.0, |(far, _)| far.max(f64::MIN_POSITIVE));
        let weight = |distance: f64| (-0.5 * (distance / width).powi(2)).exp();
        distances.iter().map(|&(d, other)| (other, if other == marker { 1.0 } else { weight(d) })).collect()
    }

    /// mm per frame, over the frames before and after.
    fn speed(&self, window: &[&Solved], center: usize, marker: usize) -> Vector3<f64> {
        let at = |index: Option<usize>| Some(window.get(index?)?.fix(marker)?.position);
        let (before, after) = (at(center.checked_sub(1)), at(Some(center + 1)));
        match (before, after) {
            (Some(before), Some(after)) => (after - before) / 2.0,
            _ => Vector3::zeros(),
        }
    }
}
