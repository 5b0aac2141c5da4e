//! A picture of one number per pixel.

use rayon::prelude::*;

/// Numbers over a picture; row 0 is the top, and pixel (0, 0) is the centre of the top-left one.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row after row.
    pub values: Vec<f64>,
}

impl Plane {
    /// The same number everywhere.
    #[must_use]
    pub fn filled(width: usize, height: usize, value: f64) -> Self {
        Self { width, height, values: vec![value; width * height] }
    }

    /// A number for each pixel, by column and row; rows are worked out in parallel.
    #[must_use]
    pub fn from_fn(width: usize, height: usize, value: impl Fn(usize, usize) -> f64 + Sync) -> Self {
        let mut plane = Self::filled(width, height, 0.0);
        plane.values.par_chunks_mut(width.max(1)).enumerate().for_each(|(row, line)| {
            line.iter_mut().enumerate().for_each(|(column, pixel)| *pixel = value(column, row));
        });
        plane
    }

    /// The same for each pixel's number.
    #[must_use]
    pub fn map(&self, value: impl Fn(f64) -> f64 + Sync) -> Self {
        let values = self.values.par_iter().map(|pixel| value(*pixel)).collect();
        Self { width: self.width, height: self.height, values }
    }

    /// The same for the numbers of two planes.
    #[must_use]
    pub fn with(&self, other: &Self, value: impl Fn(f64, f64) -> f64 + Sync) -> Self {
        let values = self.values.par_iter().zip(&other.values).map(|(a, b)| value(*a, *b)).collect();
        Self { width: self.width, height: self.height, values }
    }

    /// The number at a pixel.
    #[must_use]
    pub fn at(&self, column: usize, row: usize) -> f64 {
        self.values[row * self.width + column]
    }

    /// Whether two planes have the same size.
    #[must_use]
    pub fn fits(&self, other: &Self) -> bool {
        (self.width, self.height) == (other.width, other.height)
    }

    /// Between the four pixels around a place; the border goes on for ever.
    #[must_use]
    pub fn bilinear(&self, x: f64, y: f64) -> f64 {
        let (column, u) = split(x, self.width);
        let (row, v) = split(y, self.height);
        let (right, below) = ((column + 1).min(self.width - 1), (row + 1).min(self.height - 1));
        let top = self.at(column, row) + u * (self.at(right, row) - self.at(column, row));
        let bottom = self.at(column, below) + u * (self.at(right, below) - self.at(column, below));
        top + v * (bottom - top)
    }

    /// Through the sixteen pixels around a place, by Catmull and Rom's cubic; the border goes on for ever.
    #[must_use]
    pub fn cubic(&self, x: f64, y: f64) -> f64 {
        let (column, u) = split(x, self.width);
        let (row, v) = split(y, self.height);
        let (wx, wy) = (cubic_weights(u), cubic_weights(v));
        if (1..self.width.saturating_sub(2)).contains(&column)
            && (1..self.height.saturating_sub(2)).contains(&row)
        {
            let line = |k: usize| {
                let first = (row + k - 1) * self.width + column - 1;
                let p = &self.values[first..first + 4];
                wx[0] * p[0] + wx[1] * p[1] + wx[2] * p[2] + wx[3] * p[3]
            };
            return wy[0] * line(0) + wy[1] * line(1) + wy[2] * line(2) + wy[3] * line(3);
        }
        let near = |place: usize, k: usize, size: usize| (place + k).saturating_sub(1).min(size - 1);
        let line = |k: usize| -> f64 {
            let row = near(row, k, self.height);
            (0..4).map(|i| wx[i] * self.at(near(column, i, self.width), row)).sum()
        };
        (0..4).map(|k| wy[k] * line(k)).sum()
    }

    /// Gradient by central differences, one-sided at the border: along x, along y (down).
    #[must_use]
    pub fn gradient(&self) -> [Self; 2] {
        let along = |before: f64, after: f64, steps: usize| (after - before) / steps.max(1) as f64;
        let x = Self::from_fn(self.width, self.height, |column, row| {
            let [left, right] = [column.saturating_sub(1), (column + 1).min(self.width - 1)];
            along(self.at(left, row), self.at(right, row), right - left)
        });
        let y = Self::from_fn(self.width, self.height, |column, row| {
            let [above, below] = [row.saturating_sub(1), (row + 1).min(self.height - 1)];
            along(self.at(column, above), self.at(column, below), below - above)
        });
        [x, y]
    }

    /// A rectangle of it: its first column and row, its width and height.
    #[must_use]
    pub fn cropped(&self, [left, top, width, height]: [usize; 4]) -> Self {
        let line = |row: usize| {
            let first = (top + row) * self.width + left;
            self.values[first..first + width].iter().copied()
        };
        Self { width, height, values: (0..height).flat_map(line).collect() }
    }

    /// The same, put back into a picture of another size whose other pixels are `value`.
    #[must_use]
    pub fn framed(&self, [left, top]: [usize; 2], [width, height]: [usize; 2], value: f64) -> Self {
        let mut plane = Self::filled(width, height, value);
        for (row, line) in self.values.chunks(self.width).enumerate() {
            let first = (top + row) * width + left;
            plane.values[first..first + self.width].copy_from_slice(line);
        }
        plane
    }
}

/// The pixel before a place, and how far the place lies beyond it.
fn split(place: f64, size: usize) -> (usize, f64) {
    let place = place.clamp(0.0, (size - 1) as f64);
    let before = (place as usize).min(size.saturating_sub(2));
    (before, place - before as f64)
}

fn cubic_weights(t: f64) -> [f64; 4] {
    let (square, cube) = (t * t, t * t * t);
    [
        0.5 * (2.0 * square - t - cube),
        0.5 * (3.0 * cube - 5.0 * square + 2.0),
        0.5 * (4.0 * square - 3.0 * cube + t),
        0.5 * (cube - square),
    ]
}

/// The middle one of numbers, of those for which `keep` holds; 0 where there is none. Of very many a fixed part is looked at.
#[must_use]
pub(crate) fn median<'a>(values: impl Iterator<Item = &'a f64>) -> f64 {
    quantile(values, 0.5)
}

/// The number that a share of the others lies below.
#[must_use]
pub(crate) fn quantile<'a>(values: impl Iterator<Item = &'a f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.copied().filter(|value| value.is_finite()).collect();
    if values.is_empty() {
        return 0.0;
    }
    let at = ((values.len() - 1) as f64 * share) as usize;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}
