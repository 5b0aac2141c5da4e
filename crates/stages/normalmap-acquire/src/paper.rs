//! The paper's own rule, as it is printed.

use crate::blur::exact;
use crate::plane::Plane;

/// Gradients shorter than this have no direction; the normal is then (0, 0, 1).
const NO_DIRECTION: f64 = 1e-12;

/// Normals from a ratio image [DutreveMeyer2011, Eq. 1–3]: R is blurred, `N'_z = R N_z` clipped to 0–1, and the rest of the unit length
/// points down the gradient of R, towards the dark valley.
///
/// `ratio`, `neutral_z`: #px; `sigma_px` of the blur. The result is x right, y up, z towards the camera. The paper prints no sign:
/// ours is that of a height which is low where R is dark.
#[must_use]
pub fn paper_normals(ratio: &Plane, neutral_z: &Plane, sigma_px: f64) -> [Plane; 3] {
    let ratio = exact(ratio, sigma_px);
    let [gx, gy] = ratio.gradient();
    let length = gx.with(&gy, f64::hypot);
    let tilted = ratio.with(neutral_z, |ratio, z| (ratio * z).clamp(0.0, 1.0));
    let z = tilted.with(&length, |z, length| if length > NO_DIRECTION { z } else { 1.0 });
    let across = z.with(&length, |z, length| match length > NO_DIRECTION {
        true => (1.0 - z * z).max(0.0).sqrt() / length,
        false => 0.0,
    });
    [across.with(&gx, |across, g| -across * g), across.with(&gy, |across, g| across * g), z]
}
