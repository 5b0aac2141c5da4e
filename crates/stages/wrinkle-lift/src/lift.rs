//! All wrinkles of a frame.

use crate::ground::{Ground, Seen, Spot};
use crate::line::arcs;
use crate::merge::{Sample, merged};
use crate::params::Params;
use crate::scene::{Scene, Spaces};
use crate::section::{Lifted, Lost, Shot, tangents};
use crate::tally::Tally;
use crate::track::{Track, is_open, tracks};
use crate::view::View;
use artifact::{Section, ValleyPoint, ValleysFrame};
use camera::Camera;
use nalgebra::{Isometry3, Point3, Vector3};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// What a camera saw in a frame.
pub struct Image<'a> {
    /// Camera id.
    pub id: &'a str,
    /// Its calibration.
    pub camera: &'a Camera,
    /// Where the head was when the image was taken.
    pub world_from_head: Isometry3<f64>,
    /// The face when the image was taken.
    pub scene: &'a Scene<'a>,
    /// Per wrinkle id its sections, at rising u.
    pub sections: &'a BTreeMap<String, Vec<Section>>,
}

/// What stays the same over all frames.
pub struct Lifter<'a> {
    /// The surface.
    pub ground: &'a Ground,
    /// The warp.
    pub spaces: &'a Spaces,
    /// Parameters.
    pub params: &'a Params,
}

impl Lifter<'_> {
    /// Brings the sections that the images of a frame show onto the face [BickelBotsch2007, Sec. 5.3]: casts each through its camera,
    /// turns lengths in the image into millimetres, and merges what several cameras saw.
    ///
    /// `in_face`: #V, mm, the mesh without wrinkles in this frame; the valleys are told on it, whenever within the frame an image was taken.
    /// `x_mm` counts from each valley's first point: [`arrange`](crate::arrange) makes it say the same in all frames.
    #[must_use]
    pub fn frame(&self, frame: i64, in_face: &[Point3<f64>], images: &[Image<'_>]) -> (ValleysFrame, Tally) {
        let ids: BTreeSet<&String> = images.iter().flat_map(|image| image.sections.keys()).collect();
        let ids: Vec<&String> = ids.into_iter().collect();
        let lift = |id: &&String| (id.to_string(), self.wrinkle(id, in_face, images));
        let lifted: Vec<(String, (Vec<ValleyPoint>, Tally))> = ids.par_iter().map(lift).collect();
        let mut tally = Tally::default();
        let mut valleys = BTreeMap::new();
        for (id, (points, more)) in lifted {
            tally.add(more);
            if points.len() > 1 {
                valleys.insert(id, points);
            }
        }
        (ValleysFrame { frame, valleys }, tally)
    }

    fn wrinkle(&self, id: &str, in_face: &[Point3<f64>], images: &[Image<'_>]) -> (Vec<ValleyPoint>, Tally) {
        let (mut tally, mut seen) = (Tally::default(), self.ground.none_seen());
        let mut all: Vec<Track> = Vec::new();
        for (number, image) in images.iter().enumerate() {
            let Some(sections) = image.sections.get(id) else { continue };
            let lifted = self.sections(image, sections, &mut seen);
            tally.count(image.id, &lifted);
            let (mut found, strays) = tracks(number, sections, &lifted, self.params);
            tally.strays(image.id, strays);
            let open = sections.iter().any(is_open);
            tally.wrinkle(image.id, id, open && found.is_empty());
            // An image is taken a little before or after the frame: the skin's place is kept, not the place in space.
            for point in found.iter_mut().flat_map(|track| &mut track.points) {
                point.foot = self.ground.at(&point.spot, in_face);
            }
            all.append(&mut found);
        }
        let merged = merged(all, self.params);
        tally.apart(id, &merged.apart_mm);
        tally.bridged_mm += merged.bridged_mm;
        tally.split_mm += merged.split_mm;
        let points = self.points(&merged.samples, in_face, &mut seen);
        tally.coarse += points.iter().filter(|point| self.is_coarse(point, in_face)).count();
        tally.points += points.len();
        (points, tally)
    }

    fn sections(
        &self,
        image: &Image<'_>,
        sections: &[Section],
        seen: &mut Seen,
    ) -> Vec<Result<Lifted, Lost>> {
        let view = View::new(image.camera, &image.world_from_head);
        let shot = Shot { scene: image.scene, spaces: self.spaces, view, params: self.params };
        sections
            .iter()
            .zip(tangents(sections))
            .map(|(section, tangent)| shot.lift(section, tangent, seen))
            .collect()
    }

    /// Puts merged places onto the surface.
    fn points(&self, samples: &[Sample], in_face: &[Point3<f64>], seen: &mut Seen) -> Vec<ValleyPoint> {
        let spot = |sample: &Sample| self.ground.nearest(&sample.foot, sample.face, in_face);
        let spots: Vec<Spot> = samples.iter().map(spot).collect();
        let feet: Vec<Point3<f64>> = spots.iter().map(|spot| self.ground.at(spot, in_face)).collect();
        let normals: Vec<Vector3<f64>> =
            spots.iter().map(|spot| self.ground.normal(spot, in_face, self.params.normal_mm, seen)).collect();
        let bottom = |i: usize| feet[i] - normals[i] * samples[i].d_mm;
        let x = arcs(&feet);
        let last = samples.len().saturating_sub(1);
        let point = |i: usize| {
            let along = bottom((i + 1).min(last)) - bottom(i.saturating_sub(1));
            let across = along.cross(&normals[i]).try_normalize(0.0)?;
            let Sample { w_mm, d_mm, epsilon, kappa, .. } = samples[i];
            Some(ValleyPoint {
                x_mm: x[i],
                face: spots[i].face,
                barycentric: spots[i].barycentric,
                at_mm: bottom(i).into(),
                normal: normals[i].into(),
                across: across.into(),
                w_mm,
                d_mm,
                epsilon,
                kappa,
            })
        };
        // Points of no width along the curve have no direction across it.
        let mut points: Vec<ValleyPoint> = Vec::with_capacity(samples.len());
        for point in (0..samples.len()).filter_map(point) {
            if points.last().is_none_or(|last| point.x_mm - last.x_mm > 1e-6) {
                points.push(point);
            }
        }
        points
    }

    /// Whether the mesh has fewer than four edges across the valley: its form cannot be told then.
    fn is_coarse(&self, point: &ValleyPoint, in_face: &[Point3<f64>]) -> bool {
        point.d_mm > 0.0 && 2.0 * point.w_mm < LEAST_EDGES * self.ground.edge_mm(point.face, in_face)
    }
}

/// Edges across a valley, over 2w, that carry its form.
const LEAST_EDGES: f64 = 4.0;
