//! How far off tracks are, from the tracks themselves.

use crate::Params;
use crate::point::{Fix, Scale};
use crate::solve::{Rig, Solved};
use artifact::Tracks2dFrame;

/// Frames that the noise is measured in.
pub(crate) const FRAMES: usize = 100;
/// What residuals mean before anything is known, px: wide, so that only gross errors are left out.
const UNKNOWN: Scale = Scale { noise: 0.25, spread: 0.25, outlier: 4.0 };
/// Outliers are so many standard deviations off …
const OUTLIER: f64 = 6.0;
/// … and at least this, px.
const LEAST_OUTLIER_PX: f64 = 0.75;
/// Least noise, px: below it, perfect tracks would make every rounding an event.
const LEAST_NOISE_PX: f64 = 0.01;
/// Median of a sum of two squared standard normal numbers.
const MEDIAN_CHI2_2: f64 = 1.386_294_361;

/// The scale of residuals, as the parameters say or as the first frames show. The *noise* is what residuals change by from
/// frame to frame: what they share is the calibration's error, which makes nothing jitter. The *outlier* is counted in their
/// whole size, calibration's error included.
pub(crate) fn measure(rig: &Rig, frames: &[Tracks2dFrame], marker_count: usize, params: &Params) -> Scale {
    if let (Some(noise), Some(outlier)) = (params.noise_px, params.outlier_px) {
        return Scale { noise, spread: (outlier / OUTLIER).max(noise), outlier };
    }
    let solved: Vec<Solved> = frames.iter().map(|frame| rig.solve(frame, marker_count, UNKNOWN)).collect();
    let fixes = solved.iter().flat_map(|frame| frame.fixes().map(|(_, fix)| fix));
    let whole = deviation(fixes.flat_map(|fix| squares(fix, None)).collect(), 1.0);
    let pairs = solved.windows(2).filter(|pair| pair[1].frame == pair[0].frame + 1);
    let changes =
        pairs.flat_map(|pair| pair[1].fixes().filter_map(|(marker, fix)| Some((fix, pair[0].fix(marker)?))));
    let change = deviation(changes.flat_map(|(fix, before)| squares(fix, Some(before))).collect(), 2.0);
    let whole = whole.unwrap_or(UNKNOWN.noise);
    let noise = params.noise_px.unwrap_or(change.unwrap_or(whole)).max(LEAST_NOISE_PX);
    Scale {
        noise,
        spread: whole.max(noise),
        outlier: params.outlier_px.unwrap_or((OUTLIER * whole).max(LEAST_OUTLIER_PX)),
    }
}

/// Squared residuals (or their changes, where the same cameras were used), each over the share of the noise that fitting
/// three coordinates to n views leaves in the residuals, (2n − 3) / 2n.
fn squares<'a>(fix: &'a Fix, before: Option<&'a Fix>) -> impl Iterator<Item = f64> + 'a {
    let count = 2.0 * fix.used.len() as f64;
    let left = (count - 3.0) / count;
    let same = before.is_none_or(|before| {
        before.used.len() == fix.used.len() && before.used.iter().zip(&fix.used).all(|(a, b)| a.0 == b.0)
    });
    let used = if same { &fix.used[..] } else { &[] };
    used.iter().enumerate().map(move |(i, (_, residual))| {
        let change = before.map_or(*residual, |before| residual - before.used[i].1);
        change.norm_squared() / left
    })
}

/// Standard deviation per axis from squared lengths in the plane, by their median: outliers do not move it.
fn deviation(mut squares: Vec<f64>, doubled: f64) -> Option<f64> {
    if squares.is_empty() {
        return None;
    }
    let middle = squares.len() / 2;
    let (_, median, _) = squares.select_nth_unstable_by(middle, f64::total_cmp);
    Some((*median / (MEDIAN_CHI2_2 * doubled)).sqrt())
}
