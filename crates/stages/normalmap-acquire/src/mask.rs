//! Which pixels count: regions inside polygons, soft borders, stripes rather than blotches.

use crate::blur::blurred;
use crate::plane::Plane;

/// Border of a painted region that is left out, and over which it fades in, io.
const FEATHER_IO: f64 = 0.015;
/// Window of the structure tensor, io.
const COHERENCE_IO: f64 = 0.02;
/// Blotches have a coherence below the first, wrinkles above the second.
const COHERENT: [f64; 2] = [0.2, 0.55];
/// Skin whose normal's share towards the camera is below the first is not used, above the second wholly.
const FACING: [f64; 2] = [0.6, 0.8];

/// The convex hull of points, in order.
#[must_use]
pub fn hull(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut points = points.to_vec();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    let turn =
        |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while chain.len() >= 2 && turn(chain[chain.len() - 2], chain[chain.len() - 1], point) <= 0.0 {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut lower = chain(&mut points.iter().copied());
    lower.extend(chain(&mut points.iter().rev().copied()));
    lower
}

/// 1 inside a polygon, 0 outside; `first` is the picture's first column and row.
#[must_use]
pub fn inside(polygon: &[[f64; 2]], first: [usize; 2], width: usize, height: usize) -> Plane {
    let mut plane = Plane::filled(width, height, 0.0);
    for row in 0..height {
        let y = (first[1] + row) as f64;
        let mut crossings: Vec<f64> = (0..polygon.len())
            .filter_map(|i| {
                let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
                ((a[1] <= y) != (b[1] <= y)).then(|| a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
            })
            .collect();
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let place = |x: f64| (x.ceil() - first[0] as f64).clamp(0.0, width as f64) as usize;
            plane.values[row * width + place(pair[0])..row * width + place(pair[1])].fill(1.0);
        }
    }
    plane
}

/// The mask with its border taken off and faded, so that what lies outside stays outside.
#[must_use]
pub(crate) fn feathered(mask: &Plane, io: f64) -> Plane {
    let soft = blurred(mask, FEATHER_IO * io);
    mask.with(&soft, |mask, soft| mask * (2.0 * soft - 1.0).clamp(0.0, 1.0))
}

/// How much a picture is made of stripes, 0–1, by its structure tensor [BigunGranlund1987].
#[must_use]
pub(crate) fn coherence(plane: &Plane, io: f64) -> Plane {
    let [gx, gy] = plane.gradient();
    let window = |one: &Plane, other: &Plane| blurred(&one.with(other, |a, b| a * b), COHERENCE_IO * io);
    let (xx, xy, yy) = (window(&gx, &gx), window(&gx, &gy), window(&gy, &gy));
    let apart = xx.with(&yy, |xx, yy| xx - yy).with(&xy, |apart, xy| apart.hypot(2.0 * xy));
    let sum = xx.with(&yy, |xx, yy| xx + yy);
    apart.with(&sum, |apart, sum| if sum > 1e-18 { ramp(apart / sum, COHERENT) } else { 0.0 })
}

/// How well skin faces the camera, from the share of its normal that does.
#[must_use]
pub(crate) fn facing(normal_z: &Plane) -> Plane {
    normal_z.map(|z| ramp(z, FACING))
}

/// 0 below the first, 1 above the second, smooth between.
pub(crate) fn ramp(value: f64, [low, high]: [f64; 2]) -> f64 {
    let share = ((value - low) / (high - low)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}
