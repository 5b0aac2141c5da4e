//! Slopes from a ratio image: how steep, to which side, and the surface that has them.

use crate::blur::blurred;
use crate::crease::sides;
use crate::integrate::integrated;
use crate::params::{Light, Params};
use crate::plane::{Plane, median};
use crate::ratio::{counted, noise};

/// Darker is shadow, not tilt: R is held above this.
const DARKEST: f64 = 0.35;
/// What is noise is told over this length beyond the first blur, io.
const NOISE_IO: f64 = 0.012;
/// Gradients of the smoothed ratio below this part of their usual size tell no side.
const QUIET: f64 = 0.7;
/// Rounds in which the light's tilt is taken out of the ratio.
const ROUNDS: usize = 4;

/// Slopes and the surface that has them.
#[derive(Debug, Clone)]
pub(crate) struct Estimated {
    /// Heights over the neutral skin, px.
    pub(crate) height: Plane,
    /// Noise of the ratio, after its blur.
    pub(crate) noise: f64,
}

/// How a darkening becomes a slope under some light: the gain, and the blur (io) of the ratio whose gradient tells the side.
///
/// Under open sky a place that is as dark is steeper than under a flash; light from wall to wall brightens both.
pub(crate) fn response(params: &Params) -> (f64, f64) {
    let (gain, side) = match params.light {
        None => (1.2, 0.016),
        Some(Light { flash_share, .. }) => (1.4 - 0.4 * flash_share, 0.016 + 0.007 * flash_share),
    };
    (params.gain.unwrap_or(gain), params.side_io.unwrap_or(side))
}

/// The surface under a ratio image, after [DutreveMeyer2011, Eq. 2].
///
/// `ratio`: R without exposure, #px; `weight`: how much each pixel counts, 0–1; `io`: distance of the pupils, px.
/// With D = 1 − R̄ beyond a dead zone of the noise's size, the slope is `γ √(1/(1 − D)² − 1)` up the gradient of a smoother R
/// (of a finer one at creases); one surface is laid under all slopes. Under a flash that stands off the line of sight, `R / (1 − τ·∇h)` takes R's place, in turn.
#[must_use]
pub(crate) fn estimated(ratio: &Plane, weight: &Plane, io: f64, params: &Params) -> Estimated {
    let (gain, side) = response(params);
    let first = blurred(ratio, params.blur_io * io);
    let noise = noise(&first, weight, NOISE_IO * io);
    let lambda = (params.reach_io * io).powi(-2);
    let tilt = params.light.map_or([0.0; 2], |light| light.tilt.map(|tilt| tilt * light.flash_share));
    let rounds = if tilt == [0.0; 2] { 1 } else { ROUNDS };
    let mut height = Plane::filled(ratio.width, ratio.height, 0.0);
    for round in 0..rounds {
        let turned = if round == 0 { None } else { Some(upright(ratio, &height, tilt)) };
        let turned = turned.as_ref().unwrap_or(ratio);
        let fine = if round == 0 { first.clone() } else { blurred(turned, params.blur_io * io) };
        let steep = fine.map(|value| slope(1.0 - value.max(DARKEST), gain, params.dead_zone * noise));
        let sides = sides(turned, &blurred(turned, side * io), io);
        height = integrated(&directed(&steep, sides, weight), lambda);
    }
    Estimated { height, noise }
}

/// The slope for a darkening.
fn slope(darkening: f64, gain: f64, dead: f64) -> f64 {
    if darkening <= 0.0 {
        return 0.0;
    }
    let beyond = darkening * darkening / (darkening + dead);
    gain * ((1.0 - beyond).powi(-2) - 1.0).max(0.0).sqrt()
}

/// Slopes that rise with the ratio; where its gradient is hardly there they fade.
fn directed(steep: &Plane, [gx, gy]: [Plane; 2], weight: &Plane) -> [Plane; 2] {
    let length = gx.with(&gy, f64::hypot);
    let quiet = (QUIET * 1.4826 * median(counted(&length, weight))).max(1e-12);
    let scale = length.with(steep, |length, steep| steep / length.hypot(quiet));
    let scale = scale.with(weight, |scale, weight| scale * weight);
    [gx, gy].map(|plane| plane.with(&scale, |value, scale| value * scale))
}

/// The ratio as it would be if the flash stood beside the lens.
fn upright(ratio: &Plane, height: &Plane, [x, y]: [f64; 2]) -> Plane {
    let [hx, hy] = height.gradient();
    // The picture's rows run down, the tilt is given upwards.
    let facing = hx.with(&hy, |hx, hy| (1.0 - x * hx + y * hy).clamp(0.3, 3.0));
    ratio.with(&facing, |ratio, facing| ratio / facing)
}
