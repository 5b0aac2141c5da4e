//! `cross-section measure`.

use super::geometry::{Face, Geometry};
use super::options::{Options, View};
use artifact::picture::is_subsampled;
use artifact::{
    Curve2d, FrameRange, FrameWriter, Profile, SectionState, Sections, SectionsFrame, SectionsHeader,
    Wrinkles2dFrame,
};
use cross_section::{ImageSections, ImageWrinkle, Model, Params, steadied};
use stage::Run;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::PathBuf;

/// Measures the sections of all wrinkles in all images
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    options: Options,
    /// Frames to measure [default: all]; parts join to the whole
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    range: Option<FrameRange>,
    /// Smooth widths and depths over so many images to both sides; 0 is none
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=50))]
    smooth: u8,
    /// Sections to write (sections; - for standard output)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("measure");
    let material = arguments.options.read(run)?;
    let (params, views) = (&material.params, &material.views);
    let range = arguments.range.unwrap_or(FrameRange::ALL);
    let reach = usize::from(arguments.smooth);
    let (wanted, halo) = span(&material.frames, range, reach);
    let frames = &material.frames[halo.clone()];
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
    let mut all: Vec<SectionsFrame> = Vec::with_capacity(frames.len());
    let mut motion = material.geometry.as_ref().map(Geometry::cursor).transpose()?.flatten();
    for frame in frames {
        let face = match &material.geometry {
            Some(geometry) => geometry.face(motion.as_mut(), frame.frame)?.map(|face| (geometry, face)),
            None => None,
        };
        all.push(frame_sections(run, frame, views, face.as_ref(), params, &mut tally)?);
        progress.step();
    }
    for at in wanted.start - halo.start..wanted.end - halo.start {
        let is_smooth = reach > 0;
        writer.write(&if is_smooth { steadied(&all, at, reach) } else { all[at].clone() })?;
    }
    drop(progress);
    tally.report(run);
    run.publish(vec![writer.finish()?])
}

/// The frames of a range, and those that smoothing looks at beside them: so many to both sides, so that parts join to the whole.
fn span(frames: &[Wrinkles2dFrame], range: FrameRange, reach: usize) -> (Range<usize>, Range<usize>) {
    let inside = |frame: &Wrinkles2dFrame| range.contains(frame.frame);
    let first = frames.iter().position(inside).unwrap_or(0);
    let end = frames.iter().rposition(inside).map_or(first, |last| last + 1);
    (first..end, first.saturating_sub(reach)..(end + reach).min(frames.len()))
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
    run: &mut Run,
    frame: &Wrinkles2dFrame,
    views: &BTreeMap<String, View>,
    face: Option<&(&Geometry, Face)>,
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
        let image = run.timed("decode", || view.camera.read_8_bits(path))?;
        let picture = image.picture();
        if is_subsampled(picture.width, picture.rgb) == Some(true) {
            tally.subsampled.insert(camera.clone());
        }
        let light = view.camera.transfer.light_of_codes();
        let paths: Vec<&Curve2d> = curves.values().collect();
        let found = {
            let surface = face.and_then(|(geometry, face)| geometry.surface(camera, face));
            run.timed("fit", || ImageSections::of(&picture, &light, &paths, surface.as_ref(), params))
        };
        tally.add(&found);
        let by_wrinkle =
            curves.keys().cloned().zip(found.wrinkles.into_iter().map(|wrinkle| wrinkle.sections));
        sections.insert(camera.clone(), by_wrinkle.collect());
    }
    Ok(SectionsFrame { frame: frame.frame, sections })
}

impl Tally {
    fn add(&mut self, image: &ImageSections) {
        self.images += 1;
        self.albedo += image.albedo;
        let [saturated, black] = image.clipped();
        (self.saturated, self.black) = (self.saturated + saturated, self.black + black);
        for ImageWrinkle { sections, .. } in &image.wrinkles {
            let count =
                |state: SectionState| sections.iter().filter(|section| section.state == state).count();
            self.wrinkles += 1;
            self.sections += sections.len();
            self.measured += count(SectionState::Measured);
            let failed = count(SectionState::Failed) == sections.len();
            self.failed += usize::from(failed);
            self.flat += usize::from(!failed && count(SectionState::Measured) == 0);
        }
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
                "camera {camera}: colours look as if they were stored at half the size of the image (4:2:0 or 4:2:2), which blurs valleys and the edges of paint; film or export without chroma subsampling"
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
