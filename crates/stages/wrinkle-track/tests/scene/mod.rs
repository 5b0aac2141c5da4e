//! Skin with painted strokes, drawn pixel by pixel: small, and known.
#![allow(dead_code, clippy::unwrap_used, reason = "each test binary uses a part")]

use artifact::Transfer;
use artifact::picture::{Codes, Marked, Rgb};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use wrinkle_track::{FLOOR, Picture};

/// Width, height, px.
pub(crate) const SIZE: [usize; 2] = [240, 180];

pub(crate) const GREEN: [u8; 3] = [0, 255, 0];
pub(crate) const VIOLET: [u8; 3] = [200, 0, 255];

/// Linear light of skin and paints.
const SKIN: [f64; 3] = [0.50, 0.31, 0.23];
const PAINTS: [[f64; 3]; 2] = [[0.05, 0.34, 0.10], [0.30, 0.07, 0.38]];

/// A stroke of paint: a line, half its width, px, and how dark its valley is (share of light at the line).
#[derive(Debug, Clone)]
pub(crate) struct Stroke {
    pub(crate) line: Vec<[f64; 2]>,
    pub(crate) half: f64,
    /// 0 green, 1 violet.
    pub(crate) paint: usize,
    pub(crate) dark: f64,
    /// How far the valley lies beside the middle of the paint, downwards, px.
    pub(crate) off: f64,
}

impl Stroke {
    pub(crate) fn new(line: &[[f64; 2]], paint: usize) -> Self {
        Self { line: line.to_vec(), half: 6.0, paint, dark: 0.7, off: 0.0 }
    }

    pub(crate) fn moved(&self, by: [f64; 2]) -> Self {
        let line = self.line.iter().map(|at| [at[0] + by[0], at[1] + by[1]]).collect();
        Self { line, ..self.clone() }
    }

    /// Distance of a place from the line.
    pub(crate) fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        let segment = |pair: &[[f64; 2]]| {
            let [dx, dy] = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            let share = ((x - pair[0][0]) * dx + (y - pair[0][1]) * dy) / (dx * dx + dy * dy);
            let share = share.clamp(0.0, 1.0);
            (x - pair[0][0] - share * dx).hypot(y - pair[0][1] - share * dy)
        };
        self.line.windows(2).map(segment).fold(f64::INFINITY, f64::min)
    }

    fn cover(&self, at: [f64; 2]) -> f64 {
        (self.half - self.distance(at) + 0.5).clamp(0.0, 1.0)
    }

    fn light(&self, [x, y]: [f64; 2]) -> f64 {
        1.0 - (1.0 - self.dark) * (-(self.distance([x, y - self.off]) / 1.5).powi(2)).exp()
    }
}

/// Two green strokes and a violet one.
pub(crate) fn strokes() -> Vec<Stroke> {
    vec![
        Stroke::new(&[[40.0, 40.0], [110.0, 36.0], [190.0, 44.0]], 0),
        Stroke::new(&[[40.0, 75.0], [110.0, 71.0], [190.0, 79.0]], 1),
        Stroke::new(&[[60.0, 110.0], [110.0, 130.0], [170.0, 140.0]], 0),
    ]
}

/// How a scene is filmed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Look {
    pub(crate) light: f64,
    /// Noise of the codes, standard deviation.
    pub(crate) noise: f64,
    pub(crate) seed: u64,
    /// Colours of all pixels as they are, or of blocks of two by two.
    pub(crate) subsampled: bool,
}

impl Default for Look {
    fn default() -> Self {
        Self { light: 1.0, noise: 1.5, seed: 1, subsampled: false }
    }
}

/// Codes of sRGB.
pub(crate) fn draw(strokes: &[Stroke], look: Look) -> Vec<u8> {
    let mut rng = ChaCha8Rng::seed_from_u64(look.seed);
    let mut codes: Vec<[f64; 3]> = Vec::with_capacity(SIZE[0] * SIZE[1]);
    for pixel in 0..SIZE[0] * SIZE[1] {
        let at = [(pixel % SIZE[0]) as f64, (pixel / SIZE[0]) as f64];
        let mut color = SKIN;
        for stroke in strokes {
            let (cover, light) = (stroke.cover(at), stroke.light(at));
            let mixed = |i: usize| color[i] * (1.0 - cover) + PAINTS[stroke.paint][i] * light * cover;
            color = [0, 1, 2].map(mixed);
        }
        let mut noise = || {
            let sum: f64 = (0..12).map(|_| rng.random_range(0.0..1.0)).sum::<f64>() - 6.0;
            look.noise * sum
        };
        codes.push(color.map(|light| 255.0 * stored(light * look.light) + noise()));
    }
    if look.subsampled {
        subsample(&mut codes);
    }
    codes.iter().flatten().map(|code| code.round().clamp(0.0, 255.0) as u8).collect()
}

fn stored(light: f64) -> f64 {
    let light = light.clamp(0.0, 1.0);
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

/// One colour for each block of two by two pixels, brightness for each pixel.
fn subsample(codes: &mut [[f64; 3]]) {
    let luma = |code: [f64; 3]| 0.299 * code[0] + 0.587 * code[1] + 0.114 * code[2];
    for y in (0..SIZE[1]).step_by(2) {
        for x in (0..SIZE[0]).step_by(2) {
            let block = [0, 1, SIZE[0], SIZE[0] + 1].map(|offset| y * SIZE[0] + x + offset);
            let mean = [0, 1, 2].map(|i| block.iter().map(|at| codes[*at][i]).sum::<f64>() / 4.0);
            for at in block {
                let bright = luma(codes[at]) - luma(mean);
                codes[at] = mean.map(|value| value + bright);
            }
        }
    }
}

pub(crate) fn rgb(codes: Vec<u8>) -> Rgb {
    Rgb { width: SIZE[0], height: SIZE[1], codes: Codes::Bits8(codes) }
}

pub(crate) fn picture(strokes: &[Stroke], look: Look) -> Picture {
    Picture::new(&rgb(draw(strokes, look)), Transfer::Srgb, FLOOR).unwrap()
}

/// What somebody marks: pixels of half cover and more.
pub(crate) fn mask(strokes: &[Stroke]) -> Marked {
    let mark = |pixel: usize| {
        let at = [(pixel % SIZE[0]) as f64, (pixel / SIZE[0]) as f64];
        let stroke = strokes.iter().rev().find(|stroke| stroke.cover(at) >= 0.5)?;
        Some([GREEN, VIOLET][stroke.paint])
    };
    Marked { width: SIZE[0], height: SIZE[1], marks: (0..SIZE[0] * SIZE[1]).map(mark).collect() }
}

/// Red, green and blue of a mask.
pub(crate) fn mask_codes(mask: &Marked) -> Vec<u8> {
    mask.marks.iter().flat_map(|mark| mark.unwrap_or([0; 3])).collect()
}
