//! The patch of skin: grooves as a height field, and how dark its pigment is.

use super::params::{Groove, PairScenario};
use super::waves::Waves;
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Skin around (0, 0); x right, y *down*, heights towards the camera; all mm.
#[derive(Debug, Clone)]
pub struct Skin {
    form: Groove,
    grooves: Vec<Line>,
    pores: Waves,
    blotches: Waves,
    spots: Vec<Spot>,
    texture: f64,
}

/// A groove along a bent line.
#[derive(Debug, Clone)]
struct Line {
    /// Unit vector along it.
    along: [f64; 2],
    /// Distance of the line from (0, 0), mm.
    offset: f64,
    /// How the line bends: height of the bow (mm) at `half`, and a slow wave.
    bow: f64,
    wave: [f64; 3],
    /// Half its length, and where its middle lies along it, mm.
    half: f64,
    middle: f64,
    width: f64,
    depth: f64,
}

/// A mole or a freckle: place, radius (mm) and how dark.
#[derive(Debug, Clone)]
struct Spot {
    at: [f64; 2],
    radius: f64,
    dark: f64,
}

/// Where a groove begins and ends it runs out over this length, mm.
const RUN_OUT_MM: f64 = 6.0;

impl Skin {
    /// Skin of a scenario; the rest is drawn.
    #[must_use]
    pub fn new(scenario: &PairScenario, rng: &mut ChaCha8Rng) -> Self {
        let half = scenario.pixel_mm * f64::from(scenario.side_px) / 2.0;
        let grooves = match scenario.groove {
            Groove::Flat => Vec::new(),
            _ => lines(scenario, half, rng),
        };
        let spot = |rng: &mut ChaCha8Rng| Spot {
            at: [0, 1].map(|_| rng.random_range(-half..half)),
            radius: rng.random_range(0.2..0.8),
            dark: rng.random_range(0.5..2.5),
        };
        Self {
            form: scenario.groove,
            grooves,
            pores: Waves::new(rng, [0.4, 1.5]),
            blotches: Waves::new(rng, [3.0, 20.0]),
            spots: (0..12).map(|_| spot(rng)).collect(),
            texture: scenario.degradation.texture,
        }
    }

    /// Height at a place, mm.
    #[must_use]
    pub fn height(&self, at: [f64; 2]) -> f64 {
        self.grooves.iter().map(|line| line.height(self.form, at)).sum()
    }

    /// Whether a place belongs to a groove: nearer to its line than its width.
    #[must_use]
    pub fn is_groove(&self, at: [f64; 2]) -> bool {
        self.grooves.iter().any(|line| {
            let (along, across) = line.places(at);
            across.abs() < line.width && along.abs() < line.half
        })
    }

    /// Albedo over its mean.
    #[must_use]
    pub fn pigment(&self, at: [f64; 2]) -> f64 {
        let spots: f64 = self
            .spots
            .iter()
            .map(|spot| {
                let square = (at[0] - spot.at[0]).powi(2) + (at[1] - spot.at[1]).powi(2);
                spot.dark * (-square / (2.0 * spot.radius * spot.radius)).exp()
            })
            .sum();
        let waves = 0.6 * self.pores.at(at) + 0.8 * self.blotches.at(at);
        (self.texture * (waves - 2.0 * spots)).exp()
    }
}

impl Line {
    /// Places along and across, mm.
    fn places(&self, [x, y]: [f64; 2]) -> (f64, f64) {
        let [c, s] = self.along;
        let along = c * x + s * y - self.middle;
        let bend = self.bow * (along / self.half).powi(2);
        let [height, length, phase] = self.wave;
        (along, c * y - s * x - self.offset - bend - height * (along / length + phase).sin())
    }

    fn height(&self, form: Groove, at: [f64; 2]) -> f64 {
        let (along, across) = self.places(at);
        let run_out = ((self.half - along.abs()) / RUN_OUT_MM).clamp(0.0, 1.0);
        let depth = self.depth * run_out * run_out * (3.0 - 2.0 * run_out);
        // Either way the groove is about `width` wide between its rims.
        let p = across.abs() / (0.5 * self.width);
        depth
            * match form {
                Groove::Round => -(-1.4 * p * p).exp(),
                Groove::Crease => (p - 1.0) * (-p).exp(),
                Groove::Flat => 0.0,
            }
    }
}

/// Grooves beside each other, as on a forehead, in any direction.
fn lines(scenario: &PairScenario, half: f64, rng: &mut ChaCha8Rng) -> Vec<Line> {
    let count = rng.random_range(scenario.count[0]..=scenario.count[1]);
    let angle = rng.random_range(0.0..std::f64::consts::PI);
    let pitch = 1.5 * half / f64::from(count.max(1));
    let range = |rng: &mut ChaCha8Rng, [low, high]: [f64; 2]| low + (high - low) * rng.random::<f64>();
    let line = |index: u32| {
        let (s, c) = (angle + rng.random_range(-0.15..0.15)).sin_cos();
        let width = range(rng, scenario.width_mm);
        let [shallow, deep] = scenario.depth_mm;
        Line {
            along: [c, s],
            offset: pitch * (f64::from(index) - f64::from(count - 1) / 2.0)
                + 0.15 * pitch * rng.random_range(-1.0..1.0),
            bow: rng.random_range(-3.0..3.0),
            wave: [rng.random_range(0.0..0.6), rng.random_range(2.5..6.0), rng.random_range(0.0..6.0)],
            half: half * rng.random_range(0.6..1.0),
            middle: half * rng.random_range(-0.2..0.2),
            width,
            depth: (width * range(rng, scenario.depth_over_width)).clamp(shallow, deep),
        }
    };
    (0..count).map(line).collect()
}
