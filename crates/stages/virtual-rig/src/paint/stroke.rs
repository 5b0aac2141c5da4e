//! A stroke of wrinkle paint.

use super::edge::{Edge, Softness, Spot, share_between};
use super::{Paint, Texture};

/// A half-width that changes linearly between knots along the line and is constant beyond the outer ones.
#[derive(Debug, Clone, PartialEq)]
pub struct HalfWidth {
    /// (x, half-width), mm, with x rising.
    knots: Vec<[f64; 2]>,
}

impl HalfWidth {
    /// The half-width through knots (x, half-width) in mm; they are sorted by x.
    ///
    /// # Panics
    /// Without knots.
    #[must_use]
    pub fn through(mut knots: Vec<[f64; 2]>) -> Self {
        assert!(!knots.is_empty(), "a width needs a knot");
        knots.sort_by(|one, other| one[0].total_cmp(&other[0]));
        Self { knots }
    }

    /// The half-width at x, mm.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        self.value_and_slope(x)[0]
    }

    /// The largest half-width, mm.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.knots.iter().map(|knot| knot[1]).fold(0.0, f64::max)
    }

    /// The largest half-width between two x, mm.
    fn largest_in(&self, from: f64, to: f64) -> f64 {
        let inner = self.knots.iter().filter(|knot| from < knot[0] && knot[0] < to).map(|knot| knot[1]);
        inner.fold(self.at(from).max(self.at(to)), f64::max)
    }

    fn value_and_slope(&self, x: f64) -> [f64; 2] {
        let after = self.knots.partition_point(|knot| knot[0] <= x);
        if after == 0 {
            return [self.knots[0][1], 0.0];
        }
        let Some(&[x1, w1]) = self.knots.get(after) else { return [self.knots[after - 1][1], 0.0] };
        let [x0, w0] = self.knots[after - 1];
        let slope = (w1 - w0) / (x1 - x0);
        [w0 + slope * (x - x0), slope]
    }
}

/// Paint along a wrinkle line, in the line's coordinates on the skin at rest: x along it, p across it, mm. It covers
/// −left(x) ≤ p ≤ right(x) for x in its range, except for missing stretches.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    /// Name of the wrinkle line.
    pub id: String,
    /// Its paint.
    pub paint: Paint,
    /// Half-width on the side of negative p.
    pub left: HalfWidth,
    /// Half-width on the side of positive p.
    pub right: HalfWidth,
    /// Where along the line it starts and ends, mm.
    pub range: [f64; 2],
    /// Stretches of x without paint, mm.
    pub missing: Vec<[f64; 2]>,
    /// Over which width its edges fade, mm; 0 is sharp. The paint covers half in the middle of the fading.
    pub smear_mm: f64,
    /// How uneven it is.
    pub texture: Texture,
}

impl Stroke {
    /// The paint at a place (x, p), mm.
    pub(crate) fn paint_at(&self, at: [f64; 2]) -> Paint {
        match self.texture.deviation {
            0.0 => self.paint,
            _ => {
                let factor = self.texture.factor(at) as f32;
                self.paint.map(|channel| channel * factor)
            }
        }
    }

    /// The share of a sample's footprint that the stroke covers, times the paint's opacity.
    pub(crate) fn share(&self, spot: &Spot, ramp_px: f64) -> f64 {
        let softness = Softness { ramp_px, smear_mm: self.smear_mm };
        let [x, p] = spot.at;
        let side = |half: &HalfWidth, sign: f64| {
            let [width, slope] = half.value_and_slope(x);
            Edge {
                inside_mm: width + sign * p,
                slope_mm_per_px: spot.chain([slope, sign]),
                curvature_per_mm: 0.0,
            }
        };
        let across = share_between(side(&self.left, 1.0), side(&self.right, -1.0), softness);
        if across == 0.0 {
            return 0.0;
        }
        let along = |[from, to]: [f64; 2]| {
            let end = |inside_mm: f64, sign: f64| Edge {
                inside_mm,
                slope_mm_per_px: spot.chain([sign, 0.0]),
                curvature_per_mm: 0.0,
            };
            share_between(end(x - from, 1.0), end(to - x, -1.0), softness)
        };
        let gaps: f64 = self.missing.iter().map(|&gap| 1.0 - along(gap)).product();
        across * along(self.range) * gaps
    }

    /// Whether a triangle with these corners (x, p) may hold some of the paint. Cautious: it says yes for some that do not.
    pub(super) fn may_touch(&self, corners: &[[f64; 2]; 3]) -> bool {
        // Footprints of samples reach over the edge.
        let margin = self.smear_mm + 0.4 * self.left.largest().max(self.right.largest());
        let x = corners.map(|corner| corner[0]);
        let from = x.into_iter().fold(f64::INFINITY, f64::min) - margin;
        let to = x.into_iter().fold(f64::NEG_INFINITY, f64::max) + margin;
        let (left, right) = (self.left.largest_in(from, to), self.right.largest_in(from, to));
        let beyond = |axis: usize, low: f64, high: f64| {
            corners.iter().all(|corner| corner[axis] < low - margin)
                || corners.iter().all(|corner| corner[axis] > high + margin)
        };
        !beyond(0, self.range[0], self.range[1]) && !beyond(1, -left, right)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::GREEN;

    fn stroke(smear_mm: f64) -> Stroke {
        Stroke {
            id: "w".to_string(),
            paint: GREEN,
            left: HalfWidth::through(vec![[0.0, 1.0], [10.0, 2.0]]),
            right: HalfWidth::through(vec![[0.0, 0.5]]),
            range: [-5.0, 20.0],
            missing: vec![[12.0, 14.0]],
            smear_mm,
            texture: Texture::default(),
        }
    }

    fn share(stroke: &Stroke, x: f64, p: f64) -> f64 {
        stroke.share(&Spot { at: [x, p], per_px: [[0.5, 0.0], [0.0, 0.5]] }, 1e-3)
    }

    #[test]
    fn widths_run_linearly_between_knots_and_stay_beyond() {
        let left = stroke(0.0).left;
        assert_eq!([-3.0, 0.0, 5.0, 10.0, 50.0].map(|x| left.at(x)), [1.0, 1.0, 1.5, 2.0, 2.0]);
    }

    #[test]
    fn paint_lies_between_its_two_edges_within_its_range() {
        let sharp = stroke(0.0);
        for (x, p, expected) in [
            (5.0, -1.4, 1.0),
            (5.0, -1.6, 0.0),
            (5.0, 0.4, 1.0),
            (5.0, 0.6, 0.0),
            (-5.1, 0.0, 0.0),
            (20.1, 0.0, 0.0),
            (13.0, 0.0, 0.0),
            (14.1, 0.0, 1.0),
        ] {
            assert_eq!(share(&sharp, x, p), expected, "at ({x}, {p})");
        }
        assert!((share(&sharp, 5.0, 0.5) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_smear_fades_over_its_width_and_keeps_the_area() {
        let area = |stroke: &Stroke| -> f64 {
            (-400..400).map(|i| 0.01 * share(stroke, 5.0, 0.01 * f64::from(i))).sum()
        };
        assert!((share(&stroke(0.4), 5.0, 0.4) - 0.75).abs() < 1e-3);
        assert!((area(&stroke(0.4)) - area(&stroke(0.0))).abs() < 5e-3);
    }

    #[test]
    fn a_triangle_across_the_line_may_be_touched_and_one_far_off_is_not() {
        assert!(stroke(0.0).may_touch(&[[0.0, -30.0], [1.0, 30.0], [2.0, 30.0]]));
        assert!(!stroke(0.0).may_touch(&[[0.0, 3.0], [1.0, 3.0], [2.0, 5.0]]));
        assert!(!stroke(0.0).may_touch(&[[30.0, 0.0], [31.0, 0.0], [32.0, 1.0]]));
        // Beside the narrow end of a stroke that is wide elsewhere.
        assert!(stroke(0.0).may_touch(&[[9.0, -2.5], [10.0, -2.5], [9.5, -2.7]]));
        assert!(!stroke(0.0).may_touch(&[[-3.0, -2.5], [-2.0, -2.5], [-2.5, -2.7]]));
    }
}
