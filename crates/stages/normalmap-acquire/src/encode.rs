//! Normals and heights as code values.

use crate::plane::Plane;
use artifact::GreenAxis;

/// Codes of unit normals (x right, y up): `(n + 1)/2`, red, green, blue of each pixel, from 0 to `white`.
#[must_use]
pub fn normal_codes(normals: &[Plane; 3], green: GreenAxis, white: f64) -> Vec<f64> {
    let sign = green.sign();
    let code = |value: f64| ((0.5 * value + 0.5).clamp(0.0, 1.0) * white).round();
    let [x, y, z] = normals;
    let pixels = x.values.iter().zip(&y.values).zip(&z.values);
    pixels.flat_map(|((x, y), z)| [code(*x), code(sign * y), code(*z)]).collect()
}

/// The normal of codes given as shares of white.
#[must_use]
pub fn normal_of([r, g, b]: [f64; 3], green: GreenAxis) -> [f64; 3] {
    let sign = green.sign();
    let raw = [2.0 * r - 1.0, sign * (2.0 * g - 1.0), 2.0 * b - 1.0];
    let length = raw.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-9);
    raw.map(|x| x / length)
}

/// Heights as shares of white, ½ being none, and the height that a step from 0 to 1 stands for.
#[must_use]
pub fn height_shares(height: &Plane) -> (Vec<f64>, f64) {
    let most = height.values.iter().fold(0.0f64, |most, height| most.max(height.abs())).max(1e-9);
    (height.values.iter().map(|height| 0.5 + 0.5 * height / most).collect(), 2.0 * most)
}
