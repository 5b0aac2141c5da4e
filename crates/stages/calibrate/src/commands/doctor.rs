//! `calibrate doctor`: what is wrong with a calibration.

use super::doctor_input::{self, Given};
use super::length;
use super::number;
use calibrate::doctor::{Examination, Finding, Params, examine};
use calibrate::wand::Length;
use serde_json::json;
use stage::Run;
use std::path::PathBuf;

/// Look for what is wrong with a calibration, by what it has not seen
///
/// Give what several cameras saw at the same time, other than what they were calibrated with: tracks of markers or of a wand, or
/// corners of a board. Each camera is judged by the others. Exit code 1 if anything is found.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Cameras to examine
    #[arg(value_name = "CAMERAS")]
    cameras: PathBuf,
    /// Points that the cameras saw (tracks-2d); may be repeated
    #[arg(long, value_name = "FILE")]
    tracks: Vec<PathBuf>,
    /// Corners of a board that the cameras saw, its squares are known lengths
    #[arg(long, value_name = "FILE")]
    corners: Option<PathBuf>,
    /// Take manifest: gives the sizes of the footage
    #[arg(long, value_name = "FILE")]
    take: Option<PathBuf>,
    /// Time base: tracks of images taken beside the frame's time are interpolated to it, doubled images left out
    #[arg(long, value_name = "FILE", requires = "tracks")]
    sync: Option<PathBuf>,
    /// A length measured between two cameras, two markers of the tracks, or two frames where they have one point only; may be
    /// repeated
    #[arg(long, value_name = "A:B=MM", value_parser = length::length, value_delimiter = ',')]
    scale: Vec<Length>,
    /// A fault must explain this much of a camera's residuals
    #[arg(long, value_name = "PX", default_value_t = Params::default().tolerance_px, allow_negative_numbers = true, value_parser = number::from_zero)]
    tolerance_px: f64,
    /// Share of each image that the points must cover
    #[arg(long, value_name = "SHARE", default_value_t = Params::default().coverage, allow_negative_numbers = true, value_parser = number::share)]
    coverage: f64,
    /// Known lengths may be off by this share in the mean
    #[arg(long, value_name = "SHARE", default_value_t = Params::default().length, allow_negative_numbers = true, value_parser = number::share)]
    scale_tolerance: f64,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("doctor");
    let params = Params {
        tolerance_px: arguments.tolerance_px,
        coverage: arguments.coverage,
        length: arguments.scale_tolerance,
        ..Params::default()
    };
    run.parameters(&params)?;
    let given = Given {
        cameras: &arguments.cameras,
        tracks: &arguments.tracks,
        sync: arguments.sync.as_deref(),
        corners: arguments.corners.as_deref(),
        take: arguments.take.as_deref(),
        lengths: &arguments.scale,
    };
    let evidence = doctor_input::read(run, &given)?;
    let examination = run.timed("examine", || examine(&evidence, &params));
    tell(run, &examination)
}

/// Prints the findings, and objects if there are any.
fn tell(run: &mut Run, examination: &Examination) -> anyhow::Result<()> {
    for report in &examination.cameras {
        let number = |value: Option<f64>, unit: &str| match value {
            Some(value) => format!("{value:.3} {unit}"),
            None => "–".to_string(),
        };
        run.report(&format!(
            "  {}: residual {}, clock {}, covers {}",
            report.camera,
            number(report.residual_px, "px"),
            number(report.late_frames, "frames late"),
            number(report.coverage, "of the image (hull of the points)"),
        ))?;
    }
    for what in &examination.unjudged {
        run.warn(format!("{what}; nothing was found out about it"));
    }
    for what in &examination.unchecked {
        run.report(&format!("  not checked: {what}"))?;
    }
    for finding in &examination.findings {
        run.report(&sentence(finding))?;
    }
    run.result("examination", json!(examination));
    run.result("findings", examination.findings.len());
    if let Some(ratio) = examination.length_ratio {
        run.result("length_ratio", ratio);
    }
    match examination.findings.len() {
        0 if !examination.compared => run.object(
            "nothing to examine: no points that two cameras see at the same time; only sizes and lenses were looked at\n  to do: give \
             --tracks or --corners that cameras of this rig saw together",
        ),
        0 => {}
        1 => run.object("the calibration has a fault"),
        count => run.object(format!("the calibration has {count} faults")),
    }
    Ok(())
}

fn sentence(finding: &Finding) -> String {
    let who = finding.camera.as_ref().map_or("the rig".to_string(), |camera| format!("camera {camera}"));
    format!("  {who}: {}\n    to do: {}", finding.what, finding.advice)
}
