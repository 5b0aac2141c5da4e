//! Which dot is whose: the costs of the assignment.

use crate::Params;
use crate::assign::{Pair, assign};
use crate::dots::Dot;
use crate::track::{Prediction, Track};

/// Cost at the edge of the gate.
const AT_GATE: f64 = 9.0;
/// Price of staying without a dot: a little more, so that a dot in the gate is taken.
const ALONE: f64 = 12.0;
/// Cost of a dot whose area is e times the usual one, or its e-th part.
const AREA_WEIGHT: f64 = 1.5;
/// A dot is not larger than its usual area by more than this.
const LARGEST: f64 = 2.5;

/// The dots, and who got which.
pub(crate) struct Matches {
    pub(crate) dots: Vec<Dot>,
    /// Per track its dot.
    pub(crate) dot_of: Vec<Option<usize>>,
}

/// Assigns dots to tracks.
pub(crate) fn match_tracks(
    predictions: &[Option<Prediction>],
    tracks: &[Track],
    dots: Vec<Dot>,
    params: &Params,
) -> Matches {
    let mut pairs = Vec::new();
    for (track, prediction) in predictions.iter().enumerate() {
        let Some(prediction) = prediction else { continue };
        for (dot, found) in dots.iter().enumerate().filter(|(_, dot)| prediction.reaches(dot.spot.at)) {
            let usual = tracks[track].area.unwrap_or(found.spot.area);
            let share = found.spot.area / usual;
            if (params.least_share..=LARGEST).contains(&share) {
                let off = (found.spot.at[0] - prediction.at[0]).hypot(found.spot.at[1] - prediction.at[1]);
                let distance = off / prediction.gate;
                // The gate is wide where markers stand apart; what counts is how far a dot is for the marker's own size too.
                let cost = AT_GATE * distance * distance + AREA_WEIGHT * share.ln().powi(2);
                pairs.push(Pair { track, dot, cost });
            }
        }
    }
    let dot_of = assign(&pairs, tracks.len(), dots.len(), ALONE);
    Matches { dots, dot_of }
}
