//! Which pixels beside a curve show its paint, and how bright they are.

use crate::Picture;
use crate::albedo::extremes;
use crate::bare::bare_skin;
use crate::curve::Curve;
use nalgebra::Vector2;

/// Added to linear light before ratios are taken, so that the dark ones do not drown in noise.
const FLOOR: f64 = 0.004;
/// Less light than this has no logarithm that means anything.
const DARKEST: f64 = 1e-4;
/// Pixels so near to the curve are taken for paint, to learn its colour, px.
const NEAR: f64 = 2.5;
/// Log-ratios so many robust deviations off are another colour …
const DEVIATIONS: f64 = 6.0;
/// … but not nearer and not farther than this.
pub(crate) const DISTANCES: [f64; 2] = [0.25, 0.6];
/// How far inside the paint's edge pixels must lie, px.
pub(crate) const EROSION: i64 = 2;
/// Codes from here on may be clipped, and up to there hold no light.
const SATURATED: u8 = 254;
const BLACK: u8 = 3;

/// A painted pixel beside a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pixel {
    /// Length along the curve, px.
    pub x: f64,
    /// Distance from the curve, px; positive on its right.
    pub p: f64,
    /// Light, as share of that of bright paint.
    pub light: f64,
    /// ln of its light in the paint's brightest channel over that in the darkest.
    pub ratio: f64,
    /// Column and row in the image.
    pub place: [u32; 2],
}

/// The painted pixels beside a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Pixels at least 2 px inside the paint.
    pub pixels: Vec<Pixel>,
    /// Bare skin beside paint that is narrow, its light as share of bright skin's.
    pub skin: Vec<Pixel>,
    /// Linear light of bright paint.
    pub color: [f64; 3],
    /// Painted pixels that were left out because a channel is saturated.
    pub saturated: usize,
    /// … because they are black.
    pub black: usize,
}

/// A part of the image around a curve.
pub(crate) struct Window {
    corner: [i64; 2],
    pub(crate) size: [usize; 2],
}

impl Window {
    /// Around the curve, up to `reach` px from it; none where that lies outside the image.
    pub(crate) fn around(curve: &Curve, reach: f64, picture: &Picture) -> Option<Self> {
        let count = (curve.len() / 4.0).ceil().max(1.0);
        let places = (0..=count as usize).map(|i| curve.at(curve.len() * i as f64 / count).1);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in places {
            for axis in 0..2 {
                low[axis] = low[axis].min(place[axis] - reach);
                high[axis] = high[axis].max(place[axis] + reach);
            }
        }
        let limits = [picture.width as f64, picture.height as f64];
        let from = [0, 1].map(|axis| low[axis].floor().clamp(0.0, limits[axis]) as i64);
        let to = [0, 1].map(|axis| (high[axis].ceil() + 1.0).clamp(0.0, limits[axis]) as i64);
        let size = [0, 1].map(|axis| (to[axis] - from[axis]).max(0) as usize);
        (size[0] > 0 && size[1] > 0).then_some(Self { corner: from, size })
    }

    pub(crate) fn place(&self, index: usize) -> [usize; 2] {
        [index % self.size[0] + self.corner[0] as usize, index / self.size[0] + self.corner[1] as usize]
    }

    pub(crate) fn index(&self, [x, y]: [i64; 2]) -> Option<usize> {
        let (x, y) = (x - self.corner[0], y - self.corner[1]);
        let inside = x >= 0 && y >= 0 && (x as usize) < self.size[0] && (y as usize) < self.size[1];
        inside.then(|| y as usize * self.size[0] + x as usize)
    }
}

/// Log-ratios of linear light by code: ln(G/R), ln(B/G).
pub(crate) struct Ratios([f64; 256]);

impl Ratios {
    pub(crate) fn of(light: &[f64; 256]) -> Self {
        Self(light.map(|light| (light + FLOOR).ln()))
    }

    pub(crate) fn at(&self, codes: [u8; 3]) -> [f64; 2] {
        let [r, g, b] = codes.map(|code| self.0[usize::from(code)]);
        [g - r, b - g]
    }
}

pub(crate) fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The colour of the paint along a curve: median log-ratios, and how far others may be off.
fn paint_color(curve: &Curve, picture: &Picture, ratios: &Ratios) -> Option<([f64; 2], f64)> {
    let mut found: Vec<[f64; 2]> = Vec::new();
    for i in 0..curve.len().ceil() as usize {
        let (_, at, right) = curve.at(i as f64);
        for off in -2..=2 {
            let place = at + right * (f64::from(off) * 0.5 * NEAR);
            let [x, y] = [place.x.round(), place.y.round()];
            let inside = x >= 0.0 && y >= 0.0 && x < picture.width as f64 && y < picture.height as f64;
            let codes = inside.then(|| picture.at(x as usize, y as usize));
            found.extend(codes.filter(|codes| is_usable(*codes)).map(|codes| ratios.at(codes)));
        }
    }
    if found.is_empty() {
        return None;
    }
    let middle = [0, 1].map(|k| median(&mut found.iter().map(|ratio| ratio[k]).collect::<Vec<_>>()));
    let mut off: Vec<f64> = found.iter().map(|ratio| distance(ratio, &middle)).collect();
    Some((middle, (DEVIATIONS * median(&mut off)).clamp(DISTANCES[0], DISTANCES[1])))
}

pub(crate) fn distance(one: &[f64; 2], other: &[f64; 2]) -> f64 {
    (one[0] - other[0]).hypot(one[1] - other[1])
}

pub(crate) fn is_usable(codes: [u8; 3]) -> bool {
    codes.iter().all(|&code| code < SATURATED) && codes.iter().any(|&code| code > BLACK)
}

/// What becomes of a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    Other,
    Paint,
    Saturated,
    Black,
}

/// The painted pixels beside a curve, at most `reach` px from it, that hang together with paint on the curve.
///
/// The paint's colour is learnt along the curve, as ratios of linear light, which no shadow changes. None where the curve leaves the
/// image, or nothing painted is left.
#[must_use]
pub fn band(picture: &Picture, light: &[f64; 256], curve: &Curve, reach: f64) -> Option<Band> {
    let ratios = Ratios::of(light);
    let window = Window::around(curve, reach, picture)?;
    let (color, most) = paint_color(curve, picture, &ratios)?;
    let mark = |index: usize| {
        let [x, y] = window.place(index);
        let codes = picture.at(x, y);
        match codes {
            _ if codes.iter().all(|&code| code <= BLACK) => Mark::Black,
            _ if codes.iter().any(|&code| code >= SATURATED) => Mark::Saturated,
            _ if distance(&ratios.at(codes), &color) < most => Mark::Paint,
            _ => Mark::Other,
        }
    };
    let marks: Vec<Mark> = (0..window.size[0] * window.size[1]).map(mark).collect();
    let marks = enclosed(&window, &marks);
    let joined = joined(&window, &marks, curve);
    let inner = eroded(&window, &marks, &joined);
    let placed: Vec<(usize, Pixel)> = inner
        .into_iter()
        .filter_map(|index| {
            let [x, y] = window.place(index);
            let foot = curve.foot(Vector2::new(x as f64, y as f64)).filter(|foot| foot.p.abs() <= reach)?;
            Some((index, Pixel { x: foot.x, p: foot.p, light: 0.0, ratio: 0.0, place: [x as u32, y as u32] }))
        })
        .collect();
    let count = |wanted: Mark| joined.iter().zip(&marks).filter(|&(&is, &mark)| is && mark == wanted).count();
    let (saturated, black) = (count(Mark::Saturated), count(Mark::Black));
    let codes = |[x, y]: [u32; 2]| picture.at(x as usize, y as usize).map(|code| light[usize::from(code)]);
    let color = bright(placed.iter().map(|(_, pixel)| codes(pixel.place)))?;
    let weight = color.iter().map(|light| light * light).sum::<f64>();
    let (most, least) = extremes(&color);
    let channel = |wanted: f64| color.iter().position(|light| *light == wanted).unwrap_or(0);
    let (bright, dark) = (channel(most), channel(least));
    let lit = |(_, pixel): (usize, Pixel)| {
        let lights = codes(pixel.place);
        let sum: f64 = lights.iter().zip(color).map(|(light, color)| light * color).sum();
        let ratio = ((lights[bright] + DARKEST) / (lights[dark] + DARKEST)).ln();
        Pixel { light: sum / weight, ratio, ..pixel }
    };
    let pixels: Vec<Pixel> = placed.into_iter().map(lit).collect();
    let skin = bare_skin(picture, light, curve, &pixels, &ratios).unwrap_or_default();
    Some(Band { pixels, skin, color, saturated, black })
}

/// The light of bright paint: the 80 % of each channel.
pub(crate) fn bright(lights: impl Iterator<Item = [f64; 3]> + Clone) -> Option<[f64; 3]> {
    let channel = |k: usize| {
        let mut values: Vec<f64> = lights.clone().map(|light| light[k]).collect();
        let place = values.len() * 4 / 5;
        (!values.is_empty()).then(|| *values.select_nth_unstable_by(place, f64::total_cmp).1)
    };
    let color = [channel(0)?, channel(1)?, channel(2)?];
    (color.iter().sum::<f64>() > 0.0).then_some(color)
}

/// Clipped pixels count only where paint is on both sides of them: beside a dark background they are none of the paint's.
fn enclosed(window: &Window, marks: &[Mark]) -> Vec<Mark> {
    let is_clipped = |mark: Mark| mark == Mark::Saturated || mark == Mark::Black;
    let paint_towards = |index: usize, [dx, dy]: [i64; 2]| {
        let [x, y] = window.place(index).map(|place| place as i64);
        let beside = (1..=CLIPPED).filter_map(|step| window.index([x + step * dx, y + step * dy]));
        beside.map(|index| marks[index]).find(|mark| !is_clipped(*mark)) == Some(Mark::Paint)
    };
    let keeps = |index: usize| {
        let sides = [[[1, 0], [-1, 0]], [[0, 1], [0, -1]]];
        sides.iter().any(|sides| sides.iter().all(|&side| paint_towards(index, side)))
    };
    let kept = |(index, &mark): (usize, &Mark)| match is_clipped(mark) && !keeps(index) {
        true => Mark::Other,
        false => mark,
    };
    marks.iter().enumerate().map(kept).collect()
}

/// Clipped places in the paint are not wider, px.
const CLIPPED: i64 = 12;
const AROUND: [[i64; 2]; 4] = [[1, 0], [-1, 0], [0, 1], [0, -1]];

/// Paint, and what is clipped within it, that hangs together with paint on the curve.
fn joined(window: &Window, marks: &[Mark], curve: &Curve) -> Vec<bool> {
    let mut joined = vec![false; marks.len()];
    let mut open: Vec<usize> = Vec::new();
    for i in 0..curve.len().ceil() as usize {
        let (_, at, right) = curve.at(i as f64);
        for off in [0.0, -NEAR, NEAR] {
            let place = at + right * off;
            let index = window.index([place.x.round() as i64, place.y.round() as i64]);
            open.extend(index.filter(|&index| marks[index] == Mark::Paint));
        }
    }
    while let Some(index) = open.pop() {
        if std::mem::replace(&mut joined[index], true) {
            continue;
        }
        let [x, y] = window.place(index).map(|place| place as i64);
        let beside = AROUND.iter().filter_map(|[dx, dy]| window.index([x + dx, y + dy]));
        open.extend(beside.filter(|&index| marks[index] != Mark::Other && !joined[index]));
    }
    joined
}

/// Painted pixels with nothing else around them, indices in the window, rising.
fn eroded(window: &Window, marks: &[Mark], joined: &[bool]) -> Vec<usize> {
    let disk: Vec<[i64; 2]> = (-EROSION..=EROSION)
        .flat_map(|dy| (-EROSION..=EROSION).map(move |dx| [dx, dy]))
        .filter(|[dx, dy]| dx * dx + dy * dy <= EROSION * EROSION)
        .collect();
    let is_inner = |index: &usize| {
        let [x, y] = window.place(*index).map(|place| place as i64);
        let is_paint =
            |[dx, dy]: &[i64; 2]| window.index([x + dx, y + dy]).is_some_and(|index| joined[index]);
        marks[*index] == Mark::Paint && joined[*index] && disk.iter().all(is_paint)
    };
    (0..marks.len()).filter(is_inner).collect()
}
