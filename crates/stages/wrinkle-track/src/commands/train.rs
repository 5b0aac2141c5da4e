//! `wrinkle-track train`.

use super::masks::{MaskSource, MaskedShot, paints_of};
use anyhow::Context;
use artifact::canvas::Canvas;
use artifact::picture::write_rgb8;
use artifact::{LearntPaint, PaintModel, Staged};
use serde::Serialize;
use stage::{ImageSource, Run};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use wrinkle_track::{
    Chosen, Classifier, Drawing, Error, FLOOR, Learnt, MarkedPaint, Sample, TrackParams, TrainParams, View,
    choose, learn, marked_wrinkles, tidied, tint,
};

/// Learns what the paints look like from images in which they are marked
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: ImageSource,
    #[command(flatten)]
    masks: MaskSource,
    /// Name of a paint by its colour in the masks, e.g. green=6bff92; may be given several times [default: by hue]
    #[arg(long, value_name = "NAME=RRGGBB", value_parser = named_paint)]
    paint: Vec<MarkedPaint>,
    /// Cost of a training pixel on the wrong side [default: by cross-validation]
    #[arg(long, value_name = "C")]
    c: Option<f64>,
    /// Kernel exp(−gamma d²) over log ratios of light [default: by cross-validation]
    #[arg(long, value_name = "GAMMA")]
    gamma: Option<f64>,
    /// Pixels that a paint is learnt from, at most
    #[arg(long, value_name = "N", default_value_t = TrainParams::default().pixels)]
    pixels: usize,
    /// Share of held-out pixels that must be told rightly
    #[arg(long, value_name = "SHARE", default_value_t = TrainParams::default().least_score)]
    least_score: f64,
    /// Model to write (paint-model)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Picture to write (PNG): what the model takes for paint in the marked images, with the ids of the wrinkles
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Folder to write the training pixels of each paint into (<paint>.csv), for a classifier of your own; must not exist, or be
    /// empty
    #[arg(long, value_name = "FOLDER")]
    samples: Option<PathBuf>,
    /// Table of the wrinkles to write (CSV), to give them other names for `track --names`
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
}

fn named_paint(text: &str) -> Result<MarkedPaint, String> {
    let wrong = || "write a name, =, and six hexadecimal digits: red, green, blue".to_string();
    let (name, color) = text.split_once('=').ok_or_else(wrong)?;
    let digits = color.trim_start_matches('#');
    match (digits.len(), u32::from_str_radix(digits, 16)) {
        (6, Ok(value)) if !name.is_empty() => Ok(MarkedPaint {
            name: name.to_string(),
            mark: [16, 8, 0].map(|shift| (value >> shift & 255) as u8),
        }),
        _ => Err(wrong()),
    }
}

/// What the summary says of a paint.
#[derive(Serialize)]
struct Report {
    score: f64,
    c: f64,
    gamma: f64,
    pixels: usize,
    support: usize,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("train");
    let params = TrainParams {
        c: arguments.c,
        gamma: arguments.gamma,
        pixels: arguments.pixels,
        least_score: arguments.least_score,
    };
    params.check()?;
    run.parameters(&params)?;
    let footage = arguments.source.open(run)?;
    let shots = arguments.masks.read(run, &footage)?;
    let folder = arguments.masks.folder();
    let paints = paints_of(&shots, &arguments.paint, folder)?;
    let labels: Vec<Vec<u8>> = shots.iter().map(|shot| shot.labels(&paints)).collect();
    let views: Vec<View> = shots
        .iter()
        .zip(&labels)
        .map(|(shot, labels)| View { picture: &shot.shot.picture, labels })
        .collect();
    if let Some(folder) = &arguments.samples {
        artifact::require_new_folder(folder)?;
    }
    let chosen = chosen(&paints, &views, params.pixels).with_context(|| folder.display().to_string())?;
    let learnt = learn_all(run, &paints, &chosen, &params).with_context(|| folder.display().to_string())?;
    let model = PaintModel { take: footage.take.clone(), floor: FLOOR, paints: learnt };
    let mut outputs = vec![artifact::write_document(&arguments.out, &model)?];
    if let Some(folder) = &arguments.samples {
        for (paint, chosen) in paints.iter().zip(&chosen) {
            outputs.push(write_samples(&folder.join(format!("{}.csv", paint.name)), chosen)?);
        }
    }
    let marked = Marked { shots: &shots, labels: &labels, paints: &paints, numbers: &footage.numbers() };
    if let Some(path) = &arguments.picture {
        outputs.push(marked.picture(path, &model)?);
    }
    if let Some(path) = &arguments.table {
        outputs.push(marked.table(path)?);
    }
    run.publish(outputs)
}

/// The training pixels of each paint.
fn chosen(paints: &[MarkedPaint], views: &[View], most: usize) -> Result<Vec<Vec<Chosen>>, Error> {
    let of_paint = |(index, paint): (usize, &MarkedPaint)| {
        choose(views, index as u8 + 1, FLOOR, most).map_err(|error| match error {
            Error::FewPixels { painted, all, .. } => {
                Error::FewPixels { paint: paint.name.clone(), painted, all }
            }
            Error::Clipped { clipped, all, .. } => Error::Clipped { paint: paint.name.clone(), clipped, all },
            other => other,
        })
    };
    paints.iter().enumerate().map(of_paint).collect()
}

fn write_samples(path: &Path, chosen: &[Chosen]) -> anyhow::Result<Staged> {
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(["ln_g_r", "ln_b_g", "paint"])?;
    for Sample { ratios, paint } in chosen.iter().map(|chosen| chosen.sample) {
        table.write_record([ratios[0].to_string(), ratios[1].to_string(), u8::from(paint).to_string()])?;
    }
    Ok(artifact::stage_bytes(path, &table.into_inner()?)?)
}

fn learn_all(
    run: &mut Run,
    paints: &[MarkedPaint],
    chosen: &[Vec<Chosen>],
    params: &TrainParams,
) -> Result<Vec<LearntPaint>, Error> {
    let mut progress = run.progress("learning", Some(paints.len() as u64));
    let (mut learnt, mut reports) = (Vec::new(), BTreeMap::new());
    for (paint, chosen) in paints.iter().zip(chosen) {
        let found = run.timed("learn", || learn(&paint.name, chosen, params))?;
        let support = found.machine.support().to_vec();
        let Learnt { c, gamma, score, .. } = found;
        run.say(&format!(
            "{}: tells {:.2} % of held-out pixels rightly (C {c}, gamma {gamma}, {} support pixels of {})",
            paint.name,
            100.0 * score,
            support.len(),
            chosen.len()
        ));
        let report = Report { score, c, gamma, pixels: chosen.len(), support: support.len() };
        reports.insert(paint.name.clone(), report);
        let (id, mark, bias) = (paint.name.clone(), paint.mark, found.machine.bias());
        learnt.push(LearntPaint { id, mark, gamma, c, score, bias, support });
        progress.step();
    }
    run.result("paints", reports);
    Ok(learnt)
}

/// The marked images, to be shown.
struct Marked<'a> {
    shots: &'a [MaskedShot],
    labels: &'a [Vec<u8>],
    paints: &'a [MarkedPaint],
    numbers: &'a [i64],
}

impl Marked<'_> {
    /// Ids, paints and regions of a shot's wrinkles.
    fn wrinkles(&self, index: usize) -> Vec<wrinkle_track::MarkedWrinkle> {
        let picture = &self.shots[index].shot.picture;
        let names: Vec<String> = self.paints.iter().map(|paint| paint.name.clone()).collect();
        let prefix = format!("{}_", self.shots[index].camera);
        let params = TrackParams::default();
        let size = [picture.width, picture.height];
        marked_wrinkles(size, &self.labels[index], &names, &[], &prefix, &params).wrinkles
    }

    fn picture(&self, path: &Path, model: &PaintModel) -> anyhow::Result<Staged> {
        let sizes: Vec<[usize; 2]> =
            self.shots.iter().map(|shot| [shot.shot.picture.width, shot.shot.picture.height]).collect();
        let width = sizes.iter().map(|size| size[0]).max().unwrap_or(1);
        let height = sizes.iter().map(|size| size[1]).sum();
        let mut canvas: Canvas = Drawing::sheet(width, height)?;
        let mut top = 0;
        let mut classifier = Classifier::new(model)?;
        for (index, shot) in self.shots.iter().enumerate() {
            let picture = &shot.shot.picture;
            let classified = classifier.classify(picture);
            let mut drawing = Drawing { canvas: &mut canvas, corner: [0, top], scale: 1.0 };
            drawing.image(picture, &shot.shot.rgb.to_8_bits());
            for paint in 0..model.paints.len() {
                drawing
                    .outline(&tidied(&classified.of_paint(paint as u8 + 1), TrackParams::default().tidy_px));
            }
            for wrinkle in self.wrinkles(index) {
                let center = wrinkle.region.center();
                drawing.write(&wrinkle.id, [center.x as usize, center.y as usize], tint(&wrinkle.id));
            }
            top += picture.height;
        }
        Ok(write_rgb8(path, canvas.width, canvas.height, &canvas.rgb)?)
    }

    fn table(&self, path: &Path) -> anyhow::Result<Staged> {
        let mut table = csv::Writer::from_writer(Vec::new());
        table.write_record(["camera", "frame", "x", "y", "paint", "area", "wrinkle"])?;
        for (index, shot) in self.shots.iter().enumerate() {
            for wrinkle in self.wrinkles(index) {
                // The centre of a bent one lies beside it.
                let center = wrinkle.region.center();
                let on_paint = wrinkle
                    .region
                    .places()
                    .into_iter()
                    .min_by(|a, b| (a - center).norm_squared().total_cmp(&(b - center).norm_squared()));
                let at = on_paint.unwrap_or(center);
                table.write_record([
                    &shot.camera,
                    &self.numbers[shot.index].to_string(),
                    &at.x.to_string(),
                    &at.y.to_string(),
                    &self.paints[usize::from(wrinkle.paint) - 1].name,
                    &wrinkle.region.area().to_string(),
                    &wrinkle.id,
                ])?;
            }
        }
        Ok(artifact::stage_bytes(path, &table.into_inner()?)?)
    }
}
