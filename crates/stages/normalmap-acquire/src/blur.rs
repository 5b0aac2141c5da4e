//! Gaussian blur: exact where it is narrow, over a coarser picture where it is wide.

use crate::plane::Plane;
use rayon::prelude::*;

/// Standard deviations beyond this are blurred over a picture of half the size.
const NARROW_PX: f64 = 5.0;
/// The kernel ends after so many standard deviations.
const REACH: f64 = 4.0;

/// The picture blurred by a Gaussian of standard deviation `sigma` (px) that is cut off after four of them; the border goes on
/// for ever.
#[must_use]
pub fn exact(plane: &Plane, sigma: f64) -> Plane {
    if sigma <= 0.0 {
        return plane.clone();
    }
    let weights = kernel(sigma);
    vertically(&horizontally(plane, &weights), &weights)
}

/// The same within about 1 %, in a time that does not grow with `sigma`.
#[must_use]
pub(crate) fn blurred(plane: &Plane, sigma: f64) -> Plane {
    if sigma <= NARROW_PX || plane.width.min(plane.height) < 8 {
        return exact(plane, sigma);
    }
    // The mean of two pixels has a variance of ¼, and what is put between two coarse ones one of ½ (in fine pixels).
    let left = (sigma * sigma - 0.75).max(0.0).sqrt() / 2.0;
    doubled(&blurred(&halved(plane), left), plane.width, plane.height)
}

/// The blurred picture where a mask says how much each pixel counts.
#[must_use]
pub(crate) fn weighted(plane: &Plane, weight: &Plane, sigma: f64) -> Plane {
    let values = blurred(&plane.with(weight, |value, weight| value * weight), sigma);
    let weights = blurred(weight, sigma);
    values.with(&weights, |value, weight| if weight > 1e-6 { value / weight } else { 0.0 })
}

/// Planes count no more than this share of the kernel's own spread where few pixels tell of them.
const STIFF: f64 = 0.05;

/// At each pixel the value of the plane that comes nearest to the picture around it, weighted by a mask and a Gaussian: as
/// [`weighted`], but right also at a mask's border, where all that counts lies to one side.
#[must_use]
pub(crate) fn leaning(plane: &Plane, weight: &Plane, sigma: f64) -> Plane {
    let (width, height) = (plane.width, plane.height);
    let x = |index: usize| ((index % width) as f64 - 0.5 * width as f64) / sigma;
    let y = |index: usize| ((index / width) as f64 - 0.5 * height as f64) / sigma;
    let moment = |of: &(dyn Fn(usize) -> f64 + Sync)| {
        let product = Plane::from_fn(width, height, |column, row| {
            let index = row * width + column;
            weight.values[index] * of(index)
        });
        blurred(&product, sigma)
    };
    let value = |index: usize| plane.values[index];
    let sums = [
        moment(&|_| 1.0),
        moment(&x),
        moment(&y),
        moment(&|i| x(i) * x(i)),
        moment(&|i| x(i) * y(i)),
        moment(&|i| y(i) * y(i)),
        moment(&value),
        moment(&|i| x(i) * value(i)),
        moment(&|i| y(i) * value(i)),
    ];
    Plane::from_fn(width, height, |column, row| {
        let index = row * width + column;
        let total = sums[0].values[index];
        if total <= 1e-6 {
            return 0.0;
        }
        let [mx, my, xx, xy, yy, mean, xv, yv] = std::array::from_fn(|k| sums[k + 1].values[index] / total);
        // Covariances; the plane is laid through the mean.
        let (a, b, c) = (xx - mx * mx + STIFF, xy - mx * my, yy - my * my + STIFF);
        let (p, q) = (xv - mx * mean, yv - my * mean);
        let area = a * c - b * b;
        let slope = [(p * c - q * b) / area, (q * a - p * b) / area];
        mean + slope[0] * (x(index) - mx) + slope[1] * (y(index) - my)
    })
}

/// Means of two by two pixels; an odd last one counts alone.
pub(crate) fn halved(plane: &Plane) -> Plane {
    let (width, height) = (plane.width.div_ceil(2), plane.height.div_ceil(2));
    Plane::from_fn(width, height, |column, row| {
        let (right, below) = ((2 * column + 1).min(plane.width - 1), (2 * row + 1).min(plane.height - 1));
        0.25 * (plane.at(2 * column, 2 * row)
            + plane.at(right, 2 * row)
            + plane.at(2 * column, below)
            + plane.at(right, below))
    })
}

/// Back to a picture of twice the size.
pub(crate) fn doubled(plane: &Plane, width: usize, height: usize) -> Plane {
    let mut out = Plane::filled(width, height, 0.0);
    out.values.par_chunks_mut(width).enumerate().for_each(|(row, line)| {
        let (near, far) = parents(row, plane.height);
        let (near, far) = (&plane.values[near * plane.width..], &plane.values[far * plane.width..]);
        let mixed: Vec<f64> = (0..plane.width).map(|i| 0.75 * near[i] + 0.25 * far[i]).collect();
        for (column, pixel) in line.iter_mut().enumerate() {
            let (near, far) = parents(column, plane.width);
            *pixel = 0.75 * mixed[near] + 0.25 * mixed[far];
        }
    });
    out
}

/// The coarse pixel that a fine one lies in, and the next nearest.
fn parents(fine: usize, size: usize) -> (usize, usize) {
    let near = (fine / 2).min(size - 1);
    let far = if fine.is_multiple_of(2) { near.saturating_sub(1) } else { (near + 1).min(size - 1) };
    (near, far)
}

fn kernel(sigma: f64) -> Vec<f64> {
    // As SciPy rounds it.
    let reach = (REACH * sigma + 0.5) as i64;
    let weights: Vec<f64> = (-reach..=reach).map(|k| (-0.5 * (k as f64 / sigma).powi(2)).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}

fn horizontally(plane: &Plane, weights: &[f64]) -> Plane {
    let (width, reach) = (plane.width, weights.len() / 2);
    let mut out = Plane::filled(width, plane.height, 0.0);
    out.values.par_chunks_mut(width).zip(plane.values.par_chunks(width)).for_each(|(line, from)| {
        let mut padded = vec![from[0]; width + 2 * reach];
        padded[reach..reach + width].copy_from_slice(from);
        padded[reach + width..].fill(from[width - 1]);
        for (k, weight) in weights.iter().enumerate() {
            line.iter_mut().zip(&padded[k..]).for_each(|(pixel, value)| *pixel += weight * value);
        }
    });
    out
}

fn vertically(plane: &Plane, weights: &[f64]) -> Plane {
    let (width, reach) = (plane.width, weights.len() / 2);
    let mut out = Plane::filled(width, plane.height, 0.0);
    out.values.par_chunks_mut(width).enumerate().for_each(|(row, line)| {
        for (k, weight) in weights.iter().enumerate() {
            let from = (row + k).saturating_sub(reach).min(plane.height - 1) * width;
            let from = &plane.values[from..from + width];
            line.iter_mut().zip(from).for_each(|(pixel, value)| *pixel += weight * value);
        }
    });
    out
}
