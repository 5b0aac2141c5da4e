//! Makes a take.

mod calibration;
mod choice;
mod film;
mod footage;
mod given;
mod headers;
mod paper;
mod records;

pub(crate) use choice::Choice;

use anyhow::bail;
use artifact::FrameRange;
use footage::{FootageSink, Video};
use serde::Serialize;
use stage::Run;
use std::path::PathBuf;
use virtual_rig::scenario::Scenario;
use virtual_rig::take::Studio;

/// Make a take: footage as a user would bring it home (take/), and what is true of it (truth/)
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    choice: Choice,
    /// Frames to film, by their absolute numbers; the rest of the take stays the same
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    frames: Option<FrameRange>,
    /// Film neither the boards nor the wand
    #[arg(long)]
    no_calibration: bool,
    /// One video per camera instead of PNG pictures: lossless ffv1 (.avi), or lossy h264 (.mp4) or mjpg (.avi)
    #[arg(long, value_name = "ffv1|h264|mjpg", hide_possible_values = true, conflicts_with = "no_footage")]
    video: Option<Video>,
    /// Film no take: write only what is true of faces, not of images; the manifest names no footage
    #[arg(long)]
    no_footage: bool,
    /// Leave out the pictures of normals, which take most of the room
    #[arg(long)]
    no_normals: bool,
    /// Folder to make; gets take/ and truth/
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    given: given::GivenFace,
}

/// What stands in the side-cars.
#[derive(Serialize)]
struct Parameters<'a> {
    scenario: &'a Scenario,
    frames: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    video: Option<Video>,
    #[serde(flatten)]
    given: &'a given::GivenFace,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("make");
    arguments.video.map_or(Ok(()), Video::check)?;
    let mut scenario = arguments.choice.scenario(run)?;
    let chosen = scenario.clone();
    let (given, files) = arguments.given.read(run, &mut scenario)?;
    scenario.mark_changes(&chosen);
    let frames = arguments.frames.unwrap_or(FrameRange::ALL);
    run.parameters(&Parameters {
        scenario: &scenario,
        frames: frames.to_string(),
        video: arguments.video,
        given: &arguments.given,
    })?;
    let last = scenario.extent.first_frame + i64::from(scenario.extent.frames) - 1;
    if !(scenario.extent.first_frame..=last).any(|frame| frames.contains(frame)) {
        bail!(
            "--frames {frames}: the take has frames {}-{last}\n  to do: choose some of these",
            scenario.extent.first_frame
        );
    }
    artifact::require_new_folder(&arguments.out)?;
    // What cannot be filmed is refused before anything is written.
    let choice = &arguments.choice;
    let studio = choice.explain(run.timed("set up", || Studio::set_up(scenario, given)))?;
    let schedule = choice.explain(studio.schedule())?;
    let calibration = match arguments.no_calibration {
        true => None,
        false => Some(choice.explain(calibration::Plan::new(&studio))?),
    };
    run.say(&format!(
        "{}: {} vertices, {} markers, {} wrinkle lines, {} cameras",
        studio.scenario().name,
        studio.body().mesh.positions.len(),
        studio.marker_names().len(),
        studio.wrinkles().lines().len(),
        studio.stations().len()
    ));
    run.result("vertices", studio.body().mesh.positions.len());
    run.result("markers", studio.marker_names().len());
    let footage = FootageSink::new(arguments.video, &studio, &schedule, frames, &arguments.out)?;
    let (paper, last) = paper::Paper::new(&studio, files, arguments)?;
    let mut outputs = paper.write_truth(&studio)?;
    outputs.push(paper.write_picks(&studio)?);
    if !arguments.no_footage {
        outputs.extend(paper.write_stamps(&schedule)?);
    }
    if let Some(calibration) = calibration {
        calibration.film(run, &arguments.out)?;
    }
    outputs.extend(film::film(run, &studio, &schedule, &paper, footage, arguments)?);
    // The manifest comes last: a folder without it is not finished.
    outputs.extend(last);
    run.publish(outputs)
}
