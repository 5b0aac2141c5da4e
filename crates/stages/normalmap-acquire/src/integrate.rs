//! The surface whose slopes come nearest to given ones: `min ∫ |∇h − s|² + λ h²`, by multigrid.

use crate::blur::{doubled, halved};
use crate::plane::Plane;
use rayon::prelude::*;

/// V-cycles after the start from the coarse grids; each leaves about a tenth of the error.
const CYCLES: usize = 3;
/// Grids of fewer pixels on a side are not halved further.
const COARSEST: usize = 8;

/// Heights `h` (px) whose gradient comes nearest to the slopes `s` (x right, y down), pulled to 0 by `lambda` (px⁻²).
///
/// Solves `(λ − Δ) h = −div s` with free borders: slopes on the edges between pixels are the means of the pixels' own.
#[must_use]
pub fn integrated(slopes: &[Plane; 2], lambda: f64) -> Plane {
    let right = divergence(slopes).map(|value| -value);
    let mut height = started(&right, lambda);
    (0..CYCLES).for_each(|_| cycle(&mut height, &right, lambda));
    height
}

fn divergence([x, y]: &[Plane; 2]) -> Plane {
    let (width, height) = (x.width, x.height);
    Plane::from_fn(width, height, |column, row| {
        let between =
            |plane: &Plane, a: [usize; 2], b: [usize; 2]| 0.5 * (plane.at(a[0], a[1]) + plane.at(b[0], b[1]));
        let here = [column, row];
        let mut sum = 0.0;
        if column + 1 < width {
            sum += between(x, here, [column + 1, row]);
        }
        if column > 0 {
            sum -= between(x, here, [column - 1, row]);
        }
        if row + 1 < height {
            sum += between(y, here, [column, row + 1]);
        }
        if row > 0 {
            sum -= between(y, here, [column, row - 1]);
        }
        sum
    })
}

fn is_coarsest(plane: &Plane) -> bool {
    plane.width.min(plane.height) <= COARSEST
}

/// A first surface from the coarsest grid up. `right` is per pixel; on a grid of twice the pixel, λ and it weigh four times.
fn started(right: &Plane, lambda: f64) -> Plane {
    if is_coarsest(right) {
        let mut height = Plane::filled(right.width, right.height, 0.0);
        (0..40).for_each(|_| sweep(&mut height, right, lambda));
        return height;
    }
    let coarse = started(&halved(right).map(|value| 4.0 * value), 4.0 * lambda);
    let mut height = doubled(&coarse, right.width, right.height);
    cycle(&mut height, right, lambda);
    height
}

fn cycle(height: &mut Plane, right: &Plane, lambda: f64) {
    if is_coarsest(right) {
        (0..40).for_each(|_| sweep(height, right, lambda));
        return;
    }
    sweep(height, right, lambda);
    let left = residual(height, right, lambda);
    let coarse_right = halved(&left).map(|value| 4.0 * value);
    let mut correction = Plane::filled(coarse_right.width, coarse_right.height, 0.0);
    cycle(&mut correction, &coarse_right, 4.0 * lambda);
    let correction = doubled(&correction, height.width, height.height);
    height.values.par_iter_mut().zip(&correction.values).for_each(|(height, step)| *height += step);
    sweep(height, right, lambda);
}

/// Two steps of Chebyshev's: down the residual, with lengths that leave least of what a coarser grid cannot show.
fn sweep(height: &mut Plane, right: &Plane, lambda: f64) {
    for step in STEPS {
        let before = height.values.clone();
        relax(height, &before, |at, pixel, sum, count| {
            pixel + step * ((right.values[at] + sum) / (count + lambda) - pixel)
        });
    }
}

/// 1 / (1¼ ± ¾ cos 45°): what they act on has eigenvalues from ½ to 2.
const STEPS: [f64; 2] = [0.561_5, 1.389_6];

fn residual(height: &Plane, right: &Plane, lambda: f64) -> Plane {
    let mut left = Plane::filled(height.width, height.height, 0.0);
    relax(&mut left, &height.values, |at, pixel, sum, count| {
        right.values[at] + sum - (count + lambda) * pixel
    });
    left
}

/// Gives each pixel what `value` makes of its place, its number, and the sum and number of the four pixels around.
fn relax(out: &mut Plane, from: &[f64], value: impl Fn(usize, f64, f64, f64) -> f64 + Sync) {
    let (width, rows) = (out.width, out.height);
    out.values.par_chunks_mut(width).enumerate().for_each(|(row, line)| {
        let first = row * width;
        let border = |column: usize| {
            let (sum, count) = neighbours(from, [width, rows], column, row);
            value(first + column, from[first + column], sum, count)
        };
        if row == 0 || row + 1 == rows || width < 3 {
            line.iter_mut().enumerate().for_each(|(column, pixel)| *pixel = border(column));
            return;
        }
        line[0] = border(0);
        line[width - 1] = border(width - 1);
        let [above, here, below] = [first - width, first, first + width].map(|at| &from[at..at + width]);
        for column in 1..width - 1 {
            let sum = here[column - 1] + here[column + 1] + above[column] + below[column];
            line[column] = value(first + column, here[column], sum, 4.0);
        }
    });
}

/// Sum and number of the four pixels around one.
fn neighbours(values: &[f64], [width, rows]: [usize; 2], column: usize, row: usize) -> (f64, f64) {
    let at = row * width + column;
    let mut found = (0.0, 0.0);
    let mut add = |there: bool, at: usize| {
        if there {
            found = (found.0 + values[at], found.1 + 1.0);
        }
    };
    add(column > 0, at.wrapping_sub(1));
    add(column + 1 < width, at + 1);
    add(row > 0, at.wrapping_sub(width));
    add(row + 1 < rows, at + width);
    found
}
