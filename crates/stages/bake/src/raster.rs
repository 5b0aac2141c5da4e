//! Which triangle lies under which place of a map.

use nalgebra::Vector2;

/// A triangle in the coordinates of a grid of samples: x to the right, y down, sample centers at whole numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Flat {
    corners: [Vector2<f64>; 3],
    /// Twice its area, with the sign of its turn.
    area: f64,
}

/// Shares below this, by rounding, still lie within.
const RIM: f64 = 1e-9;
/// Two triangles that both hold a sample by more than this share lie over each other.
const OVER: f64 = 1e-4;

impl Flat {
    pub(crate) fn new(corners: [Vector2<f64>; 3]) -> Self {
        let [a, b, c] = corners;
        Self { corners, area: (b - a).perp(&(c - a)) }
    }

    /// First and last row and column of samples that it can hold, within a grid of `count` × `count`; none where it holds none.
    pub(crate) fn bounds(&self, count: usize) -> Option<[[usize; 2]; 2]> {
        let range = |axis: usize| {
            let low = self.corners.iter().map(|corner| corner[axis]).fold(f64::INFINITY, f64::min);
            let high = self.corners.iter().map(|corner| corner[axis]).fold(f64::NEG_INFINITY, f64::max);
            let (first, last) = ((low - RIM).ceil().max(0.0), (high + RIM).floor().min(count as f64 - 1.0));
            (first <= last && self.area != 0.0).then_some([first as usize, last as usize])
        };
        Some([range(1)?, range(0)?])
    }

    /// Shares of the corners at a sample, where it lies within.
    pub(crate) fn shares(&self, x: usize, y: usize) -> Option<[f64; 3]> {
        let [a, b, c] = self.corners;
        let at = Vector2::new(x as f64, y as f64);
        let of = |one: Vector2<f64>, other: Vector2<f64>| (one - at).perp(&(other - at)) / self.area;
        let shares = [of(b, c), of(c, a), of(a, b)];
        shares.iter().all(|share| *share >= -RIM).then_some(shares)
    }
}

/// The triangle under a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Under {
    pub(crate) triangle: u32,
    pub(crate) shares: [f64; 3],
}

/// Rows `rows` of a grid of `count` columns: under each sample the first triangle in order; and how many samples lie under two.
pub(crate) fn under(
    triangles: &[(u32, Flat)],
    rows: std::ops::Range<usize>,
    count: usize,
) -> (Vec<Option<Under>>, usize) {
    let mut found: Vec<Option<Under>> = vec![None; rows.len() * count];
    let mut doubled = 0;
    for (triangle, flat) in triangles {
        let Some([[top, bottom], [left, right]]) = flat.bounds(count) else { continue };
        for y in top.max(rows.start)..(bottom + 1).min(rows.end) {
            for x in left..=right {
                let Some(shares) = flat.shares(x, y) else { continue };
                let place = &mut found[(y - rows.start) * count + x];
                let is_deep = |shares: &[f64; 3]| shares.iter().all(|share| *share > OVER);
                match place {
                    Some(first) => doubled += usize::from(is_deep(&first.shares) && is_deep(&shares)),
                    None => *place = Some(Under { triangle: *triangle, shares }),
                }
            }
        }
    }
    (found, doubled)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<(u32, Flat)> {
        let corner = |x: f64, y: f64| Vector2::new(x, y);
        let [a, b, c, d] = [corner(-0.5, -0.5), corner(7.5, -0.5), corner(7.5, 7.5), corner(-0.5, 7.5)];
        vec![(0, Flat::new([a, b, c])), (1, Flat::new([a, c, d]))]
    }

    #[test]
    fn a_square_of_two_triangles_has_no_gap_and_nothing_twice() {
        let (found, doubled) = under(&square(), 0..8, 8);
        assert!(found.iter().all(Option::is_some) && doubled == 0);
        // The diagonal belongs to the first.
        assert!((0..8).all(|k| found[9 * k].unwrap().triangle == 0));
        let (part, _) = under(&square(), 2..5, 8);
        assert_eq!(part, found[16..40]);
    }

    #[test]
    fn what_lies_over_another_is_counted() {
        let mut all = square();
        all.push((2, all[0].1));
        let (found, doubled) = under(&all, 0..8, 8);
        assert_eq!(found, under(&square(), 0..8, 8).0);
        assert!((28 - 8..=28).contains(&doubled), "{doubled}");
    }
}
