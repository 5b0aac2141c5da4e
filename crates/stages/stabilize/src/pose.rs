//! The head's pose in every frame: fitted where the markers are seen, bridged where they are missing for a moment.

use crate::rigid_body::{BodyFit, RigidBody, Row, fit_weighted};
use nalgebra::{Isometry3, Point3, Vector3};

/// The pose in one frame.
#[derive(Debug, Clone)]
pub(crate) struct Pose {
    /// Body to world, mm.
    pub(crate) world_from_body: Isometry3<f64>,
    /// Per marker of the body whether the pose rests on it; none where the pose was interpolated.
    pub(crate) used: Vec<bool>,
}

/// Fits the body to every frame.
///
/// In frames where some of its markers are missing or left out, the others are fitted not to the body's mean shape
/// but to the shape that they had in the whole frames before and after (blended over time). The skin lets head
/// markers slip by half a millimetre; without this the pose would step by a part of that whenever one is hidden.
pub(crate) fn fit_poses(body: &RigidBody, frames: &[&Row]) -> Vec<Option<Pose>> {
    let first: Vec<Option<BodyFit>> = frames.iter().map(|row| body.fit(row)).collect();
    let is_whole = |fit: &Option<BodyFit>| fit.as_ref().is_some_and(|fit| fit.used.iter().all(|used| *used));
    let shapes: Vec<Option<Vec<Vector3<f64>>>> = first
        .iter()
        .zip(frames)
        .map(|(fit, row)| fit.as_ref().filter(|_| is_whole(fit)).map(|fit| strain(body, fit, row)))
        .collect();
    let whole: Vec<usize> = (0..frames.len()).filter(|&f| shapes[f].is_some()).collect();
    let refit = |(f, fit): (usize, Option<BodyFit>)| {
        let fit = fit?;
        let fit = match shapes[f] {
            Some(_) => fit,
            None => with_shape_of_neighbours(body, frames[f], f, &fit, &whole, &shapes).unwrap_or(fit),
        };
        Some(Pose { world_from_body: fit.world_from_body, used: fit.used })
    };
    first.into_iter().enumerate().map(refit).collect()
}

/// Per marker how far it is from its place, in body space.
fn strain(body: &RigidBody, fit: &BodyFit, row: &Row) -> Vec<Vector3<f64>> {
    let off = |(&marker, place): (&usize, &Point3<f64>)| match row[marker] {
        Some(point) => fit.world_from_body.inverse_transform_point(&point) - place,
        None => Vector3::zeros(),
    };
    body.markers.iter().zip(&body.places).map(off).collect()
}

fn with_shape_of_neighbours(
    body: &RigidBody,
    row: &Row,
    frame: usize,
    fit: &BodyFit,
    whole: &[usize],
    shapes: &[Option<Vec<Vector3<f64>>>],
) -> Option<BodyFit> {
    let at = whole.partition_point(|&other| other < frame);
    let before = at.checked_sub(1).map(|i| whole[i]);
    let after = whole.get(at).copied();
    let (a, b) = (before.or(after)?, after.or(before)?);
    let share = if a == b { 0.0 } else { (frame - a) as f64 / (b - a) as f64 };
    let (from, to) = (shapes[a].as_ref()?, shapes[b].as_ref()?);
    let places: Vec<Point3<f64>> =
        body.places.iter().zip(from.iter().zip(to)).map(|(place, (a, b))| place + a.lerp(b, share)).collect();
    // Only what the first fit trusted: the shape decides where the head is, not who slipped.
    let mut trusted = row.to_vec();
    for (&marker, used) in body.markers.iter().zip(&fit.used) {
        trusted[marker] = trusted[marker].filter(|_| *used);
    }
    body.fit_shape(&places, &trusted)
}

/// Bridges gaps of at most `longest` frames, and says that no head marker was used. Longer gaps, and those at the
/// ends, stay.
///
/// While the head markers are hidden the face carries the pose: the markers that are seen throughout are taken to
/// move slowly in body space, from where they are before the gap to where they are after it, and the pose is fitted
/// to them. Where too few are seen, the body's middle moves on a straight line and its rotation on the shortest arc.
pub(crate) fn bridge_gaps(
    poses: &mut [Option<Pose>],
    numbers: &[i64],
    frames: &[&Row],
    body: &RigidBody,
    longest: i64,
) {
    let known: Vec<usize> = (0..poses.len()).filter(|&f| poses[f].is_some()).collect();
    for pair in known.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        if b == a + 1 || numbers[b] - numbers[a] - 1 > longest {
            continue;
        }
        let (Some(from), Some(to)) = (poses[a].clone(), poses[b].clone()) else { continue };
        let ends = [(frames[a], from.world_from_body), (frames[b], to.world_from_body)];
        for f in a + 1..b {
            let share = (numbers[f] - numbers[a]) as f64 / (numbers[b] - numbers[a]) as f64;
            let world_from_body = carried(&ends, frames[f], share)
                .unwrap_or_else(|| between(&ends[0].1, &ends[1].1, &middle(body), share));
            poses[f] = Some(Pose { world_from_body, used: vec![false; body.markers.len()] });
        }
    }
}

/// Markers that must be seen throughout for the face to carry the pose.
const CARRIERS: usize = 6;
/// What a carrier may usually stray meanwhile, mm.
const CARRIER_SCALE_MM: f64 = 1.0;

fn carried(ends: &[(&Row, Isometry3<f64>); 2], row: &Row, share: f64) -> Option<Isometry3<f64>> {
    let in_body = |end: usize, marker: usize| {
        let (row, pose) = &ends[end];
        row[marker].map(|point| pose.inverse_transform_point(&point).coords)
    };
    let carrier = |marker: usize| {
        let place = in_body(0, marker)?.lerp(&in_body(1, marker)?, share);
        Some((Point3::from(place), row[marker]?))
    };
    let carriers: Vec<(Point3<f64>, Point3<f64>)> = (0..row.len()).filter_map(carrier).collect();
    if carriers.len() < CARRIERS {
        return None;
    }
    let (places, seen): (Vec<_>, Vec<_>) =
        carriers.into_iter().map(|(place, seen)| (place, Some(seen))).unzip();
    let all = places.len();
    fit_weighted(&places, &seen, &vec![1.0; all], &vec![true; all], CARRIER_SCALE_MM)
}

fn middle(body: &RigidBody) -> Point3<f64> {
    (body.places.iter().map(|place| place.coords).sum::<Vector3<f64>>() / body.places.len() as f64).into()
}

fn between(a: &Isometry3<f64>, b: &Isometry3<f64>, middle: &Point3<f64>, share: f64) -> Isometry3<f64> {
    let rotation = a.rotation.try_slerp(&b.rotation, share, 1e-12).unwrap_or(a.rotation);
    let place = (a * middle).coords.lerp(&(b * middle).coords, share);
    Isometry3::from_parts((place - rotation * middle.coords).into(), rotation)
}
