//! What stands before the camera.

use super::pattern::times;
use crate::paint::Layers;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

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
    /// #V × 3 when it closes. None for a still.
    pub close: Option<&'a [Point3<f64>]>,
    /// #V × 3 halfway: vertices run along the parabola through the three, evenly in its parameter. None: they run straight.
    pub middle: Option<&'a [Point3<f64>]>,
    /// #V × 3, unit normals; only gloss asks for them, and an empty list has none.
    pub normals: &'a [Vector3<f64>],
    /// #V × 3, light that arrives, linear RGB: 1 = full unshadowed ambient.
    pub irradiance: &'a [[f32; 3]],
}

impl Moment<'_> {
    /// The vertices' mean places over the samples of the exposure: what the centroid of a blurred dot is that of.
    #[must_use]
    pub fn mean(&self) -> Vec<Point3<f64>> {
        let Some(close) = self.close else { return self.open.to_vec() };
        let weights = times().map(weights);
        let [open, middle, last] =
            [0, 1, 2].map(|key| weights.iter().map(|weight| weight[key]).sum::<f64>() / weights.len() as f64);
        let ends = self.open.par_iter().zip(close).with_min_len(4096);
        match self.middle {
            None => ends.map(|(from, to)| nalgebra::center(from, to)).collect(),
            Some(halfway) => ends
                .zip(halfway)
                .map(|((from, to), at)| {
                    Point3::from(from.coords * open + at.coords * middle + to.coords * last)
                })
                .collect(),
        }
    }
}

/// Weights of the places at opening, halfway and at closing in the parabola through them, at a share of the exposure.
pub(super) fn weights(time: f64) -> [f64; 3] {
    let from_middle = time - 0.5;
    [2.0 * from_middle * (time - 1.0), 4.0 * time * (1.0 - time), 2.0 * time * from_middle]
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
            for places in [solid.moment.close, solid.moment.middle].into_iter().flatten() {
                assert_eq!(places.len(), count, "one place per vertex");
            }
            let normals = solid.moment.normals.len();
            assert!(normals == 0 || normals == count, "one normal per vertex, or none");
        }
    }
}
