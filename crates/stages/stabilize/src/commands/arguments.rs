//! What the user may say.

use artifact::{FrameRange, Unit};
use clap::{Parser, ValueEnum};
use stabilize::{JumpLimit, Params, Swaps, TIMES_MS};
use std::path::PathBuf;

/// Takes the head's rigid motion out of marker trajectories
///
/// Writes the markers in head space (= world space at the reference frame) and the head's pose in every frame, so
/// that world = world_from_head · head. Without --head-markers, the markers that deform least are taken for the head.
#[derive(Parser)]
#[command(name = "stabilize", version)]
pub(crate) struct Arguments {
    /// Markers in world space: trajectories-3d (.jsonl, - for standard input), .c3d, .trc or .csv
    #[arg(long, value_name = "FILE")]
    pub(crate) markers: PathBuf,
    /// Unit of the markers' coordinates, where the file may not say it
    #[arg(long, value_name = "mm|cm|m")]
    pub(crate) marker_unit: Option<Unit>,
    /// Take manifest: gives the frame rate and is referred to by what is written
    #[arg(long, value_name = "FILE")]
    pub(crate) take: Option<PathBuf>,
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
    #[arg(long, value_name = "MS", default_value_t = 60.0, allow_negative_numbers = true, value_parser = milliseconds)]
    smooth_ms: f64,
    /// Step against its neighbours from which a marker has jumped, mm per frame
    #[arg(long, value_name = "MM|auto|off", default_value = "auto", allow_negative_numbers = true)]
    jump_mm: JumpLimit,
    /// Longest gap that is filled, ms; 0: none
    #[arg(long, value_name = "MS", default_value_t = 100.0, allow_negative_numbers = true, value_parser = milliseconds)]
    fill_ms: f64,
    /// Samples under another marker's name: take them out, or give them back where it is clear whose they are
    #[arg(long, value_enum, default_value_t = SwapsArgument::Mend)]
    swaps: SwapsArgument,
    /// Write the head markers among the trajectories too
    #[arg(long)]
    keep_head_markers: bool,
    /// Frames to write; poses and places are found from the whole take all the same
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    pub(crate) frames: Option<FrameRange>,
    /// Trajectories to write, in head space (head-trajectories; - for standard output)
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// Poses to write (head-pose)
    #[arg(long, value_name = "FILE")]
    pub(crate) pose: PathBuf,
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

fn milliseconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(time) if TIMES_MS.contains(&time) => Ok(time),
        _ => Err(format!("say a time from {} to {} ms", TIMES_MS.start(), TIMES_MS.end())),
    }
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

impl Arguments {
    pub(crate) fn params(&self) -> Params {
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
