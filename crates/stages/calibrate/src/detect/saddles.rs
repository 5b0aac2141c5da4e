//! Corners of chessboards, each by itself: saddles of the grey values.

use super::DetectError;
use nalgebra::Vector2;
use opencv::core::{BORDER_REPLICATE, CV_32F, Mat, Size};
use opencv::imgproc::gaussian_blur;
use opencv::prelude::{MatTraitConst, MatTraitConstManual};

/// A place where the grey values rise one way and fall across it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Saddle {
    /// px.
    pub(super) at: Vector2<f64>,
    /// −det of the second derivatives, codes² px⁻⁴.
    strength: f32,
}

/// Width of the Gaussian before the derivatives: above the noise, below the squares, px.
const SIGMA_PX: f64 = 1.2;
/// Least strength: a corner of two greys 20 codes apart has about 4, noise of 3 codes makes 0.2.
const LEAST: f32 = 2.0;
/// A corner has at least this share of the strength of the board's typical one: leaning, defocus and light differ over a board.
const FAINTEST: f32 = 0.08;
/// Saddles closer than this are one, px.
const APART: usize = 2;

/// The strongest saddles of a picture of 8 bits: at most half as many again as are looked for.
pub(super) fn saddles(image: &Mat, count: usize) -> Result<Vec<Saddle>, DetectError> {
    let (mut light, mut smooth) = (Mat::default(), Mat::default());
    image.convert_to_def(&mut light, CV_32F)?;
    gaussian_blur(&light, &mut smooth, Size::new(0, 0), SIGMA_PX, SIGMA_PX, BORDER_REPLICATE)?;
    let (width, height) = (smooth.cols() as usize, smooth.rows() as usize);
    let strengths = strengths(smooth.data_typed::<f32>()?, width, height);
    let mut found = peaks(&strengths, width, height);
    found.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    let typical = found.get(found.len().min(count) / 2).map_or(0.0, |saddle| saddle.strength);
    found.truncate(count + count / 2);
    found.retain(|saddle| saddle.strength > FAINTEST * typical);
    Ok(found)
}

/// Lxy² − Lxx Lyy of every pixel; 0 along the edge.
fn strengths(smooth: &[f32], width: usize, height: usize) -> Vec<f32> {
    let mut strengths = vec![0.0; smooth.len()];
    for y in 1..height.saturating_sub(1) {
        for x in 1..width.saturating_sub(1) {
            let at =
                |dx: isize, dy: isize| smooth[y.wrapping_add_signed(dy) * width + x.wrapping_add_signed(dx)];
            let xx = at(1, 0) - 2.0 * at(0, 0) + at(-1, 0);
            let yy = at(0, 1) - 2.0 * at(0, 0) + at(0, -1);
            let xy = 0.25 * (at(1, 1) - at(-1, 1) - at(1, -1) + at(-1, -1));
            strengths[y * width + x] = xy * xy - xx * yy;
        }
    }
    strengths
}

/// The places that are stronger than all around them.
fn peaks(strengths: &[f32], width: usize, height: usize) -> Vec<Saddle> {
    let mut found = Vec::new();
    for y in APART..height.saturating_sub(APART) {
        for x in APART..width.saturating_sub(APART) {
            let (here, place) = (strengths[y * width + x], y * width + x);
            if here < LEAST {
                continue;
            }
            let is_peak = (y - APART..=y + APART)
                .flat_map(|row| row * width + x - APART..=row * width + x + APART)
                // Of equal ones the first.
                .all(|other| strengths[other] < here || (strengths[other] <= here && other >= place));
            if is_peak {
                found.push(Saddle { at: Vector2::new(x as f64, y as f64), strength: here });
            }
        }
    }
    found
}
