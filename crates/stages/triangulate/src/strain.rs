//! Exchanged labels, found by implausible local strain.
//!
//! Skin stretches by a few percent from frame to frame. Where two neighbours take each other's place, the distances of both
//! to all others jump; given back their places, they do not. What is compared are the logarithms of distances to neighbours
//! with those of the frame before, labels as they should have been.

use crate::affine::nearest;
use crate::solve::Solved;
use nalgebra::Point3;
use serde::Serialize;

/// Median strain of a marker's distances to its neighbours, per frame, from which it is looked at.
const IMPLAUSIBLE: f64 = 0.06;
/// An exchange explains the strain if it leaves less than this share of it.
const EXPLAINED: f64 = 0.25;
/// Places are forgotten after so many frames out of sight, and neighbours looked for anew.
const FORGOTTEN: i64 = 25;
/// Fewer distances say nothing.
const LEAST_DISTANCES: usize = 3;

/// Two markers that stand under each other's name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Swap {
    /// Their ids.
    pub markers: [String; 2],
    /// The camera in whose images they do; none: in all, so that the trajectories change over.
    pub camera: Option<String>,
    /// First frame …
    pub first: i64,
    /// … and last frame of the exchange; to the end of the take, if they do not change back.
    pub last: i64,
}

/// Watches frames in their order.
pub(crate) struct StrainWatch {
    /// Per marker its last true place, and in which frame.
    places: Vec<Option<(i64, Point3<f64>)>>,
    /// Per marker its neighbours, and in which frame they were looked for.
    neighbors: Vec<(i64, Vec<usize>)>,
    /// Exchanges that have not ended: markers, first frame, last frame seen.
    open: Vec<([usize; 2], i64, i64)>,
    closed: Vec<([usize; 2], i64, i64)>,
}

impl StrainWatch {
    pub(crate) fn new(marker_count: usize) -> Self {
        let neighbors = vec![(i64::MIN / 2, Vec::new()); marker_count];
        Self { places: vec![None; marker_count], neighbors, open: Vec::new(), closed: Vec::new() }
    }

    pub(crate) fn see(&mut self, frame: &Solved) {
        self.places.iter_mut().for_each(|place| {
            place.take_if(|(seen, _)| frame.frame - *seen > FORGOTTEN);
        });
        self.refresh(frame.frame);
        let mut now: Vec<Option<Point3<f64>>> =
            (0..frame.found.len()).map(|marker| frame.fix(marker).map(|fix| fix.position)).collect();
        // As the labels should be, if the exchanges that are open go on.
        self.open.iter().for_each(|([a, b], ..)| now.swap(*a, *b));
        for [a, b] in self.exchanged(&now) {
            now.swap(a, b);
            match self.open.iter().position(|(pair, ..)| *pair == [a, b]) {
                Some(ended) => self.closed.push(self.open.remove(ended)),
                None => self.open.push(([a, b], frame.frame, frame.frame)),
            }
        }
        let is_seen = |marker: &usize| now[*marker].is_some();
        for (pair, _, last) in &mut self.open {
            *last = if pair.iter().any(is_seen) { frame.frame } else { *last };
        }
        for (place, now) in self.places.iter_mut().zip(now) {
            *place = now.map(|now| (frame.frame, now)).or(*place);
        }
    }

    /// What was found, in the order of frames.
    pub(crate) fn finish(mut self, ids: &[String]) -> Vec<Swap> {
        self.closed.append(&mut self.open);
        self.closed.sort_by_key(|(pair, first, last)| (*first, *last, *pair));
        let swap = |([a, b], first, last): &([usize; 2], i64, i64)| Swap {
            markers: [ids[*a].clone(), ids[*b].clone()],
            camera: None,
            first: *first,
            last: *last,
        };
        self.closed.iter().map(swap).collect()
    }

    /// Pairs whose exchange explains an implausible strain; no marker twice.
    fn exchanged(&self, now: &[Option<Point3<f64>>]) -> Vec<[usize; 2]> {
        let strained: Vec<usize> = (0..now.len()).filter(|&marker| self.is_strained(marker, now)).collect();
        // One of the two may stand so that few distances change: what the other one explains is enough.
        let around = |&a: &usize| self.neighbors[a].1.iter().map(move |&b| [a.min(b), a.max(b)]);
        let mut candidates: Vec<[usize; 2]> = strained.iter().flat_map(around).collect();
        candidates.sort_unstable();
        candidates.dedup();
        let share = |pair: [usize; 2]| Some((self.share_left(pair[0], pair[1], now)?, pair));
        let mut pairs: Vec<(f64, [usize; 2])> = candidates.into_iter().filter_map(share).collect();
        pairs.retain(|(share, _)| *share < EXPLAINED);
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut taken: Vec<[usize; 2]> = Vec::new();
        for (_, pair) in pairs {
            if !taken.iter().flatten().any(|marker| pair.contains(marker)) {
                taken.push(pair);
            }
        }
        taken
    }

    /// How much of the strain of two markers is left if they change places.
    fn share_left(&self, a: usize, b: usize, now: &[Option<Point3<f64>>]) -> Option<f64> {
        let mut changed = now.to_vec();
        changed.swap(a, b);
        let sum =
            |now: &[Option<Point3<f64>>]| Some(self.strain(a, now[a], now)? + self.strain(b, now[b], now)?);
        Some(sum(&changed)? / sum(now)?)
    }

    /// Median of |log distance − log distance before| over the neighbours of a marker.
    fn strain(&self, marker: usize, here: Option<Point3<f64>>, now: &[Option<Point3<f64>>]) -> Option<f64> {
        let squares = self.squares(marker, here, now)?;
        let mut changes: Vec<f64> = squares.map(|(now, before)| (now / before).ln().abs() / 2.0).collect();
        if changes.len() < LEAST_DISTANCES {
            return None;
        }
        let middle = changes.len() / 2;
        Some(*changes.select_nth_unstable_by(middle, f64::total_cmp).1)
    }

    /// Whether the strain is implausible; the same without logarithms and without sorting, for it is asked of every sample.
    fn is_strained(&self, marker: usize, now: &[Option<Point3<f64>>]) -> bool {
        let Some(squares) = self.squares(marker, now[marker], now) else { return false };
        let most = (2.0 * IMPLAUSIBLE).exp();
        let count = |(all, strained), (now, before)| {
            let is_strained = now > most * before || before > most * now;
            (all + 1, strained + usize::from(is_strained))
        };
        let (all, strained) = squares.fold((0, 0), count);
        all >= LEAST_DISTANCES && 2 * strained >= all
    }

    /// Squared distances of a marker to its neighbours, now and before.
    fn squares<'a>(
        &'a self,
        marker: usize,
        here: Option<Point3<f64>>,
        now: &'a [Option<Point3<f64>>],
    ) -> Option<impl Iterator<Item = (f64, f64)> + 'a> {
        let (here, (_, before)) = (here?, self.places[marker]?);
        let squares = self.neighbors[marker].1.iter().filter_map(move |&other| {
            let (there, (_, there_before)) = (now[other]?, self.places[other]?);
            Some(((there - here).norm_squared(), (there_before - before).norm_squared()))
        });
        Some(squares.filter(|(now, before)| *now > 0.0 && *before > 0.0))
    }

    /// Looks for the neighbours of markers that have too few, or had them looked for long ago.
    fn refresh(&mut self, frame: i64) {
        for (marker, (since, neighbors)) in self.neighbors.iter_mut().enumerate() {
            let Some((_, here)) = self.places[marker] else { continue };
            let is_there = |other: &&usize| self.places[**other].is_some();
            if frame - *since > FORGOTTEN || neighbors.iter().filter(is_there).count() < LEAST_DISTANCES {
                let others = self.places.iter().enumerate().filter(|(other, _)| *other != marker);
                let others = others.filter_map(|(other, place)| Some((other, (*place)?.1)));
                *neighbors = nearest(&here, others).iter().map(|neighbor| neighbor.marker).collect();
                *since = frame;
            }
        }
    }
}
