//! Calibration from a board.

use super::footage::{Footage, check_corners, check_outputs};
use super::number;
use super::shared::{Lens, Loss, of_file, read_corners, tell};
use artifact::Staged;
use calibrate::{Calibration, Corners, Params, calibrate_board};
use stage::Run;
use std::path::{Path, PathBuf};

/// What is said of pictures, and would say nothing of corners that were found.
#[cfg(feature = "detect")]
const OF_PICTURES: [&str; 11] = [
    "folder",
    "name",
    "images",
    "every",
    "board",
    "chessboard",
    "charuco",
    "square_mm",
    "marker_mm",
    "dictionary",
    "see_through",
];

/// Calibrate all cameras from a board held before them
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Corners that were found, as `calibrate detect` writes them
    #[cfg(feature = "detect")]
    #[arg(long, value_name = "FILE", conflicts_with_all = OF_PICTURES, required_unless_present_any = ["folder", "images"])]
    corners: Option<PathBuf>,
    /// Corners that were found, as `calibrate detect` writes them (built with the feature `detect`)
    #[cfg(not(feature = "detect"))]
    #[arg(long, value_name = "FILE")]
    corners: PathBuf,
    #[cfg(feature = "detect")]
    #[command(flatten)]
    pictures: super::detect::Pictures,
    #[command(flatten)]
    footage: Footage,
    /// Where to write the cameras
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Where to draw residuals and coverage of each camera, as PNG
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Distortion of the lenses
    #[arg(long, value_enum, default_value = "tangential")]
    lens: Lens,
    /// Pixels are square: one focal length per camera
    #[arg(long)]
    square_pixels: bool,
    /// The principal point is the image's middle
    #[arg(long)]
    centered: bool,
    /// How residuals are weighed
    #[arg(long, value_enum, default_value = "huber")]
    loss: Loss,
    /// From which length on a residual counts less than its square [default: from their spread]
    #[arg(long, value_name = "PX", allow_negative_numbers = true, value_parser = number::positive)]
    scale_px: Option<f64>,
    /// The camera whose space is the world [default: the board of the first frame is]
    #[arg(long, value_name = "ID", conflicts_with = "world_frame")]
    world_camera: Option<String>,
    /// The frame whose board is the world
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    world_frame: Option<i64>,
    /// Corners that a view must show to be used
    #[arg(long, value_name = "N", default_value_t = Params::default().min_corners, value_parser = number::corners)]
    min_corners: usize,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("board");
    let params = arguments.params();
    params.check()?;
    run.parameters(&params)?;
    let corners = arguments.corners(run)?;
    check_corners(run, arguments.source(), &corners)?;
    let calibration = run
        .timed("calibrate", || calibrate_board(&corners, &params))
        .map_err(|error| of_file(arguments.source(), &error))?;
    tell(run, &calibration.report)?;
    let outputs = arguments.outputs(&calibration)?;
    run.publish(outputs)
}

impl Arguments {
    fn params(&self) -> Params {
        Params {
            lens: self.lens.into(),
            square_pixels: self.square_pixels,
            centered: self.centered,
            robust: self.loss.into(),
            scale_px: self.scale_px,
            world_camera: self.world_camera.clone(),
            world_frame: self.world_frame,
            min_corners: self.min_corners,
        }
    }

    /// Where the corners come from.
    #[cfg(feature = "detect")]
    fn source(&self) -> &Path {
        self.corners.as_deref().or(self.pictures.folder()).unwrap_or(Path::new("the pictures"))
    }

    #[cfg(not(feature = "detect"))]
    fn source(&self) -> &Path {
        &self.corners
    }

    fn corners(&self, run: &mut Run) -> anyhow::Result<Corners> {
        let outputs = [Some(self.out.as_path()), self.picture.as_deref()];
        #[cfg(feature = "detect")]
        let Some(path) = &self.corners else {
            return self.pictures.corners(run, &self.footage, &outputs);
        };
        #[cfg(not(feature = "detect"))]
        let path = &self.corners;
        let mut corners = read_corners(run, path)?;
        self.footage.apply(run, path, &mut corners)?;
        check_outputs(run, &outputs)?;
        Ok(corners)
    }

    fn outputs(&self, calibration: &Calibration) -> anyhow::Result<Vec<Staged>> {
        let mut outputs = vec![artifact::write_document(&self.out, &calibration.rig)?];
        if let Some(path) = &self.picture {
            let sheet = calibrate::draw(&calibration.rig, &calibration.residuals)?;
            outputs.push(artifact::picture::write_rgb8(path, sheet.width, sheet.height, &sheet.rgb)?);
        }
        Ok(outputs)
    }
}
