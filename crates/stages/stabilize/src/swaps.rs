//! Samples under another marker's name: found by whose place they are at, and given back where that is clear.

use crate::jumps::{Jump, offsets};
use crate::layout::Layout;
use crate::robust::{geometric_median, median};
use crate::samples::Samples;
use nalgebra::{Point3, Vector3};

/// A sample is at a marker's place within this distance, mm: markers on a face are at least twice as far apart.
const AT_PLACE_MM: f64 = 2.5;
/// A marker's offset from its neighbours is taken from so many of its samples next in time: a single one, beside a
/// mix-up, may be part of it.
const OFFSET_SAMPLES: usize = 7;
/// It is clear whose a sample is if every other free place is this many times further.
const CLEAR_RATIO: f64 = 2.0;
/// Fewer frames in a row than this are left alone: a slide passes many places.
const LEAST_FRAMES: usize = 3;
/// A marker that took a place without a jump worth the name is this much closer to it than to its own.
const TAKEN_RATIO: f64 = 0.35;
/// … and this far from its own, as a share of the distance at rest.
const TAKEN_AWAY: f64 = 0.4;
/// A side of an exchange that is so many times the other is right, unless the user named a frame of the other.
const CLEAR_MAJORITY: usize = 3;
/// Only beside other markers' jumps is that looked for: within so many frames.
const BESIDE_FRAMES: usize = 2;

/// A run of one marker's samples at another marker's place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Swap {
    /// Under whose name the samples stand.
    pub(crate) marker: usize,
    /// At whose place they are.
    pub(crate) place_of: usize,
    /// First and last frame, positions in the take.
    pub(crate) frames: (usize, usize),
    /// Whether the samples were given to that marker.
    pub(crate) is_mended: bool,
}

/// Takes out samples that came to stand at the place of a marker which has none of its own there, although they did
/// not jump far: beside other jumps only, where labels were mixed up. Such a run starts or ends beside a gap.
pub(crate) fn take_out_squatters(
    head: &mut Samples,
    layout: &Layout,
    candidates: &[usize],
    jumps: &[Jump],
) -> Vec<Jump> {
    let homes = Homes::of(head, layout);
    let upset = |f: usize| {
        jumps.iter().any(|jump| {
            jump.is_off
                && (jump.frames.0.saturating_sub(BESIDE_FRAMES)..=jump.frames.1 + BESIDE_FRAMES).contains(&f)
        })
    };
    let mut found = Vec::new();
    for &marker in candidates {
        let squats: Vec<bool> = (0..head.frame_count())
            .map(|f| upset(f) && homes.squatted_by(head, marker, f).is_some())
            .collect();
        for (first, last) in runs(&squats) {
            let beside_gap = |f: Option<usize>| {
                f.and_then(|f| head.points.get(f)).is_some_and(|row| row[marker].is_none())
            };
            if last + 1 - first >= LEAST_FRAMES
                && (beside_gap(first.checked_sub(1)) || beside_gap(Some(last + 1)))
            {
                let away = (first..=last).filter_map(|f| homes.away(head, marker, f));
                let size_mm = median(&mut away.collect::<Vec<_>>());
                found.push(Jump { marker, frames: (first, last), size_mm, is_off: true });
            }
        }
    }
    for jump in &found {
        (jump.frames.0..=jump.frames.1).for_each(|f| head.points[f][jump.marker] = None);
    }
    found
}

/// Says at whose place the samples are that were taken out, and gives them back if `mend`.
///
/// A sample is at the place of a marker that has none of its own in that frame, if it is near where that marker's
/// neighbours and its own nearest sample in time put it, and no other free place is near.
pub(crate) fn find(
    head: &mut Samples,
    labelled: &Samples,
    layout: &Layout,
    jumps: &[Jump],
    mend: bool,
) -> Vec<Swap> {
    let homes = Homes::of(head, layout);
    let mut swaps = Vec::new();
    for jump in jumps.iter().filter(|jump| jump.is_off) {
        let owner = |f: usize| homes.owner(head, jump.marker, f, labelled.points[f][jump.marker]?);
        let owners: Vec<Option<usize>> = (jump.frames.0..=jump.frames.1).map(owner).collect();
        let mut known: Vec<usize> = owners.iter().flatten().copied().collect();
        known.sort_unstable();
        known.dedup();
        for place_of in known {
            let here: Vec<bool> = owners.iter().map(|owner| *owner == Some(place_of)).collect();
            for (a, b) in runs(&here).into_iter().filter(|(a, b)| b + 1 - a >= LEAST_FRAMES) {
                let frames = (jump.frames.0 + a, jump.frames.0 + b);
                swaps.push(Swap { marker: jump.marker, place_of, frames, is_mended: false });
            }
        }
    }
    if mend {
        give_back(head, labelled, &mut swaps);
    }
    swaps
}

/// Gives samples to the marker whose place they are at, unless two claim one place in a frame.
fn give_back(head: &mut Samples, labelled: &Samples, swaps: &mut [Swap]) {
    let rival = |a: &Swap, b: &Swap| {
        a.place_of == b.place_of
            && a.marker != b.marker
            && a.frames.0 <= b.frames.1
            && b.frames.0 <= a.frames.1
    };
    let is_clear: Vec<bool> =
        swaps.iter().map(|swap| !swaps.iter().any(|other| rival(swap, other))).collect();
    for (swap, _) in swaps.iter_mut().zip(is_clear).filter(|(_, is_clear)| *is_clear) {
        swap.is_mended = true;
        for f in swap.frames.0..=swap.frames.1 {
            head.points[f][swap.place_of] = labelled.points[f][swap.marker];
        }
    }
}

/// Two markers whose names are exchanged from a frame to one end of the take.
#[derive(Debug, Clone, Copy)]
struct Exchange {
    markers: [usize; 2],
    /// The frames that were mended, and the others.
    mended: (usize, usize),
    others: (usize, usize),
}

/// Where two names are exchanged to one end of the take, nothing says which side is right, save that the larger one was taken for
/// it: the side that holds the reference frame is, unless it is far the shorter one and `is_asked` is false.
pub(crate) fn keep_reference_side(
    head: &mut Samples,
    jumps: &mut [Jump],
    swaps: &mut [Swap],
    reference: usize,
    is_asked: bool,
) {
    let length = |frames: (usize, usize)| frames.1 + 1 - frames.0;
    for exchange in exchanges(swaps, head.frame_count()) {
        let Exchange { markers: [a, b], mended, others } = exchange;
        let holds = (mended.0..=mended.1).contains(&reference);
        if !holds || !(is_asked || length(others) <= CLEAR_MAJORITY * length(mended)) {
            continue;
        }
        head.points.iter_mut().for_each(|row| row.swap(a, b));
        for swap in swaps
            .iter_mut()
            .filter(|swap| swap.is_mended && [a, b].contains(&swap.marker) && overlap(swap.frames, mended))
        {
            swap.frames = others;
        }
        for jump in jumps
            .iter_mut()
            .filter(|jump| jump.is_off && [a, b].contains(&jump.marker) && overlap(jump.frames, mended))
        {
            jump.frames = others;
        }
    }
}

fn overlap(a: (usize, usize), b: (usize, usize)) -> bool {
    a.0 <= b.1 && b.0 <= a.1
}

fn exchanges(swaps: &[Swap], frame_count: usize) -> Vec<Exchange> {
    let mended = || swaps.iter().filter(|swap| swap.is_mended);
    let exchange = |swap: &Swap| {
        let back = |other: &&Swap| {
            (other.marker, other.place_of) == (swap.place_of, swap.marker) && other.frames == swap.frames
        };
        mended().find(back).filter(|_| swap.marker < swap.place_of)?;
        let others = match swap.frames {
            (0, last) if last + 1 < frame_count => (last + 1, frame_count - 1),
            (first, last) if first > 0 && last + 1 == frame_count => (0, first - 1),
            _ => return None,
        };
        Some(Exchange { markers: [swap.marker, swap.place_of], mended: swap.frames, others })
    };
    mended().filter_map(exchange).collect()
}

/// Where markers would be, from their neighbours.
struct Homes<'a> {
    layout: &'a Layout,
    /// Per marker the frames where it is seen, and its offset from the neighbours there.
    offsets: Vec<(Vec<usize>, Vec<Vector3<f64>>)>,
    /// Per marker its usual offset.
    home: Vec<Vector3<f64>>,
}

impl<'a> Homes<'a> {
    fn of(head: &Samples, layout: &'a Layout) -> Self {
        let offset = |marker: usize| {
            let at = head.seen(marker);
            let offsets = offsets(head, layout, marker, &at);
            (at, offsets)
        };
        let offsets: Vec<_> = (0..head.marker_count()).map(offset).collect();
        let home = offsets.iter().map(|(_, offsets)| geometric_median(offsets).unwrap_or_default()).collect();
        Self { layout, offsets, home }
    }

    /// Where the marker would be with its usual offset.
    fn usual_place(&self, head: &Samples, marker: usize, f: usize) -> Option<Vector3<f64>> {
        Some(
            self.layout.rest[marker]?
                + self.layout.neighbors_displacement(head, marker, f)
                + self.home[marker],
        )
    }

    /// Where the marker would be with the offset that it has where it is seen next in time.
    fn place(&self, head: &Samples, marker: usize, f: usize) -> Option<Vector3<f64>> {
        let (at, offsets) = &self.offsets[marker];
        let mut first = at.partition_point(|&seen| seen < f);
        let mut last = first;
        while last - first < OFFSET_SAMPLES.min(at.len()) {
            let before = first.checked_sub(1).map(|k| at[k].abs_diff(f));
            let after = at.get(last).map(|seen| seen.abs_diff(f));
            match (before, after) {
                (Some(before), Some(after)) if before > after => last += 1,
                (None, _) => last += 1,
                _ => first -= 1,
            }
        }
        let offset = geometric_median(&offsets[first..last])?;
        Some(self.layout.rest[marker]? + self.layout.neighbors_displacement(head, marker, f) + offset)
    }

    fn away(&self, head: &Samples, marker: usize, f: usize) -> Option<f64> {
        Some((head.points[f][marker]?.coords - self.usual_place(head, marker, f)?).norm())
    }

    /// The marker without a sample whose place this one has taken, if it has left its own.
    fn squatted_by(&self, head: &Samples, marker: usize, f: usize) -> Option<usize> {
        let sample = head.points[f][marker]?;
        let away = self.away(head, marker, f)?;
        (0..head.marker_count()).find(|&other| {
            let free = other != marker && head.points[f][other].is_none();
            let near = || Some((sample.coords - self.place(head, other, f)?).norm() < TAKEN_RATIO * away);
            let left = || Some(away > TAKEN_AWAY * self.layout.distance(marker, other)?);
            free && left() == Some(true) && near() == Some(true)
        })
    }

    /// The marker at whose place a sample is, if that is clear.
    fn owner(&self, head: &Samples, marker: usize, f: usize, sample: Point3<f64>) -> Option<usize> {
        let distance = |other: usize| Some((sample.coords - self.place(head, other, f)?).norm());
        let free = (0..head.marker_count()).filter(|&other| head.points[f][other].is_none());
        let mut near: Vec<(f64, usize)> = free.filter_map(|other| Some((distance(other)?, other))).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let &(nearest, other) = near.first()?;
        let is_clear = near.get(1).is_none_or(|next| next.0 > CLEAR_RATIO * nearest);
        (other != marker && nearest <= AT_PLACE_MM && is_clear).then_some(other)
    }
}

/// First and last of each run of `true`.
pub(crate) fn runs(flags: &[bool]) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for i in (0..flags.len()).filter(|&i| flags[i]) {
        match runs.last_mut() {
            Some(last) if last.1 + 1 == i => last.1 = i,
            _ => runs.push((i, i)),
        }
    }
    runs
}
