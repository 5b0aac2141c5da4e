//! Where the ratio's own fine gradient may tell the side: at sharp creases.
//!
//! A rounded wrinkle under a flash has two dark walls and a brighter bottom: only a ratio that is smoothed over all of it slopes down to its
//! middle. A crease is darkest at its line, and smoothing blunts it. Which of the two a wrinkle is, is seen at its middle, along its line:
//! there the fine ratio bends up far more than the smooth one at a crease, and less, or down, at a rounded bottom.

use crate::blur::{blurred, doubled, halved};
use crate::plane::Plane;

/// Scale at which each wrinkle is one valley, and at which its bottom is looked at, io.
const VALLEY_IO: f64 = 0.03;
const FINE_IO: f64 = 0.008;
/// Scale of the gradient that then tells the side, io.
const SIDE_IO: f64 = 0.006;
/// Places nearer to the middle line than this part of the valley's scale are looked at.
const NEAR: f64 = 0.35;
/// They are averaged over so many scales.
const POOL: f64 = 1.5;
/// Fine over smooth curvature: rounded below the first, a crease above the second.
const SHARP: [f64; 2] = [5.0, 9.0];
/// Most that the fine gradient counts.
const MOST: f64 = 0.8;
/// Curvature is found over a picture of half the size where the pupils lie further apart, px.
const COARSE_PX: f64 = 160.0;

/// The smooth gradient, mixed with the fine one where the wrinkle is a crease.
pub(crate) fn sides(ratio: &Plane, smooth: &Plane, io: f64) -> [Plane; 2] {
    let sharp = match io > COARSE_PX {
        true => doubled(&sharpness(&halved(ratio), io / 2.0), ratio.width, ratio.height),
        false => sharpness(ratio, io),
    };
    let fine = blurred(ratio, SIDE_IO * io).gradient();
    let mut smooth = smooth.gradient();
    for (plane, fine) in smooth.iter_mut().zip(&fine) {
        let step = fine.with(plane, |fine, smooth| fine - smooth);
        *plane = plane.with(&step.with(&sharp, |step, share| step * share), |smooth, step| smooth + step);
    }
    smooth
}

/// How much each place belongs to a crease, 0 to [`MOST`].
fn sharpness(ratio: &Plane, io: f64) -> Plane {
    let valley = blurred(ratio, VALLEY_IO * io);
    let [gx, gy] = valley.gradient();
    let [xx, xy, yy] = bends(&valley);
    let [fine_xx, fine_xy, fine_yy] = bends(&blurred(ratio, FINE_IO * io));
    let reach = NEAR * VALLEY_IO * io;
    let mut smooth = Plane::filled(ratio.width, ratio.height, 0.0);
    let mut fine = smooth.clone();
    for at in 0..ratio.values.len() {
        let value = |plane: &Plane| plane.values[at];
        let half = 0.5 * (value(&xx) - value(&yy));
        let bend = 0.5 * (value(&xx) + value(&yy)) + half.hypot(value(&xy));
        if bend <= 0.0 {
            continue;
        }
        // Across the valley.
        let (sin, cos) = (0.5 * value(&xy).atan2(half)).sin_cos();
        let distance = (value(&gx) * cos + value(&gy) * sin) / bend;
        let weight = bend * (-(distance / reach).powi(2)).exp();
        let across =
            cos * cos * value(&fine_xx) + 2.0 * sin * cos * value(&fine_xy) + sin * sin * value(&fine_yy);
        smooth.values[at] = weight * bend;
        fine.values[at] = weight * across;
    }
    let pool = |plane: &Plane| blurred(plane, POOL * VALLEY_IO * io);
    pool(&fine).with(&pool(&smooth), |fine, smooth| {
        let share = ((fine / (smooth + 1e-15) - SHARP[0]) / (SHARP[1] - SHARP[0])).clamp(0.0, 1.0);
        MOST * share * share * (3.0 - 2.0 * share)
    })
}

/// Second derivatives: xx, xy, yy.
fn bends(plane: &Plane) -> [Plane; 3] {
    let [x, y] = plane.gradient();
    let [xx, xy] = x.gradient();
    let [_, yy] = y.gradient();
    [xx, xy, yy]
}
