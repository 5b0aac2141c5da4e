//! Refinement of cameras that are known.

use super::shared::{Lens, Loss, of_file, read_corners, tell};
use artifact::{CameraRig, FrameRange, FrameReader, Staged, Tracks2d, Tracks2dFrame};
use calibrate::bundle::{Focal, Free};
use calibrate::{LensModel, RefineParams, Refined, refine_with_corners, refine_with_tracks};
use clap::ValueEnum;
use stage::Run;
use std::path::{Path, PathBuf};

/// Make known cameras better, with corners of a board or with tracks
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Cameras to start from
    #[arg(long, value_name = "FILE")]
    cameras: PathBuf,
    /// Corners of a board, as `calibrate detect` writes them
    #[arg(long, value_name = "FILE", required_unless_present = "tracks", conflicts_with = "tracks")]
    corners: Option<PathBuf>,
    /// Markers tracked in the images
    #[arg(long, value_name = "FILE")]
    tracks: Option<PathBuf>,
    /// Use only these frames, e.g. 1001-1100
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    frames: Option<FrameRange>,
    /// Use every so many frames of the tracks
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    every: u32,
    /// What moves
    #[arg(long, value_enum, value_delimiter = ',', default_values = ["pose"])]
    free: Vec<Part>,
    /// Which distortion moves, with --free distortion
    #[arg(long, value_enum, default_value = "tangential")]
    lens: Lens,
    /// Cameras that stay as they are
    #[arg(long, value_name = "ID", value_delimiter = ',')]
    hold: Vec<String>,
    /// How residuals are weighed
    #[arg(long, value_enum, default_value = "huber")]
    loss: Loss,
    /// From which length on a residual counts less than its square [default: from their spread]
    #[arg(long, value_name = "PX")]
    scale_px: Option<f64>,
    /// Corners that a view must show to be used
    #[arg(long, value_name = "N", default_value_t = RefineParams::default().min_corners)]
    min_corners: usize,
    /// Where to write the cameras
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Where to draw residuals and coverage of each camera, as PNG
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

/// A part of a camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Its place and direction
    Pose,
    /// Focal lengths, in proportion
    Focal,
    /// Focal lengths, each by itself
    Aspect,
    /// The principal point
    Center,
    /// Distortion
    Distortion,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("refine");
    let params = arguments.params();
    run.parameters(&params)?;
    let rig: CameraRig = artifact::read_document(&arguments.cameras)?;
    run.input("cameras", &arguments.cameras)?;
    let refined = match (&arguments.corners, &arguments.tracks) {
        (Some(path), _) => arguments.with_corners(run, &rig, path, &params)?,
        (None, Some(path)) => arguments.with_tracks(run, &rig, path, &params)?,
        (None, None) => anyhow::bail!("neither --corners nor --tracks is given"),
    };
    tell(run, &refined.report)?;
    let outputs = arguments.outputs(&refined)?;
    run.publish(outputs)
}

impl Arguments {
    fn params(&self) -> RefineParams {
        let has = |part| self.free.contains(&part);
        let focal = match (has(Part::Aspect), has(Part::Focal)) {
            (true, _) => Focal::Free,
            (false, true) => Focal::Tied,
            (false, false) => Focal::Held,
        };
        let distortion =
            if has(Part::Distortion) { LensModel::from(self.lens).free() } else { LensModel::Pinhole.free() };
        RefineParams {
            free: Free { pose: has(Part::Pose), focal, center: has(Part::Center), distortion },
            hold: self.hold.iter().cloned().collect(),
            robust: self.loss.into(),
            scale_px: self.scale_px,
            min_corners: self.min_corners,
        }
    }

    fn with_corners(
        &self,
        run: &mut Run,
        rig: &CameraRig,
        path: &Path,
        params: &RefineParams,
    ) -> anyhow::Result<Refined> {
        let mut corners = read_corners(run, path)?;
        let wanted = self.frames.unwrap_or(FrameRange::ALL);
        corners.frames.retain(|frame| wanted.contains(frame.frame));
        run.timed("refine", || refine_with_corners(rig, &corners, params))
            .map_err(|error| of_file(path, &error))
    }

    fn with_tracks(
        &self,
        run: &mut Run,
        rig: &CameraRig,
        path: &Path,
        params: &RefineParams,
    ) -> anyhow::Result<Refined> {
        let reader = FrameReader::<Tracks2d>::open(path)?;
        let header = reader.header().clone();
        let wanted = self.frames.unwrap_or(FrameRange::ALL);
        let is_wanted = |frame: &artifact::Result<Tracks2dFrame>| {
            frame.as_ref().map_or(true, |frame| wanted.contains(frame.frame))
        };
        let frames = reader.filter(is_wanted).step_by(self.every as usize);
        let frames = frames.collect::<artifact::Result<Vec<Tracks2dFrame>>>()?;
        run.input("tracks", path)?;
        run.timed("refine", || refine_with_tracks(rig, &header, &frames, params))
            .map_err(|error| of_file(path, &error))
    }

    fn outputs(&self, refined: &Refined) -> anyhow::Result<Vec<Staged>> {
        let mut outputs = vec![artifact::write_document(&self.out, &refined.rig)?];
        if let Some(path) = &self.picture {
            let sheet = calibrate::draw(&refined.rig, &refined.residuals)?;
            outputs.push(artifact::picture::write_rgb8(path, sheet.width, sheet.height, &sheet.rgb)?);
        }
        Ok(outputs)
    }
}
