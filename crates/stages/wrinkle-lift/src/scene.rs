//! The face at one moment, where the cameras are: carried back to mocap space, and ready for rays.

use crate::ground::{Ground, Spot};
use nalgebra::{Matrix3, Point3, Vector3};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::{Ray, RayHit};
use operators::{Inverse, RbfMap};

/// The warp c: head space → face space, and its inverse.
#[derive(Debug, Clone)]
pub struct Spaces {
    /// c
    pub face_from_head: RbfMap,
    /// c⁻¹
    pub head_from_face: Inverse,
}

impl Spaces {
    /// How small steps in face space are in head space: (∂c/∂x)⁻¹ at a point of head space; none where c is folded.
    #[must_use]
    pub fn slope(&self, point_in_head: &Point3<f64>) -> Option<Matrix3<f64>> {
        let jacobian = self.face_from_head.with_jacobian(point_in_head).1;
        if jacobian.determinant() > 0.0 { jacobian.try_inverse() } else { None }
    }
}

/// Where a ray meets the face first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Where on the mesh.
    pub spot: Spot,
    /// The point in head space, mm.
    pub point: Point3<f64>,
    /// Whether the ray comes from outside; else it passed through an opening and meets the back of the skin.
    pub from_outside: bool,
}

/// The face at one moment.
pub struct Scene<'a> {
    /// The surface.
    pub ground: &'a Ground,
    /// Vertices in face space, mm.
    pub in_face: Vec<Point3<f64>>,
    /// The same in head space; those without a preimage say nothing.
    pub in_head: Vec<Point3<f64>>,
    /// How many vertices have no preimage.
    pub lost: usize,
    tree: Tree,
}

impl<'a> Scene<'a> {
    /// Carries the deformed mesh (`in_face`: #V, mm) back through the warp [BickelBotsch2007, Sec. 5.3]. Triangles with a corner that
    /// has no preimage, or that lies where the warp is folded over, are not there for rays.
    #[must_use]
    pub fn new(ground: &'a Ground, in_face: Vec<Point3<f64>>, spaces: &Spaces) -> Self {
        let inverse = &spaces.head_from_face;
        let found = inverse.preimages(&in_face);
        let is_there: Vec<bool> =
            found.iter().map(|preimage| inverse.is_found(preimage) && preimage.determinant > 0.0).collect();
        let in_head: Vec<Point3<f64>> = found.iter().map(|preimage| preimage.point).collect();
        let lost = is_there.iter().filter(|there| !**there).count();
        let whole = |face: &u32| ground.triangles()[*face as usize].iter().all(|&v| is_there[v as usize]);
        let faces: Vec<u32> = (0..ground.triangles().len() as u32).filter(whole).collect();
        let tree = Tree::over(ground, faces, &in_head);
        Self { ground, in_face, in_head, lost, tree }
    }

    /// The first triangle that a ray from outside meets; `direction` of unit length, both in head space.
    #[must_use]
    pub fn cast(&self, origin: &Point3<f64>, direction: &Vector3<f64>) -> Option<Hit> {
        self.tree.cast(self.ground, &self.in_head, origin, direction)
    }
}

/// Boxes around triangles. They are in single precision and only say which triangles to look at; those are met in double precision.
struct Tree {
    center: Point3<f64>,
    radius: f64,
    bvh: Bvh2,
    /// In the order of the tree's leaves.
    faces: Vec<u32>,
}

/// Boxes grow by this, mm: more than single precision loses on a head.
const MARGIN_MM: f32 = 1e-2;
/// Two triangles that a ray meets this close together are one edge; the first in order is taken, mm.
const SAME_MM: f64 = 1e-7;

impl Tree {
    fn over(ground: &Ground, faces: Vec<u32>, points: &[Point3<f64>]) -> Self {
        let corners = |face: &u32| ground.corners(*face, points);
        let all: Vec<Point3<f64>> = faces.iter().flat_map(corners).collect();
        let (low, high) = mesh::bounding_box(&all);
        let center = nalgebra::center(&low, &high);
        let radius = (high - low).norm() / 2.0;
        let boxed = |triangle: &[Point3<f64>]| {
            let (low, high) = mesh::bounding_box(triangle);
            let single = |point: Point3<f64>, margin: f32| single(point - center).map(|x| x + margin);
            Aabb::new(single(low, -MARGIN_MM).into(), single(high, MARGIN_MM).into())
        };
        let boxes: Vec<Aabb> = all.chunks_exact(3).map(boxed).collect();
        let bvh = build_bvh2(&boxes, BvhBuildParams::fast_build(), &mut Default::default());
        let faces = bvh.primitive_indices.iter().map(|&i| faces[i as usize]).collect();
        Self { center, radius, bvh, faces }
    }

    fn cast(
        &self,
        ground: &Ground,
        points: &[Point3<f64>],
        origin: &Point3<f64>,
        direction: &Vector3<f64>,
    ) -> Option<Hit> {
        if self.faces.is_empty() {
            return None;
        }
        // Up to the ball around the face there is nothing, and coordinates stay small.
        let ahead = ((self.center - origin).dot(direction) - self.radius - 1.0).max(0.0);
        let start = origin + direction * ahead;
        let ray = Ray::new_inf(single(start - self.center).into(), single(*direction).into());
        let mut best: Option<(f64, Spot, bool)> = None;
        let meet = |_: &Ray, id: usize| {
            let face = self.faces[id];
            let Some((t, barycentric, from_outside)) = meets(&start, direction, ground.corners(face, points))
            else {
                return f32::INFINITY;
            };
            let is_first = best.is_none_or(|(nearest, spot, _)| {
                t < nearest - SAME_MM || (t < nearest + SAME_MM && face < spot.face)
            });
            if is_first {
                best = Some((t, Spot { face, barycentric }, from_outside));
            }
            t as f32
        };
        self.bvh.ray_traverse(ray, &mut RayHit::none(), meet);
        best.map(|(t, spot, from_outside)| Hit { spot, point: start + direction * t, from_outside })
    }
}

fn single(vector: Vector3<f64>) -> [f32; 3] {
    vector.map(|x| x as f32).into()
}

/// How far outside a side a ray still meets a triangle, as share of it: none slips through between two.
const RIM: f64 = 1e-9;

/// Where a ray meets a triangle, after Möller and Trumbore: distance, shares of the corners, and whether it meets the outer side.
fn meets(
    start: &Point3<f64>,
    direction: &Vector3<f64>,
    [a, b, c]: [Point3<f64>; 3],
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
