//! Simple shapes about the face.

use nalgebra::{Point3, Vector3};
use std::f64::consts::{PI, TAU};

const STACKS: u32 = 12;
const SLICES: u32 = 20;

/// A ball: points, and triangles that face outwards.
pub(super) fn ball(center: &Point3<f64>, radius: f64) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
    let mut points = vec![center + Vector3::y() * radius];
    for stack in 1..STACKS {
        let (sin, cos) = (PI * f64::from(stack) / f64::from(STACKS)).sin_cos();
        points.extend((0..SLICES).map(|slice| {
            let (across, along) = (TAU * f64::from(slice) / f64::from(SLICES)).sin_cos();
            center + Vector3::new(sin * across, cos, sin * along) * radius
        }));
    }
    points.push(center - Vector3::y() * radius);
    let last = points.len() as u32 - 1;
    let at = |stack: u32, slice: u32| 1 + (stack - 1) * SLICES + slice % SLICES;
    let mut triangles = Vec::new();
    for slice in 0..SLICES {
        triangles.push([0, at(1, slice), at(1, slice + 1)]);
        for stack in 1..STACKS - 1 {
            triangles.push([at(stack, slice), at(stack + 1, slice), at(stack + 1, slice + 1)]);
            triangles.push([at(stack, slice), at(stack + 1, slice + 1), at(stack, slice + 1)]);
        }
        triangles.push([at(STACKS - 1, slice), last, at(STACKS - 1, slice + 1)]);
    }
    (points, triangles)
}

/// A strip along a line, seen from both sides; per point of its middle the direction in which it is wide.
pub(super) fn strip(line: &[(Point3<f64>, Vector3<f64>)], width: f64) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
    let edges =
        |(at, wide): &(Point3<f64>, Vector3<f64>)| [at - wide * (0.5 * width), at + wide * (0.5 * width)];
    let points = line.iter().flat_map(edges).collect();
    let pieces = (1..line.len() as u32).flat_map(|i| {
        let [a, b, c, d] = [2 * i - 2, 2 * i - 1, 2 * i, 2 * i + 1];
        [[a, c, d], [a, d, b], [a, d, c], [a, b, d]]
    });
    (points, pieces.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_faces_outwards_and_has_its_radius() {
        let center = Point3::new(1.0, 2.0, 3.0);
        let (points, triangles) = ball(&center, 2.0);
        assert!(points.iter().all(|point| ((point - center).norm() - 2.0).abs() < 1e-12));
        for [a, b, c] in triangles.into_iter().map(|triangle| triangle.map(|corner| points[corner as usize]))
        {
            assert!((b - a).cross(&(c - a)).dot(&(a - center)) > 0.0);
        }
    }
}
