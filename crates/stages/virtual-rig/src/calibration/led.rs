//! Pictures of a bright point in a dark room.

use super::Picture;
use camera::Camera;
use nalgebra::{Point3, Vector2, Vector3};

/// Corners of the polygon that stands for the point's outline; its area is made that of the round one.
const SIDES: usize = 96;

/// A glowing ball as the camera sees it: linear radiance, each pixel by the share of it that the ball covers, exact but for the
/// outline being a polygon of 96 corners. `room`: radiance of everything else.
///
/// `point_in_world`, `radius_mm`: the ball, mm. Behind the camera or outside the image it is not seen.
#[must_use]
pub fn render_led(
    camera: &Camera,
    point_in_world: &Point3<f64>,
    radius_mm: f64,
    radiance: [f32; 3],
    room: f32,
) -> Picture {
    let mut picture = Picture::filled(camera.image_size, [room; 3]);
    let Some(outline) = outline(camera, point_in_world, radius_mm) else { return picture };
    let [width, height] = camera.image_size.map(|side| side as usize);
    let span = |axis: usize, count: usize| {
        let (low, high) = outline.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), corner| {
            (low.min(corner[axis]), high.max(corner[axis]))
        });
        (low + 0.5).floor().max(0.0) as usize..((high + 1.5).floor().max(0.0) as usize).min(count)
    };
    let columns = span(0, width);
    for y in span(1, height) {
        for x in columns.clone() {
            let share = coverage(&outline, [x, y]) as f32;
            let pixel = &mut picture.radiance[y * width + x];
            *pixel = std::array::from_fn(|channel| room + share * (radiance[channel] - room));
        }
    }
    picture
}

/// The ball's outline in the image; none if it is behind the camera or reaches there.
fn outline(camera: &Camera, point_in_world: &Point3<f64>, radius_mm: f64) -> Option<Vec<Vector2<f64>>> {
    let middle = (camera.cam_from_world * point_in_world).coords;
    let distance = middle.norm();
    if middle.z <= 2.0 * radius_mm || !camera.contains(camera.lens.project(middle)) {
        return None;
    }
    let toward = middle / distance;
    let aside = toward.cross(&Vector3::x()).normalize();
    let upward = toward.cross(&aside);
    let step = std::f64::consts::TAU / SIDES as f64;
    // Rays that touch the ball form a cone of half angle asin(r / distance).
    let slope = (radius_mm / distance).asin().tan() * (step / step.sin()).sqrt();
    let corner = |i: usize| {
        let (sin, cos) = (step * i as f64).sin_cos();
        camera.lens.project(toward + slope * (cos * aside + sin * upward))
    };
    Some((0..SIDES).map(corner).collect())
}

/// The share of a pixel that a convex polygon covers.
fn coverage(outline: &[Vector2<f64>], pixel: [usize; 2]) -> f64 {
    let mut polygon = outline.to_vec();
    for axis in 0..2 {
        let middle = pixel[axis] as f64;
        polygon = clip(&polygon, |point| point[axis] - (middle - 0.5));
        polygon = clip(&polygon, |point| (middle + 0.5) - point[axis]);
    }
    let Some(&first) = polygon.first() else { return 0.0 };
    let twice: f64 = polygon.windows(2).map(|pair| (pair[0] - first).perp(&(pair[1] - first))).sum();
    (0.5 * twice.abs()).min(1.0)
}

/// The part of a polygon where `inside` is not negative.
fn clip(polygon: &[Vector2<f64>], inside: impl Fn(&Vector2<f64>) -> f64) -> Vec<Vector2<f64>> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, to) in polygon.iter().enumerate() {
        let from = &polygon[(i + polygon.len() - 1) % polygon.len()];
        let (before, after) = (inside(from), inside(to));
        if (before < 0.0) != (after < 0.0) {
            kept.push(from.lerp(to, before / (before - after)));
        }
        if after >= 0.0 {
            kept.push(*to);
        }
    }
    kept
}
