//! How much of each pixel around a dot is paint.

use crate::center::Part;
use crate::paint::Paint;
use nalgebra::{Matrix3, Vector3};

/// Fewer pixels around are no surroundings.
const FEWEST: usize = 12;
/// Noise of a pixel, as a share of the paint's brightness.
const NOISE: f64 = 0.01;
/// What is beside the dot is known but for this share of the variance around it.
const SPREAD: f64 = 2.0;
/// Weight of a pixel's neighbours across corners against those across sides.
const DIAGONAL: f64 = 0.5;
/// Light on a dot lies within these shares of that on the labelled dots.
const LIGHT: [f64; 2] = [0.1, 4.0];
/// The light on a dot is known but for this share.
const LIGHT_SPREAD: f64 = 0.03;

/// What each pixel would show without paint on it: what surrounds a dot, carried inwards layer by layer, so that the edge of each
/// other paint, of hair, of the lips ends where it meets the dot, and each pixel of the dot's rim is told from what lies beside it.
///
/// A pixel of cover a then shows a k b + (1 − a) f, with the paint's colour b, its light k, and f from here.
pub(crate) struct Ground {
    colors: Vec<Vector3<f64>>,
    known: Vec<bool>,
    /// What differences of colour say about paint: the inverse of the covariance around the dot, with that of the dot's light.
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
        let light = LIGHT_SPREAD * Vector3::from(paint.color);
        let precision = precision(colors, &known, light, floor)?;
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

    /// The share of paint of each of the dot's own pixels, in their order; it may be a little below 0 or above 1. `mask` says the
    /// same roughly, from each pixel's ratios alone.
    pub(crate) fn covers(
        &self,
        own: &[usize],
        mask: &[f64],
        colors: &[Vector3<f64>],
        paint: &Paint,
    ) -> Vec<f64> {
        let painted = self.light(own, mask, colors, paint) * Vector3::from(paint.color);
        let cover = |&i: &usize| {
            let full = painted - self.colors[i];
            let along = self.precision * full;
            (colors[i] - self.colors[i]).dot(&along) / full.dot(&along).max(1e-12)
        };
        own.iter().map(cover).collect()
    }

    /// The light on the dot, as a share of that on the labelled ones.
    ///
    /// It comes from the mask, whose ratios do not hang on it. Light and the shares below, fitted by turns, run away where other
    /// paints lie around that hold the dot's colour, at some other light, between them.
    fn light(&self, own: &[usize], mask: &[f64], colors: &[Vector3<f64>], paint: &Paint) -> f64 {
        let color = Vector3::from(paint.color);
        let (mut seen, mut weights) = (0.0, 0.0);
        for (cover, &i) in mask.iter().zip(own) {
            seen += cover * cover * (colors[i] - (1.0 - cover) * self.colors[i]).dot(&color);
            weights += cover * cover * cover;
        }
        match weights > 0.0 {
            true => (seen / weights / color.norm_squared()).clamp(LIGHT[0], LIGHT[1]),
            false => 1.0,
        }
    }
}

fn precision(
    colors: &[Vector3<f64>],
    known: &[bool],
    light: Vector3<f64>,
    floor: f64,
) -> Option<Matrix3<f64>> {
    let around = || colors.iter().zip(known).filter(|(_, known)| **known).map(|(color, _)| color);
    let count = around().count() as f64;
    let mean: Vector3<f64> = around().sum::<Vector3<f64>>() / count;
    let spread: Matrix3<f64> = around().map(|color| (color - mean) * (color - mean).transpose()).sum();
    (spread * (SPREAD / count) + light * light.transpose() + Matrix3::identity() * floor).try_inverse()
}
