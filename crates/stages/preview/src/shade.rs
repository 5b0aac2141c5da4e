//! Studio light: a warm key from above left, a cool fill from the right, a rim from behind, and a dome.
//!
//! The lights stand still beside the camera, so that every view is lit well.

use nalgebra::Vector3;

/// A light that is far away.
struct Light {
    /// Towards the light, in the camera's coordinates (x right, y down, z forward).
    toward: [f32; 3],
    /// Linear light.
    color: [f32; 3],
    /// How far it reaches around the terminator, as from a large soft box: 0 not at all, 1 all around.
    wrap: f32,
}

const KEY: Light = Light { toward: [-0.52, -0.62, -0.59], color: [0.98, 0.92, 0.84], wrap: 0.14 };
const FILL: Light = Light { toward: [0.80, -0.05, -0.60], color: [0.12, 0.145, 0.18], wrap: 0.40 };
const RIM: Light = Light { toward: [0.62, -0.45, 0.64], color: [0.36, 0.38, 0.42], wrap: 0.0 };
/// Light of the dome from above and from below.
const SKY: [f32; 3] = [0.20, 0.21, 0.235];
const GROUND: [f32; 3] = [0.105, 0.098, 0.092];
/// Strength and sharpness of the key's gloss.
const GLOSS: f32 = 0.075;
const GLOSS_POWER: f32 = 26.0;
/// Colour of the bare surface, linear light.
pub(crate) const CLAY: [f32; 3] = [0.60, 0.555, 0.51];
/// What is left of the light on the inside of the surface, per colour: dark and a little warm, so that holes read as
/// holes.
const INSIDE: [f32; 3] = [0.11, 0.078, 0.068];
/// Above this, light is bent towards white instead of being cut off.
const SHOULDER: f32 = 0.78;

/// Light that leaves a point towards the camera, linear.
///
/// `normal`: towards the camera's side; `toward_camera`: unit; `coloured`: whether the colour must stay readable, which
/// calls for flatter light.
pub(crate) fn shade(
    normal: Vector3<f32>,
    toward_camera: Vector3<f32>,
    albedo: [f32; 3],
    is_front: bool,
    coloured: bool,
) -> [f32; 3] {
    let up = 0.5 - 0.5 * normal.y;
    let mut light: [f32; 3] = std::array::from_fn(|i| GROUND[i] + (SKY[i] - GROUND[i]) * up);
    for lamp in [&KEY, &FILL, &RIM] {
        let cosine = normal.dot(&Vector3::from(lamp.toward).normalize());
        let amount = ((cosine + lamp.wrap) / (1.0 + lamp.wrap)).max(0.0);
        (0..3).for_each(|i| light[i] += lamp.color[i] * amount);
    }
    if coloured {
        let gray = 0.30 * light[0] + 0.55 * light[1] + 0.15 * light[2];
        light = [0.27 + 0.68 * gray; 3];
    }
    let gloss = if is_front { gloss(normal, toward_camera) } else { 0.0 };
    std::array::from_fn(|i| {
        let inside = if is_front { 1.0 } else { INSIDE[i] };
        bend(light[i] * albedo[i] * inside + gloss)
    })
}

/// Highlight of the key light [Blinn1977].
fn gloss(normal: Vector3<f32>, toward_camera: Vector3<f32>) -> f32 {
    let half = (Vector3::from(KEY.toward).normalize() + toward_camera).normalize();
    GLOSS * normal.dot(&half).max(0.0).powf(GLOSS_POWER)
}

fn bend(light: f32) -> f32 {
    match light > SHOULDER {
        true => 1.0 - (1.0 - SHOULDER) * (-(light - SHOULDER) / (1.0 - SHOULDER)).exp(),
        false => light,
    }
}
