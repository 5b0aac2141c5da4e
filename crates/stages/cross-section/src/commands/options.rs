//! Options that measuring and drawing share.

use super::geometry::{Geometry, GeometryOptions};
use anyhow::bail;
use artifact::{FrameReader, Wrinkles2d, Wrinkles2dFrame, Wrinkles2dHeader};
use cross_section::{Model, Params};
use stage::{CameraImages, Footage, ImageSource, Run, check_take};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What is measured, and how.
#[derive(clap::Args)]
pub(crate) struct Options {
    #[command(flatten)]
    source: ImageSource,
    #[command(flatten)]
    geometry: GeometryOptions,
    /// Curves of the wrinkles (wrinkles-2d)
    #[arg(long, value_name = "FILE")]
    wrinkles: PathBuf,
    /// Model: the paper's, exactly, or the extended one
    #[arg(long, value_enum, default_value_t = Which::Extended)]
    model: Which,
    /// Distance of the sections along a wrinkle, px
    #[arg(long, value_name = "PX", default_value_t = Params::default().step_px)]
    step_px: f64,
    /// How far from a curve paint is looked for, px
    #[arg(long, value_name = "PX", default_value_t = Params::default().reach_px)]
    reach_px: f64,
    /// Blur of the lens, standard deviation in px
    #[arg(long, value_name = "PX", default_value_t = Params::default().lens_blur_px)]
    lens_blur_px: f64,
    /// Share of the light that the paint's brightest channel throws back [default: estimated from the channels]
    #[arg(long, value_name = "SHARE")]
    albedo: Option<f64>,
    /// Angle of the camera off the skin's normal, across the wrinkles and towards their right, degrees [default: fitted]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    tilt_deg: Option<f64>,
    /// How much better than any smooth light a valley must explain the image
    #[arg(long, value_name = "GAIN", default_value_t = Params::default().gate)]
    gate: f64,
}

/// The models, as words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Which {
    Paper,
    Extended,
}

/// A camera's images by frame.
pub(crate) struct View {
    pub(crate) camera: CameraImages,
    pub(crate) images: BTreeMap<i64, PathBuf>,
}

/// Everything that is read.
pub(crate) struct Material {
    pub(crate) params: Params,
    pub(crate) header: Wrinkles2dHeader,
    pub(crate) frames: Vec<Wrinkles2dFrame>,
    pub(crate) views: BTreeMap<String, View>,
    pub(crate) geometry: Option<Geometry>,
}

impl Options {
    fn params(&self) -> Params {
        Params {
            model: if self.model == Which::Paper { Model::Paper } else { Model::Extended },
            step_px: self.step_px,
            reach_px: self.reach_px,
            lens_blur_px: self.lens_blur_px,
            albedo: self.albedo,
            tilt_deg: self.tilt_deg,
            gate: self.gate,
        }
    }

    pub(crate) fn read(&self, run: &mut Run) -> anyhow::Result<Material> {
        let params = self.params();
        params.check()?;
        run.parameters(&params)?;
        let footage = self.source.open(run)?;
        let wrinkles = FrameReader::<Wrinkles2d>::open(&self.wrinkles)?;
        run.input("wrinkles", &self.wrinkles)?;
        let mut header = wrinkles.header().clone();
        check_take(run, &self.wrinkles, header.take.as_ref(), footage.take.as_ref())?;
        let known = footage.ids();
        if let Some(id) = header.cameras.iter().find(|id| !known.contains(id)) {
            bail!(
                "{}: camera {id} has no images in {}\n  to do: give the footage that the curves were found in",
                self.wrinkles.display(),
                footage.path().display()
            );
        }
        header.take = footage.take.clone().or(header.take);
        let frames = wrinkles.collect::<artifact::Result<Vec<_>>>()?;
        let views = views(&footage, &header.cameras)?;
        let geometry = self.geometry.read(run)?;
        Ok(Material { params, header, frames, views, geometry })
    }
}

fn views(footage: &Footage, cameras: &[String]) -> anyhow::Result<BTreeMap<String, View>> {
    let view = |id: &String| {
        let mut camera = footage.camera(id)?;
        let paths = std::mem::take(&mut camera.paths);
        let images = footage.numbers().into_iter().zip(paths);
        let images = images.filter_map(|(number, path)| Some((number, path?))).collect();
        Ok((id.clone(), View { camera, images }))
    };
    cameras.iter().map(view).collect()
}
