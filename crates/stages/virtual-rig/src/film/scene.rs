//! What stands before the camera.

use crate::paint::Layers;
use nalgebra::{Point3, Vector3};

/// A surface's shape-independent part.
#[derive(Debug, Clone, Copy)]
pub struct Skin<'a> {
    /// #F × 3, counter-clockwise seen from outside.
    pub triangles: &'a [[u32; 3]],
    /// #V × 3, linear RGB reflectance.
    pub albedo: &'a [[f32; 3]],
}

/// A surface while the shutter is open.
#[derive(Debug, Clone, Copy)]
pub struct Moment<'a> {
    /// #V × 3 when the shutter opens, world, mm.
    pub open: &'a [Point3<f64>],
    /// #V × 3 when it closes; in between, vertices run straight. None for a still.
    pub close: Option<&'a [Point3<f64>]>,
    /// #V × 3, unit normals; only gloss asks for them, and an empty list has none.
    pub normals: &'a [Vector3<f64>],
    /// #V × 3, light that arrives, linear RGB: 1 = full unshadowed ambient.
    pub irradiance: &'a [[f32; 3]],
}

impl Moment<'_> {
    /// The vertices at a share of the exposure, 0 (open) to 1 (close); 0.5 is the moment that truth is stated for.
    #[must_use]
    pub fn at(&self, share: f64) -> Vec<Point3<f64>> {
        match self.close {
            None => self.open.to_vec(),
            Some(close) => self.open.iter().zip(close).map(|(from, to)| from + share * (to - from)).collect(),
        }
    }
}

/// Something that hides what is behind it.
#[derive(Debug, Clone, Copy)]
pub struct Solid<'a> {
    /// What it is made of.
    pub skin: Skin<'a>,
    /// Where it is.
    pub moment: Moment<'a>,
}

/// A painted face and things about it.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    /// The face.
    pub face: Solid<'a>,
    /// The paint on it.
    pub layers: &'a Layers,
    /// What else can be seen, without paint or gloss: eyeballs, the bag of the mouth.
    pub props: &'a [Solid<'a>],
}

impl<'a> Scene<'a> {
    /// The face, then the props.
    pub(super) fn solids(&self) -> impl Iterator<Item = &Solid<'a>> {
        std::iter::once(&self.face).chain(self.props)
    }

    pub(super) fn moves(&self) -> bool {
        self.solids().any(|solid| solid.moment.close.is_some())
    }

    /// # Panics
    /// If the lengths of a solid's lists differ.
    pub(super) fn check(&self) {
        for solid in self.solids() {
            let count = solid.moment.open.len();
            assert_eq!(solid.skin.albedo.len(), count, "one albedo per vertex");
            assert_eq!(solid.moment.irradiance.len(), count, "one irradiance per vertex");
            assert!(solid.moment.close.is_none_or(|close| close.len() == count), "one place per vertex");
            let normals = solid.moment.normals.len();
            assert!(normals == 0 || normals == count, "one normal per vertex, or none");
        }
    }
}
