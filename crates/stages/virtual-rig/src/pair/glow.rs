//! How bright each place of a height field is: the light that reaches it from the sky and a flash, and from all of the skin that
//! it sees, bounce after bounce.
//!
//! Around a place, each direction of the compass is walked outwards. Where the ground rises above everything before it, it fills the
//! wedge between the horizon so far and its own: through that wedge the place sees it. What lies above the last horizon is sky.
//! On flat skin the light is 1, whatever its mixture.

use rayon::prelude::*;
use std::f64::consts::TAU;

/// Heights over a grid, mm; row 0 is the top.
#[derive(Debug, Clone)]
pub(super) struct Field {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) step_mm: f64,
    pub(super) z: Vec<f32>,
}

/// The light that falls on a height field.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lights {
    pub(super) flash_share: f64,
    pub(super) flash_tilt: [f64; 2],
    pub(super) albedo: f64,
}

/// Directions of the compass.
const HEADINGS: usize = 24;
/// How far the ground is walked, mm.
const REACH_MM: f64 = 9.0;
/// Each step is longer than the one before by this factor, once it is above one place.
const GROWTH: f64 = 1.12;
/// What is left out after so many bounces is below albedo³ of a groove's own light.
const BOUNCES: usize = 2;

impl Field {
    /// Height gradient at a place: x right, y down.
    pub(super) fn slope(&self, column: usize, row: usize) -> [f64; 2] {
        let at = |column: usize, row: usize| f64::from(self.z[row * self.width + column]);
        let [left, right] = [column.saturating_sub(1), (column + 1).min(self.width - 1)];
        let [above, below] = [row.saturating_sub(1), (row + 1).min(self.height - 1)];
        [
            (at(right, row) - at(left, row)) / ((right - left) as f64 * self.step_mm),
            (at(column, below) - at(column, above)) / ((below - above) as f64 * self.step_mm),
        ]
    }

    /// The light that leaves each place, over that of flat skin.
    pub(super) fn glow(&self, lights: &Lights) -> Vec<f32> {
        let mut glow = self.gather(lights, None);
        for _ in 0..BOUNCES {
            glow = self.gather(lights, Some(&glow));
        }
        glow
    }

    fn gather(&self, lights: &Lights, glow: Option<&[f32]>) -> Vec<f32> {
        let paths = paths(self.step_mm);
        let row = |row: usize| {
            let place = |column: usize| self.light_at(lights, glow, &paths, [column, row]) as f32;
            (0..self.width).map(place).collect::<Vec<_>>()
        };
        (0..self.height).into_par_iter().flat_map_iter(row).collect()
    }

    fn light_at(&self, lights: &Lights, glow: Option<&[f32]>, paths: &[Path], at: [usize; 2]) -> f64 {
        let slope = self.slope(at[0], at[1]);
        let up = 1.0 / (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
        let share = lights.flash_share;
        let [tilt_x, tilt_y] = lights.flash_tilt;
        let flash = (up * (1.0 - slope[0] * tilt_x + slope[1] * tilt_y)).max(0.0);
        let sum: f64 = paths.iter().map(|path| self.along(lights, glow, path, at, slope, up)).sum();
        share * flash + sum * 2.0 / HEADINGS as f64
    }

    /// Sky and lit skin in one direction of the compass; ½ on flat ground under open sky.
    fn along(
        &self,
        lights: &Lights,
        glow: Option<&[f32]>,
        path: &Path,
        [column, row]: [usize; 2],
        slope: [f64; 2],
        up: f64,
    ) -> f64 {
        let here = f64::from(self.z[row * self.width + column]);
        let [dx, dy] = path.heading;
        let rise = slope[0] * dx + slope[1] * dy;
        let wedge = |horizon: f64| wedge(-rise * up, up, horizon);
        let (mut horizon, mut below) = (rise, wedge(rise));
        let mut bounced = 0.0;
        let mut meet = |place: f64, glow: f64| {
            if place > horizon {
                let above = wedge(place);
                bounced += (below - above) * glow;
                (horizon, below) = (place, above);
            }
        };
        for (offset, distance) in &path.steps {
            let x = column as isize + offset[0];
            let y = row as isize + offset[1];
            if x < 0 || y < 0 || x >= self.width as isize || y >= self.height as isize {
                break;
            }
            let there = y as usize * self.width + x as usize;
            // Places lie beside the heading by up to half a step: what the plane of the ground there adds is taken off.
            let plane = (slope[0] * offset[0] as f64 + slope[1] * offset[1] as f64) * self.step_mm;
            let place = rise + (f64::from(self.z[there]) - here - plane) / distance;
            meet(place, glow.map_or(0.0, |glow| f64::from(glow[there])));
        }
        // Beyond lies flat skin.
        meet(0.0, f64::from(u8::from(glow.is_some())));
        (1.0 - lights.flash_share) * below + lights.albedo * bounced
    }
}

/// A way outwards: places on the grid and their distances, mm.
struct Path {
    heading: [f64; 2],
    steps: Vec<([isize; 2], f64)>,
}

fn paths(step_mm: f64) -> Vec<Path> {
    let path = |heading: usize| {
        // Off the axes, so that rows and columns of the grid are not preferred.
        let (s, c) = (TAU * (heading as f64 + 0.5) / HEADINGS as f64).sin_cos();
        let mut steps: Vec<([isize; 2], f64)> = Vec::new();
        let mut reach = 1.0;
        while reach * step_mm < REACH_MM {
            let offset = [(reach * c).round() as isize, (reach * s).round() as isize];
            let distance = (offset[0] as f64).hypot(offset[1] as f64) * step_mm;
            if steps.last().is_none_or(|(last, _)| *last != offset) {
                steps.push((offset, distance));
            }
            reach = (reach + 1.0).max(reach * GROWTH);
        }
        Path { heading: [c, s], steps }
    };
    (0..HEADINGS).map(path).collect()
}

/// `∫ (n·ω) sin θ dθ` from the zenith to a horizon that rises by `horizon` per length, for a normal of `out` along the heading
/// and `up` upwards.
fn wedge(out: f64, up: f64, horizon: f64) -> f64 {
    let square = 1.0 / (1.0 + horizon * horizon);
    let zenith = 1.0f64.atan2(horizon);
    0.5 * (out * (zenith - horizon * square) + up * square)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(z: impl Fn(f64) -> f64) -> Field {
        let (width, height, step_mm) = (161, 161, 0.1);
        let place = |i: usize| z((i % width) as f64 * step_mm - 8.0) as f32;
        Field { width, height, step_mm, z: (0..width * height).map(place).collect() }
    }

    fn middle(field: &Field, lights: &Lights) -> f64 {
        f64::from(field.glow(lights)[80 * field.width + 81])
    }

    const SKY: Lights = Lights { flash_share: 0.0, flash_tilt: [0.0; 2], albedo: 0.0 };

    #[test]
    fn flat_skin_is_as_bright_as_it_should() {
        for flash_share in [0.0, 0.4, 1.0] {
            let lights = Lights { flash_share, albedo: 0.5, ..SKY };
            assert!((middle(&field(|_| 0.0), &lights) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn a_wide_valley_sees_the_sky_that_it_should() {
        // Walls of 30° on both sides, 5 mm high: E = ½ (1 + cos 60°) near the bottom of an endless one.
        let valley = field(|x| x.abs() * 30f64.to_radians().tan());
        let found = middle(&valley, &SKY);
        assert!((found - 0.75).abs() < 0.02, "{found}");
        let bounced = middle(&valley, &Lights { albedo: 0.5, ..SKY });
        assert!(bounced > found + 0.05 && bounced < 1.0, "{bounced}");
    }

    #[test]
    fn a_flash_dims_by_the_cosine() {
        let slope = field(|x| 0.5 * x);
        let flash = Lights { flash_share: 1.0, ..SKY };
        assert!((middle(&slope, &flash) - 1.0 / 1.25f64.sqrt()).abs() < 1e-6);
        // Tilted to the right: the rising ground looks to the left.
        let tilted = Lights { flash_tilt: [0.2, 0.0], ..flash };
        assert!((middle(&slope, &tilted) - 0.9 / 1.25f64.sqrt()).abs() < 1e-6);
    }
}
