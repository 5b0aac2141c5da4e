//! The picture of a take: reprojection error of every camera over time, and what every marker was in each frame.

use artifact::Staged;
use artifact::canvas::{Canvas, Color};
use std::path::Path;
use triangulate::{Column, Report, STATES, Timeline};

/// Where the charts begin, px from the left.
const LEFT: usize = 150;
/// Width of the charts, px.
const CHART: usize = 1024;
/// Height of a camera's lane, px.
const LANE: usize = 56;
/// Height of a marker's row, px: captions fit.
const ROW: usize = 15;
/// Frame numbers along the charts.
const TICKS: usize = 10;
const INK: Color = [40, 40, 40];
const GRID: Color = [225, 225, 225];
const ERROR: Color = [31, 94, 168];
const OUTLIER: Color = [214, 63, 38];
/// Of the states of a marker: measured, single-camera, neighbour-filled, interpolated, missing.
const STATE: [Color; STATES] =
    [[196, 214, 232], [240, 180, 60], [92, 168, 96], [150, 110, 190], [214, 63, 38]];
const STATE_NAMES: [&str; STATES] =
    ["measured", "one camera", "filled from neighbours", "interpolated", "missing"];

/// Draws the chart and writes it as PNG.
pub(crate) fn write(
    path: &Path,
    report: &Report,
    timeline: &Timeline,
    cameras: &[String],
    markers: &[String],
) -> anyhow::Result<Staged> {
    let height = 60 + cameras.len() * (LANE + 8) + 68 + markers.len() * ROW + 20;
    let mut canvas = Canvas::new(LEFT + CHART + 20, height)?;
    let last = timeline.first + timeline.columns.len() as i64 * timeline.span - 1;
    let title = format!(
        "frames {} to {last} · reprojection error {:.3} px rms · {} of {} samples measured",
        timeline.first,
        report.reprojection_rms_px,
        report.measured,
        report.frames * report.markers
    );
    canvas.write(&title, [8, 8], INK);
    let top = error_scale(timeline);
    let note = format!(
        "Root mean square of the views used, 0 to {top:.2} px (blue); share of the camera's views that are outliers (red, full height: all)"
    );
    canvas.write(&note, [8, 30], INK);
    let mut y = 56;
    for (camera, id) in cameras.iter().enumerate() {
        lane(&mut canvas, timeline, camera, [id, &format!("{:.3} px", report.cameras[id].rms_px)], y, top);
        y += LANE + 8;
    }
    ticks(&mut canvas, timeline, y);
    legend(&mut canvas, y + 24);
    y += 52;
    for (marker, id) in markers.iter().enumerate() {
        canvas.write(id, [8, y], INK);
        for (at, column) in timeline.columns.iter().enumerate() {
            let (x, width) = place(timeline, at);
            canvas.fill([x, y], [width, ROW - 2], STATE[worst(column, marker)]);
        }
        y += ROW;
    }
    Ok(artifact::picture::write_rgb8(path, canvas.width, canvas.height, &canvas.rgb)?)
}

/// Where a column stands, and how wide it is.
fn place(timeline: &Timeline, at: usize) -> (usize, usize) {
    let count = timeline.columns.len().max(1);
    let edge = |at: usize| at * CHART / count;
    (LEFT + edge(at), (edge(at + 1) - edge(at)).max(1))
}

/// The state that most deserves a look among the frames of a column.
fn worst(column: &Column, marker: usize) -> usize {
    let states = &column.markers[marker];
    (0..STATES).rev().find(|&state| states[state] > 0).unwrap_or(STATES - 1)
}

fn rms(column: &Column, camera: usize) -> Option<f64> {
    let (squares, count, _) = column.cameras[camera];
    (count > 0).then(|| (squares / count as f64).sqrt())
}

/// Upper end of the lanes: what nearly all columns stay below, rounded up.
fn error_scale(timeline: &Timeline) -> f64 {
    let cameras = timeline.columns.first().map_or(0, |column| column.cameras.len());
    let mut all: Vec<f64> = timeline
        .columns
        .iter()
        .flat_map(|column| (0..cameras).filter_map(|camera| rms(column, camera)))
        .collect();
    all.sort_by(f64::total_cmp);
    let high = all.get(all.len() * 99 / 100).copied().unwrap_or(0.1);
    (high * 1.25 * 20.0).ceil().max(1.0) / 20.0
}

fn lane(canvas: &mut Canvas, timeline: &Timeline, camera: usize, captions: [&str; 2], y: usize, top: f64) {
    canvas.fill([LEFT, y], [CHART, 1], GRID);
    canvas.fill([LEFT, y + LANE / 2], [CHART, 1], GRID);
    canvas.fill([LEFT, y + LANE], [CHART, 1], INK);
    captions.iter().enumerate().for_each(|(i, text)| canvas.write(text, [8, y + 8 + 18 * i], INK));
    for (at, column) in timeline.columns.iter().enumerate() {
        let (x, width) = place(timeline, at);
        let (_, used, outliers) = column.cameras[camera];
        let height = (outliers * LANE).div_ceil((used + outliers).max(1));
        canvas.fill([x, y + LANE - height], [width, height], OUTLIER);
        if let Some(rms) = rms(column, camera) {
            let up = ((rms / top).min(1.0) * (LANE - 2) as f64) as usize;
            canvas.fill([x, y + LANE - 2 - up], [width, 2], ERROR);
        }
    }
}

/// Frame numbers below the lanes.
fn ticks(canvas: &mut Canvas, timeline: &Timeline, y: usize) {
    let count = timeline.columns.len();
    canvas.write("frame", [8, y], INK);
    for tick in (0..TICKS).filter(|_| count >= TICKS) {
        let at = tick * count / TICKS;
        let (x, _) = place(timeline, at);
        canvas.fill([x, y - 8], [1, 6], INK);
        canvas.write(&(timeline.first + at as i64 * timeline.span).to_string(), [x, y], INK);
    }
}

fn legend(canvas: &mut Canvas, y: usize) {
    for (i, (name, color)) in STATE_NAMES.iter().zip(STATE).enumerate() {
        let x = LEFT + 190 * i;
        canvas.fill([x, y + 1], [14, 12], color);
        canvas.write(name, [x + 20, y], INK);
    }
}
