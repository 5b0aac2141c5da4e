//! Sightings of images that were not taken at the frame's time.

use super::Sighting;
use nalgebra::Vector2;
use std::collections::BTreeMap;

/// Frames before and after that are looked at.
const REACH: i64 = 2;
/// Lags below this change nothing that can be measured, frames.
const NEGLIGIBLE: f64 = 1e-6;

/// Brings sightings to the times of their frames: `lag_frames` says of a camera and a frame by how many frames the image was taken
/// later. Views that cannot be told at the frame's time are left out; the sightings stay in their places.
#[must_use]
pub fn at_frame_times(sightings: &[Sighting], lag_frames: impl Fn(usize, i64) -> f64) -> Vec<Sighting> {
    let mut tracks: BTreeMap<(&str, usize), BTreeMap<i64, Vector2<f64>>> = BTreeMap::new();
    for sighting in sightings {
        for (camera, pixel) in &sighting.views {
            tracks.entry((&sighting.name, *camera)).or_default().insert(sighting.frame, *pixel);
        }
    }
    let aligned = |sighting: &Sighting| {
        let view = |(camera, pixel): &(usize, Vector2<f64>)| {
            if lag_frames(*camera, sighting.frame).abs() < NEGLIGIBLE {
                return Some((*camera, *pixel));
            }
            let track = tracks.get(&(sighting.name.as_str(), *camera))?;
            let near = track.range(sighting.frame - REACH..=sighting.frame + REACH);
            let time = |frame: i64| (frame - sighting.frame) as f64 + lag_frames(*camera, frame);
            let samples: Vec<_> = near.map(|(frame, pixel)| (time(*frame), *pixel)).collect();
            Some((*camera, camera::place_at_zero(&samples)?))
        };
        Sighting { views: sighting.views.iter().filter_map(view).collect(), ..sighting.clone() }
    };
    sightings.iter().map(aligned).collect()
}
