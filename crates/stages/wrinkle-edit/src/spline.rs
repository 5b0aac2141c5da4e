//! Curves through places that somebody picked, and their lengths.

use artifact::{Curve2d, CurveState};
use nalgebra::Vector2;

/// A place in an image, px.
pub(crate) type Place = Vector2<f64>;

/// The control points of the cubic B-spline that passes through places in their order, without curvature at its ends.
///
/// At least two places: with controls C, `(Cᵢ₋₁ + 4 Cᵢ + Cᵢ₊₁)/6 = Pᵢ` at each, and `C₋₁ − 2 C₀ + C₁ = 0` at the ends.
pub(crate) fn through(places: &[Place]) -> Vec<Place> {
    let count = places.len();
    let mut inner = places.to_vec();
    // Thomas's algorithm for the rows (1 4 1) between the first and the last place, which are controls themselves.
    let mut above = vec![0.0; count];
    for i in 1..count - 1 {
        let pivot = 4.0 - above[i - 1];
        above[i] = 1.0 / pivot;
        inner[i] = (6.0 * places[i] - inner[i - 1]) / pivot;
    }
    for i in (1..count - 1).rev() {
        inner[i] = inner[i] - above[i] * inner[i + 1];
    }
    let beyond = |end: usize, next: usize| 2.0 * inner[end] - inner[next];
    let ends = [beyond(0, 1), beyond(count - 1, count - 2)];
    [&ends[..1], &inner, &ends[1..]].concat()
}

/// The curve of these control points, as a person's.
pub(crate) fn drawn(controls: &[Place]) -> Curve2d {
    let controls = controls.iter().map(|control| [control.x, control.y]).collect();
    Curve2d { controls, state: CurveState::Edited, confidence: 1.0, paint: vec![] }
}

/// Steps in which a curve is walked, per span and per pixel of the control polygon.
const STEPS_PER_SPAN: f64 = 8.0;
const STEPS_PER_PX: f64 = 0.5;

/// A curve by its length.
pub(crate) struct Walk<'a> {
    curve: &'a Curve2d,
    /// Parameter and length from the start of places along it.
    knots: Vec<[f64; 2]>,
}

impl<'a> Walk<'a> {
    pub(crate) fn of(curve: &'a Curve2d) -> Self {
        let polygon: f64 = curve.controls.windows(2).map(|pair| distance(pair[0], pair[1])).sum();
        let steps = (STEPS_PER_SPAN * curve.end()).max(STEPS_PER_PX * polygon).ceil();
        let mut knots = vec![[0.0; 2]];
        for step in 1..=steps as usize {
            let u = curve.end() * step as f64 / steps;
            let [before, length] = knots[step - 1];
            knots.push([u, length + arc(curve, before, u)]);
        }
        Self { curve, knots }
    }

    /// Length, px.
    pub(crate) fn len(&self) -> f64 {
        self.knots.last().map_or(0.0, |knot| knot[1])
    }

    /// Parameter, place, and unit vector to the right, at a length from the start.
    pub(crate) fn at(&self, length: f64) -> (f64, [f64; 2], [f64; 2]) {
        let after = self.knots.partition_point(|knot| knot[1] <= length).clamp(1, self.knots.len() - 1);
        let [from, to] = [self.knots[after - 1], self.knots[after]];
        let share = ((length - from[1]) / (to[1] - from[1]).max(1e-12)).clamp(0.0, 1.0);
        let u = from[0] + share * (to[0] - from[0]);
        let along = Place::from(self.curve.derivative(u)).try_normalize(1e-12).unwrap_or_else(Place::x);
        (u, self.curve.at(u), [-along.y, along.x])
    }
}

/// Length between two near parameters, by Gauss's rule of two points.
fn arc(curve: &Curve2d, from: f64, to: f64) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let speed = |side: f64| Place::from(curve.derivative(middle + side * half / 3.0f64.sqrt())).norm();
    half * (speed(-1.0) + speed(1.0))
}

fn distance(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[0] - from[0]).hypot(to[1] - from[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_passes_through_its_places() {
        let places = [[0.0, 0.0], [10.0, 8.0], [25.0, 3.0], [40.0, 9.0], [60.0, 0.0]].map(Place::from);
        for count in 2..=places.len() {
            let curve = drawn(&through(&places[..count]));
            assert_eq!(curve.controls.len(), count + 2);
            for (i, place) in places[..count].iter().enumerate() {
                assert!((Place::from(curve.at(i as f64)) - place).norm() < 1e-12, "{count} {i}");
            }
        }
    }

    #[test]
    fn an_arc_is_as_long_as_it_is() {
        let places: Vec<Place> = (0..=20)
            .map(|i| 50.0 * Place::new((0.1 * f64::from(i)).cos(), (0.1 * f64::from(i)).sin()))
            .collect();
        let curve = drawn(&through(&places));
        let walk = Walk::of(&curve);
        assert!((walk.len() - 100.0).abs() < 0.01, "{}", walk.len());
        let (_, at, right) = walk.at(walk.len() / 2.0);
        // y runs down, so that growing angles turn right, and the centre lies there.
        assert!((Place::from(at) + 50.0 * Place::from(right)).norm() < 0.05);
    }
}
