//! Which patch of paint belongs to which wrinkle.

use crate::bits::Patch;
use crate::params::TrackParams;
use crate::region::Region;
use crate::spline::{self, Place};

/// Where a wrinkle was: a line, and how far its paint reached to both sides.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stroke {
    line: Vec<Place>,
    reach: f64,
    center: Place,
    area: f64,
}

const LINE_POINTS: usize = 25;

impl Stroke {
    /// The stroke of a region; without a curve a point.
    #[must_use]
    pub(crate) fn new(region: &Region, controls: Option<&[Place]>) -> Self {
        let center = region.center();
        let area = region.area() as f64;
        let line = controls.map_or_else(|| vec![center], |controls| spline::sampled(controls, LINE_POINTS));
        let length: f64 = line.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let reach = if length > 1.0 { 0.5 * area / length } else { (area / std::f64::consts::PI).sqrt() };
        Self { line, reach, center, area }
    }

    /// The stroke of a curve through a region that was cut out of a larger patch: it is as wide as it was before.
    #[must_use]
    pub(crate) fn with_width_of(self, before: Option<&Self>) -> Self {
        match before {
            Some(before) => Self { reach: before.reach, area: before.area, ..self },
            None => self,
        }
    }

    /// Moves it.
    pub(crate) fn shift(&mut self, by: Place) {
        self.line.iter_mut().for_each(|point| *point += by);
        self.center += by;
    }

    /// How far a place lies outside the stroke, px.
    fn distance(&self, at: Place) -> f64 {
        (self.to_line(at) - self.reach).max(0.0)
    }

    fn to_line(&self, at: Place) -> f64 {
        let to_segment = |pair: &[Place]| {
            let along = pair[1] - pair[0];
            let share =
                ((at - pair[0]).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            (pair[0] + along * share - at).norm()
        };
        let nearest = self.line.windows(2).map(to_segment).fold(f64::INFINITY, f64::min);
        nearest.min((self.line[0] - at).norm())
    }
}

/// A paint and the stroke in it, if it has been seen.
type Known<'a> = (u8, Option<&'a Stroke>);

/// Pixels of a patch that are asked.
const ASKED: usize = 160;

fn asked(patch: &Patch) -> Vec<Place> {
    let every = patch.area().div_ceil(ASKED);
    patch.pixels().step_by(every).map(|[x, y]| Place::new(x as f64, y as f64)).collect()
}

fn mean_distance(stroke: &Stroke, places: &[Place], shift: Place) -> f64 {
    places.iter().map(|place| stroke.distance(place - shift)).sum::<f64>() / places.len().max(1) as f64
}

/// The wrinkle of a paint that some places lie nearest to, and how far they do.
fn nearest(strokes: &[Known], paint: u8, places: &[Place], shift: Place) -> Option<(usize, f64)> {
    let same = strokes.iter().enumerate().filter(|(_, (of, _))| *of == paint);
    let known = same.filter_map(|(index, (_, stroke))| Some((index, (*stroke)?)));
    known
        .map(|(index, stroke)| (index, mean_distance(stroke, places, shift)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

const SHIFT_ROUNDS: usize = 4;
/// Wrinkles whose area changed more tell nothing of the motion.
const SAME_AREA: std::ops::Range<f64> = 0.6..1.6;

/// How all wrinkles together moved: the median of their centres' motions.
#[must_use]
pub(crate) fn common_shift(strokes: &[Known], patches: &[(u8, Patch)]) -> Place {
    let places: Vec<Vec<Place>> = patches.iter().map(|(_, patch)| asked(patch)).collect();
    let mut shift = Place::zeros();
    for _ in 0..SHIFT_ROUNDS {
        // Per wrinkle: sum of its pixels, their number.
        let mut sums = vec![(Place::zeros(), 0.0); strokes.len()];
        for ((paint, patch), places) in patches.iter().zip(&places) {
            if let Some((index, _)) = nearest(strokes, *paint, places, shift) {
                let area = patch.area() as f64;
                let center = places.iter().sum::<Place>() / places.len() as f64;
                sums[index] = (sums[index].0 + center * area, sums[index].1 + area);
            }
        }
        let moves: Vec<Place> = strokes
            .iter()
            .zip(&sums)
            .filter_map(|((_, stroke), (sum, area))| {
                let stroke = (*stroke)?;
                SAME_AREA.contains(&(area / stroke.area)).then(|| sum / *area - stroke.center)
            })
            .collect();
        if moves.is_empty() {
            return shift;
        }
        let median = |axis: usize| {
            let mut values: Vec<f64> = moves.iter().map(|step| step[axis]).collect();
            values.sort_by(f64::total_cmp);
            0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2])
        };
        shift = Place::new(median(0), median(1));
    }
    shift
}

/// A wrinkle takes part in a patch with others if it has such a share of what it was.
const CLAIM: f64 = 0.25;

/// A wrinkle's part of the paint.
pub(crate) struct Share {
    pub(crate) region: Region,
    /// Whether it was cut out of a patch that others have a part in.
    pub(crate) is_cut: bool,
}

/// The pixels of each wrinkle, and how many patches belong to none. A patch belongs to the nearest wrinkle of its paint; where
/// several wrinkles have run into one patch, each pixel belongs to the nearest of them.
#[must_use]
pub(crate) fn assigned(
    strokes: &[Known],
    patches: &[(u8, Patch)],
    shift: Place,
    params: &TrackParams,
) -> (Vec<Option<Share>>, usize) {
    let near: Vec<Option<usize>> = patches
        .iter()
        .map(|(paint, patch)| {
            let found = nearest(strokes, *paint, &asked(patch), shift)?;
            (found.1 <= params.gate_px).then_some(found.0)
        })
        .collect();
    let has_patch = |index: usize| near.contains(&Some(index));
    let mut found: Vec<(Vec<[usize; 2]>, bool)> = vec![(Vec::new(), false); strokes.len()];
    let mut strays = 0;
    for ((paint, patch), near) in patches.iter().zip(&near) {
        let Some(nearest) = *near else {
            strays += 1;
            continue;
        };
        // Only one that has no patch of its own can have run into another's.
        let mut candidates: Vec<usize> = (0..strokes.len())
            .filter(|i| *i == nearest || strokes[*i].0 == *paint && !has_patch(*i))
            .collect();
        let mut shares = shared_out(strokes, patch, &candidates, shift);
        candidates.retain(|i| *i == nearest || claims(strokes[*i].1, shares[*i].len()));
        shares = shared_out(strokes, patch, &candidates, shift);
        for ((pixels, is_cut), share) in found.iter_mut().zip(shares) {
            *is_cut |= candidates.len() > 1 && !share.is_empty();
            pixels.extend(share);
        }
    }
    let share = |(pixels, is_cut): (Vec<[usize; 2]>, bool)| {
        (!pixels.is_empty()).then(|| Share { region: Region::new(pixels), is_cut })
    };
    (found.into_iter().map(share).collect(), strays)
}

fn claims(stroke: Option<&Stroke>, pixels: usize) -> bool {
    stroke.is_some_and(|stroke| pixels as f64 >= CLAIM * stroke.area)
}

/// Per wrinkle the pixels of a patch that lie nearest to it, of some candidates.
fn shared_out(strokes: &[Known], patch: &Patch, candidates: &[usize], shift: Place) -> Vec<Vec<[usize; 2]>> {
    let mut shares = vec![Vec::new(); strokes.len()];
    if let [only] = candidates {
        shares[*only] = patch.pixels().collect();
        return shares;
    }
    for pixel in patch.pixels() {
        let at = Place::new(pixel[0] as f64, pixel[1] as f64) - shift;
        let distance =
            |index: usize| strokes[index].1.map_or(f64::INFINITY, |stroke| stroke.to_line(at) - stroke.reach);
        if let Some(nearest) = candidates.iter().min_by(|a, b| distance(**a).total_cmp(&distance(**b))) {
            shares[*nearest].push(pixel);
        }
    }
    shares
}
