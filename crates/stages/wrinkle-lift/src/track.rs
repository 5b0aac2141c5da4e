//! What one camera says of one wrinkle: runs of sections on the face.

use crate::params::Params;
use crate::section::{Lifted, Lost};
use artifact::{Section, SectionState};

/// Sections of one camera that hang together, in the order of the curve.
#[derive(Debug, Clone)]
pub(crate) struct Track {
    /// Number of the camera.
    pub(crate) camera: usize,
    pub(crate) points: Vec<Lifted>,
}

/// Neighbouring places are on two sheets of the face (nose and cheek behind it) if they are farther apart than this many times what
/// their distance in the image is on the surface, and this much, mm.
const SHEETS: (f64, f64) = (3.0, 1.0);
/// A run of fewer sections says nothing of where a wrinkle goes.
const LEAST_POINTS: usize = 3;

/// A lifted section, and where it was in the image.
type Seen = (Lifted, [f64; 2]);

/// Splits a wrinkle's sections into runs: gaps up to `gap_mm` are bridged. Runs that lie on another sheet of the face than the longest
/// one are left out, as are runs of a point or two; their points are counted.
pub(crate) fn tracks(
    camera: usize,
    sections: &[Section],
    lifted: &[Result<Lifted, Lost>],
    params: &Params,
) -> (Vec<Track>, usize) {
    let mut runs: Vec<Vec<Seen>> = Vec::new();
    let mut is_beside = false;
    for (section, lifted) in sections.iter().zip(lifted) {
        let Ok(point) = lifted else {
            is_beside = false;
            continue;
        };
        let seen = (*point, section.at);
        let goes_on = |last: &Seen| {
            let gap = (last.0.foot - point.foot).norm();
            (is_beside || gap <= params.gap_mm) && is_near(last, &seen)
        };
        match runs.last_mut() {
            Some(run) if run.last().is_some_and(goes_on) => run.push(seen),
            _ => runs.push(vec![seen]),
        }
        is_beside = true;
    }
    let count: usize = runs.iter().map(Vec::len).sum();
    let runs = on_one_sheet(runs);
    let kept: usize = runs.iter().map(Vec::len).sum();
    let track = |run: Vec<Seen>| Track { camera, points: run.into_iter().map(|(point, _)| point).collect() };
    let mut tracks: Vec<Track> = runs.into_iter().map(track).collect();
    tracks.iter_mut().for_each(|track| fill_flat(&mut track.points));
    (tracks, count - kept)
}

fn is_near(a: &Seen, b: &Seen) -> bool {
    let px = (a.1[0] - b.1[0]).hypot(a.1[1] - b.1[1]);
    let expected = px * 0.5 * (a.0.pixel_mm + b.0.pixel_mm);
    (a.0.foot - b.0.foot).norm() <= SHEETS.0 * expected + SHEETS.1
}

/// The longest run, and those that follow from it without a jump in depth.
fn on_one_sheet(runs: Vec<Vec<Seen>>) -> Vec<Vec<Seen>> {
    let lengths = runs.iter().map(Vec::len);
    // The first of equally long ones.
    let Some((main, _)) = lengths.enumerate().min_by_key(|(i, length)| (std::cmp::Reverse(*length), *i))
    else {
        return runs;
    };
    let mut keeps = vec![false; runs.len()];
    keeps[main] = true;
    let mut end = runs[main][runs[main].len() - 1];
    for i in main + 1..runs.len() {
        if runs[i].len() >= LEAST_POINTS && is_near(&end, &runs[i][0]) {
            (keeps[i], end) = (true, runs[i][runs[i].len() - 1]);
        }
    }
    let mut start = runs[main][0];
    for i in (0..main).rev() {
        if runs[i].len() >= LEAST_POINTS && is_near(&start, &runs[i][runs[i].len() - 1]) {
            (keeps[i], start) = (true, runs[i][0]);
        }
    }
    keeps[main] = runs[main].len() >= LEAST_POINTS;
    runs.into_iter().zip(keeps).filter_map(|(run, keep)| keep.then_some(run)).collect()
}

/// Where there is no valley its width says nothing: it is that of the nearest place with one.
fn fill_flat(points: &mut [Lifted]) {
    let known: Vec<(usize, Lifted)> =
        points.iter().copied().enumerate().filter(|(_, point)| point.d_mm > 0.0).collect();
    for (i, point) in points.iter_mut().enumerate().filter(|(_, point)| point.d_mm == 0.0) {
        if let Some((_, near)) = known.iter().min_by_key(|(other, _)| other.abs_diff(i)) {
            (point.w_mm, point.epsilon, point.kappa) = (near.w_mm, near.epsilon, near.kappa);
        }
    }
}

/// Whether a section says that there is a valley.
pub(crate) fn is_open(section: &Section) -> bool {
    section.state != SectionState::Failed && section.d_px > 0.0
}
