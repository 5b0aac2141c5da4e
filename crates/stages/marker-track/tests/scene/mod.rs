//! Small images of blue dots on skin, drawn with 8 × 8 samples per pixel and stored as sRGB.

#![allow(dead_code, reason = "each test file uses its part")]

use rand::{Rng, SeedableRng};
use std::collections::BTreeMap;

pub(crate) const SIZE: [usize; 2] = [160, 120];
pub(crate) const SKIN: [f64; 3] = [0.42, 0.27, 0.2];
pub(crate) const PAINT: [f64; 3] = [0.012, 0.045, 0.24];
const SAMPLES: usize = 8;
/// Standard deviation of the blur, px.
const BLUR: f64 = 0.7;

/// A dot: place and radius, px.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dot {
    pub(crate) at: [f64; 2],
    pub(crate) radius: f64,
}

/// How the image is taken.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Look {
    /// All light is multiplied by this.
    pub(crate) gain: f64,
    /// Light grows by this share per pixel to the right.
    pub(crate) gradient: f64,
    /// Standard deviation of the noise, share of mid-grey.
    pub(crate) noise: f64,
    pub(crate) seed: u64,
}

impl Default for Look {
    fn default() -> Self {
        Self { gain: 1.0, gradient: 0.0, noise: 0.01, seed: 1 }
    }
}

pub(crate) fn grid() -> Vec<Dot> {
    (0..12)
        .map(|i| Dot {
            at: [20.3 + 37.1 * f64::from(i % 4), 22.7 + 35.4 * f64::from(i / 4)],
            radius: 2.0 + 0.15 * f64::from(i),
        })
        .collect()
}

pub(crate) fn names(dots: &[Dot]) -> Vec<String> {
    (0..dots.len()).map(|i| format!("d{i:02}")).collect()
}

pub(crate) fn labels(dots: &[Dot]) -> BTreeMap<String, [f64; 2]> {
    names(dots).into_iter().zip(dots.iter().map(|dot| dot.at.map(|x| (2.0 * x).round() / 2.0))).collect()
}

fn stored(light: f64) -> u8 {
    let light = light.clamp(0.0, 1.0);
    let code = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (255.0 * code).round() as u8
}

fn cover(dots: &[Dot], x: usize, y: usize) -> f64 {
    let close = |dot: &&Dot| {
        (dot.at[0] - x as f64).abs() < dot.radius + 1.0 && (dot.at[1] - y as f64).abs() < dot.radius + 1.0
    };
    let near: Vec<&Dot> = dots.iter().filter(close).collect();
    let place = |k: usize| (k as f64 + 0.5) / SAMPLES as f64 - 0.5;
    let inside =
        |sx: f64, sy: f64| near.iter().any(|dot| (sx - dot.at[0]).hypot(sy - dot.at[1]) <= dot.radius);
    let hits = (0..SAMPLES * SAMPLES)
        .filter(|k| inside(x as f64 + place(k % SAMPLES), y as f64 + place(k / SAMPLES)))
        .count();
    hits as f64 / (SAMPLES * SAMPLES) as f64
}

/// The image of some dots.
pub(crate) fn draw(dots: &[Dot], look: Look) -> Vec<u8> {
    draw_on(dots, look, |_, _| SKIN)
}

/// The image of some dots on a ground that has a colour of its own at each pixel.
pub(crate) fn draw_on(dots: &[Dot], look: Look, ground: impl Fn(usize, usize) -> [f64; 3]) -> Vec<u8> {
    let [width, height] = SIZE;
    let light = |x: usize| look.gain * (1.0 + look.gradient * (x as f64 - width as f64 / 2.0)).max(0.1);
    let sharp: Vec<[f64; 3]> = (0..width * height)
        .map(|i| {
            let share = cover(dots, i % width, i / width);
            let ground = ground(i % width, i / width);
            std::array::from_fn(|c| light(i % width) * ((1.0 - share) * ground[c] + share * PAINT[c]))
        })
        .collect();
    let weights: Vec<f64> = (-3i32..=3).map(|k| (-f64::from(k * k) / (2.0 * BLUR * BLUR)).exp()).collect();
    let total: f64 = weights.iter().sum();
    let blur = |image: &[[f64; 3]], step: [i64; 2]| -> Vec<[f64; 3]> {
        (0..width * height)
            .map(|i| {
                let mut sum = [0.0; 3];
                for (k, weight) in weights.iter().enumerate() {
                    let off = k as i64 - 3;
                    let x = ((i % width) as i64 + off * step[0]).clamp(0, width as i64 - 1) as usize;
                    let y = ((i / width) as i64 + off * step[1]).clamp(0, height as i64 - 1) as usize;
                    (0..3).for_each(|c| sum[c] += weight / total * image[y * width + x][c]);
                }
                sum
            })
            .collect()
    };
    let soft = blur(&blur(&sharp, [1, 0]), [0, 1]);
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(look.seed);
    let mut noise = || {
        let sum: f64 = (0..12).map(|_| rng.random_range(-0.5..0.5)).sum();
        0.18 * look.noise * look.gain * sum
    };
    soft.iter().flatten().map(|light| stored(light + noise())).collect()
}
