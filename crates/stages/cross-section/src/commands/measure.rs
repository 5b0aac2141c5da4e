//! `cross-section measure`.

use super::footage::{Footage, Image, Source, check_take};
use anyhow::bail;
use artifact::{
    Curve2d, FrameRange, FrameReader, FrameWriter, Profile, Section, SectionState, Sections, SectionsFrame, SectionsHeader,
    Transfer, Wrinkles2d, Wrinkles2dFrame,
};
use cross_section::{Model, Painted, Params, estimate_albedo, failed, measure, painted};
use rayon::prelude::*;
use serde::Serialize;
use stage::Run;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Measures the sections of all wrinkles in all frames
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// Curves of the wrinkles (wrinkles-2d)
    #[arg(long, value_name = "FILE")]
    wrinkles: PathBuf,
    /// Frames to measure [default: all]
    #[arg(long = "range", value_name = "A-B", allow_hyphen_values = true)]
    range: Option<FrameRange>,
    /// Fit the model exactly as the paper has it, instead of the extended one
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
    /// Share of the light that the paint's brightest channel throws back [default: estimated]
    #[arg(long, value_name = "SHARE")]
    albedo: Option<f64>,
    /// Angle of the camera off the skin's normal across the wrinkles, degrees [default: fitted]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    tilt_deg: Option<f64>,
    /// How much better than flat skin a valley must explain the image
    #[arg(long, value_name = "GAIN", default_value_t = Params::default().gate)]
    gate: f64,
    /// Sections to write (sections; - for standard output)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// The models, as words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Which {
    Paper,
    Extended,
}

impl Arguments {
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
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("measure");
    let params = arguments.params();
    params.check()?;
    run.parameters(&params)?;
    let footage = arguments.source.open(run)?;
    let wrinkles = FrameReader::<Wrinkles2d>::open(&arguments.wrinkles)?;
    run.input("wrinkles", &arguments.wrinkles)?;
    let header = wrinkles.header().clone();
    check_take(run, &arguments.wrinkles, header.take.as_ref(), footage.take.as_ref())?;
    let known = footage.ids();
    if let Some(id) = header.cameras.iter().find(|id| !known.contains(id)) {
        bail!("{}: camera {id} has no images in {}", arguments.wrinkles.display(), footage.path().display());
    }
    let range = arguments.range.unwrap_or(FrameRange::ALL);
    let frames = wrinkles.collect::<artifact::Result<Vec<_>>>()?;
    let frames: Vec<Wrinkles2dFrame> = frames.into_iter().filter(|frame| range.contains(frame.frame)).collect();
    let profile = if params.model == Model::Paper { Profile::S } else { Profile::Rounded };
    let header = SectionsHeader {
        cameras: header.cameras,
        wrinkles: header.wrinkles,
        profile,
        rate: header.rate,
        take: footage.take.clone().or(header.take),
    };
    let views = views(&footage, &header.cameras)?;
    let mut progress = run.progress("measure", Some(frames.len() as u64));
    let mut tally = Tally::default();
    let mut writer = FrameWriter::<Sections>::create(&arguments.out, header)?;
    for frame in &frames {
        let measured = frame_sections(frame, &views, &params, &mut tally)?;
        writer.write(&measured)?;
        progress.step();
    }
    drop(progress);
    tally.report(run);
    run.publish(vec![writer.finish()?])
}

/// A camera's images by frame.
struct View {
    transfer: Transfer,
    size: [u32; 2],
    images: BTreeMap<i64, PathBuf>,
}

fn views(footage: &Footage, cameras: &[String]) -> anyhow::Result<BTreeMap<String, View>> {
    let view = |id: &String| {
        let camera = footage.camera(id)?;
        let images = footage.numbers().into_iter().zip(camera.paths);
        let images = images.filter_map(|(number, path)| Some((number, path?))).collect();
        Ok((id.clone(), View { transfer: camera.transfer, size: camera.size, images }))
    };
    cameras.iter().map(view).collect()
}

#[derive(Debug, Default, Serialize)]
struct Tally {
    images: usize,
    missing: Vec<String>,
    wrinkles: usize,
    failed: usize,
    flat: usize,
    sections: usize,
    measured: usize,
    saturated: usize,
    black: usize,
    /// Sum over images.
    albedo: f64,
}

fn frame_sections(
    frame: &Wrinkles2dFrame,
    views: &BTreeMap<String, View>,
    params: &Params,
    tally: &mut Tally,
) -> anyhow::Result<SectionsFrame> {
    let mut sections = BTreeMap::new();
    for (camera, curves) in &frame.curves {
        let Some(view) = views.get(camera) else { continue };
        let Some(path) = view.images.get(&frame.frame) else {
            tally.missing.push(format!("{} of camera {camera}", frame.frame));
            continue;
        };
        let image = Image::read(path, view.size)?;
        let picture = image.picture()?;
        let light = view.transfer.light_of_codes();
        let curves: Vec<(&String, &Curve2d)> = curves.iter().collect();
        let paints: Vec<Option<Painted>> =
            curves.par_iter().map(|(_, curve)| painted(&picture, &light, curve, params)).collect();
        let bands = paints.iter().flatten().map(|painted| &painted.band);
        tally.saturated += bands.clone().map(|band| band.saturated).sum::<usize>();
        tally.black += bands.clone().map(|band| band.black).sum::<usize>();
        let albedo = params.albedo.unwrap_or_else(|| estimate_albedo(bands));
        let found: Vec<Vec<Section>> = curves
            .par_iter()
            .zip(&paints)
            .map(|((_, curve), paint)| match paint {
                Some(paint) => measure(paint, params, albedo).sections,
                None => failed(curve, params),
            })
            .collect();
        tally.images += 1;
        tally.albedo += albedo;
        let mut by_wrinkle = BTreeMap::new();
        for ((id, _), found) in curves.into_iter().zip(found) {
            tally.add(&found);
            by_wrinkle.insert(id.clone(), found);
        }
        sections.insert(camera.clone(), by_wrinkle);
    }
    Ok(SectionsFrame { frame: frame.frame, sections })
}

impl Tally {
    fn add(&mut self, sections: &[Section]) {
        let count = |state: SectionState| sections.iter().filter(|section| section.state == state).count();
        self.wrinkles += 1;
        self.sections += sections.len();
        self.measured += count(SectionState::Measured);
        let failed = count(SectionState::Failed) == sections.len();
        self.failed += usize::from(failed);
        self.flat += usize::from(!failed && count(SectionState::Measured) == 0);
    }

    fn report(&self, run: &mut Run) {
        run.result("images", self.images);
        run.result("wrinkles", self.wrinkles);
        run.result("failed", self.failed);
        run.result("flat", self.flat);
        run.result("sections", self.sections);
        run.result("measured", self.measured);
        run.result("saturated_pixels", self.saturated);
        run.result("black_pixels", self.black);
        run.result("albedo", self.albedo / self.images.max(1) as f64);
        if !self.missing.is_empty() {
            let first: Vec<&str> = self.missing.iter().take(5).map(String::as_str).collect();
            let more = if self.missing.len() > 5 { " …" } else { "" };
            run.warn(format!("no image of {} frames that have curves: {}{more}", self.missing.len(), first.join(", ")));
        }
        if self.saturated + self.black > 0 {
            run.warn(format!(
                "{} saturated and {} black pixels in the paint were left out; expose so that neither occurs",
                self.saturated, self.black
            ));
        }
    }
}
