//! The face at one moment, where the cameras are: carried back to mocap space, and ready for rays.

use crate::ground::{Ground, Spot};
use mesh::RayTree;
use nalgebra::{Matrix3, Point3, Vector3};
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
    tree: RayTree,
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
        let is_whole = |triangle: &[u32; 3]| triangle.iter().all(|&vertex| is_there[vertex as usize]);
        let tree = RayTree::over(&in_head, ground.triangles(), is_whole);
        Self { ground, in_face, in_head, lost, tree }
    }

    /// The first triangle that a ray from outside meets; `direction` of unit length, both in head space.
    #[must_use]
    pub fn cast(&self, origin: &Point3<f64>, direction: &Vector3<f64>) -> Option<Hit> {
        let hit = self.tree.cast(origin, direction)?;
        let spot = Spot { face: hit.face, barycentric: hit.barycentric };
        Some(Hit { spot, point: origin + direction * hit.distance, from_outside: hit.from_outside })
    }
}
