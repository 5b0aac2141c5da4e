//! Where the middle of a dot is, to a few hundredths of a pixel.
//!
//! The middle is the centroid of the painted *area*. So each pixel counts by how much of it is paint, not by how bright it is.

use crate::Picture;
use crate::blobs::Blob;
use crate::matte::Ground;
use crate::paint::Paint;
use nalgebra::Vector3;

/// Paint fades over this many pixels beyond the mask: lens blur, and the pixel's own width.
const FADE: usize = 2;
/// Beyond that come so many pixels of surroundings.
const RING: usize = 2;
/// Dots are smaller than this on either side, px.
const LARGEST: usize = 96;
/// Less cover than this is taken for what the surroundings were mistaken by; what is beyond full cover, and a gleam, is cut.
const COVER: [f64; 2] = [0.15, 1.1];
/// Rounds in which a patch of touching dots is shared out.
const ROUNDS: usize = 6;

/// A dot as measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spot {
    /// Centroid of its paint, px.
    pub(crate) at: [f64; 2],
    /// Its paint's area in the image, px².
    pub(crate) area: f64,
}

/// Which blob each pixel of an image belongs to.
#[derive(Debug, Clone, Default)]
pub(crate) struct Owners {
    width: usize,
    height: usize,
    /// Number of the blob, from 1; 0 is none.
    of: Vec<u16>,
}

impl Owners {
    /// Enters the blobs of an image.
    pub(crate) fn enter(&mut self, picture: &Picture, blobs: &[Blob]) {
        if [self.width, self.height] != [picture.width, picture.height] {
            *self = Self {
                width: picture.width,
                height: picture.height,
                of: vec![0; picture.width * picture.height],
            };
        }
        self.write(blobs, |number| u16::try_from(number + 1).unwrap_or(u16::MAX));
    }

    /// Takes them out again, which is less work than to wipe the image.
    pub(crate) fn leave(&mut self, blobs: &[Blob]) {
        self.write(blobs, |_| 0);
    }

    fn write(&mut self, blobs: &[Blob], value: impl Fn(usize) -> u16) {
        for (number, blob) in blobs.iter().enumerate() {
            for run in &blob.runs {
                let row = run.y as usize * self.width;
                self.of[row + run.first as usize..row + run.end as usize].fill(value(number));
            }
        }
    }
}

/// What a pixel of the window is.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    Free,
    Own,
    Other,
    /// Next to the dot and to another one: neither's.
    Between,
}

/// The painted pixels of a blob and of its fading rim, with the share of each that is paint.
#[derive(Debug, Clone)]
pub(crate) struct Patch {
    /// x, y, the cover that is surely paint, cover as measured.
    pixels: Vec<[f64; 4]>,
}

impl Patch {
    /// Cuts the patch of a blob out of an image; `numbers` are those of the blob, or of the pieces that it fell into. None for
    /// what is too large for a dot.
    pub(crate) fn cut(
        picture: &Picture,
        paint: &Paint,
        owners: &Owners,
        blob: &Blob,
        numbers: &[usize],
    ) -> Option<Self> {
        let window = Window::around(picture, blob)?;
        let parts = window.parts(owners, numbers);
        let colors = window.colors(picture, paint);
        let ground = Ground::of(&parts, &colors, window.width, paint)?;
        let own: Vec<usize> = (0..parts.len()).filter(|&i| parts[i] == Part::Own).collect();
        let mask: Vec<f64> = own.iter().map(|&i| window.cover(i, picture, paint)).collect();
        let covers = ground.covers(&own, &mask, &colors, paint);
        let pixel = |(&index, cover): (&usize, f64)| {
            let [x, y] = window.place(index);
            [x, y, certain(cover), cover.clamp(0.0, 1.0)]
        };
        let pixels = own.iter().zip(covers).map(pixel).collect();
        Some(Self { pixels })
    }

    /// The whole patch as one dot.
    pub(crate) fn spot(&self) -> Option<Spot> {
        centroid(self.pixels.iter())
    }

    /// The patch shared out among touching dots, of which rough places and areas are known: each pixel goes to the dot in whose
    /// circle it lies deepest (power distance), in rounds.
    pub(crate) fn share(&self, dots: &[Spot]) -> Vec<Option<Spot>> {
        let mut spots = dots.to_vec();
        let nearest = |spots: &[Spot], pixel: &[f64; 4]| {
            let power = |spot: &Spot| {
                (pixel[0] - spot.at[0]).powi(2) + (pixel[1] - spot.at[1]).powi(2)
                    - spot.area / std::f64::consts::PI
            };
            let best = spots.iter().map(power).enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
            best.map_or(0, |(dot, _)| dot)
        };
        let mut found = vec![None; dots.len()];
        for _ in 0..ROUNDS {
            for (dot, found) in found.iter_mut().enumerate() {
                *found = centroid(self.pixels.iter().filter(|pixel| nearest(&spots, pixel) == dot));
            }
            for (spot, found) in spots.iter_mut().zip(&found) {
                spot.at = found.map_or(spot.at, |found| found.at);
            }
        }
        found
    }
}

/// The part of a measured cover that is surely paint, stretched so that full cover stays full.
fn certain(cover: f64) -> f64 {
    (cover.clamp(COVER[0], COVER[1]) - COVER[0]) / (1.0 - COVER[0])
}

fn centroid<'a>(pixels: impl Iterator<Item = &'a [f64; 4]>) -> Option<Spot> {
    let [mut sure, mut area, mut x, mut y] = [0.0; 4];
    for [px, py, weight, cover] in pixels {
        sure += weight;
        area += cover;
        x += weight * px;
        y += weight * py;
    }
    (sure > 0.2).then(|| Spot { at: [x / sure, y / sure], area })
}

/// The part of the image around a blob.
struct Window {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

impl Window {
    fn around(picture: &Picture, blob: &Blob) -> Option<Self> {
        let margin = FADE + RING;
        let [left, top, right, bottom] = blob.bounds.map(|x| x as usize);
        if right - left >= LARGEST || bottom - top >= LARGEST {
            return None;
        }
        let (x, y) = (left.saturating_sub(margin), top.saturating_sub(margin));
        let end = [(right + margin + 1).min(picture.width), (bottom + margin + 1).min(picture.height)];
        Some(Self { left: x, top: y, width: end[0] - x, height: end[1] - y })
    }

    /// A pixel's place in the image.
    fn place(&self, index: usize) -> [f64; 2] {
        [(self.left + index % self.width) as f64, (self.top + index / self.width) as f64]
    }

    /// The share of paint of a pixel, from its ratios alone.
    fn cover(&self, index: usize, picture: &Picture, paint: &Paint) -> f64 {
        let (x, y) = (self.left + index % self.width, self.top + index / self.width);
        f64::from(paint.coverage(picture.at(x, y))) / 255.0
    }

    /// Linear light of the pixels.
    fn colors(&self, picture: &Picture, paint: &Paint) -> Vec<Vector3<f64>> {
        let mut colors = Vec::with_capacity(self.width * self.height);
        for y in self.top..self.top + self.height {
            let row = &picture.rgb[3 * (y * picture.width + self.left)..][..3 * self.width];
            colors.extend(
                row.chunks_exact(3)
                    .map(|p| Vector3::from_fn(|c, _| f64::from(paint.light[usize::from(p[c])]))),
            );
        }
        colors
    }

    /// The dot with its fading rim, other dots with theirs, and what is free.
    fn parts(&self, owners: &Owners, numbers: &[usize]) -> Vec<Part> {
        let mut parts = Vec::with_capacity(self.width * self.height);
        for y in self.top..self.top + self.height {
            let row = &owners.of[y * owners.width + self.left..][..self.width];
            parts.extend(row.iter().map(|&owner| match owner {
                0 => Part::Free,
                owner if numbers.contains(&(usize::from(owner) - 1)) => Part::Own,
                _ => Part::Other,
            }));
        }
        for _ in 0..FADE {
            parts = self.grown(&parts);
        }
        parts
    }

    /// Lets the dots grow into what is free by one pixel; what is next to two of them becomes neither's.
    fn grown(&self, parts: &[Part]) -> Vec<Part> {
        let mut grown = parts.to_vec();
        let mut touched = vec![0u8; parts.len()];
        for y in 0..self.height {
            for x in 0..self.width {
                let mark = match parts[y * self.width + x] {
                    Part::Own => 1,
                    Part::Other => 2,
                    _ => continue,
                };
                for row in y.saturating_sub(1)..(y + 2).min(self.height) {
                    let row = row * self.width;
                    let columns = row + x.saturating_sub(1)..row + (x + 2).min(self.width);
                    touched[columns].iter_mut().for_each(|touched| *touched |= mark);
                }
            }
        }
        for (part, touched) in grown.iter_mut().zip(touched) {
            if *part == Part::Free {
                *part = [Part::Free, Part::Own, Part::Other, Part::Between][usize::from(touched)];
            }
        }
        grown
    }
}
