//! Which boundary loops are openings of the face (mouth, eyes), and which are where the scan ends.

use crate::{Connectivity, loop_length};
use nalgebra::{Point3, Vector3};

/// A loop is the scan's outer rim (a mask's edge, the neck) if it is the longest of its part and reaches over more than
/// this share of the part, …
const RIM_SHARE: f64 = 1.0 / 3.0;
/// … or if it reaches over more than this share (a neck and a missing top of the head are both rims).
const SURE_RIM_SHARE: f64 = 0.5;
/// Two loops are nostrils if their middles are nearer to each other than this, mm (eyes are some 60 mm apart), …
const NOSTRILS_MM: f64 = 30.0;
/// … and the shorter is at least this share of the longer.
const NOSTRIL_LIKENESS: f64 = 0.6;

/// The boundary loops inside the surface that are at least `smallest_mm` long, longest first; holes of scanning are shorter.
/// Nostrils that were cut out are no openings either: they do not open, and soft ones cost 4 % on an expression set.
///
/// `around`: of all triangles; `points`: #V, mm. Each loop runs in the direction of its triangles.
#[must_use]
pub fn openings(around: &Connectivity, points: &[Point3<f64>], smallest_mm: f64) -> Vec<Vec<u32>> {
    let (part, part_count) = around.components();
    let mut boxes = vec![Extent::default(); part_count];
    points.iter().zip(&part).for_each(|(point, &part)| boxes[part as usize].include(point));
    let measure = |vertices: Vec<u32>| {
        let mut extent = Extent::default();
        vertices.iter().for_each(|&vertex| extent.include(&points[vertex as usize]));
        let part = part[vertices[0] as usize] as usize;
        (loop_length(points, &vertices), part, extent.diagonal() / boxes[part].diagonal(), vertices)
    };
    let mut loops: Vec<_> = around.boundary_loops().into_iter().map(measure).collect();
    loops.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.3.cmp(&b.3)));
    let mut seen = vec![false; part_count];
    let inside = |(length, part, share, vertices): (f64, usize, f64, Vec<u32>)| {
        let longest = !std::mem::replace(&mut seen[part], true);
        let rim = share > SURE_RIM_SHARE || (longest && share > RIM_SHARE);
        (!rim && length >= smallest_mm).then_some(vertices)
    };
    let found: Vec<Vec<u32>> = loops.into_iter().filter_map(inside).collect();
    let is_nostril = |one: usize| {
        (0..found.len()).any(|other| other != one && are_nostrils(points, [&found[one], &found[other]]))
    };
    let kept: Vec<bool> = (0..found.len()).map(|rim| !is_nostril(rim)).collect();
    found.into_iter().zip(kept).filter_map(|(rim, kept)| kept.then_some(rim)).collect()
}

fn are_nostrils(points: &[Point3<f64>], pair: [&[u32]; 2]) -> bool {
    let [one, other] = pair.map(|rim| loop_length(points, rim));
    let middle =
        |rim: &[u32]| rim.iter().map(|&v| points[v as usize].coords).sum::<Vector3<f64>>() / rim.len() as f64;
    let apart = (middle(pair[0]) - middle(pair[1])).norm();
    apart < NOSTRILS_MM && one.min(other) >= NOSTRIL_LIKENESS * one.max(other)
}

/// Distance of a point from the nearest of some loops, mm; infinite without any.
#[must_use]
pub fn distance_to_loops(loops: &[Vec<Point3<f64>>], at: &Point3<f64>) -> f64 {
    let sides = loops.iter().flat_map(|points| points.iter().zip(points.iter().cycle().skip(1)));
    sides.map(|(a, b)| distance_to_segment(a, b, at)).fold(f64::INFINITY, f64::min)
}

fn distance_to_segment(a: &Point3<f64>, b: &Point3<f64>, at: &Point3<f64>) -> f64 {
    let (side, to) = (b - a, at - a);
    let along = (to.dot(&side) / side.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (to - along * side).norm()
}

/// An axis-aligned box.
#[derive(Clone, Copy)]
struct Extent {
    low: Point3<f64>,
    high: Point3<f64>,
}

impl Default for Extent {
    fn default() -> Self {
        let far = Vector3::repeat(f64::INFINITY);
        Self { low: far.into(), high: (-far).into() }
    }
}

impl Extent {
    fn include(&mut self, point: &Point3<f64>) {
        (self.low, self.high) = (self.low.inf(point), self.high.sup(point));
    }

    fn diagonal(&self) -> f64 {
        (self.high - self.low).norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_to_the_sides_not_to_their_ends() {
        let square = [[0., 0., 0.], [10., 0., 0.], [10., 10., 0.], [0., 10., 0.]].map(Point3::from).to_vec();
        assert!(
            (distance_to_loops(std::slice::from_ref(&square), &Point3::new(5.0, -3.0, 4.0)) - 5.0).abs()
                < 1e-12
        );
        // The closing side counts too.
        assert!((distance_to_loops(&[square], &Point3::new(-2.0, 5.0, 0.0)) - 2.0).abs() < 1e-12);
        assert_eq!(distance_to_loops(&[], &Point3::origin()), f64::INFINITY);
    }
}
