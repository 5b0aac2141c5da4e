//! How wrinkles come: the modulation function from a film.

use super::acquire::tell;
use super::inputs::{Neutral, landmarks, photo};
use super::options::Options;
use super::output::Output;
use anyhow::ensure;
use artifact::{image_numbers, image_path, stage_bytes};
use normalmap_acquire::{Acquired, Face, Pair, acquire, fit_modulation, shown, way};
use serde_json::json;
use stage::Run;
use std::path::{Path, PathBuf};

/// Measure on a film from rest to an expression how much of the wrinkles shows at which share of the way
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    neutral: Neutral,
    /// Pictures of the film, e.g. film/{frame:04}.png; the last one shows the full expression
    #[arg(long, value_name = "PATTERN")]
    frames: PathBuf,
    /// Landmarks in each, e.g. film/{frame:04}.json
    #[arg(long, value_name = "PATTERN")]
    frame_landmarks: PathBuf,
    /// What tells how far the expression has come: landmarks, or frames (their numbers)
    #[arg(long, value_name = "NAME", default_value = "landmarks", value_parser = ["landmarks", "frames"])]
    by: String,
    /// Modulation function to write, JSON
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Also write each frame's normal map, e.g. maps/{frame:04}.png
    #[arg(long, value_name = "PATTERN")]
    maps: Option<PathBuf>,
    #[command(flatten)]
    options: Options,
    #[command(flatten)]
    output: Output,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("fit-modulation");
    let params = arguments.options.params()?;
    let region = arguments.options.region(&params);
    let rest = arguments.neutral.read(run)?;
    let numbers = image_numbers(&arguments.frames)?;
    ensure!(
        numbers.len() >= 3,
        "{}: {} pictures are there; at least 3 are needed\n  to do: check the pattern and the folder",
        arguments.frames.display(),
        numbers.len()
    );
    let file =
        |pattern: &Path, number: i64| PathBuf::from(image_path(&pattern.display().to_string(), number));
    let mut film: Vec<(Vec<Pair>, Acquired)> = Vec::new();
    let mut staged = Vec::new();
    for &number in numbers.iter().rev() {
        let marks_path = file(&arguments.frame_landmarks, number);
        let photograph = arguments.neutral.expression(run, &rest, &file(&arguments.frames, number))?;
        let marks = landmarks(run, "frame-landmarks", &marks_path, &photograph)?;
        let pairs = arguments.neutral.pairs(&rest, &marks, &marks_path)?;
        let face = Face { pairs: pairs.clone(), ..rest.face.clone() };
        let found = acquire(&rest.photo, &photo(&photograph), &face, &region, &params)?;
        if let Some(pattern) = &arguments.maps {
            staged.push(arguments.output.normals(&file(pattern, number), &found.normals)?);
        }
        film.push((pairs, found));
    }
    run.parameters(&json!({ "method": params, "region": region, "by": arguments.by }))?;
    tell(run, &film[0].1, rest.scheme.name);
    let count = film.len() - 1;
    let place = |index: usize| match arguments.by.as_str() {
        "frames" => 1.0 - index as f64 / count as f64,
        _ => way(&film[index].0, &film[0].0),
    };
    let frames: Vec<[f64; 2]> =
        (0..film.len()).rev().map(|index| [place(index), shown(&film[index].1, &film[0].1)]).collect();
    let modulation = fit_modulation(&frames)?;
    run.result("rms", modulation.rms);
    run.result("cosine_rms", modulation.cosine_rms);
    run.result("power", modulation.power);
    let document = json!({ "modulation": modulation.curve, "frames": modulation.frames, "rms": modulation.rms,
        "cosine_rms": modulation.cosine_rms, "power": modulation.power });
    staged.push(stage_bytes(&arguments.out, &serde_json::to_vec_pretty(&document)?)?);
    run.publish(staged)
}
