//! How much of each pixel around a dot is paint.

use crate::center::Part;
use crate::paint::Paint;
use nalgebra::{Matrix3, Vector3};

/// Fewer pixels around are no surroundings.
const FEWEST: usize = 12;
/// Rounds in which light and cover are told apart.
const ROUNDS: usize = 3;
/// Noise of a pixel, as a share of the paint's brightness.
const NOISE: f64 = 0.01;
/// What is beside the dot is known but for this share of the variance around it.
const SPREAD: f64 = 2.0;
/// Weight of a pixel's neighbours across corners against those across sides.
const DIAGONAL: f64 = 0.5;
/// Light on a dot lies within these shares of that on the labelled dots.
const LIGHT: [f64; 2] = [0.1, 4.0];

/// What each pixel would show without paint on it: what surrounds a dot, carried inwards layer by layer, so that the edge of each
/// other paint, of hair, of the lips ends where it meets the dot, and each pixel of the dot's rim is told from what lies beside it.
///
/// A pixel of cover a then shows a k b + (1 − a) f, with the paint's colour b, its light k, and f from here.
pub(crate) struct Ground {
    colors: Vec<Vector3<f64>>,
    known: Vec<bool>,
    /// What differences of colour say least about paint: the inverse of their covariance around the dot.
    precision: Matrix3<f64>,
}

impl Ground {
    /// None where too little is seen around.
    pub(crate) fn of(parts: &[Part], colors: &[Vector3<f64>], width: usize, paint: &Paint) -> Option<Self> {
        let known: Vec<bool> = parts.iter().map(|part| *part == Part::Free).collect();
        if known.iter().filter(|known| **known).count() < FEWEST {
            return None;
        }
        let floor = (NOISE * Vector3::from(paint.color).norm()).powi(2);
        let precision = precision(colors, &known, floor)?;
        let mut ground = Self { colors: colors.to_vec(), known, precision };
        let wanted = |part: &Part| matches!(part, Part::Own | Part::Between);
        let mut left: Vec<usize> = (0..parts.len()).filter(|&i| wanted(&parts[i])).collect();
        while !left.is_empty() {
            let layer: Vec<(usize, Option<Vector3<f64>>)> =
                left.iter().map(|&i| (i, ground.beside(i, width))).collect();
            left = layer.iter().filter(|(_, color)| color.is_none()).map(|(i, _)| *i).collect();
            if left.len() == layer.len() {
                break;
            }
            for (i, color) in layer {
                if let Some(color) = color {
                    (ground.colors[i], ground.known[i]) = (color, true);
                }
            }
        }
        Some(ground)
    }

    /// The mean of the known pixels beside one.
    fn beside(&self, index: usize, width: usize) -> Option<Vector3<f64>> {
        let (x, y, height) = (index % width, index / width, self.known.len() / width);
        let (mut sum, mut weights) = (Vector3::zeros(), 0.0);
        for row in y.saturating_sub(1)..(y + 2).min(height) {
            for column in x.saturating_sub(1)..(x + 2).min(width) {
                if self.known[row * width + column] {
                    let weight = if row == y || column == x { 1.0 } else { DIAGONAL };
                    sum += weight * self.colors[row * width + column];
                    weights += weight;
                }
            }
        }
        (weights > 0.0).then(|| sum / weights)
    }

    /// The share of paint of each of the dot's own pixels, in their order; it may be a little below 0 or above 1.
    pub(crate) fn covers(&self, own: &[usize], colors: &[Vector3<f64>], paint: &Paint) -> Vec<f64> {
        let color = Vector3::from(paint.color);
        let mut light = 1.0;
        let mut covers = vec![0.0; own.len()];
        for _ in 0..=ROUNDS {
            let painted = light * color;
            for (cover, &i) in covers.iter_mut().zip(own) {
                let full = painted - self.colors[i];
                let along = self.precision * full;
                *cover = (colors[i] - self.colors[i]).dot(&along) / full.dot(&along).max(1e-12);
            }
            let (mut seen, mut weights) = (0.0, 0.0);
            for (cover, &i) in covers.iter().zip(own) {
                let cover = cover.clamp(0.0, 1.0);
                seen += cover * cover * (colors[i] - (1.0 - cover) * self.colors[i]).dot(&color);
                weights += cover * cover * cover;
            }
            if weights > 0.0 {
                light = (seen / weights / color.norm_squared()).clamp(LIGHT[0], LIGHT[1]);
            }
        }
        covers
    }
}

fn precision(colors: &[Vector3<f64>], known: &[bool], floor: f64) -> Option<Matrix3<f64>> {
    let around = || colors.iter().zip(known).filter(|(_, known)| **known).map(|(color, _)| color);
    let count = around().count() as f64;
    let mean: Vector3<f64> = around().sum::<Vector3<f64>>() / count;
    let spread: Matrix3<f64> = around().map(|color| (color - mean) * (color - mean).transpose()).sum();
    (spread * (SPREAD / count) + Matrix3::identity() * floor).try_inverse()
}
