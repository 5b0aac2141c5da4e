//! What paint looks like: learnt from the labelled dots of one image.
//!
//! Light on the skin changes from place to place and from frame to frame, so only the *ratios* of red, green and blue in linear
//! light count. A pixel of coverage a shows k ((1 − a) s + a b), with the skin s and the paint b under the same light k: over a,
//! its ratios run along a curve from skin to paint. A table over log ratios tells, per pixel, how far along that curve it is,
//! or that it is off the curve.

use crate::Error;
use crate::Picture;
use artifact::Transfer;

/// Cells of the table along each log ratio.
const SIDE: usize = 128;
/// Logarithms are kept this much finer than the table's cells.
const FINER: i32 = 8;
/// What is added to light before its logarithm, as a share of the paint's brightest channel: below it, ratios are noise.
const FLOOR_SHARE: f64 = 0.02;
/// How far from a label its dot may be found, px: hands shake.
const SHAKE_PX: f64 = 2.5;
/// Half of the window around a label that shows its surroundings: at least and at most, px.
const WINDOW_PX: [f64; 2] = [5.0, 20.0];
/// The least difference between paint and skin, in log ratios: 0.4 is the ratio of two channels changed by half.
const LEAST_CONTRAST: f64 = 0.4;
/// Steps of coverage along the curve.
const STEPS: usize = 48;
/// How far from the curve a pixel may be, in log ratios, where the mask begins.
const NARROW: f64 = 0.09;
/// … and at full coverage, at least and at most; between them, four times the spread of the labelled dots.
const WIDE: [f64; 2] = [0.25, 0.6];
/// What lies this far beyond a dot's radius, px, in so many directions, may show through at its rim; as much of a pixel must be
/// paint then.
const GROUND_PX: f64 = 2.5;
const DIRECTIONS: u32 = 12;
const GROUND_COVERAGE: f64 = 0.4;
/// A colour is not paint's if the labelled image shows it elsewhere so many times as often as on labelled dots: unlabelled
/// dots may be as frequent as three to each labelled one.
const ELSEWHERE: u32 = 4;
/// With fewer labels than this, most dots are unlabelled, and where dots are not is not known.
const ENOUGH: usize = 8;
/// A dot reaches this far beyond its middle radius, px; what is farther than the second from twice the radius is no dot.
const ON_PX: f64 = 1.5;
const NEITHER_PX: f64 = 2.0;

/// The colour of the markers in one camera.
#[derive(Debug, Clone)]
pub struct Paint {
    /// Linear light of the codes.
    pub(crate) light: [f32; 256],
    /// Logarithm of each code's light, in parts of a cell.
    log: [i32; 256],
    /// Coverage 0–255 by log red/green and log blue/green.
    table: Vec<u8>,
    /// Linear red, green, blue of full cover.
    pub(crate) color: [f64; 3],
    /// Width of a cell, in log ratios.
    cell: f64,
    floor: f64,
}

/// A label's dot and what surrounds it, linear light.
struct Sample {
    dot: [f64; 3],
    around: [f64; 3],
    contrast: f64,
}

impl Paint {
    /// Learns the paint from places in an image that lie on dots. `transfer` is the transfer function of its codes;
    /// `least_coverage` the coverage at which a pixel counts as painted.
    ///
    /// # Errors
    /// [`Error::NoContrast`] where most places look like what surrounds them; [`Error::NoLabels`].
    pub fn learn(
        picture: &Picture,
        transfer: Transfer,
        places: &[[f64; 2]],
        least_coverage: f64,
    ) -> Result<Self, Error> {
        let light = transfer.light_of_codes().map(|light| light as f32);
        let places: Vec<[f64; 2]> = places.iter().copied().filter(|at| picture.contains(*at)).collect();
        if places.is_empty() {
            return Err(Error::NoLabels);
        }
        let reach = (0.5 * typical_spacing(&places)).clamp(WINDOW_PX[0], WINDOW_PX[1]);
        let samples: Vec<Sample> =
            places.iter().map(|at| Sample::around(picture, &light, *at, reach)).collect();
        let (color, spread, contrast) = pooled(&samples);
        if contrast < LEAST_CONTRAST {
            return Err(Error::NoContrast);
        }
        let mut paint = Self::empty(light, color);
        let wide = (4.0 * spread).clamp(WIDE[0], WIDE[1]);
        let mut nearest = vec![f64::INFINITY; SIDE * SIDE];
        for sample in &samples {
            paint.stamp(sample.around, least_coverage, wide, &mut nearest);
        }
        let radius = paint.typical_radius(picture, &places, reach);
        paint.stamp_grounds(picture, &places, radius + GROUND_PX, wide, &mut nearest);
        if places.len() >= ENOUGH {
            paint.unlearn(picture, &places, radius);
        }
        Ok(paint)
    }

    fn empty(light: [f32; 256], color: [f64; 3]) -> Self {
        let floor = FLOOR_SHARE * color.iter().copied().fold(0.0, f64::max);
        // Ratios of any two codes stay inside the table.
        let widest = ((1.0 + floor) / floor).ln();
        let cell = 2.0 * widest / (SIDE as f64 - 2.0);
        let log = std::array::from_fn(|code| {
            ((f64::from(light[code]) + floor).ln() / cell * f64::from(FINER)).round() as i32
        });
        Self { light, log, table: vec![0; SIDE * SIDE], color, cell, floor }
    }

    /// Coverage of a pixel, 0–255; 0 where it is no mixture of skin and paint.
    #[inline(always)]
    pub(crate) fn coverage(&self, [r, g, b]: [u8; 3]) -> u8 {
        self.table[self.place([r, g, b])]
    }

    #[inline(always)]
    fn place(&self, [r, g, b]: [u8; 3]) -> usize {
        let green = self.log[usize::from(g)];
        let cell = |code: u8| {
            (((self.log[usize::from(code)] - green + FINER / 2) >> FINER.trailing_zeros()) + SIDE as i32 / 2)
                as usize
        };
        // Both are in range by the choice of the cell; the mask says so to the compiler.
        (cell(r) * SIDE + cell(b)) & (SIDE * SIDE - 1)
    }

    /// Enters the curves from what lies close to each dot, which may be another paint; each colour once.
    fn stamp_grounds(
        &mut self,
        picture: &Picture,
        places: &[[f64; 2]],
        radius: f64,
        wide: f64,
        nearest: &mut [f64],
    ) {
        let here = ratios(self.color, self.floor);
        let mut done = vec![false; SIDE * SIDE];
        for at in places {
            for direction in 0..DIRECTIONS {
                let turn = std::f64::consts::TAU * f64::from(direction) / f64::from(DIRECTIONS);
                let [x, y] = [at[0] + radius * turn.cos(), at[1] + radius * turn.sin()];
                if !picture.contains([x, y]) {
                    continue;
                }
                let codes = picture.at(x.round().max(0.0) as usize, y.round().max(0.0) as usize);
                let place = self.place(codes);
                let ground = codes.map(|code| f64::from(self.light[usize::from(code)]));
                let there = ratios(ground, self.floor);
                if !done[place] && apart([there[0] - here[0], there[1] - here[1]]) >= LEAST_CONTRAST {
                    done[place] = true;
                    self.stamp(ground, GROUND_COVERAGE, wide, nearest);
                }
            }
        }
    }

    /// Enters the curve from a surrounding to the paint into the table.
    fn stamp(&mut self, around: [f64; 3], least: f64, wide: f64, nearest: &mut [f64]) {
        for step in 0..=STEPS {
            let share = least + (1.0 - least) * step as f64 / STEPS as f64;
            let mixed = std::array::from_fn(|c| (1.0 - share) * around[c] + share * self.color[c]);
            let at = ratios(mixed, self.floor);
            let reach = NARROW + (wide - NARROW) * (share - least) / (1.0 - least);
            self.stamp_disc(at, reach, share, nearest);
        }
    }

    fn stamp_disc(&mut self, at: [f64; 2], reach: f64, share: f64, nearest: &mut [f64]) {
        let middle = at.map(|x| x / self.cell + SIDE as f64 / 2.0);
        // The metric shortens diagonals by at most √2, so that a square of √2 reach holds the disc.
        let cells = 1.5 * reach / self.cell + 1.0;
        let range = |x: f64| {
            let low = (x - cells).floor().max(0.0) as usize;
            low..=((x + cells).ceil().max(0.0) as usize).min(SIDE - 1)
        };
        for row in range(middle[0]) {
            for column in range(middle[1]) {
                let off = [row as f64 - middle[0], column as f64 - middle[1]].map(|x| x * self.cell);
                let distance = apart(off);
                let entry = row * SIDE + column;
                if distance <= reach && distance < nearest[entry] {
                    nearest[entry] = distance;
                    self.table[entry] = (255.0 * share).round().max(1.0) as u8;
                }
            }
        }
    }

    /// Takes colours out of the table that the labelled image shows mostly away from dots.
    fn unlearn(&mut self, picture: &Picture, places: &[[f64; 2]], radius: f64) {
        const ON: u8 = 0;
        const NEITHER: u8 = 1;
        const OFF: u8 = 2;
        let mut zones = vec![OFF; picture.width * picture.height];
        for (zone, reach) in [(NEITHER, 2.0 * radius + NEITHER_PX), (ON, radius + ON_PX)] {
            for at in places {
                let [columns, rows] = window(picture, *at, reach);
                rows.for_each(|y| zones[y * picture.width..][columns.clone()].fill(zone));
            }
        }
        let mut counts = vec![[0u32; 3]; SIDE * SIDE];
        for (pixel, zone) in picture.rgb.chunks_exact(3).zip(&zones) {
            let place = self.place([pixel[0], pixel[1], pixel[2]]);
            counts[place][usize::from(*zone)] += 1;
        }
        let around = |place: usize, zone: u8| -> u32 {
            let (row, column) = (place / SIDE, place % SIDE);
            let rows = row.saturating_sub(1)..(row + 2).min(SIDE);
            let columns = column.saturating_sub(1)..(column + 2).min(SIDE);
            rows.map(|r| {
                counts[r * SIDE..][columns.clone()].iter().map(|c| c[usize::from(zone)]).sum::<u32>()
            })
            .sum()
        };
        for place in (0..SIDE * SIDE).filter(|&place| self.table[place] > 0).collect::<Vec<_>>() {
            if around(place, OFF) > ELSEWHERE * (around(place, ON) + 1) {
                self.table[place] = 0;
            }
        }
    }

    /// The middle radius of the dots at the labels, px, from the pixels that are mostly paint.
    fn typical_radius(&self, picture: &Picture, places: &[[f64; 2]], reach: f64) -> f64 {
        let painted = |at: &[f64; 2]| {
            let [columns, rows] = window(picture, *at, reach);
            let cover = |y| columns.clone().filter(move |&x| self.coverage(picture.at(x, y)) > 128).count();
            (rows.map(cover).sum::<usize>() as f64 / std::f64::consts::PI).sqrt()
        };
        median(&mut places.iter().map(painted).collect::<Vec<_>>())
    }
}

impl Sample {
    fn around(picture: &Picture, light: &[f32; 256], at: [f64; 2], reach: f64) -> Self {
        let [columns, rows] = window(picture, at, reach);
        let mut channels = [Vec::new(), Vec::new(), Vec::new()];
        let linear = |x, y| picture.at(x, y).map(|code| f64::from(light[usize::from(code)]));
        for y in rows {
            for x in columns.clone() {
                linear(x, y).into_iter().zip(&mut channels).for_each(|(value, all)| all.push(value));
            }
        }
        let around = channels.map(|mut values| median(&mut values));
        let floor = FLOOR_SHARE * around.iter().copied().fold(1e-6, f64::max);
        let here = ratios(around, floor);
        let mut best = (-1.0, around);
        let [columns, rows] = window(picture, at, SHAKE_PX);
        for y in rows {
            for x in columns.clone().filter(|&x| (x as f64 - at[0]).hypot(y as f64 - at[1]) <= SHAKE_PX) {
                let there = ratios(linear(x, y), floor);
                let contrast = apart([there[0] - here[0], there[1] - here[1]]);
                if contrast > best.0 {
                    best = (contrast, linear(x, y));
                }
            }
        }
        Self { dot: best.1, around, contrast: best.0 }
    }
}

/// Colour of the paint, spread of the dots' log ratios about it, and its contrast, from the half of the dots that differ most
/// from what surrounds them: the others are small, oblique, or no dots.
fn pooled(samples: &[Sample]) -> ([f64; 3], f64, f64) {
    let mut contrasts: Vec<f64> = samples.iter().map(|sample| sample.contrast).collect();
    let contrast = median(&mut contrasts);
    let best: Vec<&Sample> = samples.iter().filter(|sample| sample.contrast >= contrast).collect();
    let color: [f64; 3] =
        std::array::from_fn(|c| median(&mut best.iter().map(|sample| sample.dot[c]).collect::<Vec<_>>()));
    let floor = FLOOR_SHARE * color.iter().copied().fold(1e-6, f64::max);
    let middle = ratios(color, floor);
    let mut off: Vec<f64> = best
        .iter()
        .map(|sample| {
            let at = ratios(sample.dot, floor);
            apart([at[0] - middle[0], at[1] - middle[1]])
        })
        .collect();
    (color, median(&mut off), contrast)
}

/// ln(red / green), ln(blue / green).
fn ratios([r, g, b]: [f64; 3], floor: f64) -> [f64; 2] {
    let [r, g, b] = [r, g, b].map(|x| (x.max(0.0) + floor).ln());
    [r - g, b - g]
}

/// Distance of two log ratios that treats the three channels alike: the length of (ln r, ln g, ln b) less its mean.
fn apart([u, v]: [f64; 2]) -> f64 {
    ((u * u + v * v - u * v) * (2.0 / 3.0)).sqrt()
}

/// Columns and rows within `reach` of a place, cut at the image's border.
fn window(picture: &Picture, at: [f64; 2], reach: f64) -> [std::ops::Range<usize>; 2] {
    let range = |x: f64, side: usize| {
        let low = ((x - reach).ceil().max(0.0) as usize).min(side);
        low..(((x + reach).floor() + 1.0).max(0.0) as usize).clamp(low, side)
    };
    [range(at[0], picture.width), range(at[1], picture.height)]
}

/// The middle of the distances from each place to its nearest other one, px.
pub(crate) fn typical_spacing(places: &[[f64; 2]]) -> f64 {
    let nearest = |at: &[f64; 2]| {
        let others = places.iter().map(|other| (other[0] - at[0]).hypot(other[1] - at[1]));
        others.filter(|distance| *distance > 0.0).fold(f64::INFINITY, f64::min)
    };
    let mut distances: Vec<f64> = places.iter().map(nearest).filter(|x| x.is_finite()).collect();
    match distances.is_empty() {
        true => 2.0 * WINDOW_PX[1],
        false => median(&mut distances),
    }
}

/// The upper median; 0 of nothing.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
