//! What stands in the way of light.

use super::beam::Corner;
use super::tree::Tree;
use nalgebra::{Point3, Vector3};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;

/// A further mesh: positions (mm) and triangles.
pub type Occluder<'a> = (&'a [Point3<f64>], &'a [[u32; 3]]);

/// Where a ray hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The triangle; those of occluders count on from the surface's.
    pub triangle: u32,
    /// Weight of the triangle's second corner.
    pub u: f64,
    /// Weight of its third corner.
    pub v: f64,
    /// Distance from the origin, in lengths of the direction.
    pub t: f64,
}

/// Triangles that rays can be cast at. Coordinates are single precision about the middle of the scene: 10⁻⁵ mm on a head.
#[derive(Clone)]
pub struct Scene {
    center: Vector3<f64>,
    bvh: Bvh2,
    /// In the order of the tree's leaves.
    triangles: Vec<RtTriangle>,
    pub(super) tree: Tree,
}

impl Scene {
    /// The scene of a surface (positions in mm) and of what else stands about.
    #[must_use]
    pub fn build(positions: &[Point3<f64>], triangles: &[[u32; 3]], occluders: &[Occluder<'_>]) -> Self {
        let meshes = || std::iter::once((positions, triangles)).chain(occluders.iter().copied());
        let (low, high) = meshes()
            .flat_map(|(points, _)| points)
            .fold((Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN)), |(low, high), point| {
                (low.inf(&point.coords), high.sup(&point.coords))
            });
        let empty = low.x > high.x;
        let center = if empty { Vector3::zeros() } else { (low + high) / 2.0 };
        let radius = if empty { 0.0 } else { (high - low).amax() / 2.0 };
        let corners: Vec<[Corner; 3]> = meshes()
            .flat_map(|(points, triangles)| triangles.iter().map(move |triangle| (points, triangle)))
            .map(|(points, triangle)| {
                triangle.map(|vertex| padded(single(&(points[vertex as usize].coords - center))))
            })
            .collect();
        Self::over(&corners, center, radius)
    }

    fn over(corners: &[[Corner; 3]], center: Vector3<f64>, radius: f64) -> Self {
        let triangles: Vec<Triangle> = corners
            .iter()
            .map(|corners| corners.map(|[x, y, z, _]| [x, y, z].into()))
            .map(|[v0, v1, v2]| Triangle { v0, v1, v2 })
            .collect();
        let bvh = build_bvh2_from_tris(&triangles, build_params(), &mut Default::default());
        let margin = 4.0 * f32::EPSILON * radius as f32;
        let tree = Tree::new(&bvh, corners, margin);
        let triangles =
            bvh.primitive_indices.iter().map(|&id| RtTriangle::from(&triangles[id as usize])).collect();
        Self { center, bvh, triangles, tree }
    }

    /// The point that single-precision coordinates are relative to, mm.
    #[must_use]
    pub fn center(&self) -> Point3<f64> {
        self.center.into()
    }

    /// Whether anything lies on the way from `origin` (mm) along `direction`, nearer than `max` lengths of the direction.
    #[must_use]
    pub fn occluded(&self, origin: &Point3<f64>, direction: &Vector3<f64>, max: f64) -> bool {
        let ray = self.ray(origin, direction, max);
        !self.bvh.ray_traverse_miss(ray, |ray, at| self.triangles[at].intersect(ray))
    }

    /// The first thing that a ray hits.
    #[must_use]
    pub fn hit(&self, origin: &Point3<f64>, direction: &Vector3<f64>) -> Option<Hit> {
        let ray = self.ray(origin, direction, f64::INFINITY);
        let mut hit = RayHit::none();
        if !self.bvh.ray_traverse(ray, &mut hit, |ray, at| self.triangles[at].intersect(ray)) {
            return None;
        }
        let at = hit.primitive_id as usize;
        let weights = self.triangles[at].compute_barycentric(&ray);
        let (u, v) = (f64::from(weights.x), f64::from(weights.y));
        Some(Hit { triangle: self.bvh.primitive_indices[at], u, v, t: f64::from(hit.t) })
    }

    fn ray(&self, origin: &Point3<f64>, direction: &Vector3<f64>, max: f64) -> Ray {
        Ray::new(self.local(origin).into(), single(direction).into(), 0.0, max as f32)
    }

    /// A place as the tree sees it.
    pub(super) fn local(&self, point: &Point3<f64>) -> [f32; 3] {
        single(&(point.coords - self.center))
    }
}

impl std::fmt::Debug for Scene {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.debug_struct("Scene").field("triangles", &self.triangles.len()).finish_non_exhaustive()
    }
}

fn single(vector: &Vector3<f64>) -> [f32; 3] {
    [vector.x as f32, vector.y as f32, vector.z as f32]
}

pub(super) fn padded([x, y, z]: [f32; 3]) -> Corner {
    [x, y, z, 0.0]
}

/// Built anew for each frame, so that the build must not take long beside the casting.
fn build_params() -> BvhBuildParams {
    BvhBuildParams { max_prims_per_leaf: 4, ..BvhBuildParams::medium_build() }
}
