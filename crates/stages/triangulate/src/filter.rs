//! The spatio-temporal bilateral filter, on a sliding window.
//!
//! A marker's path near a frame is its neighbours' common motion (their local affine fit, which keeps gradients) plus its own
//! motion against them. Each is averaged over time with weights that fall with the time and with the *range*, the distance
//! in standard deviations of the noise from where the path goes. A rigid motion of the head is common; a blink is own; what
//! moves by more than noise is left as it is.

use crate::affine::{Neighbor, coefficients, nearest};
use crate::point::Fix;
use crate::solve::Solved;
use nalgebra::{Matrix3, Point3, Vector3};

/// Half of the window, in standard deviations of the weight over time.
pub(crate) const REACH: f64 = 2.0;
/// Standard deviation of the range weight, in standard deviations of the noise.
const RANGE: f64 = 2.5;
/// Speed at which the weight over time has half its width, in standard deviations of the noise per frame.
const HALF_SPEED: f64 = 12.0;
/// Rounds of the local fit over time.
const ROUNDS: usize = 3;
/// The least share of the neighbours' weight that a frame must show for their motion to be known there.
const LEAST_SHARE: f64 = 0.5;

/// A value at a time, frames from the window's middle.
type Timed = (f64, Vector3<f64>);

/// The filtered position of a marker in the frame `center` of the window; `sigma` is the standard deviation of the weight
/// over time, frames.
pub(crate) fn smooth(window: &[&Solved], center: usize, marker: usize, sigma: f64) -> Option<Point3<f64>> {
    let fix = window[center].fix(marker)?;
    let others = window[center].fixes().filter(|(other, _)| *other != marker);
    let neighbors = nearest(&fix.position, others.map(|(other, fix)| (other, fix.position)));
    let information = fix.covariance.try_inverse()?;
    let common = Common::of(window, center, neighbors);
    let own = |motion: Vector3<f64>, fix_then: &Fix| fix_then.position - fix.position - motion;
    let (mut shared, mut own_path): (Vec<Timed>, Vec<Timed>) = (Vec::new(), Vec::new());
    for (at, solved) in window.iter().enumerate() {
        let time = (solved.frame - window[center].frame) as f64;
        let Some(motion) = common.motion(window, at) else { continue };
        shared.push((time, motion));
        own_path.extend(solved.fix(marker).map(|fix| (time, own(motion, fix))));
    }
    let noise = common.noise_share();
    let shift = match noise {
        Some(share) => {
            average(&shared, &(information / share), sigma)
                + average(&own_path, &(information / (1.0 + share)), sigma)
        }
        None => average(&own_path, &information, sigma),
    };
    Some(fix.position + shift)
}

/// The neighbours' motion at a place.
struct Common {
    neighbors: Vec<Neighbor>,
    /// None where there are too few neighbours: then nothing is common.
    coefficients: Option<Vec<f64>>,
    /// Where the neighbours are in the middle of the window.
    center: Vec<Point3<f64>>,
}

impl Common {
    fn of(window: &[&Solved], center: usize, neighbors: Vec<Neighbor>) -> Self {
        let place = |neighbor: &Neighbor| window[center].fix(neighbor.marker).map(|fix| fix.position);
        let center = neighbors.iter().filter_map(place).collect();
        Self { coefficients: coefficients(&neighbors), neighbors, center }
    }

    /// Variance of the common motion's end, as a share of a marker's.
    fn noise_share(&self) -> Option<f64> {
        self.coefficients.as_ref().map(|c| c.iter().map(|c| c * c).sum())
    }

    /// How the place moves from the middle of the window to another frame of it.
    fn motion(&self, window: &[&Solved], at: usize) -> Option<Vector3<f64>> {
        let Some(whole) = &self.coefficients else { return Some(Vector3::zeros()) };
        let steps: Vec<Option<Vector3<f64>>> = self
            .neighbors
            .iter()
            .zip(&self.center)
            .map(|(neighbor, center)| Some(window[at].fix(neighbor.marker)?.position - center))
            .collect();
        if steps.iter().all(Option::is_some) {
            return Some(steps.iter().flatten().zip(whole).map(|(step, c)| step * *c).sum());
        }
        let seen = || self.neighbors.iter().zip(&steps).filter_map(|(n, step)| Some((n, (*step)?)));
        let weight: f64 = seen().map(|(neighbor, _)| neighbor.weight).sum();
        if weight < LEAST_SHARE * self.neighbors.iter().map(|neighbor| neighbor.weight).sum::<f64>() {
            return None;
        }
        let there: Vec<Neighbor> = seen().map(|(neighbor, _)| *neighbor).collect();
        Some(seen().zip(coefficients(&there)?).map(|((_, step), c)| step * c).sum())
    }
}

/// Where a path that is 0 at time 0 should be there: a straight line fitted with weights over time and range. `information`
/// is the inverse covariance of a value's noise.
fn average(path: &[Timed], information: &Matrix3<f64>, sigma: f64) -> Vector3<f64> {
    let mut line = (Vector3::zeros(), slope_at_0(path));
    let speed = line.1.dot(&(information * line.1)).sqrt();
    let sigma = sigma / (1.0 + speed / HALF_SPEED);
    for _ in 0..ROUNDS {
        let weight = |time: f64, value: &Vector3<f64>| {
            let off = value - line.0 - line.1 * time;
            let range = off.dot(&(information * off)) / (RANGE * RANGE);
            (-0.5 * (range + (time / sigma).powi(2))).exp()
        };
        line = fit_line(path, weight);
    }
    line.0
}

/// Half the step over the frames before and after, where both are there.
fn slope_at_0(path: &[Timed]) -> Vector3<f64> {
    let at = |wanted: f64| path.iter().find(|(time, _)| *time == wanted).map(|(_, value)| *value);
    match (at(-1.0), at(1.0)) {
        (Some(before), Some(after)) => (after - before) / 2.0,
        _ => Vector3::zeros(),
    }
}

/// Value and slope at time 0 of the weighted straight line; where only one time counts, of a constant.
fn fit_line(path: &[Timed], weight: impl Fn(f64, &Vector3<f64>) -> f64) -> (Vector3<f64>, Vector3<f64>) {
    let (mut w, mut wt, mut wtt) = (0.0, 0.0, 0.0);
    let (mut wv, mut wtv) = (Vector3::zeros(), Vector3::zeros());
    for (time, value) in path {
        let weight = weight(*time, value);
        w += weight;
        wt += weight * time;
        wtt += weight * time * time;
        wv += weight * value;
        wtv += weight * *time * value;
    }
    let determinant = w * wtt - wt * wt;
    // Below this the line is held by samples of next to no weight.
    if determinant <= 1e-3 * w * w {
        return (if w > 0.0 { wv / w } else { Vector3::zeros() }, Vector3::zeros());
    }
    ((wv * wtt - wtv * wt) / determinant, (wtv * w - wv * wt) / determinant)
}
