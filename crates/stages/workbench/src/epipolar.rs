//! Where a dot of one image may lie in another one [HartleyZisserman2004, § 9].

use crate::Error;
use camera::Camera;
use nalgebra::{Point3, Vector2};
use serde::Serialize;
use std::collections::BTreeMap;

/// Places of a camera's markers in its image, px, by marker.
pub type Dots = BTreeMap<String, [f64; 2]>;

/// What other cameras say of a marker in an image.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Hint {
    /// Per other camera that has the marker, the line on which it must lie, px: a polyline, bent as the lens bends it; it may leave
    /// the image and come again.
    pub lines: BTreeMap<String, Vec<Vec<[f64; 2]>>>,
    /// Where the others together say that it is, px; from two cameras on.
    pub at: Option<[f64; 2]>,
    /// How far the dot that is labelled here lies off that, or off the only line, px.
    pub off_px: Option<f64>,
}

/// A camera's id, the camera, and where it sees a marker, px.
type Seen<'a> = (&'a String, &'a Camera, Vector2<f64>);

/// Distances along a ray at which its line is drawn: from this share of the way to the middle of the cameras' views to that one.
const NEAR: f64 = 0.3;
const FAR: f64 = 3.0;
const STEPS: u32 = 96;

/// What all other cameras say of the markers in the image of `camera`. `labels`: dots by camera; cameras that are not calibrated
/// say nothing.
///
/// # Errors
/// [`Error::NoCamera`] if `camera` itself is not calibrated.
pub fn hints(
    rig: &BTreeMap<String, Camera>,
    labels: &BTreeMap<String, Dots>,
    camera: &str,
) -> Result<BTreeMap<String, Hint>, Error> {
    let to = rig.get(camera).ok_or_else(|| Error::NoCamera { camera: camera.to_string() })?;
    let depth_mm = distance_of_subject(rig);
    let mut views: BTreeMap<&String, Vec<Seen<'_>>> = BTreeMap::new();
    for (other, dots) in labels.iter().filter(|(other, _)| *other != camera) {
        let Some(from) = rig.get(other) else { continue };
        for (marker, at) in dots {
            views.entry(marker).or_default().push((other, from, Vector2::from(*at)));
        }
    }
    let here = labels.get(camera);
    let hint = |(marker, views): (&String, Vec<Seen<'_>>)| {
        let line =
            |(other, from, at): &(&String, &Camera, _)| ((*other).clone(), line(from, *at, to, depth_mm));
        let lines: BTreeMap<_, _> = views.iter().map(line).collect();
        let point = Camera::nearest_to_rays(views.iter().map(|(_, from, at)| (*from, *at)));
        let at = point.and_then(|point| to.project(&point)).map(|at| [at.x, at.y]);
        let dot = here.and_then(|dots| dots.get(marker)).copied();
        let off_px = dot.and_then(|dot| match at {
            Some(at) => Some(distance(dot, at)),
            None => lines.values().flatten().filter_map(|line| distance_to(line, dot)).min_by(f64::total_cmp),
        });
        (marker.clone(), Hint { lines, at, off_px })
    };
    Ok(views.into_iter().map(hint).collect())
}

/// How far the cameras stand from what they look at, mm: the mean distance to the point nearest to all their axes.
fn distance_of_subject(rig: &BTreeMap<String, Camera>) -> f64 {
    let axis = |camera: &Camera| {
        let [width, height] = camera.image_size.map(f64::from);
        Some((
            camera.eye_in_world(),
            camera.ray_in_world(Vector2::new(0.5 * width - 0.5, 0.5 * height - 0.5))?,
        ))
    };
    let middle = camera::nearest_to_lines(rig.values().filter_map(axis));
    let distance = |middle: Point3<f64>| {
        rig.values().map(|camera| (camera.eye_in_world() - middle).norm()).sum::<f64>() / rig.len() as f64
    };
    // Cameras side by side that look the same way: a face stands a metre off.
    middle.map_or(1000.0, distance)
}

/// The ray of a pixel as another camera sees it, in the pieces that lie on its image.
fn line(from: &Camera, at: Vector2<f64>, to: &Camera, depth_mm: f64) -> Vec<Vec<[f64; 2]>> {
    let Some(ray) = from.ray_in_world(at) else { return Vec::new() };
    let eye = from.eye_in_world();
    let mut pieces: Vec<Vec<[f64; 2]>> = vec![Vec::new()];
    for step in 0..=STEPS {
        let share = NEAR * (FAR / NEAR).powf(f64::from(step) / f64::from(STEPS));
        match to.project(&(eye + ray.into_inner() * (share * depth_mm))).filter(|seen| to.contains(*seen)) {
            Some(seen) => {
                pieces.iter_mut().next_back().into_iter().for_each(|piece| piece.push([seen.x, seen.y]))
            }
            None => pieces.push(Vec::new()),
        }
    }
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// How far a point lies off a polyline, px.
fn distance_to(line: &[[f64; 2]], point: [f64; 2]) -> Option<f64> {
    let point = Vector2::from(point);
    let to_piece = |ends: &[[f64; 2]]| {
        let (start, along) = (Vector2::from(ends[0]), Vector2::from(ends[1]) - Vector2::from(ends[0]));
        let share =
            ((point - start).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (point - start - along * share).norm()
    };
    line.windows(2).map(to_piece).min_by(f64::total_cmp)
}
