//! What is said of a take: reprojection errors, coverage, gaps.

use crate::fill::Placed;
use crate::solve::{Found, Solved};
use crate::strain::Swap;
use crate::timeline::Timeline;
use artifact::SampleStatus;
use serde::Serialize;
use std::collections::BTreeMap;

/// Exchanged markers that warnings name.
const SWAPS_SAID: usize = 12;
/// A reprojection error above this, px, and this many times the noise, is no noise: the calibration of one camera is off, or its
/// clock. Good rigs stay below 0.3 px.
const SYSTEMATIC_PX: f64 = 0.5;
const SYSTEMATIC: f64 = 6.0;
/// With a larger share of outliers the cameras contradict each other: one in three that is off leaves as many.
const CONTRADICTED: f64 = 0.35;

/// What is said of a take.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Frames.
    pub frames: usize,
    /// Markers of the tracks.
    pub markers: usize,
    /// Samples that two cameras or more measured.
    pub measured: usize,
    /// Samples on the ray of one camera.
    pub single_camera: usize,
    /// Samples filled from neighbours.
    pub neighbor_filled: usize,
    /// Samples interpolated over time.
    pub interpolated: usize,
    /// Samples without a position.
    pub missing: usize,
    /// Samples that cameras saw, but did not agree on.
    pub disagreed: usize,
    /// Root mean square of all reprojection errors that were used, radial, px.
    pub reprojection_rms_px: f64,
    /// Standard deviation of a track's point from frame to frame, px per axis: measured, or as given.
    pub noise_px: f64,
    /// Reprojection error from which views were outliers, px.
    pub outlier_px: f64,
    /// Root mean square of the measured positions' standard deviations, mm.
    pub deviation_rms_mm: f64,
    /// Samples that the time base kept from being used: nothing near them tells where the marker was at the frame's time.
    pub unaligned_views: usize,
    /// Per camera.
    pub cameras: BTreeMap<String, CameraReport>,
    /// Per marker.
    pub coverage: BTreeMap<String, MarkerReport>,
    /// Markers that seem to stand under each other's name.
    pub swaps: Vec<Swap>,
}

/// What is said of a camera.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct CameraReport {
    /// Root mean square reprojection error of the views used, radial, px.
    pub rms_px: f64,
    /// Mean residual, px: x and y; far from 0 where the calibration is off.
    pub mean_px: [f64; 2],
    /// Views used.
    pub used: usize,
    /// Views left out as outliers.
    pub outliers: usize,
    /// The largest of those, px.
    pub worst_px: f64,
}

/// What is said of a marker.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct MarkerReport {
    /// Samples that two cameras or more measured.
    pub measured: usize,
    /// Samples on the ray of one camera.
    pub single_camera: usize,
    /// Samples filled from neighbours.
    pub neighbor_filled: usize,
    /// Samples interpolated over time.
    pub interpolated: usize,
    /// Samples without a position.
    pub missing: usize,
    /// Samples that cameras saw, but did not agree on.
    pub disagreed: usize,
    /// Runs of frames in which it was not measured.
    pub gaps: usize,
    /// The longest of those, frames.
    pub longest_gap: usize,
}

#[derive(Default, Clone)]
struct CameraSums {
    squares: f64,
    sum: nalgebra::Vector2<f64>,
    used: usize,
    outliers: usize,
    worst: f64,
}

/// Counts as frames come by; what it holds does not grow with the take.
pub(crate) struct Tally {
    cameras: Vec<CameraSums>,
    markers: Vec<MarkerReport>,
    /// Per marker how long it has not been measured, frames.
    running: Vec<usize>,
    variance: f64,
    frames: usize,
    disagreed: usize,
    seen_twice: usize,
    pub(crate) timeline: Timeline,
}

impl Tally {
    pub(crate) fn new(camera_count: usize, marker_count: usize) -> Self {
        Self {
            cameras: vec![CameraSums::default(); camera_count],
            markers: vec![MarkerReport::default(); marker_count],
            running: vec![0; marker_count],
            variance: 0.0,
            frames: 0,
            disagreed: 0,
            seen_twice: 0,
            timeline: Timeline::new(camera_count, marker_count),
        }
    }

    /// Samples that two cameras or more saw.
    pub(crate) fn seen_twice(&self) -> usize {
        self.seen_twice
    }

    pub(crate) fn measured(&self) -> usize {
        self.markers.iter().map(|marker| marker.measured).sum()
    }

    pub(crate) fn see_solved(&mut self, frame: &Solved) {
        for (marker, found) in frame.found.iter().enumerate() {
            match found {
                Found::Disagreed => {
                    self.disagreed += 1;
                    self.markers[marker].disagreed += 1;
                }
                Found::Point(fix) => {
                    for (camera, residual) in &fix.used {
                        let sums = &mut self.cameras[*camera];
                        sums.squares += residual.norm_squared();
                        sums.sum += residual;
                        sums.used += 1;
                        self.timeline.add_residual(frame.frame, *camera, residual.norm_squared());
                    }
                    for (camera, off) in &fix.dropped {
                        let sums = &mut self.cameras[*camera];
                        sums.outliers += 1;
                        sums.worst =
                            sums.worst.max(Some(off.norm()).filter(|off| off.is_finite()).unwrap_or(0.0));
                        self.timeline.add_outlier(frame.frame, *camera);
                    }
                    self.variance += fix.covariance.trace() * fix.doubt;
                }
                Found::Nothing | Found::Ray(_) => continue,
            }
            self.seen_twice += 1;
        }
    }

    pub(crate) fn see_placed(&mut self, frame: &Placed) {
        self.frames += 1;
        for (marker, place) in frame.places.iter().enumerate() {
            let status = place.as_ref().map(|place| place.status);
            self.timeline.add_status(frame.frame, marker, status);
            let report = &mut self.markers[marker];
            *match status {
                Some(SampleStatus::Measured) => &mut report.measured,
                Some(SampleStatus::SingleCamera) => &mut report.single_camera,
                Some(SampleStatus::NeighborFilled) => &mut report.neighbor_filled,
                Some(SampleStatus::Interpolated) => &mut report.interpolated,
                None => &mut report.missing,
            } += 1;
            let running = &mut self.running[marker];
            *running = if status == Some(SampleStatus::Measured) { 0 } else { *running + 1 };
            report.gaps += usize::from(*running == 1);
            report.longest_gap = report.longest_gap.max(*running);
        }
    }

    pub(crate) fn report(&self, cameras: &[String], markers: &[String]) -> Report {
        let total = |count: fn(&MarkerReport) -> usize| self.markers.iter().map(count).sum();
        let used: usize = self.cameras.iter().map(|sums| sums.used).sum();
        let squares: f64 = self.cameras.iter().map(|sums| sums.squares).sum();
        let measured: usize = total(|marker| marker.measured);
        let per_camera = |(id, sums): (&String, &CameraSums)| {
            let count = sums.used.max(1) as f64;
            let report = CameraReport {
                rms_px: (sums.squares / count).sqrt(),
                mean_px: (sums.sum / count).into(),
                used: sums.used,
                outliers: sums.outliers,
                worst_px: sums.worst,
            };
            (id.clone(), report)
        };
        Report {
            frames: self.frames,
            markers: markers.len(),
            measured,
            single_camera: total(|marker| marker.single_camera),
            neighbor_filled: total(|marker| marker.neighbor_filled),
            interpolated: total(|marker| marker.interpolated),
            missing: total(|marker| marker.missing),
            disagreed: self.disagreed,
            reprojection_rms_px: (squares / used.max(1) as f64).sqrt(),
            noise_px: 0.0,
            outlier_px: 0.0,
            deviation_rms_mm: (self.variance / measured.max(1) as f64).sqrt(),
            unaligned_views: 0,
            cameras: cameras.iter().zip(&self.cameras).map(per_camera).collect(),
            coverage: markers.iter().cloned().zip(self.markers.iter().cloned()).collect(),
            swaps: Vec::new(),
        }
    }
}

impl Report {
    /// Share of all views that are outliers, if it is so large that the cameras contradict each other.
    pub(crate) fn contradiction(&self) -> Option<f64> {
        let sum = |count: fn(&CameraReport) -> usize| self.cameras.values().map(count).sum::<usize>() as f64;
        let share = sum(|camera| camera.outliers) / sum(|camera| camera.outliers + camera.used).max(1.0);
        (share > CONTRADICTED).then_some(share)
    }

    /// What the user should look at.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let never = |disagreed: bool| -> Vec<&str> {
            let is_so = |marker: &MarkerReport| marker.measured == 0 && (marker.disagreed > 0) == disagreed;
            self.coverage.iter().filter(|(_, marker)| is_so(marker)).map(|(id, _)| id.as_str()).collect()
        };
        for (markers, what) in [
            (never(false), "no two cameras ever see these markers together"),
            (
                never(true),
                "the cameras that see these markers never agree where they are; look for wrong names in one",
            ),
        ] {
            if !markers.is_empty() {
                warnings.push(format!("{what}: {}", markers.join(", ")));
            }
        }
        let rms = self.reprojection_rms_px;
        if rms > SYSTEMATIC_PX && rms > SYSTEMATIC * self.noise_px {
            warnings.push(format!(
                "the cameras miss the markers by {rms:.2} px, while the tracks are steady to {:.2} px: the calibration seems off; look at it with calibrate doctor",
                self.noise_px
            ));
        }
        let idle = self.cameras.iter().filter(|(_, camera)| camera.used == 0);
        let idle: Vec<&str> = idle.map(|(id, _)| id.as_str()).collect();
        if !idle.is_empty() {
            warnings.push(format!("no point was found with the help of these cameras: {}", idle.join(", ")));
        }
        for (id, camera) in
            self.cameras.iter().filter(|(_, camera)| camera.used > 0 && 10 * camera.outliers > camera.used)
        {
            let share = 100.0 * camera.outliers as f64 / (camera.outliers + camera.used) as f64;
            warnings.push(format!(
                "camera {id}: {share:.0} % of its views are outliers; its calibration, synchronisation or labels may be off"
            ));
        }
        for swap in self.swaps.iter().take(SWAPS_SAID) {
            let [a, b] = &swap.markers;
            let mut warning =
                format!("markers {a} and {b} seem exchanged in frames {}-{}", swap.first, swap.last);
            if let Some(camera) = &swap.camera {
                warning += &format!(" of camera {camera}, which is left out there");
            }
            warnings.push(warning);
        }
        if self.swaps.len() > SWAPS_SAID {
            warnings.push(format!("{} more such pairs: see the side-car", self.swaps.len() - SWAPS_SAID));
        }
        warnings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_say_what_is_the_matter() {
        let ids = |names: [&str; 2]| names.map(String::from);
        let mut tally = Tally::new(2, 2);
        let found = vec![Found::Disagreed, Found::Nothing];
        tally.see_solved(&Solved { frame: 1, found });
        let mut report = tally.report(&ids(["m1", "m2"]), &ids(["a", "b"]));
        (report.reprojection_rms_px, report.noise_px) = (1.3, 0.07);
        let said = report.warnings().join("\n");
        assert!(said.contains("no two cameras ever see these markers together: b\n"), "{said}");
        assert!(said.contains("never agree") && said.contains("names in one: a\n"), "{said}");
        assert!(said.contains("by 1.30 px, while the tracks are steady to 0.07 px"), "{said}");
        // Tracks that are as unsteady say nothing of the calibration; nor does an error of a tenth.
        for (rms, noise) in [(1.3, 0.5), (0.1, 0.01)] {
            (report.reprojection_rms_px, report.noise_px) = (rms, noise);
            assert!(!report.warnings().join("\n").contains("calibration seems off"));
        }
    }
}
