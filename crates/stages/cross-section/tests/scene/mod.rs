//! Painted grooves, drawn by brute force: horizons by looking at every other place, the sky by quadrature, pixels by many samples.

#![allow(dead_code, reason = "each test file uses a part")]

use artifact::{Curve2d, CurveState};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Width, height of the pictures, px.
pub(crate) const SIZE: [usize; 2] = [160, 96];
const PAINT: [f64; 3] = [0.05, 0.34, 0.1];
const SKIN: [f64; 3] = [0.55, 0.36, 0.27];

/// A groove along a gently bent line, and how it is filmed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scene {
    pub(crate) w: f64,
    pub(crate) ratio: f64,
    pub(crate) epsilon: f64,
    pub(crate) kappa: f64,
    /// Tangent of the view's tilt, towards p > 0.
    pub(crate) tilt: f64,
    /// `L = 1 + g ω_p`.
    pub(crate) skew: f64,
    /// How far the paint reaches to both sides, px.
    pub(crate) paint: [f64; 2],
    /// Share of the light on open paint.
    pub(crate) exposure: f64,
    pub(crate) noise: f64,
    /// Deviation of the paint's reflectance, in patches of 3 px.
    pub(crate) texture: f64,
    /// Curvature of what the groove lies in, 1/px; positive where that is hollow.
    pub(crate) bend: f64,
    /// How far the curve that is handed over lies off the crease, px.
    pub(crate) off: f64,
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            w: 8.0,
            ratio: 0.4,
            epsilon: 0.0,
            kappa: 0.0,
            tilt: 0.0,
            skew: 0.0,
            paint: [20.0, 18.0],
            exposure: 1.0,
            noise: 0.005,
            texture: 0.0,
            bend: 0.0,
            off: 0.0,
        }
    }
}

/// Size of a patch of uneven paint, px.
const PATCH: usize = 3;
/// Bent surroundings run out level from so far on, px.
const FAR: f64 = 60.0;

/// Height of the crease's line at a column.
fn line(x: f64) -> f64 {
    48.0 + 3.0 * (x / 40.0).sin()
}

impl Scene {
    fn height(&self, p: f64) -> f64 {
        let depth = self.ratio * self.w / ((1.0 - self.epsilon) * (-self.epsilon).exp());
        let scale = self.w / (1.0 - self.epsilon * self.epsilon).sqrt();
        let side = if p < 0.0 { 1.0 - self.kappa } else { 1.0 + self.kappa };
        let u = ((p / (scale * side)).powi(2) + self.epsilon * self.epsilon).sqrt();
        depth * (u - 1.0) * (-u).exp() + self.bend * FAR * FAR * (1.0 - (1.0 + (p / FAR).powi(2)).powf(-0.5))
    }

    /// Light by the distance in the image from the crease, in steps of a tenth of a pixel from −60 px on; blurred.
    fn light(&self) -> Vec<f64> {
        let reach = 90.0;
        let ground: Vec<[f64; 2]> =
            (0..=3600).map(|i| -reach + 0.05 * f64::from(i)).map(|p| [p, self.height(p)]).collect();
        let lights: Vec<[f64; 2]> = (0..ground.len())
            .step_by(2)
            .map(|i| [ground[i][0] - (ground[i][1] - self.height(0.0)) * self.tilt, self.sky(&ground, i)])
            .collect();
        let sharp: Vec<f64> =
            (0..1200).map(|i| -60.0 + 0.1 * f64::from(i)).map(|q| between(&lights, q)).collect();
        let sigma = (0.49f64 + 1.0 / 12.0).sqrt() / 0.1;
        let kernel: Vec<f64> = (-35..=35).map(|k| (-0.5 * (f64::from(k) / sigma).powi(2)).exp()).collect();
        let sum: f64 = kernel.iter().sum();
        let at = |i: i64| sharp[i.clamp(0, 1199) as usize];
        (0..1200).map(|i| kernel.iter().zip(-35..).map(|(k, off)| k / sum * at(i + off)).sum()).collect()
    }

    /// The sky over a place of the ground: quadrature over the angles between its horizons.
    fn sky(&self, ground: &[[f64; 2]], i: usize) -> f64 {
        let [p, z] = ground[i];
        let slope = (self.height(p + 1e-5) - self.height(p - 1e-5)) / 2e-5;
        let rise = |other: &[f64; 2]| (other[1] - z) / (other[0] - p).abs();
        let right = ground[i + 1..].iter().map(rise).fold(slope.max(0.0), f64::max);
        let left = ground[..i].iter().map(rise).fold((-slope).max(0.0), f64::max);
        let (low, high) = (right.atan(), std::f64::consts::PI - left.atan());
        let normal = slope.atan() + std::f64::consts::FRAC_PI_2;
        // Rows of sky along the groove: a great half circle of height φ over it, whose mean radiance along p is 8/(3π) of that in its middle.
        let steps = 600;
        let width = (high - low) / f64::from(steps);
        let row = |k: i32| {
            let angle = low + (f64::from(k) + 0.5) * width;
            (angle - normal).cos().max(0.0)
                * (1.0 + self.skew * 8.0 / (3.0 * std::f64::consts::PI) * angle.cos())
        };
        0.5 * width * (0..steps).map(row).sum::<f64>()
    }

    /// The picture, in sRGB codes.
    pub(crate) fn picture(&self, seed: u64) -> Vec<u8> {
        let light = self.light();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let patches = [SIZE[0] / PATCH + 2, SIZE[1] / PATCH + 2];
        // A blend of even values keeps about two thirds of their deviation.
        let patch: Vec<f64> =
            (0..patches[0] * patches[1]).map(|_| 2.6 * (rng.random::<f64>() * 2.0 - 1.0)).collect();
        let patchy = |x: usize, y: usize| {
            let at = |i: usize, j: usize| patch[(y / PATCH + j) * patches[0] + x / PATCH + i];
            let [u, v] = [x % PATCH, y % PATCH].map(|rest| rest as f64 / PATCH as f64);
            (1.0 - v) * ((1.0 - u) * at(0, 0) + u * at(1, 0)) + v * ((1.0 - u) * at(0, 1) + u * at(1, 1))
        };
        let mut rgb = Vec::with_capacity(3 * SIZE[0] * SIZE[1]);
        for y in 0..SIZE[1] {
            for x in 0..SIZE[0] {
                let uneven = 1.0 + self.texture * patchy(x, y);
                let x = x as f64;
                let lean = 1.0 + (3.0 / 40.0 * (x / 40.0).cos()).powi(2);
                // Downwards in the image is the right side of a line that runs to the right.
                let p = (y as f64 - line(x)) / lean.sqrt();
                let share = light[(((p + 60.0) * 10.0).round() as usize).min(1199)];
                let is_painted = -self.paint[0] <= p && p <= self.paint[1] && (12.0..148.0).contains(&x);
                let color = if is_painted { PAINT } else { SKIN };
                for channel in color {
                    let noise = self.noise * (rng.random::<f64>() + rng.random::<f64>() - 1.0) * 2.4;
                    rgb.push(code(channel * self.exposure * share * uneven + noise * 0.34));
                }
            }
        }
        rgb
    }

    /// The curve along the crease, shifted by `off`.
    pub(crate) fn curve(&self) -> Curve2d {
        let control = |i: i32| {
            let x = 8.0 + 10.0 * f64::from(i);
            [x, line(x) + self.off]
        };
        let controls = (0..15).map(control).collect();
        Curve2d { controls, state: CurveState::Seen, confidence: 1.0, paint: vec![] }
    }
}

fn between(points: &[[f64; 2]], at: f64) -> f64 {
    let after = points.partition_point(|point| point[0] < at).clamp(1, points.len() - 1);
    let [from, to] = [points[after - 1], points[after]];
    from[1] + (to[1] - from[1]) * ((at - from[0]) / (to[0] - from[0])).clamp(0.0, 1.0)
}

/// sRGB, IEC 61966-2-1.
fn code(light: f64) -> u8 {
    let stored = match light <= 0.003_130_8 {
        true => 12.92 * light.max(0.0),
        false => 1.055 * light.powf(1.0 / 2.4) - 0.055,
    };
    (255.0 * stored).round().clamp(0.0, 255.0) as u8
}
