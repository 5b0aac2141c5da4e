//! `wrinkle-track apply`.

use super::shots::Shot;
use anyhow::bail;
use artifact::picture::write_rgb8;
use artifact::{FrameRange, PaintModel};
use rayon::prelude::*;
use stage::{ImageSource, Run};
use std::path::{Path, PathBuf};
use wrinkle_track::{Classifier, TrackParams, tidied};

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
    let ids: Vec<String> = match arguments.camera.is_empty() {
        true => footage.ids().into_iter().cloned().collect(),
        false => arguments.camera.clone(),
    };
    let range = arguments.range.unwrap_or(FrameRange::ALL);
    let numbers = footage.numbers();
    let mut jobs = Vec::new();
    for id in &ids {
        let images = footage.camera(id)?;
        let wanted: Vec<(i64, PathBuf)> = numbers
            .iter()
            .zip(&images.paths)
            .filter(|(number, _)| range.contains(**number))
            .filter_map(|(number, path)| Some((*number, path.clone()?)))
            .collect();
        jobs.push((id, images, wanted));
    }
    let count: usize = jobs.iter().map(|(_, _, wanted)| wanted.len()).sum();
    if count == 0 {
        bail!("{}: has no image of the frames {range}", footage.path().display());
    }
    let mut progress = run.progress("classifying", Some(count as u64));
    let (mut painted, mut outputs) = (0usize, Vec::with_capacity(count));
    for (id, images, wanted) in &jobs {
        let mut classifier = Classifier::new(&model)?;
        // Images of a few frames are in memory at a time.
        for block in wanted.chunks(BLOCK) {
            let shots: Vec<Shot> = run.timed("decode", || {
                block.par_iter().map(|(_, path)| Shot::read(images, path)).collect::<anyhow::Result<_>>()
            })?;
            let masks: Vec<Mask> = run.timed("classify", || {
                shots.iter().map(|shot| Mask::of(&mut classifier, shot, &model, arguments)).collect()
            });
            let write = |((frame, _), mask): (&(i64, PathBuf), &Mask)| {
                let path = arguments.out.join(id).join(format!("{frame:06}.png"));
                mask.write(&path)
            };
            outputs.extend(block.par_iter().zip(&masks).map(write).collect::<artifact::Result<Vec<_>>>()?);
            painted += masks.iter().map(|mask| mask.painted).sum::<usize>();
            block.iter().for_each(|_| progress.step());
        }
    }
    drop(progress);
    run.result("images", count);
    run.result("painted_px", painted);
    outputs.into_iter().try_for_each(|output| Ok(output.publish()?))
}

const BLOCK: usize = 8;

/// A mask in colours.
struct Mask {
    size: [usize; 2],
    rgb: Vec<u8>,
    painted: usize,
}

impl Mask {
    fn of(classifier: &mut Classifier, shot: &Shot, model: &PaintModel, arguments: &Arguments) -> Self {
        let classified = classifier.classify(&shot.picture);
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
