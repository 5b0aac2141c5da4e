//! Markers that jump: steps that no neighbour shares, and the samples that they leave off their place.

use crate::layout::Layout;
use crate::params::JumpLimit;
use crate::robust::{geometric_median, median};
use crate::samples::Samples;
use nalgebra::Vector3;

/// Smallest limit that is chosen automatically, mm.
const LIMIT_FLOOR_MM: f64 = 10.0;
/// Lips reach 0.3 m/s in speech; beyond this (mm/s) a step is no motion of a face.
const LIMIT_SPEED_MM_S: f64 = 400.0;
/// A marker's own usual step times this is a jump.
const LIMIT_STEPS: f64 = 12.0;
/// Off its place: further from home than this share of the limit …
const AWAY_SHARE: f64 = 0.5;
/// … and than the usual distance from home times this.
const AWAY_DISTANCES: f64 = 4.0;
/// A step above this share of the limit, before and after a sample, means that it is on its way.
const SLIDE_SHARE: f64 = 0.15;
/// … and above the usual step times this.
const SLIDE_STEPS: f64 = 6.0;
/// A jump away and one back within this time (s) enclose what is wrong, wherever the face is meanwhile.
const EXCURSION_S: f64 = 1.0;
/// Back means: within this share of the limit of where it left.
const BACK_SHARE: f64 = 0.5;
/// Over a gap a marker may move further: the limit grows by this share per missing frame …
const GAP_GROWTH: f64 = 0.25;
/// … up to this many times; and no step is judged over a longer gap than this, s.
const GAP_MOST: f64 = 3.0;
/// Jumps hide others among their neighbours: look again until none is found, at most so often.
const ROUNDS: usize = 6;

/// A run of samples off their place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Jump {
    pub(crate) marker: usize,
    /// First and last frame (positions in the take) that are off their place. A jump with both sides in the
    /// marker's usual range leaves it open which is wrong: then it is the frame after the jump, and nothing is off.
    pub(crate) frames: (usize, usize),
    /// Largest step against the neighbours, mm.
    pub(crate) size_mm: f64,
    /// Whether the samples are off their place.
    pub(crate) is_off: bool,
}

/// Takes samples that are off their place out of `head` and says which. `rate`: frames per second.
///
/// Method: a marker's step from one frame to the next is compared with the geometric median of its eight nearest
/// neighbours' steps. Where the difference passes the limit, the marker jumped. If it jumps back soon, what is between is
/// off its place. If not, the side of the jump that lies further from the marker's home (its median offset from
/// its neighbours) is, and so are the samples beside it until the marker is in its usual range again and
/// no more under way.
pub(crate) fn take_out(
    head: &mut Samples,
    layout: &Layout,
    candidates: &[usize],
    limit: JumpLimit,
    rate: f64,
) -> Vec<Jump> {
    let mut jumps = Vec::new();
    for _ in 0..ROUNDS {
        let found: Vec<Jump> = candidates
            .iter()
            .flat_map(|&marker| Track::of(head, layout, marker).jumps(limit, rate))
            .collect();
        let off: Vec<Jump> = found.iter().filter(|jump| jump.is_off).cloned().collect();
        for jump in &off {
            (jump.frames.0..=jump.frames.1).for_each(|f| head.points[f][jump.marker] = None);
        }
        if off.is_empty() {
            // Only now: what looked undecided before may have been a wrong neighbour's doing.
            jumps.extend(found);
            break;
        }
        jumps.extend(off);
    }
    joined(jumps, head)
}

/// Joins runs of one marker that no sample separates.
fn joined(mut jumps: Vec<Jump>, head: &Samples) -> Vec<Jump> {
    jumps.sort_by_key(|jump| (jump.marker, jump.frames));
    let mut all: Vec<Jump> = Vec::new();
    for jump in jumps {
        match all.last_mut() {
            Some(last)
                if last.marker == jump.marker
                    && last.is_off
                    && jump.is_off
                    && (last.frames.1 + 1..jump.frames.0).all(|f| head.points[f][jump.marker].is_none()) =>
            {
                last.frames.1 = last.frames.1.max(jump.frames.1);
                last.size_mm = last.size_mm.max(jump.size_mm);
            }
            _ => all.push(jump),
        }
    }
    all.sort_by_key(|jump| (jump.frames, jump.marker));
    all
}

/// A marker against its neighbours, where it is seen.
struct Track<'a> {
    marker: usize,
    numbers: &'a [i64],
    /// Frames (positions in the take) where it is seen.
    at: Vec<usize>,
    /// Its offset from its neighbours, mm.
    offset: Vec<Vector3<f64>>,
    /// Distance of its offset from home, mm.
    away: Vec<f64>,
    /// Length of the step from the sample before against the neighbours' step, mm; 0 for the first.
    step: Vec<f64>,
}

impl<'a> Track<'a> {
    fn of(head: &'a Samples, layout: &Layout, marker: usize) -> Self {
        let at = head.seen(marker);
        let offset = offsets(head, layout, marker, &at);
        let home = geometric_median(&offset).unwrap_or_default();
        let away = offset.iter().map(|offset| (offset - home).norm()).collect();
        let places = head.of(marker);
        let step = |k: usize| match k.checked_sub(1) {
            Some(before) => {
                let own = places[k] - places[before];
                (own - layout.neighbors_step(head, marker, at[before], at[k])).norm()
            }
            None => 0.0,
        };
        let step = (0..at.len()).map(step).collect();
        Self { marker, numbers: &head.numbers, at, offset, away, step }
    }

    /// Frames from the sample before.
    fn frames_to(&self, k: usize) -> i64 {
        self.numbers[self.at[k]] - self.numbers[self.at[k - 1]]
    }

    fn jumps(&self, limit: JumpLimit, rate: f64) -> Vec<Jump> {
        let mut steps: Vec<f64> =
            (1..self.at.len()).filter(|&k| self.frames_to(k) == 1).map(|k| self.step[k]).collect();
        let usual_step = median(&mut steps);
        let limit = match limit {
            JumpLimit::Off => return Vec::new(),
            JumpLimit::Mm(limit) => limit,
            JumpLimit::Auto => LIMIT_FLOOR_MM.max(LIMIT_SPEED_MM_S / rate).max(LIMIT_STEPS * usual_step),
        };
        let away_limit = (AWAY_SHARE * limit).max(AWAY_DISTANCES * median(&mut self.away.clone()));
        let slide = (SLIDE_SHARE * limit).max(SLIDE_STEPS * usual_step);
        let is_off = |k: usize| {
            let next = self.step.get(k + 1).copied().unwrap_or(0.0);
            self.away[k] > away_limit || (self.step[k] > slide && next > slide)
        };
        let is_jump = |k: usize| {
            let missing = (self.frames_to(k) - 1) as f64;
            missing <= 0.5 * rate && self.step[k] > limit * (1.0 + GAP_GROWTH * missing).min(GAP_MOST)
        };
        let jumps: Vec<usize> = (1..self.at.len()).filter(|&k| is_jump(k)).collect();
        self.runs(&jumps, BACK_SHARE * limit, EXCURSION_S * rate, is_off)
    }

    /// What is off its place around jumps to the samples `jumps`.
    fn runs(&self, jumps: &[usize], back_mm: f64, longest: f64, is_off: impl Fn(usize) -> bool) -> Vec<Jump> {
        let mut found = Vec::new();
        let mut next = 0;
        while let Some(&away) = jumps.get(next) {
            let left = self.offset[away - 1];
            let returns = |&&k: &&usize| (self.offset[k] - left).norm() <= back_mm;
            let soon =
                |&&k: &&usize| (self.numbers[self.at[k]] - self.numbers[self.at[away]]) as f64 <= longest;
            match jumps[next + 1..].iter().take_while(soon).find(returns) {
                Some(&back) => {
                    let size_mm = self.step[away].max(self.step[back]);
                    let frames = (self.at[away], self.at[back - 1]);
                    found.push(Jump { marker: self.marker, frames, size_mm, is_off: true });
                    next = jumps.partition_point(|&k| k <= back);
                }
                None => {
                    found.push(self.run_beside(away, &is_off));
                    next += 1;
                }
            }
        }
        found
    }

    /// The samples off their place on the worse side of the jump to sample `k`.
    fn run_beside(&self, k: usize, is_off: impl Fn(usize) -> bool) -> Jump {
        let before = self.away[k - 1] > self.away[k];
        let (mut first, mut last) = if before { (k - 1, k - 1) } else { (k, k) };
        let off = is_off(first);
        if off && before {
            while first > 0 && is_off(first - 1) {
                first -= 1;
            }
        }
        if off && !before {
            while last + 1 < self.at.len() && is_off(last + 1) {
                last += 1;
            }
        }
        let frames = if off { (self.at[first], self.at[last]) } else { (self.at[k], self.at[k]) };
        Jump { marker: self.marker, frames, size_mm: self.step[k], is_off: off }
    }
}

/// Displacement of a marker from rest against its neighbours' displacement, where it is seen, mm.
pub(crate) fn offsets(head: &Samples, layout: &Layout, marker: usize, at: &[usize]) -> Vec<Vector3<f64>> {
    let rest = layout.rest[marker].unwrap_or_default();
    at.iter()
        .filter_map(|&f| {
            let place = head.points[f][marker]?.coords;
            Some(place - rest - layout.neighbors_displacement(head, marker, f))
        })
        .collect()
}
