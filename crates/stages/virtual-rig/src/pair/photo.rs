//! What the camera makes of the skin, at rest and wrinkled.

use super::glow::{Field, Lights};
use super::params::PairScenario;
use super::skin::Skin;
use super::waves::Waves;
use crate::film::Transfer;
use artifact::{Landmark, Landmarks};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;

/// Photographs of a patch of skin, and what is true of it.
#[derive(Debug, Clone)]
pub struct Pair {
    /// Side of all pictures, px.
    pub side: usize,
    /// The skin at rest, 8-bit sRGB.
    pub neutral: Vec<u8>,
    /// Wrinkled, one for each amplitude.
    pub expressions: Vec<Vec<u8>>,
    /// Landmarks of the skin at rest.
    pub neutral_landmarks: Landmarks,
    /// Of each wrinkled one.
    pub expression_landmarks: Vec<Landmarks>,
    /// True normals of the last picture in the frame of the one at rest: x right, *y up*, z towards the camera.
    pub normals: Vec<[f64; 3]>,
    /// Which pixels belong to a groove.
    pub grooves: Vec<bool>,
    /// What was drawn.
    pub truth: PairTruth,
}

/// What was drawn for a pair.
#[derive(Debug, Clone, Serialize)]
pub struct PairTruth {
    /// Exposure of the wrinkled pictures over that at rest, slow changes over the picture apart.
    pub exposure: f64,
    /// How far landmarks leave the skin from its place, root mean square, px.
    pub misregistration_px: f64,
    /// The head's motion between the pictures: scale, turn (rad), shift (px) of the last one.
    pub motion: [f64; 4],
    /// The wrinkles' height over their full one, for each wrinkled picture.
    pub amplitudes: Vec<f64>,
}

/// Places of the height field in a pixel, in each direction.
const FINE: usize = 2;
/// Skin beyond the picture's edge, px.
const MARGIN: usize = 28;
/// Landmarks in a row.
const LANDMARKS: usize = 7;
/// Linear light that white skin throws back, red, green, blue.
const SKIN: [f64; 3] = [0.52, 0.33, 0.26];
/// How narrow the sheen is.
const SHINE: i32 = 24;

/// Photographs the skin of a scenario at rest, and with its wrinkles at each amplitude, 0 to 1.
#[must_use]
pub fn photograph(scenario: &PairScenario, seed: u64, amplitudes: &[f64]) -> Pair {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let skin = Skin::new(scenario, &mut rng);
    let studio = Studio::new(scenario, skin, &mut rng);
    let still = Motion::still();
    let neutral = studio.shoot(&studio.radiance(0.0, 0), &still, 1.0, &mut rng);
    let shot = |(index, &amplitude): (usize, &f64)| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ (index as u64 + 1) << 32);
        let radiance = studio.radiance(amplitude, 1);
        studio.shoot(&radiance, &studio.motion.part(amplitude), studio.exposure, &mut rng)
    };
    let expressions = amplitudes.iter().enumerate().map(shot).collect();
    let last = amplitudes.last().copied().unwrap_or(1.0);
    let landmarks = |motion: &Motion| studio.landmarks(motion);
    Pair {
        side: studio.side,
        neutral,
        expressions,
        neutral_landmarks: landmarks(&still),
        expression_landmarks: amplitudes.iter().map(|&part| landmarks(&studio.motion.part(part))).collect(),
        normals: studio.normals(last),
        grooves: studio.places().map(|at| studio.skin.is_groove(at)).collect(),
        truth: PairTruth {
            exposure: studio.exposure,
            misregistration_px: studio.motion.off_px,
            motion: [studio.motion.scale, studio.motion.turn, studio.motion.shift[0], studio.motion.shift[1]],
            amplitudes: amplitudes.to_vec(),
        },
    }
}

/// How the skin moved: what landmarks tell, and what they do not.
#[derive(Debug, Clone)]
struct Motion {
    scale: f64,
    turn: f64,
    shift: [f64; 2],
    /// Root mean square of the part that landmarks miss, px.
    off_px: f64,
    off: Option<[Waves; 2]>,
}

impl Motion {
    fn still() -> Self {
        Self { scale: 1.0, turn: 0.0, shift: [0.0; 2], off_px: 0.0, off: None }
    }

    fn new(scenario: &PairScenario, rng: &mut ChaCha8Rng) -> Self {
        let [least, most] = scenario.degradation.misregistration_px;
        Self {
            scale: 1.0 + rng.random_range(-0.02..0.02),
            turn: rng.random_range(-0.025..0.025),
            shift: [0, 1].map(|_| rng.random_range(-8.0..8.0)),
            off_px: least + (most - least) * rng.random::<f64>(),
            off: Some([0, 1].map(|_| Waves::new(rng, [8.0, 25.0]))),
        }
    }

    /// A part of the way.
    fn part(&self, part: f64) -> Self {
        let Self { scale, turn, shift, off_px, off } = self.clone();
        Self {
            scale: 1.0 + part * (scale - 1.0),
            turn: part * turn,
            shift: shift.map(|shift| part * shift),
            off_px: part * off_px,
            off,
        }
    }

    /// From a place of the moved picture to that at rest, as landmarks tell it; px from the middle.
    fn back(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (s, c) = self.turn.sin_cos();
        let [x, y] = [x - self.shift[0], y - self.shift[1]];
        [(c * x + s * y) / self.scale, (c * y - s * x) / self.scale]
    }

    /// From a place at rest to that in the moved picture; px from the middle.
    fn forth(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (s, c) = self.turn.sin_cos();
        [self.scale * (c * x - s * y) + self.shift[0], self.scale * (s * x + c * y) + self.shift[1]]
    }

    /// Where the skin at a place of the moved picture truly was.
    fn skin(&self, at: [f64; 2], pixel_mm: f64) -> [f64; 2] {
        let told = self.back(at);
        let Some(off) = &self.off else { return told };
        let size = self.off_px / 2.0f64.sqrt();
        [0, 1].map(|axis| told[axis] + size * off[axis].at(told.map(|place| place * pixel_mm)))
    }
}

struct Studio<'a> {
    scenario: &'a PairScenario,
    skin: Skin,
    motion: Motion,
    exposure: f64,
    /// Slow change of the exposure over the picture.
    uneven: Waves,
    /// How oily the skin is, in the first and in the second photograph.
    oil: [Waves; 2],
    side: usize,
}

impl<'a> Studio<'a> {
    fn new(scenario: &'a PairScenario, skin: Skin, rng: &mut ChaCha8Rng) -> Self {
        let [least, most] = scenario.degradation.exposure;
        let change = least + (most - least) * rng.random::<f64>();
        Self {
            scenario,
            skin,
            motion: Motion::new(scenario, rng),
            exposure: if rng.random() { 1.0 + change } else { 1.0 / (1.0 + change) },
            uneven: Waves::new(rng, [40.0, 90.0]),
            oil: [0, 1].map(|_| Waves::new(rng, [2.0, 15.0])),
            side: scenario.side_px as usize,
        }
    }

    /// Half the side, px: what places from the middle are counted against.
    fn middle(&self) -> f64 {
        (self.side as f64 - 1.0) / 2.0
    }

    /// The pixels of the picture at rest, mm from the middle.
    fn places(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let mm = |index: usize| (index as f64 - self.middle()) * self.scenario.pixel_mm;
        (0..self.side * self.side).map(move |index| [mm(index % self.side), mm(index / self.side)])
    }

    fn fine_side(&self) -> usize {
        FINE * (self.side + 2 * MARGIN)
    }

    /// Place on the skin of a column or row of the fine grid, mm from the middle.
    fn fine_mm(&self, index: usize) -> f64 {
        let pixel = (index as f64 + 0.5) / FINE as f64 - 0.5 - MARGIN as f64;
        (pixel - self.middle()) * self.scenario.pixel_mm
    }

    fn field(&self, amplitude: f64) -> Field {
        let side = self.fine_side();
        let height = |index: usize| {
            let at = [self.fine_mm(index % side), self.fine_mm(index / side)];
            (amplitude * self.skin.height(at)) as f32
        };
        let z = (0..side * side).into_par_iter().map(height).collect();
        Field { width: side, height: side, step_mm: self.scenario.pixel_mm / FINE as f64, z }
    }

    /// Linear light of the fine grid: red, green, blue.
    fn radiance(&self, amplitude: f64, oil: usize) -> Vec<[f32; 3]> {
        let PairScenario { flash_share, flash_tilt, albedo, degradation, .. } = self.scenario;
        let field = self.field(amplitude);
        let lights = Lights { flash_share: *flash_share, flash_tilt: *flash_tilt, albedo: *albedo };
        let glow = if amplitude == 0.0 { vec![1.0; field.z.len()] } else { field.glow(&lights) };
        let side = field.width;
        let light = |index: usize| {
            let (column, row) = (index % side, index / side);
            let at = [self.fine_mm(column), self.fine_mm(row)];
            let [sx, sy] = field.slope(column, row);
            let up = 1.0 / (1.0 + sx * sx + sy * sy).sqrt();
            let facing = flash_share * up.powi(SHINE) + 0.3 * (1.0 - flash_share);
            let sheen = degradation.specular * facing * (0.5 * self.oil[oil].at(at)).exp();
            let matte = f64::from(glow[index]) * self.skin.pigment(at);
            SKIN.map(|color| (color * matte + sheen * SKIN[1]) as f32)
        };
        (0..side * side).into_par_iter().map(light).collect()
    }

    /// A photograph, 8-bit sRGB.
    fn shoot(&self, radiance: &[[f32; 3]], motion: &Motion, exposure: f64, rng: &mut ChaCha8Rng) -> Vec<u8> {
        let degradation = &self.scenario.degradation;
        let mm = self.scenario.pixel_mm;
        let light = |index: usize| {
            let middle = self.middle();
            let [column, row] = [index % self.side, index / self.side].map(|place| place as f64 - middle);
            let mut sum = [0.0; 3];
            for (dx, dy) in [(-0.25, -0.25), (0.25, -0.25), (-0.25, 0.25), (0.25, 0.25)] {
                let place = motion.skin([column + dx, row + dy], mm);
                let seen = self.sample(radiance, place);
                (0..3).for_each(|channel| sum[channel] += 0.25 * seen[channel]);
            }
            let wave = 0.02 * (exposure - 1.0).signum() * self.uneven.at([column * mm, row * mm]);
            let gain = if exposure == 1.0 { 1.0 } else { exposure * (1.0 + wave) };
            sum.map(|light: f64| gain * light)
        };
        let mut lights: Vec<[f64; 3]> = (0..self.side * self.side).into_par_iter().map(light).collect();
        blur(&mut lights, self.side, degradation.blur_px);
        let mut code = |light: f64| -> u8 {
            let noise: f64 = degradation.noise * (light.max(0.0).sqrt() * normal(rng) + 0.1 * normal(rng));
            (255.0 * Transfer::Srgb.encode(light + noise)).round() as u8
        };
        lights.iter().flat_map(|light| light.map(&mut code)).collect()
    }

    /// The fine grid at a place, px from the picture's middle.
    fn sample(&self, radiance: &[[f32; 3]], place: [f64; 2]) -> [f64; 3] {
        let side = self.fine_side();
        let fine = place.map(|place| {
            let index = (place + self.middle() + MARGIN as f64 + 0.5) * FINE as f64 - 0.5;
            index.clamp(0.0, side as f64 - 1.001)
        });
        let [column, row] = fine.map(|place| place as usize);
        let [u, v] = fine.map(|place| place.fract());
        let at = |dx: usize, dy: usize| radiance[(row + dy) * side + column + dx];
        let corners = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
        let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
        std::array::from_fn(|channel| {
            corners.iter().zip(weights).map(|(corner, weight)| weight * f64::from(corner[channel])).sum()
        })
    }

    /// Mean normals of the picture's pixels.
    fn normals(&self, amplitude: f64) -> Vec<[f64; 3]> {
        let field = self.field(amplitude);
        let normal = |index: usize| {
            let first = [index % self.side, index / self.side].map(|place| FINE * (place + MARGIN));
            let mut sum = nalgebra::Vector3::zeros();
            for part in 0..FINE * FINE {
                let [sx, sy] = field.slope(first[0] + part % FINE, first[1] + part / FINE);
                // y up, where the rows run down.
                sum += nalgebra::Vector3::new(-sx, sy, 1.0).normalize();
            }
            sum.normalize().into()
        };
        (0..self.side * self.side).map(normal).collect()
    }

    /// A net of places that the motion carries along.
    fn landmarks(&self, motion: &Motion) -> Landmarks {
        let border = 0.06 * self.side as f64;
        let step = (self.side as f64 - 1.0 - 2.0 * border) / (LANDMARKS - 1) as f64;
        let point = |index: usize| {
            let [x, y] =
                [index % LANDMARKS, index / LANDMARKS].map(|k| border + step * k as f64 - self.middle());
            let at = motion.forth([x, y]).map(|place| place + self.middle());
            (format!("p{index:02}"), Landmark { at, depth_px: None })
        };
        let points: BTreeMap<String, Landmark> = (0..LANDMARKS * LANDMARKS).map(point).collect();
        let side = self.side as u32;
        let interocular_px = Some(self.scenario.interocular_mm / self.scenario.pixel_mm);
        Landmarks { image: None, size: Some([side, side]), interocular_px, points }
    }
}

/// A number of the standard normal distribution, after Box and Muller.
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * rng.random::<f64>()).cos()
}

fn blur(lights: &mut [[f64; 3]], side: usize, sigma: f64) {
    if sigma <= 0.0 {
        return;
    }
    let reach = (4.0 * sigma).ceil() as isize;
    let weights: Vec<f64> = (-reach..=reach).map(|k| (-0.5 * (k as f64 / sigma).powi(2)).exp()).collect();
    let total: f64 = weights.iter().sum();
    for (step, other) in [(1, side), (side, 1)] {
        let before = lights.to_vec();
        for line in 0..side {
            for place in 0..side {
                let mut sum = [0.0; 3];
                for (k, weight) in weights.iter().enumerate() {
                    let from = (place as isize + k as isize - reach).clamp(0, side as isize - 1) as usize;
                    let seen = before[line * other + from * step];
                    (0..3).for_each(|channel| sum[channel] += weight / total * seen[channel]);
                }
                lights[line * other + place * step] = sum;
            }
        }
    }
}
