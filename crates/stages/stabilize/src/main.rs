//! `stabilize`: arguments → read → call → write.

mod input;

use anyhow::bail;
use artifact::{FrameRange, FrameWriter, HeadPose, HeadTrajectories, Unit};
use clap::{Parser, ValueEnum};
use stabilize::{JumpLimit, Params, Stabilized, Swaps, stabilize};
use std::path::PathBuf;
use std::process::ExitCode;

/// Takes the head's rigid motion out of marker trajectories
///
/// Writes the markers in head space (= world space at the reference frame) and the head's pose in every frame, so
/// that world = world_from_head · head. Without --head-markers, the markers that deform least are taken for the head.
#[derive(Parser)]
#[command(name = "stabilize", version)]
struct Arguments {
    /// Markers in world space: trajectories-3d (.jsonl, - for standard input), .c3d, .trc or .csv
    #[arg(long, value_name = "FILE")]
    markers: PathBuf,
    /// Unit of the markers' coordinates, where the file may not say it
    #[arg(long, value_name = "mm|cm|m")]
    unit: Option<Unit>,
    /// Take manifest: gives the frame rate and is referred to by what is written
    #[arg(long, value_name = "FILE")]
    take: Option<PathBuf>,
    /// Markers on rigid parts of the head, ids or patterns such as 'root-*'
    #[arg(long, value_name = "ID,…", value_delimiter = ',')]
    head_markers: Vec<String>,
    /// Markers to leave out altogether, ids or patterns such as 'Unlabeled*'
    #[arg(long, value_name = "ID,…", value_delimiter = ',')]
    drop: Vec<String>,
    /// Frame at which head space is world space; auto: the first that shows the most markers
    #[arg(long, value_name = "N|auto", default_value = "auto", value_parser = reference_frame, allow_hyphen_values = true)]
    reference_frame: ReferenceFrame,
    /// Time scale of the pose's jitter, ms; 0: the pose stays as fitted
    #[arg(long, value_name = "MS", default_value_t = 60.0, allow_negative_numbers = true)]
    smooth_ms: f64,
    /// Step against its neighbours from which a marker has jumped, mm per frame
    #[arg(long, value_name = "MM|auto|off", default_value = "auto")]
    jump_mm: JumpLimit,
    /// Longest gap that is filled, ms; 0: none
    #[arg(long, value_name = "MS", default_value_t = 100.0, allow_negative_numbers = true)]
    fill_ms: f64,
    /// Samples under another marker's name: take them out, or give them back where it is clear whose they are
    #[arg(long, value_enum, default_value_t = SwapsArgument::Mend)]
    swaps: SwapsArgument,
    /// Write the head markers among the trajectories too
    #[arg(long)]
    keep_head_markers: bool,
    /// Frames to write; poses and places are found from the whole take all the same
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    frames: Option<FrameRange>,
    /// Trajectories to write, in head space (head-trajectories; - for standard output)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Poses to write (head-pose)
    #[arg(long, value_name = "FILE")]
    pose: PathBuf,
    #[command(flatten)]
    common: stage::Common,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum SwapsArgument {
    Report,
    Mend,
}

/// A frame, or the one that the stage chooses.
#[derive(Debug, Clone, Copy)]
struct ReferenceFrame(Option<i64>);

fn reference_frame(text: &str) -> Result<ReferenceFrame, String> {
    match text {
        "auto" => Ok(ReferenceFrame(None)),
        _ => match text.parse() {
            Ok(frame) => Ok(ReferenceFrame(Some(frame))),
            Err(_) => Err("say a frame number, or auto".into()),
        },
    }
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

impl Arguments {
    fn params(&self) -> Params {
        Params {
            head_markers: self.head_markers.clone(),
            drop: self.drop.clone(),
            reference_frame: self.reference_frame.0,
            smooth_ms: self.smooth_ms,
            jump: self.jump_mm,
            fill_ms: self.fill_ms,
            swaps: match self.swaps {
                SwapsArgument::Report => Swaps::Report,
                SwapsArgument::Mend => Swaps::Mend,
            },
            keep_head_markers: self.keep_head_markers,
        }
    }
}

fn main() -> ExitCode {
    stage::run::<Arguments>(work)
}

fn work(run: &mut stage::Run, arguments: Arguments) -> anyhow::Result<()> {
    if arguments.out == arguments.pose {
        bail!("--out and --pose are both {}\n  to do: name two files", arguments.out.display());
    }
    let params = arguments.params();
    params.check()?;
    run.parameters(&params)?;
    let take = input::read(run, &arguments.markers, arguments.unit, arguments.take.as_deref())?;
    let stable = run.timed("stabilize", || stabilize(&take, &params));
    let stable = stable.map_err(|error| error.in_file(&arguments.markers))?;
    stable.report.warnings().into_iter().for_each(|warning| run.warn(warning));
    if let serde_json::Value::Object(results) = serde_json::to_value(&stable.report)? {
        results.into_iter().for_each(|(key, value)| run.result(&key, value));
    }
    write(run, &arguments, &stable)
}

fn write(run: &mut stage::Run, arguments: &Arguments, stable: &Stabilized) -> anyhow::Result<()> {
    let range = arguments.frames.unwrap_or(FrameRange::ALL);
    if !stable.poses.iter().any(|pose| range.contains(pose.frame)) {
        bail!(
            "{}: has no frames in {range}\n  to do: choose --frames of the take",
            arguments.markers.display()
        );
    }
    let mut head = FrameWriter::<HeadTrajectories>::create(&arguments.out, stable.head.header.clone())?;
    for frame in stable.head.frames.iter().filter(|frame| range.contains(frame.frame)) {
        head.write(frame)?;
    }
    let mut pose = FrameWriter::<HeadPose>::create(&arguments.pose, stable.pose_header.clone())?;
    for frame in stable.poses.iter().filter(|frame| range.contains(frame.frame)) {
        pose.write(frame)?;
    }
    run.publish(vec![head.finish()?, pose.finish()?])
}
