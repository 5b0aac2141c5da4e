//! Jitter of the pose, measured where it shows: as a motion that all markers share.
//!
//! Noise of the few head markers becomes noise of the pose, and that moves the whole face. It cannot be smoothed out
//! of the pose itself without smoothing the head's own fast motion: at 3 Hz and 15° a filter of 13 ms already
//! moves the face by 0.02 mm. But in head space the head's motion is gone, however fast, and what is left that
//! all markers do together, faster than faces move as a whole, is the pose's error. It is found there and given back
//! to the pose. So any rigid motion of the take changes nothing in head space, exactly.

use crate::local_quadratic::smooth;
use crate::rigid_body::is_line;
use crate::robust::{axis_deviation, median, tukey_weight};
use crate::samples::Samples;
use nalgebra::{Isometry3, Point3};

/// The markers' noise is known better once the jitter is out: two rounds; a third changes < 1 %.
const ROUNDS: usize = 2;
/// Reweightings per frame.
const REWEIGHTINGS: usize = 4;
/// From this many standard deviations on, a marker moves by itself and has no vote.
const CUT: f64 = 6.8;
/// A marker's deviation counts as at least this share of the usual one, so that none outvotes all others.
const QUIET_SHARE: f64 = 0.25;
/// Deviation (mm) that noise-free data are granted.
const NOISE_FLOOR_MM: f64 = 1e-6;

/// Per frame the rigid motion that all markers share on top of their slow motion: `found_from_true` of the head
/// space, so that `world_from_head · found_from_true` is the better pose.
///
/// `head`: samples in head space. `sigma`: time scale, frames. `fitted`: the markers that the pose was fitted to;
/// what they show of their noise is less than there is, since the fit followed it.
///
/// Method: each marker is smoothed over time by a local quadratic; its deviation from that gives its noise, and the
/// weighted rigid fit [Horn1987] from smoothed to unsmoothed places, with Tukey's biweight [BeatonTukey1974], gives
/// the frame's common motion. Head markers vote too: they stand for what the pose is known to be.
pub(crate) fn common_jitter(head: &Samples, sigma: f64, fitted: &[usize]) -> Vec<Isometry3<f64>> {
    let mut jitter = vec![Isometry3::identity(); head.frame_count()];
    for _ in 0..ROUNDS {
        let steady = head.moved(|f| Some(jitter[f].inverse()));
        let smoothed = smooth(&steady, sigma);
        let deviation = deviations(&steady, &smoothed, fitted);
        for (f, jitter) in jitter.iter_mut().enumerate() {
            *jitter *= shared_motion(&smoothed.points[f], &steady.points[f], &deviation);
        }
    }
    jitter
}

/// Per marker the standard deviation of its fast motion per axis, mm.
fn deviations(steady: &Samples, smoothed: &Samples, fitted: &[usize]) -> Vec<f64> {
    let count = fitted.len() as f64;
    // A fit of 6 numbers to 3 n takes up that share of the noise of its own markers.
    let hidden = (count / (count - 2.0).max(1.0)).sqrt();
    let deviation = |marker: usize| {
        let pairs = steady.points.iter().zip(&smoothed.points);
        let mut off: Vec<f64> = pairs.filter_map(|(a, b)| Some((a[marker]? - b[marker]?).norm())).collect();
        let found = axis_deviation(&mut off);
        if fitted.contains(&marker) { hidden * found } else { found }
    };
    let found: Vec<f64> = (0..steady.marker_count()).map(deviation).collect();
    let mut known: Vec<f64> = found.iter().copied().filter(|deviation| *deviation > 0.0).collect();
    let floor = (QUIET_SHARE * median(&mut known)).max(NOISE_FLOOR_MM);
    found.into_iter().map(|deviation| deviation.max(floor)).collect()
}

/// The weighted robust fit of one frame; no motion where too few markers vote.
fn shared_motion(
    smoothed: &[Option<Point3<f64>>],
    seen: &[Option<Point3<f64>>],
    deviation: &[f64],
) -> Isometry3<f64> {
    let still = Isometry3::identity();
    let voters: Vec<(Point3<f64>, Point3<f64>, f64)> = smoothed
        .iter()
        .zip(seen)
        .zip(deviation)
        .filter_map(|((from, to), deviation)| Some(((*from)?, (*to)?, *deviation)))
        .collect();
    let source: Vec<Point3<f64>> = voters.iter().map(|voter| voter.0).collect();
    let target: Vec<Point3<f64>> = voters.iter().map(|voter| voter.1).collect();
    let mut weights: Vec<f64> = voters.iter().map(|voter| voter.2.powi(-2)).collect();
    let mut motion = still;
    for _ in 0..REWEIGHTINGS {
        let voting: Vec<Point3<f64>> =
            source.iter().zip(&weights).filter(|(_, weight)| **weight > 0.0).map(|(p, _)| *p).collect();
        if is_line(&voting) {
            return still;
        }
        let Ok(found) = camera::fit_rigid(&source, &target, Some(&weights)) else { return still };
        motion = found;
        for (weight, (from, to, deviation)) in weights.iter_mut().zip(&voters) {
            let off = (motion * from - to).norm();
            *weight = tukey_weight(off / deviation, CUT) / (deviation * deviation);
        }
    }
    motion
}
