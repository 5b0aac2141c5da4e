//! Step 2: the medium scale, taken out by the surface that bends least [BickelBotsch2007, Sec. 5.4].

use crate::Error;
use crate::calculus::Calculus;
use crate::patch::Patch;
use nalgebra::{Point3, Vector3};
use std::borrow::Cow;
use std::f64::consts::TAU;

/// The base with its free vertices where `L M⁻¹ L x = 0`: the steady state of bi-Laplacian smoothing [Desbrun1999], which
/// meets the surface around the region with its slope. On the mesh's own boundary the surface is held, and free to turn.
///
/// With a wavelength of shape Λ > 0 it is held to the base, too, `L M⁻¹ L x + (2π/Λ)⁴ M (x − b) = 0`: of a wave of length λ in
/// the base `1 / (1 + (λ/Λ)⁻⁴)` stays, so that wide regions keep the shape that the scanner saw.
///
/// `calculus`: of the patch; `base`: b, #P, mm.
pub(crate) fn fill(
    patch: &Patch,
    calculus: &Calculus,
    base: &[Point3<f64>],
    shape_mm: f64,
) -> Result<Vec<Point3<f64>>, Error> {
    let free = patch.free();
    let (matrix, scale) = match shape_mm > 0.0 {
        true => {
            let scale = (shape_mm / TAU).powi(4);
            (Cow::Owned(calculus.with_mass(&calculus.bending, scale)), scale)
        }
        false => (Cow::Borrowed(&calculus.bending), 1.0),
    };
    let bend = calculus.bend(base, scale);
    let system = calculus.factor(&matrix, |vertex| free[vertex])?;
    let step = system.solve(|vertex| (-bend[vertex]).into());
    Ok(base.iter().zip(step).map(|(point, step)| point + Vector3::from(step)).collect())
}
