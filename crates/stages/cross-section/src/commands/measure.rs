//! `cross-section measure`.

use super::footage::Image;
use super::options::{Options, View};
use artifact::{
    Curve2d, FrameRange, FrameWriter, Profile, Section, SectionState, Sections, SectionsFrame,
    SectionsHeader, Wrinkles2dFrame,
};
use cross_section::{Model, Painted, Params, estimate_albedo, failed, is_subsampled, measure, painted};
use rayon::prelude::*;
use stage::Run;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// Measures the sections of all wrinkles in all images
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    options: Options,
    /// Frames to measure [default: all]; parts join to the whole
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    range: Option<FrameRange>,
    /// Sections to write (sections; - for standard output)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("measure");
    let material = arguments.options.read(run)?;
    let (params, views) = (&material.params, &material.views);
    let range = arguments.range.unwrap_or(FrameRange::ALL);
    let frames: Vec<&Wrinkles2dFrame> =
        material.frames.iter().filter(|frame| range.contains(frame.frame)).collect();
    let header = SectionsHeader {
        cameras: material.header.cameras.clone(),
        wrinkles: material.header.wrinkles.clone(),
        profile: if params.model == Model::Paper { Profile::S } else { Profile::Rounded },
        rate: material.header.rate,
        take: material.header.take.clone(),
    };
    let mut progress = run.progress("measure", Some(frames.len() as u64));
    let mut tally = Tally::default();
    let mut writer = FrameWriter::<Sections>::create(&arguments.out, header)?;
    for frame in frames {
        let sections = run.timed("frames", || frame_sections(frame, views, params, &mut tally))?;
        writer.write(&sections)?;
        progress.step();
    }
    drop(progress);
    tally.report(run);
    run.publish(vec![writer.finish()?])
}

/// What became of everything.
#[derive(Debug, Default)]
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
    /// Cameras whose colours are stored at half size.
    subsampled: BTreeSet<String>,
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
        if is_subsampled(&picture) == Some(true) {
            tally.subsampled.insert(camera.clone());
        }
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
            run.warn(format!(
                "no image of {} frames that have curves: {}{more}",
                self.missing.len(),
                first.join(", ")
            ));
        }
        for camera in &self.subsampled {
            run.warn(format!(
                "camera {camera}: colours look as if they were stored at half the size of the image (4:2:0), which blurs valleys and the edges of paint; film or export without chroma subsampling"
            ));
        }
        if self.saturated + self.black > 0 {
            run.warn(format!(
                "{} saturated and {} black pixels in the paint were left out; expose so that neither occurs",
                self.saturated, self.black
            ));
        }
    }
}
