//! What the user may say.

use clap::{ArgGroup, Parser};
use std::path::PathBuf;
use wrinkle_removal::{DEFAULT_REACH, Detection, Params};

/// Take existing wrinkles out of a scan, keeping its pores and its shape
///
/// Say where the wrinkles are: painted over the texture coordinates, as a vertex set, along measured valleys, or let them be
/// found. Outside the region nothing moves.
#[derive(Parser)]
#[command(version, override_usage = "wrinkle-removal --mesh FILE --unit UNIT --out FILE <WHERE>…",
          group = ArgGroup::new("where").required(true).multiple(true))]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) scan: stage::MeshOptions,
    /// Where to write the scan without wrinkles, in the same unit
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// Picture over the texture coordinates, bright where wrinkles are (PNG; grey is in part)
    #[arg(long, value_name = "FILE", group = "where", help_heading = "Where the wrinkles are")]
    pub(crate) uv_mask: Option<PathBuf>,
    /// Vertices of the wrinkles (vertex-set/1)
    #[arg(long, value_name = "FILE", group = "where", help_heading = "Where the wrinkles are")]
    pub(crate) vertices: Option<PathBuf>,
    /// Valley curves on this scan (valleys/1): the region is what lies within --reach of their widths
    #[arg(long, value_name = "FILE", group = "where", help_heading = "Where the wrinkles are")]
    pub(crate) valleys: Option<PathBuf>,
    /// Frame of the valleys [default: the first]
    #[arg(long, value_name = "N", requires = "valleys", help_heading = "Where the wrinkles are")]
    pub(crate) frame: Option<i64>,
    /// Find wrinkles by their curvature; look at them with --show. With --uv-mask or --vertices: only those in there
    #[arg(long, group = "where", conflicts_with = "valleys", help_heading = "Where the wrinkles are")]
    pub(crate) detect: bool,
    /// Reach of a wrinkle to both sides, in its widths (from the crease to where it crosses the skin around)
    #[arg(long, value_name = "WIDTHS", default_value_t = DEFAULT_REACH, help_heading = "Where the wrinkles are")]
    pub(crate) reach: f64,
    /// Width of the wrinkles to detect
    #[arg(long, value_name = "MM", default_value_t = Detection::default().width_mm, requires = "detect",
          help_heading = "Where the wrinkles are")]
    pub(crate) width_mm: f64,
    /// Least curvature across a wrinkle that is detected, 1/mm
    #[arg(long, value_name = "PER_MM", default_value_t = Detection::default().curvature_per_mm, requires = "detect",
          help_heading = "Where the wrinkles are")]
    pub(crate) curvature_per_mm: f64,
    /// Where to write a picture of the scan, the region on it, and the result (PNG)
    #[arg(long, value_name = "FILE")]
    pub(crate) show: Option<PathBuf>,
    /// Share of each wrinkle to take out, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = Params::default().strength)]
    pub(crate) strength: f64,
    /// Relief of shorter wavelength is fine detail, which stays
    #[arg(long, value_name = "MM", default_value_t = Params::default().detail_mm)]
    pub(crate) detail_mm: f64,
    /// Fine detail beyond this many times its level on the skin around is the edge of a crease, and is cut down; 0 keeps it
    #[arg(long, value_name = "TIMES", default_value_t = Params::default().detail_limit)]
    pub(crate) detail_limit: f64,
    /// Relief of longer wavelength is the face's shape, which stays: some 20 widths of the widest wrinkle, 100 for nasolabial folds;
    /// 0 leaves all of the region to the surface that bends least
    #[arg(long, value_name = "MM", default_value_t = Params::default().shape_mm)]
    pub(crate) shape_mm: f64,
    /// Width of the band inside the region's rim over which the removal sets in
    #[arg(long, value_name = "MM", default_value_t = Params::default().feather_mm)]
    pub(crate) feather_mm: f64,
    /// The three steps as the paper prints them: a soft split by Laplacian smoothing, no limit, no wavelength of shape
    #[arg(long, conflicts_with_all = ["detail_limit", "shape_mm"])]
    pub(crate) paper: bool,
    #[command(flatten)]
    pub(crate) common: stage::Common,
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}
