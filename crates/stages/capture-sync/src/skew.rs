//! What a time base's lags mean: in milliseconds, and in millimetres where markers move.

use artifact::{MarkerFrame, Rate, SyncFrame, SyncHeader, SyncSource};
use serde::Serialize;
use std::collections::BTreeMap;

/// How far a camera's images are from the mocap frames that they show.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Skew {
    /// How the lag was found: what is stated was not measured.
    pub source: SyncSource,
    /// Mean lag over the frames that it shows, ms: positive where its images come late.
    pub mean_ms: f64,
    /// Largest lag, either way, ms.
    pub worst_ms: f64,
    /// How far a marker moves meanwhile at the given speed, mm.
    pub mean_mm: Option<f64>,
    /// The same of the largest lag, mm.
    pub worst_mm: Option<f64>,
    /// Frames that it shows.
    pub shown: usize,
    /// Frames that it should show and does not.
    pub missing: usize,
    /// Frames whose image only repeats another.
    pub doubled: usize,
}

/// The skew of each camera; `speed_mm_s`: how fast markers move.
#[must_use]
pub fn skews(header: &SyncHeader, frames: &[SyncFrame], speed_mm_s: Option<f64>) -> BTreeMap<String, Skew> {
    let skew = |id: &String| {
        let camera = &header.cameras[id];
        let of_camera = || frames.iter().filter_map(|frame| Some((frame.frame, frame.shows.get(id)?)));
        let lags: Vec<f64> = of_camera()
            .filter(|(_, shown)| shown.is_some())
            .map(|(frame, _)| 1e3 * camera.lag_frames(frame) / header.rate.hz())
            .collect();
        let mean_ms = lags.iter().sum::<f64>() / lags.len().max(1) as f64;
        let worst_ms = lags
            .iter()
            .copied()
            .fold(0.0_f64, |worst, lag| if lag.abs() > worst.abs() { lag } else { worst });
        let in_mm = |ms: f64| speed_mm_s.map(|speed| 1e-3 * ms.abs() * speed);
        Skew {
            source: camera.source,
            mean_ms,
            worst_ms,
            mean_mm: in_mm(mean_ms),
            worst_mm: in_mm(worst_ms),
            shown: lags.len(),
            missing: of_camera().filter(|(_, shown)| shown.is_none()).count(),
            doubled: of_camera().filter(|(_, shown)| shown.is_some_and(|shown| shown.doubled)).count(),
        }
    };
    header.cameras.keys().map(|id| (id.clone(), skew(id))).collect()
}

/// Speeds that a share of the markers' steps stays below.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Speeds {
    /// Half of the steps, mm/s.
    pub median_mm_s: f64,
    /// 95 % of the steps, mm/s: what the skew is judged by.
    pub p95_mm_s: f64,
}

/// The speeds of markers from frame to frame; none where no marker is seen in two neighbouring frames.
#[must_use]
pub fn speeds(frames: &[MarkerFrame], rate: Rate) -> Option<Speeds> {
    let mut speeds: Vec<f64> = Vec::new();
    for pair in frames.windows(2).filter(|pair| pair[1].frame == pair[0].frame + 1) {
        let steps = pair[0].points.iter().zip(&pair[1].points);
        speeds.extend(steps.filter_map(|(a, b)| Some((((*b)? - (*a)?).norm()) * rate.hz())));
    }
    speeds.sort_unstable_by(f64::total_cmp);
    let share =
        |share: f64| speeds.get((share * (speeds.len().saturating_sub(1)) as f64).round() as usize).copied();
    Some(Speeds { median_mm_s: share(0.5)?, p95_mm_s: share(0.95)? })
}
