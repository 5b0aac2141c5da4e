//! The summary for people.

use std::fmt::Write;
use triangulate::Report;

/// Cameras, then the markers that were not measured throughout.
pub(crate) fn table(report: &Report) -> String {
    let mut text = String::from("camera        rms px   mean px          views  outliers  worst px\n");
    for (id, camera) in &report.cameras {
        let [x, y] = camera.mean_px;
        let _ = writeln!(
            text,
            "{id:<12} {:>7.3}  {x:>6.3}, {y:>6.3}  {:>8}  {:>8}  {:>8.2}",
            camera.rms_px, camera.used, camera.outliers, camera.worst_px
        );
    }
    let whole = |frames: usize| 100.0 * frames as f64 / report.frames.max(1) as f64;
    text.push_str("marker             measured  one camera  filled  missing  gaps  longest\n");
    for (id, marker) in report.coverage.iter().filter(|(_, marker)| marker.gaps > 0) {
        let _ = writeln!(
            text,
            "{id:<18} {:>6.1} %  {:>8.1} %  {:>4.1} %  {:>5.1} %  {:>4}  {:>7}",
            whole(marker.measured),
            whole(marker.single_camera),
            whole(marker.neighbor_filled + marker.interpolated),
            whole(marker.missing),
            marker.gaps,
            marker.longest_gap
        );
    }
    let full = report.coverage.values().filter(|marker| marker.gaps == 0).count();
    let _ = write!(text, "{full} of {} markers were measured in every frame", report.markers);
    text
}
