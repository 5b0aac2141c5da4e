//! Refinement of cameras that are known.

use super::footage::{self, check_corners, check_outputs, check_points};
use super::number;
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
    /// Take manifest: the cameras' image sizes are checked
    #[arg(long, value_name = "FILE")]
    take: Option<PathBuf>,
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
    #[arg(long, value_name = "PX", allow_negative_numbers = true, value_parser = number::positive)]
    scale_px: Option<f64>,
    /// Corners that a view must show to be used
    #[arg(long, value_name = "N", default_value_t = RefineParams::default().min_corners, value_parser = number::corners)]
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
    if let Some(path) = &arguments.take {
        footage::check_rig(&arguments.cameras, &rig, &stage::load_take(run, path)?.0)?;
    }
    let refined = match (&arguments.corners, &arguments.tracks) {
        (Some(path), _) => arguments.with_corners(run, &rig, path, &params)?,
        (None, Some(path)) => arguments.with_tracks(run, &rig, path, &params)?,
        (None, None) => anyhow::bail!("neither --corners nor --tracks is given"),
    };
    tell(run, &refined.report)?;
    warn_of_guesses(run, &refined, &params);
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
        check_corners(run, path, &corners)?;
        check_outputs(run, &self.all_outputs())?;
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
        for (c, id) in header.cameras.iter().enumerate() {
            let Some(known) = rig.cameras.get(id) else { continue };
            let seen = frames.iter().filter_map(|frame| frame.cameras[c].as_ref()).flatten().flatten();
            let seen: Vec<_> = seen.map(|sample| sample.at.coords).collect();
            check_points(run, path, id, known.camera.image_size, &seen)?;
        }
        check_outputs(run, &self.all_outputs())?;
        run.timed("refine", || refine_with_tracks(rig, &header, &frames, params))
            .map_err(|error| of_file(path, &error))
    }

    fn all_outputs(&self) -> [Option<&Path>; 2] {
        [Some(&self.out), self.picture.as_deref()]
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

/// Standard deviations beyond which what was set free is no result: of focal lengths as a share, of principal points in px, of
/// places in mm.
const SURE_FOCAL: f64 = 0.003;
const SURE_CENTER_PX: f64 = 3.0;
const SURE_PLACE_MM: f64 = 2.0;

/// Warns of cameras whose points do not tell what was set free.
fn warn_of_guesses(run: &mut Run, refined: &Refined, params: &RefineParams) {
    let mut guessed = Vec::new();
    for (id, known) in &refined.rig.cameras {
        let is_used = refined.report.cameras.get(id).is_some_and(|camera| camera.corners > 0);
        if !is_used || params.hold.contains(id) {
            continue;
        }
        let Some(deviation) = known.deviation else {
            run.warn(format!("camera {id}: the points do not tell what was set free; set less free"));
            guessed.push(id.clone());
            continue;
        };
        let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let focal = largest(&deviation.focal_px) / known.camera.lens.focal_px.x;
        let (center, place) = (largest(&deviation.center_px), largest(&deviation.translation_mm));
        if focal > SURE_FOCAL || center > SURE_CENTER_PX || place > SURE_PLACE_MM {
            run.warn(format!(
                "camera {id}: the points hardly tell what was set free: focal length ±{:.2} %, principal point ±{center:.1} px, place \
                 ±{place:.1} mm (standard deviations); set less free, or use a board",
                100.0 * focal
            ));
            guessed.push(id.clone());
        }
    }
    run.result("undetermined", guessed);
}
