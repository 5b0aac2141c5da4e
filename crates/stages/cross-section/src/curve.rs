//! The first curve of a wrinkle, by its length.

use artifact::Curve2d;
use nalgebra::Vector2;

/// Steps in which a curve is walked, px, at most.
const STEP: f64 = 3.0;

/// A place beside a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Length along the curve, px.
    pub x: f64,
    /// Distance from it, px; positive on its right.
    pub p: f64,
}

/// A uniform cubic B-spline in the image with the lengths of its parts.
#[derive(Debug, Clone)]
pub struct Curve {
    spline: Curve2d,
    /// Parameter, place and length from the start of places along it.
    knots: Vec<Knot>,
}

#[derive(Debug, Clone, Copy)]
struct Knot {
    u: f64,
    at: Vector2<f64>,
    x: f64,
}

impl Curve {
    /// None where the curve has no length.
    #[must_use]
    pub fn of(curve: &Curve2d) -> Option<Self> {
        let hull: f64 = curve.controls.windows(2).map(|pair| (place(pair[1]) - place(pair[0])).norm()).sum();
        if curve.controls.len() < 4 || !hull.is_finite() || hull > MOST {
            return None;
        }
        let mut curve = Self { spline: Curve2d { paint: Vec::new(), ..curve.clone() }, knots: Vec::new() };
        let spans = curve.spline.end();
        let count = (hull / STEP).ceil().max(2.0 * spans);
        let mut x = 0.0;
        for i in 0..=count as usize {
            let u = spans * i as f64 / count;
            if let Some(last) = curve.knots.last() {
                x += curve.length(last.u, u);
            }
            curve.knots.push(Knot { u, at: place(curve.spline.at(u)), x });
        }
        (x > 1.0).then_some(curve)
    }

    /// Length, px.
    #[must_use]
    pub fn len(&self) -> f64 {
        self.knots.last().map_or(0.0, |knot| knot.x)
    }

    /// Parameter, place, and unit vector to the right, at a length from the start.
    #[must_use]
    pub fn at(&self, x: f64) -> (f64, Vector2<f64>, Vector2<f64>) {
        let after = self.knots.partition_point(|knot| knot.x <= x).clamp(1, self.knots.len() - 1);
        let [from, to] = [self.knots[after - 1], self.knots[after]];
        let share = ((x - from.x) / (to.x - from.x).max(1e-12)).clamp(0.0, 1.0);
        let u = from.u + share * (to.u - from.u);
        let along = self.tangent(u).try_normalize(1e-12).unwrap_or_else(Vector2::x);
        (u, place(self.spline.at(u)), Vector2::new(-along.y, along.x))
    }

    /// The nearest place of the curve; none for places beyond its ends.
    #[must_use]
    pub fn foot(&self, from: Vector2<f64>) -> Option<Foot> {
        let far = |knot: &Knot| (knot.at - from).norm_squared();
        let (nearest, _) = self
            .knots
            .iter()
            .enumerate()
            .map(|(i, knot)| (i, far(knot)))
            .reduce(|best, other| if other.1 < best.1 { other } else { best })?;
        let spans = self.spline.end();
        let mut u = self.knots[nearest].u;
        for _ in 0..3 {
            let inside = u.clamp(0.0, spans);
            let (off, tangent) = (place(self.spline.at(inside)) - from, self.tangent(inside));
            let curvature = tangent.norm_squared() + off.dot(&self.bend(inside));
            // Beyond the centre of curvature there is no nearest place.
            u -= off.dot(&tangent) / curvature.max(0.2 * tangent.norm_squared());
        }
        if !(0.0..=spans).contains(&u) {
            return None;
        }
        let along = self.tangent(u).try_normalize(1e-12)?;
        let off = from - place(self.spline.at(u));
        let p = off.dot(&Vector2::new(-along.y, along.x));
        // A place whose search ran astray is off along the curve too.
        (off.dot(&along).abs() < 0.1).then_some(Foot { x: self.length_to(u), p })
    }

    /// Length from the start to a parameter.
    fn length_to(&self, u: f64) -> f64 {
        let after = self.knots.partition_point(|knot| knot.u <= u).clamp(1, self.knots.len() - 1);
        let [from, to] = [self.knots[after - 1], self.knots[after]];
        from.x + (to.x - from.x) * (u - from.u) / (to.u - from.u)
    }

    /// Length between two near parameters, by Gauss's rule of two points.
    fn length(&self, from: f64, to: f64) -> f64 {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let speed = |side: f64| self.tangent(middle + side * half / 3.0f64.sqrt()).norm();
        half * (speed(-1.0) + speed(1.0))
    }

    fn tangent(&self, u: f64) -> Vector2<f64> {
        place(self.spline.derivative(u))
    }

    /// The second derivative by the parameter: linear between the second differences of the control points.
    fn bend(&self, u: f64) -> Vector2<f64> {
        let controls = &self.spline.controls;
        let span = (u as usize).min(controls.len() - 4);
        let difference =
            |k: usize| place(controls[k]) - 2.0 * place(controls[k + 1]) + place(controls[k + 2]);
        difference(span).lerp(&difference(span + 1), u - span as f64)
    }
}

fn place(at: [f64; 2]) -> Vector2<f64> {
    at.into()
}

/// No curve in an image is longer, px.
const MOST: f64 = 1e5;

#[cfg(test)]
mod tests {
    use super::*;
    use artifact::CurveState;

    fn arc(radius: f64) -> Curve {
        let control = |i: i32| {
            let angle = 0.1 * f64::from(i);
            [200.0 + radius * angle.sin(), 300.0 - radius * angle.cos()]
        };
        let controls = (0..12).map(control).collect();
        Curve::of(&Curve2d { controls, state: CurveState::Seen, confidence: 1.0, paint: vec![] }).unwrap()
    }

    #[test]
    fn feet_are_where_places_came_from() {
        let curve = arc(80.0);
        for x in [1.0, 20.0, 41.3, 60.0] {
            for p in [-20.0, -3.0, 0.5, 15.0] {
                let (_, at, right) = curve.at(x);
                let foot = curve.foot(at + p * right).unwrap();
                assert!((foot.x - x).abs() < 0.02 && (foot.p - p).abs() < 1e-3, "{x} {p}: {foot:?}");
            }
        }
    }

    #[test]
    fn an_arc_has_its_length_and_its_right_side_inwards() {
        let curve = arc(80.0);
        // A B-spline lies 1/6 of the second difference inside its controls.
        let radius = 80.0 * (1.0 - (1.0 - 0.1f64.cos()) / 3.0);
        assert!((curve.len() - 0.9 * radius).abs() < 0.02, "{}", curve.len());
        let (_, at, right) = curve.at(30.0);
        assert!(((at + radius * right) - Vector2::new(200.0, 300.0)).norm() < 0.2);
    }

    #[test]
    fn beyond_the_ends_there_is_no_foot() {
        let curve = arc(80.0);
        let (_, start, right) = curve.at(0.0);
        assert!(curve.foot(start + Vector2::new(right.y, -right.x) * -3.0).is_none());
    }
}
