//! The command line.

use artifact::{FrameRange, Unit};
use clap::Parser;
use serde::{Serialize, Serializer};
use std::path::PathBuf;

/// Says how far two artifacts of one kind are apart, in millimetres or levels, and where most.
///
/// Meshes (.obj, .ply), sequences (large-scale .json, .pc2), markers (.jsonl, .c3d, .trc, .csv), handles (.jsonl) and
/// images (.png) are told apart by their endings and schemas. Vertices are paired by index, markers by id and frame;
/// nothing is aligned first. The table goes to standard output. Exit code 1: they differ by more than the tolerance, or
/// cannot be compared.
#[derive(Debug, Parser)]
#[command(name = "artifact-diff", version, max_term_width = 100)]
pub(crate) struct Arguments {
    /// First file
    pub(crate) first: PathBuf,
    /// Second file
    pub(crate) second: PathBuf,
    #[command(flatten)]
    pub(crate) parameters: Parameters,
    #[command(flatten)]
    common: stage::Common,
}

/// How to compare.
#[derive(Debug, clap::Args, Serialize)]
pub(crate) struct Parameters {
    /// Unit of both files' coordinates, where they do not say it: mm, cm or m
    #[arg(long, visible_alias = "marker-unit")]
    pub(crate) unit: Option<Unit>,
    /// Unit of the second file's coordinates, if it is another one
    #[arg(long, value_name = "UNIT")]
    pub(crate) second_unit: Option<Unit>,
    /// Also report the vertices of this set (meshes and sequences); with a tolerance, only such sets are judged
    #[arg(long, value_name = "JSON")]
    #[serde(skip)]
    pub(crate) region: Vec<PathBuf>,
    /// Compare only these frames, e.g. 1001-1100
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    #[serde(serialize_with = "as_text")]
    pub(crate) frames: Option<FrameRange>,
    /// Largest difference that passes, mm
    #[arg(long, value_name = "MM", allow_hyphen_values = true, value_parser = parse_tolerance)]
    pub(crate) tolerance_mm: Option<f64>,
    /// Largest difference of images that passes, in levels of 255 or 65535
    #[arg(long, value_name = "LEVELS", allow_hyphen_values = true, value_parser = parse_tolerance, conflicts_with = "tolerance_mm")]
    pub(crate) tolerance_levels: Option<f64>,
    /// Also fail where they differ beside the numbers: faces, groups, markers or frames on one side only
    #[arg(long)]
    pub(crate) strict: bool,
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

impl Parameters {
    pub(crate) fn takes(&self, frame: i64) -> bool {
        self.frames.is_none_or(|range| range.contains(frame))
    }
}

fn as_text<S: Serializer>(range: &Option<FrameRange>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&range.unwrap_or(FrameRange::ALL))
}

fn parse_tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(tolerance) if tolerance.is_finite() && tolerance >= 0.0 => Ok(tolerance),
        _ => Err(format!("'{text}' is not a tolerance: a number from 0 on")),
    }
}
