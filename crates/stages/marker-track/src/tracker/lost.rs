//! Markers without a dot, and dots without a marker.

use super::{Stray, Tracker};
use crate::Picture;
use crate::blobs::Blob;
use crate::center::{Patch, Spot};
use crate::matching::{Lost, Matches};
use crate::predict::MotionField;
use crate::track::{Prediction, Track};

/// A dot that nobody has is a lost marker's within this share of its gate: it may also be one without a label.
const LOST_GATE: f64 = 0.5;

impl Tracker {
    /// Where hidden markers belong among the others, which `place` knows: each as the labelled frame shows it, moved as its
    /// neighbours there have moved since.
    pub(super) fn homes(&self, place: impl Fn(usize) -> Option<[f64; 2]>) -> Vec<Option<[f64; 2]>> {
        let (mut places, mut moves) = (Vec::new(), Vec::new());
        for (index, track) in self.tracks.iter().enumerate() {
            if let (Some(home), Some(at)) = (track.home, place(index).filter(|_| track.hidden == 0.0)) {
                places.push(home);
                moves.push([at[0] - home[0], at[1] - home[1]]);
            }
        }
        let field = MotionField::new(places, moves);
        let home = |track: &Track| {
            let home = track.home?;
            field.at(home).map(|by| [home[0] + by[0], home[1] + by[1]])
        };
        self.tracks.iter().map(home).collect()
    }

    /// The markers without a dot, and where they may be: where the neighbours say that they went from where they were last seen,
    /// and where they belong. After a blink, the first is wrong and the second right.
    pub(super) fn lost(
        &self,
        predictions: &[Option<Prediction>],
        matches: &Matches,
        motion: &MotionField,
    ) -> Vec<Lost> {
        let is_lost = |track: usize| matches.dot_of[track].is_none() && self.tracks[track].alive;
        let wanted: Vec<usize> = (0..self.tracks.len())
            .filter(|&track| is_lost(track) && predictions[track].as_ref().is_some_and(|p| !p.guided))
            .collect();
        if wanted.is_empty() {
            return Vec::new();
        }
        let homes = self.homes(|track| matches.dot_of[track].map(|dot| matches.dots[dot].spot.at));
        let lost = |track: usize| {
            let state = &self.tracks[track];
            let stayed = motion.at(state.at).map(|by| [state.at[0] + by[0], state.at[1] + by[1]]);
            let places: Vec<[f64; 2]> = stayed.into_iter().chain(homes[track]).collect();
            let spacing = state.home.map_or(f64::INFINITY, |home| self.spacing(track, home));
            let gate = (LOST_GATE * self.params.gate * spacing)
                .clamp(self.params.least_gate_px, self.params.most_gate_px);
            Lost { track, places, gate }
        };
        wanted.into_iter().map(lost).collect()
    }

    /// From a marker's place in the labelled frame to the nearest other one's, px.
    fn spacing(&self, track: usize, home: [f64; 2]) -> f64 {
        let others = self.tracks.iter().enumerate().filter(|(other, _)| *other != track);
        let away =
            |(_, other): (usize, &Track)| other.home.map(|at| (at[0] - home[0]).hypot(at[1] - home[1]));
        others.filter_map(away).fold(f64::INFINITY, f64::min)
    }

    /// Where the dots that no marker had must be by now, if they went with their neighbours.
    pub(super) fn guards(&self, motion: &MotionField) -> Vec<Stray> {
        let moved = |stray: &Stray| {
            let by = motion.at(stray.at).unwrap_or_default();
            Stray { at: [stray.at[0] + by[0], stray.at[1] + by[1]], ..*stray }
        };
        self.strays.iter().map(moved).collect()
    }

    /// The dots that nobody has.
    pub(super) fn find_strays(
        &self,
        picture: &Picture,
        found: &[Blob],
        patches: &[Option<Patch>],
        matches: &Matches,
    ) -> Vec<Spot> {
        let mut taken = vec![false; matches.dots.len()];
        matches.dot_of.iter().flatten().for_each(|&dot| taken[dot] = true);
        let near = matches.dots.iter().zip(taken).filter(|(_, taken)| !taken).map(|(dot, _)| dot);
        let near = near.filter(|dot| found[dot.blob].is_dot()).map(|dot| dot.spot);
        let far = (0..found.len()).filter(|&number| patches[number].is_none() && found[number].is_dot());
        let cut = |number| Patch::cut(picture, &self.paint, &self.owners, &found[number], &[number])?.spot();
        near.chain(far.filter_map(cut)).collect()
    }
}
