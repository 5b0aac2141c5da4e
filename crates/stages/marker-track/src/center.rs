//! Where the middle of a dot is, to a few hundredths of a pixel.
//!
//! The middle is the centroid of the painted *area*. So each pixel counts by how much of it is paint, not by how bright it is:
//! with the skin's colour s nearby, the part of the paint's colour across it, w = b − (b·ŝ) ŝ, answers to paint only, since
//! w·s = 0 whatever the light. What w finds on the skin around (gloss, a reddish patch) is taken off as a plane; the
//! light that w·b depends on is a plane too, fitted to the skin around.

use crate::blobs::Blob;
use crate::paint::{Paint, median};
use crate::picture::Picture;
use nalgebra::{Matrix3, Vector3};

/// Paint fades over this many pixels beyond the mask: lens blur, and the pixel's own width.
const FADE: usize = 2;
/// Beyond that comes a pixel that counts for nothing, then a ring of skin.
const RING: usize = 3;
/// Dots are smaller than this on either side, px.
const LARGEST: usize = 96;
/// Fewer pixels of skin are no surroundings.
const FEWEST: usize = 12;
/// Skin is between these shares of the middle light of the ring; the rest is hair, background, gleam.
const SKIN_LIGHT: [f64; 2] = [0.4, 2.5];
/// Residuals beyond this many middle ones are left out of the planes.
const OUTLIER: f64 = 4.0;
/// Light across a dot may change by this much against its middle.
const LIGHT_CHANGE: [f64; 2] = [0.4, 2.5];
/// A pixel's cover, as measured; noise and gleams beyond are cut.
const COVER: [f64; 2] = [-0.25, 1.4];
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
enum Part {
    Free,
    Own,
    Other,
    /// Next to the dot and to another one: neither's, and no skin.
    Between,
}

/// The painted pixels of a blob and of its fading rim, with the share of each that is paint.
#[derive(Debug, Clone)]
pub(crate) struct Patch {
    /// x, y, cover.
    pixels: Vec<[f64; 3]>,
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
        let frame = Surroundings::of(&window, &parts, &colors, paint)?;
        let mut pixels = Vec::with_capacity(window.width * window.height);
        for (index, (part, color)) in parts.iter().zip(&colors).enumerate() {
            if *part == Part::Own {
                let [x, y] = window.offset(index);
                let cover = frame.cover(color, x, y).clamp(COVER[0], COVER[1]);
                pixels.push([window.middle[0] + x, window.middle[1] + y, cover]);
            }
        }
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
        let nearest = |spots: &[Spot], pixel: &[f64; 3]| {
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

fn centroid<'a>(pixels: impl Iterator<Item = &'a [f64; 3]>) -> Option<Spot> {
    let [mut area, mut x, mut y] = [0.0; 3];
    for [px, py, cover] in pixels {
        area += cover;
        x += cover * px;
        y += cover * py;
    }
    (area > 0.2).then(|| Spot { at: [x / area, y / area], area })
}

/// The part of the image around a blob.
struct Window {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
    /// The blob's rough middle: planes are about it.
    middle: [f64; 2],
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
        Some(Self { left: x, top: y, width: end[0] - x, height: end[1] - y, middle: blob.middle })
    }

    /// A pixel's place against the middle.
    fn offset(&self, index: usize) -> [f64; 2] {
        let (x, y) = (self.left + index % self.width, self.top + index / self.width);
        [x as f64 - self.middle[0], y as f64 - self.middle[1]]
    }

    /// Linear light of the pixels.
    fn colors(&self, picture: &Picture, paint: &Paint) -> Vec<[f64; 3]> {
        let mut colors = Vec::with_capacity(self.width * self.height);
        for y in self.top..self.top + self.height {
            let row = &picture.rgb[3 * (y * picture.width + self.left)..][..3 * self.width];
            colors.extend(
                row.chunks_exact(3)
                    .map(|p| std::array::from_fn(|c| f64::from(paint.light[usize::from(p[c])]))),
            );
        }
        colors
    }

    /// The dot with its fading rim, other dots with theirs, a gap, and what is free.
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
            parts = self.grown(&parts, Part::Own);
        }
        // The gap belongs to nobody.
        self.grown(&parts, Part::Between)
    }

    /// Lets the dots grow into what is free by one pixel; what is next to two of them becomes neither's. `own` is what
    /// the dot itself leaves on its way.
    fn grown(&self, parts: &[Part], own: Part) -> Vec<Part> {
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
                *part = [Part::Free, own, Part::Other, Part::Between][usize::from(touched)];
            }
        }
        grown
    }
}

/// The skin around a dot, and what follows for the measure of cover.
struct Surroundings {
    /// Answers to paint only.
    across: [f64; 3],
    /// What it finds on bare skin, and the skin's light: 1, x, y.
    bare: Vector3<f64>,
    light: Vector3<f64>,
    /// What full cover gives in the middle.
    full: f64,
}

impl Surroundings {
    fn of(window: &Window, parts: &[Part], colors: &[[f64; 3]], paint: &Paint) -> Option<Self> {
        let mut ring: Vec<usize> = (0..parts.len()).filter(|&i| parts[i] == Part::Free).collect();
        let brightness = |i: usize| colors[i].iter().sum::<f64>();
        let typical = median(&mut ring.iter().map(|&i| brightness(i)).collect::<Vec<_>>());
        ring.retain(|&i| (SKIN_LIGHT[0] * typical..=SKIN_LIGHT[1] * typical).contains(&brightness(i)));
        if ring.len() < FEWEST {
            return None;
        }
        let skin = unit(std::array::from_fn(|c| ring.iter().map(|&i| colors[i][c]).sum()));
        let along = dot(&paint.color, &skin);
        let across = std::array::from_fn(|c| paint.color[c] - along * skin[c]);
        let samples: Vec<[f64; 4]> = ring
            .iter()
            .map(|&i| {
                let [x, y] = window.offset(i);
                [x, y, dot(&across, &colors[i]), dot(&skin, &colors[i])]
            })
            .collect();
        let [bare, light] = robust_planes(&samples)?;
        Some(Self { across, bare, light, full: dot(&across, &paint.color) })
    }

    /// The share of a pixel that is paint; x and y are against the middle.
    fn cover(&self, color: &[f64; 3], x: f64, y: f64) -> f64 {
        let at = Vector3::new(1.0, x, y);
        let light = (self.light.dot(&at) / self.light.x).clamp(LIGHT_CHANGE[0], LIGHT_CHANGE[1]);
        (dot(&self.across, color) - self.bare.dot(&at)) / (light * self.full)
    }
}

/// Planes 1, x, y through the two values of each sample (x, y, value, value); samples off the first plane are left out in a
/// second round.
fn robust_planes(samples: &[[f64; 4]]) -> Option<[Vector3<f64>; 2]> {
    let planes = fit_planes(samples.iter())?;
    let off = |s: &[f64; 4]| (s[2] - planes[0].dot(&Vector3::new(1.0, s[0], s[1]))).abs();
    let mut residuals: Vec<f64> = samples.iter().map(off).collect();
    let limit = OUTLIER * median(&mut residuals);
    let kept: Vec<&[f64; 4]> = samples.iter().filter(|s| off(s) <= limit).collect();
    let planes = if kept.len() < FEWEST { planes } else { fit_planes(kept.into_iter())? };
    (planes[1].x > 0.0).then_some(planes)
}

fn fit_planes<'a>(samples: impl Iterator<Item = &'a [f64; 4]>) -> Option<[Vector3<f64>; 2]> {
    let mut normal = Matrix3::zeros();
    let mut right = [Vector3::zeros(); 2];
    for [x, y, first, second] in samples {
        let at = Vector3::new(1.0, *x, *y);
        normal += at * at.transpose();
        right[0] += *first * at;
        right[1] += *second * at;
    }
    let inverse = normal.try_inverse()?;
    Some(right.map(|right| inverse * right))
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(&a, &a).sqrt().max(f64::MIN_POSITIVE);
    a.map(|x| x / length)
}
