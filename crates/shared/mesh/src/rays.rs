//! Rays against a mesh.

use crate::bounding_box;
use nalgebra::{Point3, Vector3};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::{Ray, RayHit};

/// Where a ray meets a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The triangle, by its number in the list that the tree was made over.
    pub face: u32,
    /// Shares of its three corners; they add up to 1.
    pub barycentric: [f64; 3],
    /// Distance from the ray's origin, in lengths of its direction.
    pub distance: f64,
    /// Whether the ray comes from the side that the triangle's normal points to.
    pub from_outside: bool,
}

/// Triangles, ready for rays. The boxes around them are in single precision and only say which triangles to look at; those are met in
/// double precision, so that no ray slips through between two.
pub struct RayTree {
    center: Point3<f64>,
    radius: f64,
    bvh: Bvh2,
    /// In the order of the tree's leaves.
    leaves: Vec<(u32, [Point3<f64>; 3])>,
}

/// Boxes grow by this share of the mesh's radius: more than single precision loses.
const MARGIN: f64 = 1e-5;
/// Two triangles that a ray meets this close together, as share of the radius, are one edge; the first in order is taken.
const SAME: f64 = 1e-9;
/// How far outside a side a ray still meets a triangle, as share of it: none slips through between two.
const RIM: f64 = 1e-9;

impl RayTree {
    /// Over those of the triangles that `is_there` keeps. `points`: #V, of any unit.
    ///
    /// # Panics
    /// If a triangle names a vertex beyond the points.
    #[must_use]
    pub fn over(
        points: &[Point3<f64>],
        triangles: &[[u32; 3]],
        is_there: impl Fn(&[u32; 3]) -> bool,
    ) -> Self {
        let all: Vec<(u32, [Point3<f64>; 3])> = (0u32..)
            .zip(triangles)
            .filter(|(_, triangle)| is_there(triangle))
            .map(|(face, triangle)| (face, triangle.map(|vertex| points[vertex as usize])))
            .collect();
        let (low, high) = match all.is_empty() {
            true => Default::default(),
            false => bounding_box(&all.iter().flat_map(|(_, corners)| *corners).collect::<Vec<_>>()),
        };
        let center = nalgebra::center(&low, &high);
        let radius = (high - low).norm() / 2.0;
        let margin = (MARGIN * radius) as f32;
        let boxed = |(_, corners): &(u32, [Point3<f64>; 3])| {
            let (low, high) = bounding_box(corners);
            let grown = |point: Point3<f64>, margin: f32| single(point - center).map(|x| x + margin);
            Aabb::new(grown(low, -margin).into(), grown(high, margin).into())
        };
        let boxes: Vec<Aabb> = all.iter().map(boxed).collect();
        let bvh = build_bvh2(&boxes, BvhBuildParams::fast_build(), &mut Default::default());
        let leaves = bvh.primitive_indices.iter().map(|&at| all[at as usize]).collect();
        Self { center, radius, bvh, leaves }
    }

    /// What a ray meets first; `direction` of any length but zero.
    #[must_use]
    pub fn cast(&self, origin: &Point3<f64>, direction: &Vector3<f64>) -> Option<Hit> {
        self.cast_where(origin, direction, |_| true)
    }

    /// The first that a ray meets of what `is_wanted` lets count.
    #[must_use]
    pub fn cast_where(
        &self,
        origin: &Point3<f64>,
        direction: &Vector3<f64>,
        is_wanted: impl Fn(&Hit) -> bool,
    ) -> Option<Hit> {
        if self.leaves.is_empty() {
            return None;
        }
        let length = direction.norm();
        let direction = direction / length;
        // Up to the ball around the mesh there is nothing, and coordinates stay small.
        let ahead = ((self.center - origin).dot(&direction) - 1.001 * self.radius).max(0.0);
        let start = origin + direction * ahead;
        let ray = Ray::new_inf(single(start - self.center).into(), single(direction).into());
        let same = SAME * self.radius / length;
        let mut best: Option<Hit> = None;
        let meet = |_: &Ray, id: usize| {
            let (face, corners) = &self.leaves[id];
            let Some((t, barycentric, from_outside)) = meets(&start, &direction, corners) else {
                return f32::INFINITY;
            };
            let hit = Hit { face: *face, barycentric, distance: (ahead + t) / length, from_outside };
            if !is_wanted(&hit) {
                return f32::INFINITY;
            }
            let is_first = best.is_none_or(|best| {
                hit.distance < best.distance - same
                    || (hit.distance < best.distance + same && hit.face < best.face)
            });
            if is_first {
                best = Some(hit);
            }
            t as f32
        };
        self.bvh.ray_traverse(ray, &mut RayHit::none(), meet);
        best
    }
}

fn single(vector: Vector3<f64>) -> [f32; 3] {
    vector.map(|x| x as f32).into()
}

/// Where a ray meets a triangle [MoellerTrumbore1997]: distance, shares of the corners, and whether it meets the outer side.
fn meets(
    start: &Point3<f64>,
    direction: &Vector3<f64>,
    [a, b, c]: &[Point3<f64>; 3],
) -> Option<(f64, [f64; 3], bool)> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(&ac);
    let determinant = ab.dot(&across);
    if determinant == 0.0 {
        return None;
    }
    let from = start - a;
    let v = from.dot(&across) / determinant;
    let other = from.cross(&ab);
    let w = direction.dot(&other) / determinant;
    let t = ac.dot(&other) / determinant;
    if !(v >= -RIM && w >= -RIM && v + w <= 1.0 + RIM && t > 0.0) {
        return None;
    }
    let raised = [1.0 - v - w, v, w].map(|share| share.max(0.0));
    let sum: f64 = raised.iter().sum();
    Some((t, raised.map(|share| share / sum), determinant > 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two sheets of a square, 1 apart, the upper one facing down.
    fn sheets() -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
        let corner = |k: usize, z: f64| Point3::new([0.0, 9.0, 9.0, 0.0][k], [0.0, 0.0, 9.0, 9.0][k], z);
        let points = (0..8).map(|k| corner(k % 4, (k / 4) as f64)).collect();
        (points, vec![[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]])
    }

    #[test]
    fn the_nearest_triangle_is_met_wherever_the_ray_starts() {
        let (points, triangles) = sheets();
        let tree = RayTree::over(&points, &triangles, |_| true);
        for height in [2.0, 1e3, 1e6] {
            let hit = tree.cast(&Point3::new(6.0, 3.0, height), &Vector3::new(0.0, 0.0, -2.0)).unwrap();
            assert!((hit.distance - (height - 1.0) / 2.0).abs() < 1e-9 * height && hit.face == 2);
            assert!(!hit.from_outside, "the upper sheet shows its back");
        }
        let hit =
            tree.cast_where(&Point3::new(6.0, 3.0, 5.0), &-Vector3::z(), |hit| hit.from_outside).unwrap();
        assert!(hit.face == 0 && (hit.distance - 5.0).abs() < 1e-12);
        let at: Vector3<f64> =
            (0..3).map(|k| hit.barycentric[k] * points[triangles[0][k] as usize].coords).sum();
        assert!((at - Vector3::new(6.0, 3.0, 0.0)).norm() < 1e-12);
    }

    #[test]
    fn a_ray_on_an_edge_meets_the_first_triangle_and_one_beside_the_mesh_none() {
        let (points, triangles) = sheets();
        let tree = RayTree::over(&points, &triangles, |triangle| triangle[0] == 0);
        let down = -Vector3::z();
        assert_eq!(tree.cast(&Point3::new(4.0, 4.0, 0.5), &down).unwrap().face, 0);
        assert_eq!(tree.cast(&Point3::new(-1e-3, 4.0, 0.5), &down), None);
        assert_eq!(tree.cast(&Point3::new(4.0, 4.0, -0.5), &down), None, "it looks away");
        let none = RayTree::over(&points, &triangles, |_| false);
        assert_eq!(none.cast(&Point3::origin(), &down), None);
    }
}
