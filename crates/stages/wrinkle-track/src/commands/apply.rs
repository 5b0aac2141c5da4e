//! `wrinkle-track apply`.

use super::shots::Shot;
use anyhow::bail;
use artifact::picture::write_rgb8;
use artifact::{FrameRange, PaintModel};
use rayon::prelude::*;
use stage::{CameraImages, Footage, ImageSource, Run};
use std::path::{Path, PathBuf};
use wrinkle_track::{Classified, Classifier, TrackParams, tidied};

/// Tells which pixels of each image are which paint, and writes masks
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: ImageSource,
    /// What the paints look like (paint-model)
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// Cameras whose images are taken [default: all]
    #[arg(long, value_name = "ID,...", value_delimiter = ',')]
    camera: Vec<String>,
    /// Frames to take
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    range: Option<FrameRange>,
    /// Steps of the opening and the closing that tidy masks, px
    #[arg(long, value_name = "PX", default_value_t = TrackParams::default().tidy_px)]
    tidy_px: usize,
    /// Show all paint in white, instead of each in the colour that it was marked in
    #[arg(long)]
    white: bool,
    /// Folder to write into, <camera>/<frame>.png; must not exist, or be empty
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("apply");
    let params = TrackParams { tidy_px: arguments.tidy_px, ..TrackParams::default() };
    params.check()?;
    run.parameters(&params)?;
    let model: PaintModel = artifact::read_document(&arguments.model)?;
    run.input("model", &arguments.model)?;
    let footage = arguments.source.open(run)?;
    artifact::require_new_folder(&arguments.out)?;
    let jobs = jobs(&footage, arguments)?;
    let count = jobs.iter().map(|job| job.wanted.len()).sum::<usize>();
    let mut progress = run.progress("classifying", Some(count as u64));
    let (mut painted, mut outputs) = (0usize, Vec::with_capacity(count));
    for job in &jobs {
        let mut classifier = run.timed("classify", || Classifier::new(&model))?;
        for block in job.wanted.chunks(BLOCK) {
            let shots: Vec<Shot> = run.timed("decode", || {
                block.par_iter().map(|(_, path)| Shot::read(&job.images, path)).collect::<anyhow::Result<_>>()
            })?;
            let classified: Vec<Classified> = run
                .timed("classify", || shots.iter().map(|shot| classifier.classify(&shot.picture)).collect());
            let tidy = |classified| Mask::of(classified, &model, arguments);
            let masks: Vec<Mask> = run.timed("tidy", || classified.iter().map(tidy).collect());
            let write = |((frame, _), mask): (&(i64, PathBuf), &Mask)| {
                mask.write(&arguments.out.join(&job.id).join(format!("{frame:06}.png")))
            };
            outputs.extend(block.par_iter().zip(&masks).map(write).collect::<artifact::Result<Vec<_>>>()?);
            painted += masks.iter().map(|mask| mask.painted).sum::<usize>();
            block.iter().for_each(|_| progress.step());
        }
    }
    drop(progress);
    run.result("images", count);
    run.result("painted_px", painted);
    run.publish(outputs)
}

/// The images of a camera that are asked for.
struct Job {
    id: String,
    images: CameraImages,
    wanted: Vec<(i64, PathBuf)>,
}

fn jobs(footage: &Footage, arguments: &Arguments) -> anyhow::Result<Vec<Job>> {
    let ids: Vec<String> = match arguments.camera.is_empty() {
        true => footage.ids().into_iter().cloned().collect(),
        false => arguments.camera.clone(),
    };
    let range = arguments.range.unwrap_or(FrameRange::ALL);
    let mut jobs = Vec::new();
    for id in ids {
        let images = footage.camera(&id)?;
        let numbered = footage.numbers().into_iter().zip(&images.paths);
        let wanted = numbered.filter(|(number, _)| range.contains(*number));
        let wanted = wanted.filter_map(|(number, path)| Some((number, path.clone()?))).collect();
        jobs.push(Job { id, images, wanted });
    }
    if jobs.iter().all(|job| job.wanted.is_empty()) {
        bail!("{}: has no image of the frames {range}", footage.path().display());
    }
    Ok(jobs)
}

/// Images in memory at a time.
const BLOCK: usize = 8;

/// A mask in colours.
struct Mask {
    size: [usize; 2],
    rgb: Vec<u8>,
    painted: usize,
}

impl Mask {
    fn of(classified: &Classified, model: &PaintModel, arguments: &Arguments) -> Self {
        let size = [classified.width, classified.height];
        let mut rgb = vec![0; 3 * size[0] * size[1]];
        let mut painted = 0;
        for (index, paint) in model.paints.iter().enumerate() {
            let bits = tidied(&classified.of_paint(index as u8 + 1), arguments.tidy_px);
            let mark = if arguments.white { [255; 3] } else { paint.mark };
            for [column, row] in bits.patches(1).iter().flat_map(|patch| patch.pixels()) {
                rgb[3 * (row * size[0] + column)..][..3].copy_from_slice(&mark);
                painted += 1;
            }
        }
        Self { size, rgb, painted }
    }

    fn write(&self, path: &Path) -> artifact::Result<artifact::Staged> {
        write_rgb8(path, self.size[0], self.size[1], &self.rgb)
    }
}
