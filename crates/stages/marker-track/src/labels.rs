//! Labels that cannot be used: outside the image, on no dot, or on a dot that another label is on.

use crate::Error;
use crate::Picture;
use crate::blobs::{Blob, Run};
use std::collections::BTreeMap;

/// How far from a label its dot may be, px. Dots nearer than this to each other are one.
pub(crate) const REACH_PX: f64 = 3.0;

/// Why a label cannot be used, of each that cannot, in the order of the ids.
pub(crate) fn faults(picture: &Picture, found: &[Blob], labels: &BTreeMap<String, [f64; 2]>) -> Vec<Error> {
    labels.iter().filter_map(|(marker, at)| fault(picture, found, marker, *at)).collect()
}

fn fault(picture: &Picture, found: &[Blob], marker: &str, at: [f64; 2]) -> Option<Error> {
    let marker = marker.to_string();
    if !picture.contains(at) {
        return Some(Error::Outside { marker, at, size: [picture.width, picture.height] });
    }
    let nearest = found.iter().map(|blob| (distance(blob, at), blob)).min_by(|a, b| a.0.total_cmp(&b.0));
    match nearest {
        Some((distance, _)) if distance <= REACH_PX => None,
        other => Some(Error::NoBlob { marker, at, nearest: other.map(|(_, blob)| blob.middle) }),
    }
}

fn distance(blob: &Blob, at: [f64; 2]) -> f64 {
    let to_run = |run: &Run| {
        let x = at[0].clamp(f64::from(run.first), f64::from(run.end - 1));
        (x - at[0]).hypot(f64::from(run.y) - at[1])
    };
    blob.runs.iter().map(to_run).fold(f64::INFINITY, f64::min)
}

/// The marker whose label lies on the same dot as this one's.
pub(crate) fn on_the_same_dot<'a>(
    labels: &'a BTreeMap<String, [f64; 2]>,
    marker: &str,
    at: [f64; 2],
) -> Option<&'a String> {
    let near = |other: &[f64; 2]| (other[0] - at[0]).hypot(other[1] - at[1]) <= REACH_PX;
    labels.iter().find(|(id, place)| *id != marker && near(place)).map(|(id, _)| id)
}
