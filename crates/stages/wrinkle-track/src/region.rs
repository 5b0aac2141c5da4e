//! The pixels of one wrinkle in one image.

use crate::bits::Bits;
use crate::spline::Place;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Pixels, in the order in which they were given, and a small image of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Column and row of each.
    pub pixels: Vec<[usize; 2]>,
    origin: [usize; 2],
    bits: Bits,
}

/// Free pixels around the small image.
const MARGIN: usize = 2;

impl Region {
    /// The region of some pixels, of which there must be one at least.
    #[must_use]
    pub fn new(pixels: Vec<[usize; 2]>) -> Self {
        let corner = |axis: usize| {
            let values = || pixels.iter().map(|pixel| pixel[axis]);
            [values().min().unwrap_or(0), values().max().unwrap_or(0)]
        };
        let ([left, right], [top, bottom]) = (corner(0), corner(1));
        let mut bits = Bits::new(right - left + 1 + 2 * MARGIN, bottom - top + 1 + 2 * MARGIN);
        for [column, row] in &pixels {
            bits.set(column - left + MARGIN, row - top + MARGIN);
        }
        Self { pixels, origin: [left, top], bits }
    }

    /// Number of pixels.
    #[must_use]
    pub fn area(&self) -> usize {
        self.pixels.len()
    }

    /// The centres of the pixels.
    #[must_use]
    pub fn places(&self) -> Vec<Place> {
        self.pixels.iter().map(|[x, y]| Place::new(*x as f64, *y as f64)).collect()
    }

    /// The mean of the pixels.
    #[must_use]
    pub fn center(&self) -> Place {
        self.places().into_iter().sum::<Place>() / self.area().max(1) as f64
    }

    fn holds(&self, column: i64, row: i64) -> bool {
        let margin = MARGIN as i64;
        self.bits.get(column - self.origin[0] as i64 + margin, row - self.origin[1] as i64 + margin)
    }

    /// How much of a pixel around a place lies in the region, interpolated between pixels.
    #[must_use]
    pub fn cover(&self, at: Place) -> f64 {
        let (column, row) = (at.x.floor(), at.y.floor());
        let [x, y] = [at.x - column, at.y - row];
        let (column, row) = (column as i64, row as i64);
        let value = |dx: i64, dy: i64| f64::from(u8::from(self.holds(column + dx, row + dy)));
        let upper = value(0, 0) * (1.0 - x) + value(1, 0) * x;
        let lower = value(0, 1) * (1.0 - x) + value(1, 1) * x;
        upper * (1.0 - y) + lower * y
    }

    /// The way from one end of the region to each of its pixels, within it, px; pieces are joined where they are nearest. The end
    /// is the pixel that lies farthest from the first one.
    #[must_use]
    pub fn ways_from_end(&self) -> Vec<f64> {
        let first = self.ways(0);
        self.ways(farthest(&first))
    }

    fn ways(&self, start: usize) -> Vec<f64> {
        let width = self.bits.width;
        let local = |[x, y]: [usize; 2]| (y - self.origin[1] + MARGIN) * width + x - self.origin[0] + MARGIN;
        let mut index = vec![usize::MAX; width * self.bits.height];
        self.pixels.iter().enumerate().for_each(|(i, pixel)| index[local(*pixel)] = i);
        let mut ways = vec![f64::INFINITY; self.pixels.len()];
        let mut open = BinaryHeap::from([Step { way: 0.0, pixel: start }]);
        ways[start] = 0.0;
        loop {
            while let Some(Step { way, pixel }) = open.pop() {
                if way > ways[pixel] {
                    continue;
                }
                let at = local(self.pixels[pixel]);
                for (offset, length) in neighbours(width) {
                    let next = index[(at as i64 + offset) as usize];
                    if next != usize::MAX && way + length < ways[next] {
                        ways[next] = way + length;
                        open.push(Step { way: way + length, pixel: next });
                    }
                }
            }
            let Some(step) = self.over_the_gap(&ways) else { return ways };
            ways[step.pixel] = step.way;
            open.push(step);
        }
    }

    /// The shortest step from what was reached to what was not.
    fn over_the_gap(&self, ways: &[f64]) -> Option<Step> {
        let (reached, left): (Vec<usize>, Vec<usize>) = (0..ways.len()).partition(|i| ways[*i].is_finite());
        let mut best: Option<(usize, Step)> = None;
        for to in left {
            for from in &reached {
                let [dx, dy] = [0, 1].map(|axis| self.pixels[to][axis].abs_diff(self.pixels[*from][axis]));
                let squared = dx * dx + dy * dy;
                if best.as_ref().is_none_or(|(least, _)| squared < *least) {
                    let way = ways[*from] + (squared as f64).sqrt();
                    best = Some((squared, Step { way, pixel: to }));
                }
            }
        }
        best.map(|(_, step)| step)
    }
}

/// Steps to the eight neighbours; their lengths err by 4 % at most in any direction [Borgefors1986].
fn neighbours(width: usize) -> [(i64, f64); 8] {
    const STRAIGHT: f64 = 0.9604;
    const DIAGONAL: f64 = 1.3583;
    let width = width as i64;
    [
        (-1, STRAIGHT),
        (1, STRAIGHT),
        (-width, STRAIGHT),
        (width, STRAIGHT),
        (-width - 1, DIAGONAL),
        (-width + 1, DIAGONAL),
        (width - 1, DIAGONAL),
        (width + 1, DIAGONAL),
    ]
}

/// The index of the largest value, the first of equals.
fn farthest(ways: &[f64]) -> usize {
    let mut best = 0;
    for (index, way) in ways.iter().enumerate() {
        if *way > ways[best] {
            best = index;
        }
    }
    best
}

/// A pixel on the front, the nearest first.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Step {
    way: f64,
    pixel: usize,
}

impl Eq for Step {}

impl PartialOrd for Step {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Step {
    fn cmp(&self, other: &Self) -> Ordering {
        other.way.total_cmp(&self.way).then(other.pixel.cmp(&self.pixel))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_go_around_corners_and_over_gaps() {
        // Down, to the right, and on beyond a gap of two pixels.
        let mut pixels: Vec<[usize; 2]> = (0..20).map(|y| [5, y]).collect();
        pixels.extend((6..20).map(|x| [x, 19]));
        pixels.extend((22..26).map(|x| [x, 19]));
        let ways = Region::new(pixels.clone()).ways_from_end();
        let longest = ways.iter().copied().fold(0.0, f64::max);
        assert!((longest - 39.0).abs() < 0.06 * 39.0, "{longest}");
        assert!((ways[0] - longest).abs() < 1e-9 || (ways[pixels.len() - 1] - longest).abs() < 1e-9);
    }

    #[test]
    fn cover_falls_from_pixel_to_pixel() {
        let region = Region::new(vec![[10, 10], [11, 10], [10, 11], [11, 11]]);
        for (x, cover) in [(10.0, 1.0), (11.0, 1.0), (11.25, 0.75), (11.5, 0.5), (12.0, 0.0)] {
            assert!((region.cover(Place::new(x, 10.5)) - cover).abs() < 1e-12, "{x}");
        }
    }
}
