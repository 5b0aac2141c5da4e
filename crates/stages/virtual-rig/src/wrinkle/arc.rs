//! Arc length of a section, and the depth that gives it the length it must have.

use crate::wrinkle::profile::{Profile, Shape, fade};

/// Pieces per side; closer at the bottom, where a section bends most.
const PIECES: usize = 32;
const GRADING: f64 = 1.6;

/// Heights and slopes of a form at the ends and in the middles of the pieces of both sides, so that lengths need no
/// more exponentials.
#[derive(Debug, Clone)]
pub(super) struct Outline {
    /// Distances from the bottom in widths.
    places: Vec<f64>,
    /// Side p < 0, side p > 0.
    sides: [Vec<(f64, f64)>; 2],
}

impl Outline {
    /// Up to `reach` widths from the bottom.
    pub(super) fn of(shape: &Shape, reach: f64) -> Self {
        let node = |i: usize| reach * (i as f64 / PIECES as f64).powf(GRADING);
        let place = |k: usize| 0.5 * (node(k / 2) + node(k.div_ceil(2)));
        let places: Vec<f64> = (0..=2 * PIECES).map(place).collect();
        let side = |side: usize| places.iter().map(|&u| shape.on_side(side, u)).collect();
        Self { sides: [side(0), side(1)], places }
    }
}

/// One side of a section: slopes per unit of d/w.
struct Slopes {
    /// Ends and middles of the pieces, mm from the bottom.
    places: Vec<f64>,
    slopes: Vec<f64>,
}

impl Slopes {
    fn of(outline: &Outline, profile: &Profile, side: usize) -> Self {
        let places: Vec<f64> = outline.places.iter().map(|&u| u * profile.w_mm).collect();
        let slope = |(&place, &(height, slope)): (&f64, &(f64, f64))| {
            let (share, share_slope) = fade(profile.fade_mm[side], place);
            slope * share + height * profile.w_mm * share_slope
        };
        let slopes = places.iter().zip(&outline.sides[side]).map(slope).collect();
        Self { places, slopes }
    }

    /// By how much a piece is longer than the surface below it (Simpson's rule), and the derivative by d/w.
    fn excess(&self, piece: usize, ratio: f64) -> (f64, f64) {
        let sixth = (self.places[2 * piece + 2] - self.places[2 * piece]) / 6.0;
        let [a, b, c] = [0, 1, 2].map(|k| {
            let slope = self.slopes[2 * piece + k];
            let stretch = (1.0 + (ratio * slope).powi(2)).sqrt();
            // Without cancellation for small slopes.
            ((ratio * slope).powi(2) / (stretch + 1.0), ratio * slope * slope / stretch)
        });
        (sixth * (a.0 + 4.0 * b.0 + c.0), sixth * (a.1 + 4.0 * b.1 + c.1))
    }
}

/// The arc length of one side as a table, to be inverted.
#[derive(Debug, Clone, Default)]
pub(super) struct Side {
    nodes: Vec<f64>,
    /// Arc length from the bottom to each node, mm.
    arcs: Vec<f64>,
    /// Its derivative.
    stretches: Vec<f64>,
}

impl Side {
    /// By how much the whole side is longer than the surface below it, mm.
    pub(super) fn excess(&self) -> f64 {
        self.arcs.last().zip(self.nodes.last()).map_or(0.0, |(arc, node)| arc - node)
    }

    /// How far from the bottom along the surface a point lies that is `arc` from it along the section (cubic Hermite
    /// in the table).
    pub(super) fn distance(&self, arc: f64) -> f64 {
        let last = self.arcs.len() - 1;
        if arc >= self.arcs[last] {
            return self.nodes[last] + (arc - self.arcs[last]);
        }
        let i = self.arcs.partition_point(|&x| x <= arc).max(1) - 1;
        let step = self.arcs[i + 1] - self.arcs[i];
        let u = (arc - self.arcs[i]) / step;
        let (u2, u3) = (u * u, u * u * u);
        let hermite = (2.0 * u3 - 3.0 * u2 + 1.0) * self.nodes[i]
            + (u3 - 2.0 * u2 + u) * step / self.stretches[i]
            + (3.0 * u2 - 2.0 * u3) * self.nodes[i + 1]
            + (u3 - u2) * step / self.stretches[i + 1];
        hermite.clamp(self.nodes[i], self.nodes[i + 1])
    }
}

/// A section's length as a function of its depth.
pub(super) struct Length {
    sides: [Slopes; 2],
}

impl Length {
    /// Of a profile of that form, width and fading; its depth does not matter.
    pub(super) fn of(outline: &Outline, profile: &Profile) -> Self {
        Self { sides: [Slopes::of(outline, profile, 0), Slopes::of(outline, profile, 1)] }
    }

    /// By how much the section is longer than the surface below it at a depth of `ratio` widths, mm, and the derivative.
    pub(super) fn excess(&self, ratio: f64) -> (f64, f64) {
        let pieces = self.sides.iter().flat_map(|side| (0..PIECES).map(|piece| side.excess(piece, ratio)));
        pieces.fold((0.0, 0.0), |sum, piece| (sum.0 + piece.0, sum.1 + piece.1))
    }

    /// The depth in widths at which the section is `excess` mm longer than the surface below it, at most `most`: Newton
    /// from above; the excess is convex in the depth and grows at most with its square.
    pub(super) fn ratio(&self, excess: f64, most: f64) -> f64 {
        let largest = self.excess(most).0;
        if largest <= excess {
            return most;
        }
        let mut ratio = most * (excess / largest).sqrt();
        for _ in 0..20 {
            let (now, slope) = self.excess(ratio);
            let next = ratio - (now - excess) / slope;
            let is_done = (next - ratio).abs() < 1e-9 * ratio;
            ratio = next;
            if is_done {
                break;
            }
        }
        ratio
    }

    /// The tables of both sides at a depth of `ratio` widths.
    pub(super) fn tables(&self, ratio: f64) -> [Side; 2] {
        [0, 1].map(|side| {
            let slopes = &self.sides[side];
            let mut arcs = vec![0.0];
            for piece in 0..PIECES {
                let flat = slopes.places[2 * piece + 2] - slopes.places[2 * piece];
                arcs.push(arcs[piece] + flat + slopes.excess(piece, ratio).0);
            }
            let stretch = |slope: &f64| (1.0 + (ratio * slope).powi(2)).sqrt();
            Side {
                nodes: slopes.places.iter().step_by(2).copied().collect(),
                arcs,
                stretches: slopes.slopes.iter().step_by(2).map(stretch).collect(),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile(shape: Shape) -> Profile {
        Profile { shape, w_mm: 2.0, d_mm: 1.2, fade_mm: [[6.0, 9.0], [10.0, 14.0]] }
    }

    /// The length of side p > 0 up to `to`, with a million pieces.
    fn measured(profile: &Profile, to: f64) -> f64 {
        let step = to / 1e6;
        let piece = |i: i32| {
            step.hypot(profile.height(step * f64::from(i + 1)) - profile.height(step * f64::from(i)))
        };
        (0..1_000_000).map(piece).sum()
    }

    #[test]
    fn lengths_are_those_of_a_fine_polyline() {
        for shape in [Shape::S, Shape::Foreign { valley: [0.5, 0.57], bulge: [2.0, 1.8] }] {
            let profile = profile(shape);
            let [_, right] = Length::of(&Outline::of(&shape, 7.0), &profile).tables(0.6);
            let whole = measured(&profile, 14.0);
            assert!((right.excess() - (whole - 14.0)).abs() < 2e-4, "{} {}", right.excess(), whole - 14.0);
            for to in [0.1, 0.7, 2.0, 4.4, 9.0, 13.0] {
                let back = right.distance(measured(&profile, to));
                assert!((back - to).abs() < 5e-4, "{shape:?}: {to} came back as {back}");
            }
        }
    }

    #[test]
    fn the_depth_for_a_length_is_found() {
        let length = Length::of(&Outline::of(&Shape::S, 7.0), &profile(Shape::S));
        for ratio in [0.001, 0.05, 0.4, 0.99] {
            let found = length.ratio(length.excess(ratio).0, 1.0);
            assert!((found - ratio).abs() < 1e-9, "{found} instead of {ratio}");
        }
        assert_eq!(length.ratio(100.0, 0.8), 0.8);
    }
}
