//! Which dot is whose: the costs of the assignment.

use crate::Params;
use crate::assign::{Pair, assign};
use crate::dots::Dot;
use crate::track::{Prediction, Track};
use crate::tracker::Stray;

/// Cost at the edge of the gate.
const AT_GATE: f64 = 9.0;
/// Price of staying without a dot: a little more, so that a dot in the gate is taken.
const ALONE: f64 = 12.0;
/// Cost of a dot whose area is e times the usual one, or its e-th part.
const AREA_WEIGHT: f64 = 1.5;
/// A dot is not larger than its usual area by more than this.
const LARGEST: f64 = 2.5;

/// A dot that is followed, and one that comes back, is not paler than its usual self by more than this: the rims of other paints
/// are.
const PALEST: [f64; 2] = [0.55, 0.7];

/// The dots, and who got which.
pub(crate) struct Matches {
    pub(crate) dots: Vec<Dot>,
    /// Per track its dot.
    pub(crate) dot_of: Vec<Option<usize>>,
}

/// A lost marker, and the places where it may have gone.
pub(crate) struct Lost {
    pub(crate) track: usize,
    pub(crate) places: Vec<[f64; 2]>,
    /// px
    pub(crate) gate: f64,
}

/// Assigns dots that nobody has to markers that have none, by the nearest of their places.
///
/// A dot that was there without a name before a marker was lost is not that marker's.
pub(crate) fn match_lost(
    lost: &[Lost],
    tracks: &[Track],
    guards: &[Stray],
    matches: &mut Matches,
    params: &Params,
) {
    let mut free = vec![true; matches.dots.len()];
    matches.dot_of.iter().flatten().for_each(|&dot| free[dot] = false);
    let mut pairs = Vec::new();
    for marker in lost {
        for (dot, found) in matches.dots.iter().enumerate().filter(|(dot, _)| free[*dot]) {
            let away = |at: &[f64; 2]| (found.spot.at[0] - at[0]).hypot(found.spot.at[1] - at[1]);
            let off = marker.places.iter().map(away).fold(f64::INFINITY, f64::min) / marker.gate;
            let is_older = |guard: &Stray| {
                guard.age >= tracks[marker.track].hidden && guard.is_near(found.spot.at, params.least_gate_px)
            };
            if off <= 1.0 && !guards.iter().any(is_older) {
                pairs.extend(cost(&tracks[marker.track], found, off, params).map(|cost| Pair {
                    track: marker.track,
                    dot,
                    cost,
                }));
            }
        }
    }
    let dot_of = assign(&pairs, tracks.len(), matches.dots.len(), ALONE);
    for (dot, found) in matches.dot_of.iter_mut().zip(dot_of) {
        *dot = dot.or(found);
    }
}

/// What it costs to take a dot for a marker's, `off` gates from where it should be; none where it cannot be.
fn cost(track: &Track, dot: &Dot, off: f64, params: &Params) -> Option<f64> {
    let share = dot.spot.area / track.area.unwrap_or(dot.spot.area);
    let palest = PALEST[usize::from(track.hidden > 0.0)];
    let is_dark = track.peak.is_none_or(|usual| dot.peak >= palest * usual);
    let fits = is_dark && (params.least_share..=LARGEST).contains(&share);
    fits.then(|| AT_GATE * off * off + AREA_WEIGHT * share.ln().powi(2))
}

/// Assigns dots to tracks. The `guards` stand for dots that no marker had in the image before: they take part, lest a marker that
/// was expected elsewhere takes such a dot.
pub(crate) fn match_tracks(
    predictions: &[Option<Prediction>],
    tracks: &[Track],
    dots: Vec<Dot>,
    guards: &[Stray],
    params: &Params,
) -> Matches {
    let has_guide = predictions.iter().flatten().any(|prediction| prediction.guided);
    let mut pairs = Vec::new();
    for (track, prediction) in predictions.iter().enumerate() {
        let Some(prediction) = prediction else { continue };
        for (dot, found) in dots.iter().enumerate().filter(|(_, dot)| prediction.reaches(dot.spot.at)) {
            let off = (found.spot.at[0] - prediction.at[0]).hypot(found.spot.at[1] - prediction.at[1]);
            let unsure = !tracks[track].alive || tracks[track].hidden > 0.0;
            let is_rivals = |(other, rival): (usize, &Option<Prediction>)| {
                let expected = rival.as_ref().filter(|rival| rival.guided || tracks[other].hidden == 0.0);
                let gate = params.guide_gate_px;
                other != track && expected.is_some_and(|r| r.owns(found.spot.at, off, gate, unsure))
            };
            if has_guide && (prediction.guided || unsure) && predictions.iter().enumerate().any(is_rivals) {
                continue;
            }
            let cost = cost(&tracks[track], found, off / prediction.gate, params);
            pairs.extend(cost.map(|cost| Pair { track, dot, cost }));
        }
    }
    for (number, guard) in guards.iter().enumerate() {
        for (dot, found) in dots.iter().enumerate() {
            if guard.is_near(found.spot.at, params.least_gate_px) {
                let off = [0, 1].map(|k| (found.spot.at[k] - guard.at[k]) / params.least_gate_px);
                let cost = AT_GATE * (off[0] * off[0] + off[1] * off[1]);
                pairs.push(Pair { track: tracks.len() + number, dot, cost });
            }
        }
    }
    let mut dot_of = assign(&pairs, tracks.len() + guards.len(), dots.len(), ALONE);
    dot_of.truncate(tracks.len());
    Matches { dots, dot_of }
}
