//! Which pixels are learnt from.
//!
//! Paint, and what lies around it, are thinned out alike, so that where the paint ends neither side has more pixels than it has;
//! beyond, colours count and not pixels: of each colour a few.

use crate::Error;
use crate::bits::Bits;
use crate::light::{Picture, ratios};
use crate::marks::UNKNOWN;
use crate::svm::Sample;
use std::collections::BTreeMap;

/// An image whose paint is marked.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// The image.
    pub picture: &'a Picture,
    /// Per pixel its paint, see [`crate::marks::labels`].
    pub labels: &'a [u8],
}

/// A pixel to learn from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chosen {
    /// What it looks like, and what it is.
    pub sample: Sample,
    /// Whether it touches the edge of what is marked: its colour is a blend, and hands shake.
    pub on_edge: bool,
    /// Which part of the image it lies in: neighbours share one.
    pub part: u64,
}

/// So far around the paint pixels are thinned out like paint, px.
const NEAR_PX: usize = 4;
/// Side of a cell of colours, in log ratios.
const CELL: f64 = 0.1;
/// One of so many pixels beyond is looked at.
const FAR_EVERY: u64 = 4;
/// Side of a part of the image, px.
const PART_PX: usize = 16;
/// Fewer marked pixels teach nothing.
const LEAST: usize = 20;

/// At most `most` pixels to learn a paint from (the number that labels give it): a third each of paint, what is near it, and the
/// rest. Always the same ones, spread evenly.
///
/// # Errors
/// [`Error::FewPixels`], or [`Error::Clipped`] where exposure is why; with the number of the paint as its name.
pub fn choose(views: &[View], paint: u8, floor: f64, most: usize) -> Result<Vec<Chosen>, Error> {
    let third = (most / 3).max(1);
    let mut pools = Pools::default();
    for (index, view) in views.iter().enumerate() {
        pools.sort_pixels(view, index, paint, floor);
    }
    let (painted, near) = (pools.painted.len(), pools.near.len());
    if painted < LEAST || near < LEAST {
        let all = painted + near + pools.clipped;
        if pools.clipped > all / 4 {
            return Err(Error::Clipped { paint: paint.to_string(), clipped: pools.clipped, all });
        }
        let all = views.iter().map(|view| view.labels.len()).sum();
        return Err(Error::FewPixels { paint: paint.to_string(), painted, all });
    }
    let share = (third as f64 / painted as f64).min(1.0).min(2.0 * third as f64 / near as f64);
    let count = |all: usize| (all as f64 * share).ceil() as usize;
    let far = pools.far_of_each_color(third);
    let mut chosen: Vec<Pixel> = spread(pools.painted, count(painted));
    chosen.extend(spread(pools.near, count(near)));
    chosen.extend(far);
    // In an order without a pattern: whoever takes every so manyth finds all kinds.
    chosen.sort_unstable();
    let logs: Vec<[f64; 256]> = views.iter().map(|view| view.picture.logs(floor)).collect();
    Ok(chosen.iter().map(|pixel| pixel.chosen(views, &logs, paint)).collect())
}

/// A pixel of a view, with what decides whether it is chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Pixel {
    rank: u64,
    view: usize,
    pixel: usize,
    on_edge: bool,
}

#[derive(Default)]
struct Pools {
    painted: Vec<Pixel>,
    near: Vec<Pixel>,
    far: BTreeMap<[i64; 2], Vec<Pixel>>,
    /// Paint, and what is near it, too bright or too dark to be looked at.
    clipped: usize,
}

impl Pools {
    fn sort_pixels(&mut self, view: &View, index: usize, paint: u8, floor: f64) {
        let picture = view.picture;
        let (width, height) = (picture.width, picture.height);
        let painted = Bits::of(width, height, |pixel| view.labels[pixel] == paint);
        let (inner, outer) = (painted.eroded(), painted.dilated());
        let near = (0..NEAR_PX).fold(painted.clone(), |bits, _| bits.dilated());
        let logs = picture.logs(floor);
        for pixel in 0..width * height {
            let (column, row) = ((pixel % width) as i64, (pixel / width) as i64);
            if view.labels[pixel] == UNKNOWN || picture.is_clipped(pixel) {
                self.clipped += usize::from(near.get(column, row));
                continue;
            }
            let rank = rank(pixel);
            let is_painted = painted.get(column, row);
            let on_edge = if is_painted { !inner.get(column, row) } else { outer.get(column, row) };
            let found = Pixel { rank, view: index, pixel, on_edge };
            if is_painted {
                self.painted.push(found);
            } else if near.get(column, row) {
                self.near.push(found);
            } else if rank.is_multiple_of(FAR_EVERY) || view.labels[pixel] != 0 {
                let cell = ratios(&logs, picture.levels[pixel]).map(|ratio| (ratio / CELL).floor() as i64);
                self.far.entry(cell).or_default().push(found);
            }
        }
    }

    /// Pixels of all colours in turn.
    fn far_of_each_color(&mut self, most: usize) -> Vec<Pixel> {
        let mut cells: Vec<Vec<Pixel>> = std::mem::take(&mut self.far).into_values().collect();
        cells.iter_mut().for_each(|cell| cell.sort_unstable());
        let mut chosen = Vec::with_capacity(most);
        let longest = cells.iter().map(Vec::len).max().unwrap_or(0);
        for turn in 0..longest {
            for cell in &cells {
                if chosen.len() == most {
                    return chosen;
                }
                chosen.extend(cell.get(turn));
            }
        }
        chosen
    }
}

impl Pixel {
    fn chosen(&self, views: &[View], logs: &[[f64; 256]], paint: u8) -> Chosen {
        let view = &views[self.view];
        let picture = view.picture;
        let [x, y] = [self.pixel % picture.width / PART_PX, self.pixel / picture.width / PART_PX];
        let sample = Sample {
            ratios: ratios(&logs[self.view], picture.levels[self.pixel]),
            paint: view.labels[self.pixel] == paint,
        };
        Chosen { sample, on_edge: self.on_edge, part: rank(x + 10_007 * (y + 10_009 * self.view)) }
    }
}

/// Numbers in an order without a pattern, always the same: multiples of the golden section, their bits mixed.
fn rank(number: usize) -> u64 {
    let mixed = (number as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (mixed ^ mixed >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 16
}

fn spread(mut pixels: Vec<Pixel>, most: usize) -> Vec<Pixel> {
    pixels.sort_unstable();
    pixels.truncate(most);
    pixels
}
