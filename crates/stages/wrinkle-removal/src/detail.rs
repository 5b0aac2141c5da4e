//! Step 1: fine detail, taken off by a little smoothing and kept as heights [BickelBotsch2007, Sec. 5.4; Kobbelt1999].

use crate::calculus::Calculus;
use crate::patch::Patch;
use crate::{Error, Params, Split};
use nalgebra::{Point3, Vector3};
use operators::CsMat;
use std::f64::consts::TAU;

/// A surface without its fine detail, and the detail as heights above it.
pub(crate) struct Layers {
    /// mm.
    pub(crate) base: Vec<Point3<f64>>,
    /// Height of the original above the base along its normal, mm.
    pub(crate) heights: Vec<f64>,
}

/// Steps of the steep split.
const STEPS: i32 = 3;

/// Splits a patch at the wavelength Λ of [`Params::detail_mm`] by implicit smoothing [Desbrun1999, Sec. 3]: one step of
/// `(M + t L) b = M x` with the paper's Laplacian, three of `(M + t² L M⁻¹ L) b = M x` with the bi-Laplacian. Of a wave of length
/// λ the base keeps `1 / (1 + (Λ/λ)²)`, or `1 / (1 + 0.26 (Λ/λ)⁴)³`: half of it at Λ either way.
///
/// Open vertices stay, and so have no detail.
pub(crate) fn split(patch: &Patch, calculus: &Calculus, params: &Params) -> Result<Layers, Error> {
    let square = (params.detail_mm / TAU).powi(2);
    let base = match params.split {
        Split::Laplacian => {
            let matrix = calculus.with_mass(&calculus.stiffness, square);
            smoothed(patch, calculus, &matrix, 1, |points| calculus.pull(points, square))
        }
        Split::Bilaplacian => {
            let time = (f64::powf(2.0, 1.0 / f64::from(STEPS)) - 1.0) * square * square;
            let matrix = calculus.with_mass(&calculus.bending, time);
            smoothed(patch, calculus, &matrix, STEPS, |points| calculus.bend(points, time))
        }
    }?;
    let normals = mesh::vertex_normals(&base, &patch.triangles);
    let above = patch.points.iter().zip(&base).zip(&normals);
    let mut heights: Vec<f64> = above.map(|((point, base), normal)| (point - base).dot(normal)).collect();
    if params.detail_limit > 0.0 {
        let limit = params.detail_limit * level_around(patch, &heights);
        heights.iter_mut().for_each(|height| *height = limited(*height, limit));
    }
    Ok(Layers { base, heights })
}

/// Steps of implicit smoothing. `pull`: the gradient that a step goes against. Each is solved for how far it goes, which keeps
/// the digits that coordinates far from the origin would cost.
fn smoothed(
    patch: &Patch,
    calculus: &Calculus,
    matrix: &CsMat<f64>,
    steps: i32,
    pull: impl Fn(&[Point3<f64>]) -> Vec<Vector3<f64>>,
) -> Result<Vec<Point3<f64>>, Error> {
    let system = calculus.factor(matrix, |vertex| !patch.open[vertex])?;
    let mut points = patch.points.clone();
    for _ in 0..steps {
        let pull = pull(&points);
        let step = system.solve(|vertex| (-pull[vertex]).into());
        points.iter_mut().zip(step).for_each(|(point, step)| *point += Vector3::from(step));
    }
    Ok(points)
}

/// Root mean square height of the detail on the skin around the region, mm.
fn level_around(patch: &Patch, heights: &[f64]) -> f64 {
    let around = (0..heights.len()).filter(|&vertex| patch.weights[vertex] == 0.0 && !patch.open[vertex]);
    let (sum, count) =
        around.fold((0.0, 0usize), |(sum, count), i| (sum + heights[i] * heights[i], count + 1));
    (sum / count.max(1) as f64).sqrt()
}

/// A height that does not exceed a limit, and is hardly changed at 0.7 of it (by 0.7 %).
fn limited(height: f64, limit: f64) -> f64 {
    match limit > 0.0 {
        true => height / (1.0 + (height / limit).powi(8)).powf(0.125),
        false => 0.0,
    }
}
