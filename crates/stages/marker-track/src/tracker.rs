//! From image to image: predict, find dots, assign them, and remember.

mod lost;

use crate::Picture;
use crate::blobs::{self, Area, Blob};
use crate::center::{Owners, Patch, Spot};
use crate::dots::{Dot, dots};
use crate::labels;
use crate::matching::{Matches, match_lost, match_tracks};
use crate::paint::Paint;
use crate::predict::MotionField;
use crate::track::{Prediction, Track};
use crate::{Error, Params};
use artifact::{Sample2d, TrackState, Transfer};
use nalgebra::Point2;
use std::collections::BTreeMap;

/// Room in a search window beyond the gate: the dot itself, its fading rim, the skin around, px.
const MARGIN_PX: f64 = 10.0;

/// Dots without a label are looked for this far from those with one, px.
const STRAY_REACH_PX: f64 = 40.0;
/// Where the 3D markers say that a marker is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hint {
    /// The reprojected place, px.
    pub at: [f64; 2],
    /// Whether the skin there faces the camera, so that the dot can be seen.
    pub facing: bool,
}

/// Follows the markers of one camera, image by image, forwards or backwards in time.
#[derive(Debug, Clone)]
pub struct Tracker {
    params: Params,
    paint: Paint,
    size: [usize; 2],
    tracks: Vec<Track>,
    owners: Owners,
    /// Dots of the latest image that no marker has.
    strays: Vec<Stray>,
    guided: GuideHits,
    label_faults: Vec<Error>,
}

/// Of the markers that the guide says can be seen: how many there are, and how many have a dot where it says.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct GuideHits {
    /// Looked for.
    pub wanted: usize,
    /// Found.
    pub found: usize,
}

/// A dot that no marker has.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stray {
    /// px
    pub(crate) at: [f64; 2],
    /// px²
    pub(crate) area: f64,
    /// Frames since it was first seen; those of the labelled image were always there.
    pub(crate) age: f64,
}

impl std::ops::AddAssign for GuideHits {
    fn add_assign(&mut self, more: Self) {
        self.wanted += more.wanted;
        self.found += more.found;
    }
}

impl Stray {
    pub(crate) fn is_near(&self, at: [f64; 2], reach: f64) -> bool {
        (self.at[0] - at[0]).powi(2) + (self.at[1] - at[1]).powi(2) <= reach * reach
    }
}

impl Tracker {
    /// Starts at the labelled image. `markers` are the ids in the order of the samples; `labels` holds the place of each that is
    /// labelled, px; `transfer` is the transfer function of the images' codes. Labels that cannot be used are left out
    /// ([`Tracker::label_faults`]).
    ///
    /// # Errors
    /// [`Error::Labels`] where most cannot; those of [`Paint::learn`].
    pub fn start(
        picture: &Picture,
        transfer: Transfer,
        markers: &[String],
        labels: &BTreeMap<String, [f64; 2]>,
        params: &Params,
    ) -> Result<Self, Error> {
        params.check()?;
        let places: Vec<[f64; 2]> = labels.values().copied().collect();
        let paint = Paint::learn(picture, transfer, &places, params.least_coverage)?;
        let found = blobs::find(picture, &paint, &Area::everything(picture));
        let faults = labels::faults(picture, &found, labels);
        if 2 * faults.len() > labels.len() {
            return Err(Error::Labels { faults, labels: labels.len() });
        }
        let usable = |id: &String| !faults.iter().any(|fault| fault.marker() == Some(id));
        let named: Vec<Option<[f64; 2]>> =
            markers.iter().map(|id| labels.get(id).copied().filter(|_| usable(id))).collect();
        let mut tracker = Self {
            params: params.clone(),
            paint,
            size: [picture.width, picture.height],
            tracks: vec![Track::default(); markers.len()],
            owners: Owners::default(),
            strays: Vec::new(),
            guided: GuideHits::default(),
            label_faults: faults,
        };
        let at = |at: &Option<[f64; 2]>| at.map(|at| Prediction::at(at, 2.0 * labels::REACH_PX));
        let with_strays = named.contains(&None);
        tracker.follow(picture, &found, named.iter().map(at).collect(), &[], 0.0, with_strays);
        for (track, at) in named.into_iter().enumerate() {
            let Some(at) = at else { continue };
            tracker.settle(track, &markers[track], at, labels);
        }
        Ok(tracker)
    }

    /// Makes the labelled place a track's home. A label without a measurable dot still stands where it was put, unless its
    /// dot is another label's.
    fn settle(&mut self, track: usize, marker: &str, at: [f64; 2], labels: &BTreeMap<String, [f64; 2]>) {
        if !self.tracks[track].alive {
            if let Some(other) = labels::on_the_same_dot(labels, marker, at) {
                self.label_faults.push(Error::SameDot { marker: marker.into(), at, other: other.clone() });
                return;
            }
            self.tracks[track].set(at);
        }
        self.tracks[track].home = Some(self.tracks[track].at);
    }

    /// Why labels were left out, one [`Error`] for each.
    #[must_use]
    pub fn label_faults(&self) -> &[Error] {
        &self.label_faults
    }

    /// What the guide was worth in the latest image.
    #[must_use]
    pub fn guide_hits(&self) -> GuideHits {
        self.guided
    }

    /// What the paint looks like.
    #[must_use]
    pub fn paint(&self) -> &Paint {
        &self.paint
    }

    /// Dots of the latest image that no marker has, px: markers without a label, hands, stains. None are looked for if 3D
    /// markers guide, or every marker is labelled.
    #[must_use]
    pub fn strays(&self) -> Vec<[f64; 2]> {
        self.strays.iter().map(|stray| stray.at).collect()
    }

    /// The samples of the latest image: per marker its place; none for one that was never found.
    #[must_use]
    pub fn samples(&self) -> Vec<Option<Sample2d>> {
        let sample = |track: &Track| {
            let state = if track.hidden > 0.0 { TrackState::Predicted } else { TrackState::Seen };
            let at = Point2::from(track.at);
            track.alive.then_some(Sample2d { at, state, confidence: track.confidence })
        };
        self.tracks.iter().map(sample).collect()
    }

    /// Goes on to another image, `frames` frames away. `hints` are reprojected 3D markers, if there are any, one per marker.
    ///
    /// # Errors
    /// [`Error::ImageSize`] if the image has another size than the labelled one.
    pub fn step(
        &mut self,
        picture: &Picture,
        frames: f64,
        hints: Option<&[Option<Hint>]>,
    ) -> Result<Vec<Option<Sample2d>>, Error> {
        let found = [picture.width, picture.height];
        if found != self.size {
            return Err(Error::ImageSize { found, wanted: self.size });
        }
        let predictions = self.predict(frames, hints);
        let mut area = Area::nothing(picture);
        for prediction in predictions.iter().flatten() {
            area.add(prediction.at, prediction.gate + prediction.radius + MARGIN_PX);
        }
        let homes = self.homes(|track| predictions[track].as_ref().map(|p| p.at));
        let is_lost = |track: usize| {
            self.tracks[track].hidden > 0.0 && predictions[track].as_ref().is_some_and(|p| !p.guided)
        };
        let homes: Vec<Spread> = (0..homes.len())
            .filter(|&track| is_lost(track))
            .filter_map(|track| Some((homes[track]?, self.params.most_gate_px)))
            .collect();
        homes.iter().for_each(|(home, reach)| area.add(*home, reach + MARGIN_PX));
        self.strays.retain(|_| hints.is_none());
        let with_strays = hints.is_none() && self.tracks.iter().any(|track| track.home.is_none());
        if with_strays {
            predictions.iter().flatten().for_each(|prediction| area.add(prediction.at, STRAY_REACH_PX));
        }
        let found = blobs::find(picture, &self.paint, &area);
        self.follow(picture, &found, predictions, &homes, frames, with_strays);
        self.leave_image();
        Ok(self.samples())
    }

    /// Where each track should be, and how far from there it is looked for.
    fn predict(&self, frames: f64, hints: Option<&[Option<Hint>]>) -> Vec<Option<Prediction>> {
        let hint = |track: usize| hints.and_then(|hints| hints[track]);
        let mut predictions: Vec<Option<Prediction>> = self
            .tracks
            .iter()
            .enumerate()
            .map(|(index, track)| match hint(index) {
                Some(hint) => Some(track.guided(hint, self.params.guide_gate_px)),
                None if hints.is_some() && !track.is_known() => None,
                None => track.alive.then(|| track.predicted(frames)),
            })
            .collect();
        let places: Vec<[f64; 2]> = predictions.iter().flatten().map(|p| p.at).collect();
        for (track, prediction) in self.tracks.iter().zip(&mut predictions) {
            if let Some(prediction) = prediction.as_mut().filter(|p| !p.guided) {
                let at = prediction.at;
                let others = places.iter().map(|p| (p[0] - at[0]).powi(2) + (p[1] - at[1]).powi(2));
                let spacing = others.filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min).sqrt();
                prediction.gate = track.gate(spacing, frames, &self.params);
            }
        }
        predictions
    }

    /// Finds the dots of the predictions among the patches, and updates the tracks.
    fn follow(
        &mut self,
        picture: &Picture,
        found: &[Blob],
        mut predictions: Vec<Option<Prediction>>,
        homes: &[Spread],
        frames: f64,
        with_strays: bool,
    ) {
        self.owners.enter(picture, found);
        let mut patches = cut_near(picture, &self.paint, &self.owners, found, &predictions, homes);
        let all = dots(&patches, found, &[], &[]);
        let motion = self.sure_motion(&all, &mut predictions);
        let guards = self.guards(&motion);
        let all = dots(&patches, found, &predictions, &guards);
        let mut matches = match_tracks(&predictions, &self.tracks, all, &guards, &self.params);
        let lost = self.lost(&predictions, &matches, &motion);
        match_lost(&lost, &self.tracks, &guards, &mut matches, &self.params);
        self.mend(picture, found, &mut patches, &mut matches);
        if with_strays {
            let strays = self.find_strays(picture, found, &patches, &matches);
            let age = |at: [f64; 2]| {
                let near = guards.iter().filter(|guard| guard.is_near(at, self.params.least_gate_px));
                near.map(|guard| guard.age + frames).fold(0.0, f64::max)
            };
            // What the labelled image shows without a name is no marker that was lost later.
            let first = if frames == 0.0 { f64::INFINITY } else { 0.0 };
            let stray = |Spot { at, area }| Stray { at, area, age: first + age(at) };
            self.strays = strays.into_iter().map(stray).collect();
        }
        self.owners.leave(found);
        self.guided = GuideHits::default();
        for (index, track) in self.tracks.iter_mut().enumerate() {
            let Some(prediction) = &predictions[index] else { continue };
            if prediction.guided && prediction.facing {
                self.guided.wanted += 1;
                self.guided.found += usize::from(matches.dot_of[index].is_some());
            }
            match matches.dot_of[index].map(|dot| &matches.dots[dot]) {
                Some(dot) => track.see(dot, prediction, frames),
                None => track.miss(prediction, frames, motion.at(track.at)),
            }
        }
    }

    /// Moves the predictions by what the markers around them did: those with one dot in reach that nobody else has in reach
    /// tell. Returns how they moved since the image before.
    fn sure_motion(&self, all: &[Dot], predictions: &mut [Option<Prediction>]) -> MotionField {
        let reach = |p: &Prediction| {
            let near = all.iter().enumerate().filter(|(_, dot)| p.reaches(dot.spot.at)).map(|(i, _)| i);
            near.take(2).collect::<Vec<_>>()
        };
        let candidates: Vec<Vec<usize>> =
            predictions.iter().map(|p| p.as_ref().map_or(Vec::new(), reach)).collect();
        let mut wanted = vec![0u32; all.len()];
        for (dot, prediction) in predictions.iter().flatten().flat_map(|p| {
            all.iter().enumerate().filter(|(_, dot)| p.reaches(dot.spot.at)).map(move |d| (d.0, p))
        }) {
            wanted[dot] += u32::from(!prediction.guided || prediction.facing);
        }
        let (mut places, mut surprises, mut moves) = (Vec::new(), Vec::new(), Vec::new());
        for ((track, prediction), candidates) in self.tracks.iter().zip(predictions.iter()).zip(&candidates) {
            let (Some(prediction), [dot]) = (prediction, candidates.as_slice()) else { continue };
            if wanted[*dot] == 1 && track.alive && track.hidden == 0.0 {
                let at = all[*dot].spot.at;
                places.push(track.at);
                surprises.push(std::array::from_fn(|k| at[k] - prediction.at[k]));
                moves.push(std::array::from_fn(|k| at[k] - track.at[k]));
            }
        }
        let surprise = MotionField::new(places.clone(), surprises);
        let motion = MotionField::new(places, moves);
        for (track, prediction) in self.tracks.iter().zip(predictions) {
            let Some(prediction) = prediction.as_mut().filter(|p| !p.guided && track.alive) else { continue };
            let field = if track.hidden > 0.0 { &motion } else { &surprise };
            if let Some(by) = field.at(track.at) {
                prediction.at = std::array::from_fn(|k| prediction.at[k] + by[k]);
            }
        }
        motion
    }

    /// Puts dots together that fell into pieces: a matched dot that lacks area takes a piece beside it that nobody has.
    fn mend(&self, picture: &Picture, found: &[Blob], patches: &mut [Option<Patch>], matches: &mut Matches) {
        let taken: Vec<bool> = {
            let mut taken = vec![false; found.len()];
            matches.dot_of.iter().flatten().for_each(|&dot| taken[matches.dots[dot].blob] = true);
            taken
        };
        for (track, dot) in self.tracks.iter().zip(&matches.dot_of) {
            let Some(dot) = dot.map(|dot| &mut matches.dots[dot]) else { continue };
            let Some(usual) = track.area.filter(|usual| dot.spot.area < 0.75 * usual && !dot.shared) else {
                continue;
            };
            let reach = (usual / std::f64::consts::PI).sqrt() + 2.5;
            let piece = (0..found.len()).filter(|&i| !taken[i] && patches[i].is_some()).find(|&i| {
                let middle = found[i].middle;
                (middle[0] - dot.spot.at[0]).hypot(middle[1] - dot.spot.at[1]) < reach
            });
            let Some(piece) = piece else { continue };
            let whole = found[dot.blob].with(&found[piece]);
            let numbers = [dot.blob, piece];
            let patch = Patch::cut(picture, &self.paint, &self.owners, &whole, &numbers);
            if let Some(spot) = patch.and_then(|patch| patch.spot()).filter(|spot| spot.area < 1.2 * usual) {
                dot.spot = spot;
                patches[piece] = None;
            }
        }
    }

    /// Forgets hidden markers whose prediction has left the image.
    fn leave_image(&mut self) {
        let [width, height] = self.size.map(|side| side as f64);
        for track in self.tracks.iter_mut().filter(|track| track.hidden > 0.0) {
            let [x, y] = track.at;
            track.alive &= (-0.5..width - 0.5).contains(&x) && (-0.5..height - 0.5).contains(&y);
        }
    }
}

/// A place, and how far around it something is looked for, px.
type Spread = ([f64; 2], f64);

/// The patches that a prediction may want, or a marker that belongs there.
fn cut_near(
    picture: &Picture,
    paint: &Paint,
    owners: &Owners,
    found: &[Blob],
    predictions: &[Option<Prediction>],
    homes: &[Spread],
) -> Vec<Option<Patch>> {
    let near = predictions.iter().flatten().map(|p| (p.at, p.gate + p.radius + 2.0));
    let near: Vec<Spread> = near.chain(homes.iter().copied()).collect();
    let wanted = |blob: &Blob| {
        let [left, top, right, bottom] = blob.bounds.map(f64::from);
        let beside = |x: f64, low: f64, high: f64, reach: f64| x >= low - reach && x <= high + reach;
        near.iter().any(|&([x, y], reach)| beside(x, left, right, reach) && beside(y, top, bottom, reach))
    };
    let cut = |(number, blob): (usize, &Blob)| match wanted(blob) {
        true => Patch::cut(picture, paint, owners, blob, &[number]),
        false => None,
    };
    found.iter().enumerate().map(cut).collect()
}
