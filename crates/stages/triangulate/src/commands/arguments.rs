//! What the user may say.

use anyhow::bail;
use clap::{Parser, ValueEnum};
use stage::Run;
use std::path::PathBuf;
use triangulate::{Filter, PIXELS, Params, TIMES_MS};

/// Finds markers in 3D from their images in calibrated cameras
///
/// Each marker is put where its images are nearest to what the cameras saw; views that are off are left out. Positions are
/// then filtered in space and time, and short gaps are filled; each sample says where it comes from, how well it was
/// measured and by which cameras.
#[derive(Parser)]
#[command(name = "triangulate", version)]
pub(crate) struct Arguments {
    /// Calibrated cameras
    #[arg(long, value_name = "FILE")]
    pub(crate) cameras: PathBuf,
    /// Markers in the images (tracks-2d; - for standard input)
    #[arg(long, value_name = "FILE")]
    pub(crate) tracks: PathBuf,
    /// Time base: tracks of images taken beside the frame's time are interpolated to it, doubled images left out
    #[arg(long, value_name = "FILE")]
    pub(crate) sync: Option<PathBuf>,
    /// Trajectories to write, in world space (trajectories-3d; - for standard output)
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// The same as C3D
    #[arg(long, value_name = "FILE")]
    pub(crate) c3d: Option<PathBuf>,
    /// The same as TRC
    #[arg(long, value_name = "FILE")]
    pub(crate) trc: Option<PathBuf>,
    /// Picture to write: reprojection error of the cameras and coverage of the markers over time (PNG)
    #[arg(long, value_name = "FILE")]
    pub(crate) picture: Option<PathBuf>,
    /// How positions are filtered: along the neighbours' affine motion, or as the paper says
    #[arg(long, value_enum, default_value_t = FilterArgument::Affine, conflicts_with = "no_filter")]
    filter: FilterArgument,
    /// Leave positions as they were measured
    #[arg(long)]
    no_filter: bool,
    /// Standard deviation of the filter's weight over time, ms; fast motion shortens it
    #[arg(long, value_name = "MS", default_value_t = Params::default().smooth_ms, allow_negative_numbers = true, value_parser = milliseconds)]
    smooth_ms: f64,
    /// Longest gap that is filled from neighbours or over time, ms; 0: none
    #[arg(long, value_name = "MS", default_value_t = Params::default().fill_ms, allow_negative_numbers = true, value_parser = milliseconds)]
    fill_ms: f64,
    /// Standard deviation of a track's point, px per axis [default: measured in the first 100 frames]
    #[arg(long, value_name = "PX", allow_negative_numbers = true, value_parser = pixels)]
    noise_px: Option<f64>,
    /// Reprojection error from which a view is left out, px [default: 6 standard deviations of the first 100 frames]
    #[arg(long, value_name = "PX", allow_negative_numbers = true, value_parser = pixels)]
    outlier_px: Option<f64>,
    #[command(flatten)]
    common: stage::Common,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum FilterArgument {
    Affine,
    Paper,
}

fn milliseconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(time) if TIMES_MS.contains(&time) => Ok(time),
        _ => Err(format!("say a time from {} to {} ms", TIMES_MS.start(), TIMES_MS.end())),
    }
}

fn pixels(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(length) if PIXELS.contains(&length) => Ok(length),
        _ => Err(format!("say a length from {} to {} px", PIXELS.start(), PIXELS.end())),
    }
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

impl Arguments {
    /// Refuses names of outputs that will not do, before the work begins.
    pub(crate) fn check_outputs(&self, run: &Run) -> anyhow::Result<()> {
        let wanted =
            [(&self.c3d, "c3d", "--c3d"), (&self.trc, "trc", "--trc"), (&self.picture, "png", "--picture")];
        let named =
            || wanted.iter().filter_map(|(path, ending, option)| Some((path.as_deref()?, *ending, *option)));
        for (path, ending, option) in named() {
            if !path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending)) {
                bail!("{}: does not end in .{ending}\n  to do: give {option} such a name", path.display());
            }
        }
        if let Some(other) = [".c3d", ".trc", ".png"]
            .into_iter()
            .find(|ending| self.out.to_string_lossy().to_lowercase().ends_with(ending))
        {
            bail!(
                "{}: --out writes trajectories-3d as JSON Lines, not {other}\n  to do: name it .jsonl; --c3d, --trc and --picture write the others",
                self.out.display()
            );
        }
        let paths: Vec<&std::path::Path> =
            std::iter::once(self.out.as_path()).chain(named().map(|(path, ..)| path)).collect();
        run.check_folders(&paths)?;
        if artifact::is_standard_stream(&self.out) {
            if self.c3d.is_some() || self.trc.is_some() {
                bail!(
                    "--c3d and --trc are made from the trajectories, which go to standard output\n  to do: name a file with --out"
                );
            }
            return Ok(());
        }
        run.check_outputs(&paths)
    }

    pub(crate) fn params(&self) -> Params {
        Params {
            noise_px: self.noise_px,
            outlier_px: self.outlier_px,
            filter: match (self.no_filter, self.filter) {
                (true, _) => Filter::Off,
                (_, FilterArgument::Affine) => Filter::Affine,
                (_, FilterArgument::Paper) => Filter::Paper,
            },
            smooth_ms: self.smooth_ms,
            fill_ms: self.fill_ms,
        }
    }
}
