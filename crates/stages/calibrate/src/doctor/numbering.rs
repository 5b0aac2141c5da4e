//! Chessboards stand on their head: which corner is which.

use super::Patient;
use camera::Camera;
use nalgebra::Vector2;
use std::collections::BTreeMap;

/// What a camera sees of a board: its index, and the corners by number.
pub type SeenCorners = (usize, BTreeMap<u32, Vector2<f64>>);

/// The corners of one instant, numbered in all cameras in the way in which their rays meet best: a chessboard's first corner cannot
/// be told from its last, and each camera may have begun at another one. `ways`: per way the numbers that a
/// corner's number may stand for, the first of which changes nothing.
///
/// Cameras are compared with the one with which most of them agree, so that a camera that is wrong spoils no other's numbers.
#[must_use]
pub fn numbered_alike(patients: &[Patient], seen: Vec<SeenCorners>, ways: &[Vec<u32>]) -> Vec<SeenCorners> {
    if ways.len() < 2 {
        return seen;
    }
    let choices = |first: &SeenCorners| -> (f64, Vec<usize>) {
        let choice = |other: &SeenCorners| {
            let gaps =
                ways.iter().enumerate().map(|(way, numbers)| (gap(patients, first, other, numbers), way));
            gaps.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0))
        };
        let found: Vec<(f64, usize)> = seen.iter().map(choice).collect();
        let mut gaps: Vec<f64> = found.iter().map(|(gap, _)| *gap).collect();
        gaps.sort_by(f64::total_cmp);
        (gaps[gaps.len() / 2], found.into_iter().map(|(_, way)| way).collect())
    };
    let best = seen.iter().map(choices).min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, chosen)) = best else { return seen };
    let renumber = |((camera, corners), way): (SeenCorners, usize)| {
        let numbered = corners.into_iter().filter_map(|(id, at)| Some((*ways[way].get(id as usize)?, at)));
        (camera, numbered.collect())
    };
    seen.into_iter().zip(chosen).map(renumber).collect()
}

/// Where two cameras have no corner in common.
const NOTHING_PX: f64 = 1e6;

/// Median reprojection error of the common corners, px.
fn gap(patients: &[Patient], first: &SeenCorners, other: &SeenCorners, numbers: &[u32]) -> f64 {
    if first.0 == other.0 {
        return if numbers.iter().enumerate().all(|(i, &n)| i as u32 == n) { 0.0 } else { NOTHING_PX };
    }
    let cameras: [&Camera; 2] = [first.0, other.0].map(|c| &patients[c].camera);
    let miss = |(id, at): (&u32, &Vector2<f64>)| {
        let views = [(cameras[0], *first.1.get(numbers.get(*id as usize)?)?), (cameras[1], *at)];
        let point = Camera::nearest_to_rays(views);
        let off = |(camera, pixel): (&Camera, Vector2<f64>)| Some((camera.project(&point?)? - pixel).norm());
        Some(views.into_iter().map(|view| off(view).unwrap_or(NOTHING_PX)).sum::<f64>())
    };
    let mut misses: Vec<f64> = other.1.iter().filter_map(miss).collect();
    misses.sort_by(f64::total_cmp);
    misses.get(misses.len() / 2).copied().unwrap_or(NOTHING_PX)
}
