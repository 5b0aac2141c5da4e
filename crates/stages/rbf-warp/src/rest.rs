//! The rest frame: the frame whose expression is closest to the scan, and where the markers are in it.

use crate::params::RestFrame;
use crate::{Error, Result};
use artifact::{MarkerFrame, Trajectories};
use nalgebra::Point3;

/// A candidate shows at least this share of the markers that the best frame shows: a frame with few of them could be
/// close to the scan by hiding what moved.
const PRESENT: f64 = 0.9;

/// Where one marker is at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum RestPoint {
    /// Seen in the rest frame.
    Seen(Point3<f64>),
    /// Taken from the frames before and after.
    Filled(Point3<f64>),
    /// Not near it in time.
    Missing,
}

impl RestPoint {
    pub(crate) fn point(self) -> Option<Point3<f64>> {
        match self {
            Self::Seen(point) | Self::Filled(point) => Some(point),
            Self::Missing => None,
        }
    }
}

/// Index (not number) of the rest frame. `tracks`: per pair the marker's index in the trajectories; `targets`: per pair
/// the vertex, mm. Automatic choice: the smallest root mean square residual of a similarity fit [Horn1987] among frames
/// with nearly all markers; the first of equals.
pub(crate) fn choose(
    trajectories: &Trajectories,
    tracks: &[usize],
    targets: &[Point3<f64>],
    rest_frame: RestFrame,
) -> Result<usize> {
    let frames = &trajectories.frames;
    if let RestFrame::Number(number) = rest_frame {
        let (first, last) = (frames.first().map_or(0, |f| f.frame), frames.last().map_or(0, |f| f.frame));
        let place = frames.iter().position(|frame| frame.frame == number);
        return place.ok_or(Error::NoSuchFrame { frame: number, first, last });
    }
    let present = |frame: &MarkerFrame| tracks.iter().filter(|&&track| frame.points[track].is_some()).count();
    let most = frames.iter().map(present).max().unwrap_or(0);
    let enough = ((PRESENT * most as f64).ceil() as usize).max(4);
    let mut best: Option<(f64, usize)> = None;
    for (index, frame) in frames.iter().enumerate().filter(|(_, frame)| present(frame) >= enough) {
        let Some(residual) = similarity_rms(frame, tracks, targets) else { continue };
        if best.is_none_or(|(smallest, _)| residual < smallest) {
            best = Some((residual, index));
        }
    }
    best.map(|(_, index)| index).ok_or(Error::NoUsableFrame { most })
}

fn similarity_rms(frame: &MarkerFrame, tracks: &[usize], targets: &[Point3<f64>]) -> Option<f64> {
    let seen =
        tracks.iter().zip(targets).filter_map(|(&track, target)| Some((frame.points[track]?, *target)));
    let (from, to): (Vec<_>, Vec<_>) = seen.unzip();
    let similarity = camera::fit_similarity(&from, &to, None).ok()?;
    let square: f64 = from.iter().zip(&to).map(|(from, to)| (to - similarity * from).norm_squared()).sum();
    Some((square / from.len() as f64).sqrt())
}

/// Where a marker is at rest: in the rest frame, or interpolated linearly between the nearest frames before and after
/// that show it, at most `reach` frames away; where only one side does, its position there.
pub(crate) fn rest_point(trajectories: &Trajectories, rest: usize, track: usize, reach: u32) -> RestPoint {
    let frames = &trajectories.frames;
    if let Some(point) = frames[rest].points[track] {
        return RestPoint::Seen(point);
    }
    let number = frames[rest].frame;
    let shown = |frame: &MarkerFrame| {
        let away = frame.frame.abs_diff(number);
        (away <= u64::from(reach)).then(|| frame.points[track].map(|point| (away as f64, point)))
    };
    let before = frames[..rest].iter().rev().map_while(shown).flatten().next();
    let after = frames[rest + 1..].iter().map_while(shown).flatten().next();
    match (before, after) {
        (Some((back, from)), Some((ahead, to))) => {
            RestPoint::Filled(from + (to - from) * (back / (back + ahead)))
        }
        (Some((_, point)), None) | (None, Some((_, point))) => RestPoint::Filled(point),
        (None, None) => RestPoint::Missing,
    }
}
