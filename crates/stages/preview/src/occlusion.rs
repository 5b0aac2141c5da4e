//! Ambient occlusion from the depth picture: hollows receive less light than ridges [McGuire2012].
//!
//! Per pixel, neighbours on a spiral are asked how far they rise above the pixel's tangent plane, at two radii: one of
//! the size of eye sockets, one of the size of creases. Radii follow the picture, so that a close-up shows finer hollows.

use camera::Pinhole;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Radii as shares of the picture's smaller side, with their strengths.
const SCALES: [(f32, f32); 2] = [(0.085, 1.15), (0.022, 0.75)];
/// Neighbours per radius.
const NEIGHBORS: usize = 18;
/// Turns of the spiral: with 18 neighbours, 7 spread them evenly.
const TURNS: f32 = 7.0;
/// Neighbours that rise less than this share of the radius do not count: a flat wall must not darken itself.
const BIAS: f32 = 0.015;
/// Half width of the smoothing, pixels.
const SMOOTH: i64 = 2;

/// What one pixel saw: the depth picture and its normals.
#[derive(Clone, Copy)]
pub(crate) struct Depth {
    /// Along the view; 0 where nothing is seen.
    pub(crate) z: f32,
    /// Towards the camera's side.
    pub(crate) normal: Vector3<f32>,
}

/// Per pixel the share of the dome's light that arrives, 0–1.
pub(crate) fn openness(depth: &[Depth], size: [u32; 2], camera: &Pinhole, strength: f64) -> Vec<f32> {
    if strength == 0.0 {
        return vec![1.0; depth.len()];
    }
    let picture = Picture { depth, width: size[0] as i64, height: size[1] as i64, camera: camera.clone() };
    let pixels = depth.len() as i64;
    let raw: Vec<f32> =
        (0..pixels).into_par_iter().map(|at| picture.openness_at(at, strength as f32)).collect();
    let rows: Vec<f32> = (0..pixels).into_par_iter().map(|at| picture.smoothed(&raw, at, 1)).collect();
    (0..pixels).into_par_iter().map(|at| picture.smoothed(&rows, at, picture.width)).collect()
}

struct Picture<'a> {
    depth: &'a [Depth],
    width: i64,
    height: i64,
    camera: Pinhole,
}

impl Picture<'_> {
    fn point(&self, column: i64, row: i64, z: f32) -> Vector3<f32> {
        let (center, focal) = (self.camera.center_px, self.camera.focal_px);
        let x = ((column as f64 - center.x) / focal) as f32;
        let y = ((row as f64 - center.y) / focal) as f32;
        Vector3::new(x * z, y * z, z)
    }

    fn openness_at(&self, at: i64, strength: f32) -> f32 {
        let here = self.depth[at as usize];
        if here.z == 0.0 {
            return 1.0;
        }
        let (column, row) = (at % self.width, at / self.width);
        let turn = noise(column, row) * std::f32::consts::TAU;
        let mut open = 1.0;
        for (share, weight) in SCALES {
            let radius_px = share * self.width.min(self.height) as f32;
            let hidden = self.hidden(column, row, here, radius_px, turn);
            open *= (1.0 - strength * weight * hidden).max(0.0);
        }
        open
    }

    fn hidden(&self, column: i64, row: i64, here: Depth, radius_px: f32, turn: f32) -> f32 {
        let origin = self.point(column, row, here.z);
        let radius = radius_px * here.z / self.camera.focal_px as f32;
        let mut sum = 0.0;
        for k in 0..NEIGHBORS {
            let share = (k as f32 + 0.5) / NEIGHBORS as f32;
            let angle = share * TURNS * std::f32::consts::TAU + turn;
            let x = column + (share * radius_px * angle.cos()).round() as i64;
            let y = row + (share * radius_px * angle.sin()).round() as i64;
            if !(0..self.width).contains(&x) || !(0..self.height).contains(&y) {
                continue;
            }
            let other = self.depth[(y * self.width + x) as usize];
            if other.z > 0.0 {
                let toward = (self.point(x, y, other.z) - origin) / radius;
                let near = (1.0 - toward.norm_squared()).max(0.0);
                sum += near * (toward.dot(&here.normal) - BIAS).max(0.0) / (toward.norm() + 0.02);
            }
        }
        2.0 * sum / NEIGHBORS as f32
    }

    /// Mean of the neighbours along one direction (step 1: a row, step width: a column) that lie on the same surface.
    fn smoothed(&self, values: &[f32], at: i64, step: i64) -> f32 {
        let here = self.depth[at as usize].z;
        if here == 0.0 {
            return 1.0;
        }
        let column = at % self.width;
        let (mut sum, mut count) = (0.0, 0.0);
        for k in -SMOOTH..=SMOOTH {
            let other = at + k * step;
            let leaves_row = step == 1 && !(0..self.width).contains(&(column + k));
            if leaves_row || !(0..values.len() as i64).contains(&other) {
                continue;
            }
            if (self.depth[other as usize].z - here).abs() < 0.01 * here {
                sum += values[other as usize];
                count += 1.0;
            }
        }
        sum / count
    }
}

/// A number in 0–1 per pixel whose neighbours differ most [Jimenez2014, interleaved gradient noise].
fn noise(column: i64, row: i64) -> f32 {
    let inner = 0.067_110_56 * column as f64 + 0.005_837_15 * row as f64;
    (52.982_918_9 * inner.fract()).fract() as f32
}
