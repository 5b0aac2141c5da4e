//! Whose face: its rest surface, and how it moves without wrinkles.

mod base;
pub mod expressions;
pub mod face;
mod motion;
mod muscles;
mod outside;
pub mod place;
mod props;
pub mod refine;
pub mod scan;
pub mod subdivide;
pub mod texture;

pub use base::Base;
pub use face::{Fineness, MarkerPlace};
pub use muscles::MUSCLES;
pub use props::Prop;

pub(crate) use outside::Outside;

use face::{Face, Person, skin};
use mesh::Mesh;
use motion::Offsets;
use muscles::Muscles;
use nalgebra::{Point2, Point3, Similarity3, Vector3};
use rayon::prelude::*;

/// A head whose face moves: millimetres, y up, looking along +z, the subject's left at +x.
#[derive(Debug, Clone)]
pub struct Body {
    /// The rest pose: triangles only, with texture coordinates.
    pub mesh: Mesh,
    /// Its triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Per vertex its place on the unrolled face, mm.
    pub domain: Vec<Point2<f64>>,
    /// Per vertex the linear RGB reflectance.
    pub albedo: Vec<[f32; 3]>,
    /// What moves with the head only.
    pub props: Vec<Prop>,
    person: Person,
    face_from_canonical: Similarity3<f64>,
    names: Vec<String>,
    motion: Motion,
}

/// How a body moves without wrinkles.
#[derive(Debug, Clone)]
enum Motion {
    Muscles(Box<Muscles>),
    Shapes(Vec<Offsets>),
}

impl Body {
    /// The synthetic face of a seed with about `vertex_count` vertices (500 to 1 500 000, within 10 %, or as many as creases
    /// need), finer along the polylines `near` (domain, mm). The same arguments give the same body; seed 0 is the average.
    #[must_use]
    pub fn parametric(
        seed: u64,
        vertex_count: usize,
        near: &[Vec<Point2<f64>>],
        fineness: impl Into<Fineness>,
    ) -> Self {
        let face = Face::refined(seed, vertex_count, near, fineness.into());
        let albedo = face.domain.par_iter().map(|&at| skin::albedo(&face.person, at)).collect();
        let muscles = Muscles::of(&face.person, &face.domain, &Similarity3::identity());
        let props = props::of(&face.person);
        let motion = Motion::Muscles(Box::new(muscles));
        Self { props, ..Self::build(face, albedo, Similarity3::identity(), muscle_names(), motion) }
    }

    /// A body that blends shapes: `offsets` hold per name one displacement per vertex, mm.
    #[must_use]
    pub fn from_shapes(
        mesh: Mesh,
        domain: Vec<Point2<f64>>,
        albedo: Vec<[f32; 3]>,
        names: Vec<String>,
        offsets: Vec<Vec<Vector3<f64>>>,
    ) -> Self {
        let shapes = offsets.iter().map(|all| Offsets::of(all, 0.0)).collect();
        let face = Face { person: Person::of_seed(0), domain, mesh };
        Self::build(face, albedo, Similarity3::identity(), names, Motion::Shapes(shapes))
    }

    /// A scan on which the muscles of the average face act. `face_from_canonical` carries the average face into the
    /// scan's space.
    #[must_use]
    pub fn from_muscles(
        mesh: Mesh,
        domain: Vec<Point2<f64>>,
        albedo: Vec<[f32; 3]>,
        face_from_canonical: Similarity3<f64>,
    ) -> Self {
        let person = Person::of_seed(0);
        let muscles = Muscles::of(&person, &domain, &face_from_canonical);
        let face = Face { person, domain, mesh };
        Self::build(face, albedo, face_from_canonical, muscle_names(), Motion::Muscles(Box::new(muscles)))
    }

    /// The same body with pores sunk into its skin, `depth_mm` deep (0.02 looks right; 0: none), in a band of 0.3 to 0.8 mm:
    /// for meshes whose edges are shorter than 0.2 mm.
    #[must_use]
    pub fn with_pores(mut self, depth_mm: f64) -> Self {
        if depth_mm == 0.0 {
            return self;
        }
        let normals = mesh::vertex_normals(&self.mesh.positions, &self.triangles);
        let sink = |((point, at), normal): ((&mut Point3<f64>, &Point2<f64>), &Vector3<f64>)| {
            *point -= normal * (depth_mm * skin::pore(&self.person, *at));
        };
        self.mesh.positions.par_iter_mut().zip(&self.domain).zip(&normals).for_each(sink);
        self
    }

    fn build(
        face: Face,
        albedo: Vec<[f32; 3]>,
        face_from_canonical: Similarity3<f64>,
        names: Vec<String>,
        motion: Motion,
    ) -> Self {
        let Face { person, domain, mesh } = face;
        let triangles = mesh.triangles();
        Self {
            mesh,
            triangles,
            domain,
            albedo,
            props: Vec::new(),
            person,
            face_from_canonical,
            names,
            motion,
        }
    }

    /// What the weights of [`Self::large_scale`] mean, in their order.
    #[must_use]
    pub fn shape_names(&self) -> &[String] {
        &self.names
    }

    /// The surface without wrinkles, the head at rest: one point per vertex, mm. One weight per shape; missing ones
    /// are 0.
    #[must_use]
    pub fn large_scale(&self, weights: &[f64]) -> Vec<Point3<f64>> {
        match &self.motion {
            Motion::Muscles(muscles) => muscles.pose(&self.mesh.positions, weights),
            Motion::Shapes(shapes) => {
                let active: Vec<(&Offsets, f64)> =
                    shapes.iter().zip(weights.iter().copied()).filter(|(_, weight)| *weight != 0.0).collect();
                motion::pose(&self.mesh.positions, &active, &[])
            }
        }
    }

    /// 85 markers on vertices: 8 on the lips, 4 on the lids, the rest spread over the face, closer around the mouth
    /// and the eyes. A marker whose place the mesh does not cover is left out.
    #[must_use]
    pub fn markers(&self) -> Vec<MarkerPlace> {
        let turn = self.face_from_canonical.isometry.rotation;
        let outwards = |vertex: usize, at: Point2<f64>| {
            let (sin, cos) = (at.x / place::ROLL).sin_cos();
            self.mesh.positions[vertex].coords.dot(&(turn * Vector3::new(sin, 0.0, cos)))
        };
        face::markers(&self.person, &self.domain, outwards)
    }

    /// The rest positions of five markers on a headband over the forehead, mm; they move with the head only. They are at
    /// least 5 mm over the skin.
    #[must_use]
    pub fn headband(&self) -> Vec<(String, Point3<f64>)> {
        let skin = self.outside();
        let worn = |(name, point)| {
            let carried = self.face_from_canonical.transform_point(&point);
            (name, skin.lifted(&carried, MARKER_OVER_SKIN_MM, MARKER_OVER_SKIN_MM))
        };
        face::headband(&self.person).into_iter().map(worn).collect()
    }

    /// The resting skin, to wear things on.
    pub(crate) fn outside(&self) -> Outside<'_> {
        Outside::of(&self.mesh.positions, &self.triangles)
    }

    /// The same body with eyeballs behind the open lids of a scan.
    fn with_eyeballs(mut self) -> Self {
        let balls = [1.0, -1.0].into_iter().filter_map(|side| props::eyeball_behind(&self, side));
        self.props = balls.collect();
        self
    }
}

/// Markers on a headband are at least this high over the skin, and over all skin this near, mm.
const MARKER_OVER_SKIN_MM: f64 = 5.0;

fn muscle_names() -> Vec<String> {
    MUSCLES.iter().map(ToString::to_string).collect()
}
