//! Connected patches of painted pixels, found in the tiles of an image that are asked for.

use crate::Picture;
use crate::paint::Paint;

/// Side of a tile, px.
const TILE: usize = 16;

/// Fewer painted pixels are no dot.
const LEAST_PIXELS: usize = 4;
/// A dot has a pixel of at least this cover.
const LEAST_PEAK: f64 = 0.4;

/// Which tiles of an image are to be searched.
#[derive(Debug, Clone)]
pub(crate) struct Area {
    columns: usize,
    rows: usize,
    size: [usize; 2],
    marked: Vec<bool>,
}

impl Area {
    pub(crate) fn nothing(picture: &Picture) -> Self {
        let (columns, rows) = (picture.width.div_ceil(TILE), picture.height.div_ceil(TILE));
        Self { columns, rows, size: [picture.width, picture.height], marked: vec![false; columns * rows] }
    }

    pub(crate) fn everything(picture: &Picture) -> Self {
        let mut area = Self::nothing(picture);
        area.marked.fill(true);
        area
    }

    /// Adds the tiles that come within `reach` of a place.
    pub(crate) fn add(&mut self, at: [f64; 2], reach: f64) {
        let tiles = |x: f64, side: usize, count: usize| {
            let low = ((x - reach).max(0.0) as usize).min(side) / TILE;
            let high = (x + reach).max(-1.0) as isize;
            let high = if high < 0 { 0 } else { (high as usize / TILE + 1).min(count) };
            low.min(high)..high
        };
        let columns = tiles(at[0], self.size[0], self.columns);
        for row in tiles(at[1], self.size[1], self.rows) {
            self.marked[row * self.columns..][columns.clone()].fill(true);
        }
    }

    /// The stretches of a row of pixels that lie in marked tiles.
    fn stretches(&self, y: usize) -> impl Iterator<Item = std::ops::Range<usize>> {
        let marked = &self.marked[y / TILE * self.columns..][..self.columns];
        let mut column = 0;
        std::iter::from_fn(move || {
            while column < marked.len() && !marked[column] {
                column += 1;
            }
            let first = column;
            while column < marked.len() && marked[column] {
                column += 1;
            }
            (first < column).then(|| first * TILE..(column * TILE).min(self.size[0]))
        })
    }

    fn has_row(&self, y: usize) -> bool {
        self.marked[y / TILE * self.columns..][..self.columns].contains(&true)
    }
}

/// Painted pixels side by side in a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) y: u32,
    pub(crate) first: u32,
    /// One past the last.
    pub(crate) end: u32,
}

/// A connected patch of painted pixels.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Blob {
    /// Top to bottom.
    pub(crate) runs: Vec<Run>,
    /// Sum of its pixels' coverages.
    pub(crate) cover: f64,
    /// The largest coverage of a pixel, 0–1.
    pub(crate) peak: f64,
    /// Middle, weighed with the coverages, px; rough.
    pub(crate) middle: [f64; 2],
    /// First column and row, last column and row.
    pub(crate) bounds: [u32; 4],
}

/// The patches in an area, in the order of their first pixels.
pub(crate) fn find(picture: &Picture, paint: &Paint, area: &Area) -> Vec<Blob> {
    let mut runs: Vec<(Run, Cover)> = Vec::new();
    let mut parents: Vec<u32> = Vec::new();
    let mut above = 0..0;
    for y in 0..picture.height {
        let start = runs.len();
        if area.has_row(y) {
            let row = &picture.rgb[3 * y * picture.width..][..3 * picture.width];
            area.stretches(y).for_each(|stretch| row_runs(row, y, stretch, paint, &mut runs));
        }
        parents.extend(start as u32..runs.len() as u32);
        join(&runs, &mut parents, above, start);
        above = start..runs.len();
    }
    gather(&runs, &mut parents)
}

/// Sums over the pixels of a run: coverage, coverage × column, largest coverage.
#[derive(Debug, Clone, Copy, Default)]
struct Cover {
    sum: u32,
    moment: u64,
    peak: u8,
}

fn row_runs(
    row: &[u8],
    y: usize,
    stretch: std::ops::Range<usize>,
    paint: &Paint,
    runs: &mut Vec<(Run, Cover)>,
) {
    let mut open: Option<(usize, Cover)> = None;
    let end = stretch.end;
    for (x, pixel) in stretch.clone().zip(row[3 * stretch.start..3 * end].chunks_exact(3)) {
        let cover = paint.coverage([pixel[0], pixel[1], pixel[2]]);
        if cover > 0 {
            let (_, sums) = open.get_or_insert((x, Cover::default()));
            sums.sum += u32::from(cover);
            sums.moment += u64::from(cover) * x as u64;
            sums.peak = sums.peak.max(cover);
        } else if let Some((first, sums)) = open.take() {
            runs.push((Run { y: y as u32, first: first as u32, end: x as u32 }, sums));
        }
    }
    if let Some((first, sums)) = open {
        runs.push((Run { y: y as u32, first: first as u32, end: end as u32 }, sums));
    }
}

/// Joins the runs from `start` on with those of the row above that they touch by a side.
fn join(runs: &[(Run, Cover)], parents: &mut [u32], above: std::ops::Range<usize>, start: usize) {
    let mut upper = above.start;
    for lower in start..runs.len() {
        let run = runs[lower].0;
        while upper < above.end && runs[upper].0.end <= run.first {
            upper += 1;
        }
        let mut other = upper;
        while other < above.end && runs[other].0.first < run.end {
            let (a, b) = (root(parents, other as u32), root(parents, lower as u32));
            // The earlier run leads, so that the order of blobs does not depend on how they were joined.
            parents[a.max(b) as usize] = a.min(b);
            other += 1;
        }
    }
}

fn root(parents: &mut [u32], mut run: u32) -> u32 {
    while parents[run as usize] != run {
        parents[run as usize] = parents[parents[run as usize] as usize];
        run = parents[run as usize];
    }
    run
}

fn gather(runs: &[(Run, Cover)], parents: &mut [u32]) -> Vec<Blob> {
    let mut blobs: Vec<Blob> = Vec::new();
    let mut numbers = vec![u32::MAX; runs.len()];
    for (index, (run, cover)) in runs.iter().enumerate() {
        let lead = root(parents, index as u32) as usize;
        if numbers[lead] == u32::MAX {
            numbers[lead] = blobs.len() as u32;
            blobs.push(Blob {
                runs: Vec::new(),
                cover: 0.0,
                peak: 0.0,
                middle: [0.0; 2],
                bounds: [u32::MAX, u32::MAX, 0, 0],
            });
        }
        blobs[numbers[lead] as usize].add(*run, *cover);
    }
    blobs.iter_mut().for_each(|blob| blob.middle = blob.middle.map(|moment| moment / blob.cover));
    blobs
}

impl Blob {
    /// Adds a run; `middle` holds moments until all are in.
    fn add(&mut self, run: Run, cover: Cover) {
        let sum = f64::from(cover.sum) / 255.0;
        self.cover += sum;
        self.peak = self.peak.max(f64::from(cover.peak) / 255.0);
        self.middle[0] += cover.moment as f64 / 255.0;
        self.middle[1] += sum * f64::from(run.y);
        let [left, top, right, bottom] = self.bounds;
        self.bounds = [left.min(run.first), top.min(run.y), right.max(run.end - 1), bottom.max(run.y)];
        self.runs.push(run);
    }

    /// Pixels of the mask.
    pub(crate) fn pixels(&self) -> usize {
        self.runs.iter().map(|run| (run.end - run.first) as usize).sum()
    }

    /// Whether it is more than a stray pixel or two of nearly the right colour.
    pub(crate) fn is_dot(&self) -> bool {
        self.pixels() >= LEAST_PIXELS && self.peak >= LEAST_PEAK
    }

    /// The same patch with another one's pixels, for a dot that fell apart.
    pub(crate) fn with(&self, other: &Self) -> Self {
        let cover = self.cover + other.cover;
        let mut runs: Vec<Run> = self.runs.iter().chain(&other.runs).copied().collect();
        runs.sort_by_key(|run| (run.y, run.first));
        let [a, b] = [self.bounds, other.bounds];
        Self {
            runs,
            cover,
            peak: self.peak.max(other.peak),
            middle: std::array::from_fn(|k| {
                (self.cover * self.middle[k] + other.cover * other.middle[k]) / cover
            }),
            bounds: [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])],
        }
    }
}
