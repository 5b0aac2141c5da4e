//! How wrinkles come: the modulation function from a film.

use super::acquire::tell;
use super::film::{Film, numbered};
use super::inputs::{Neutral, Rest, photo, read_marks};
use super::options::Options;
use super::output::Output;
use anyhow::Context;
use artifact::{FrameRange, Photograph, Staged, stage_bytes};
use normalmap_acquire::{
    Acquired, Face, Pair, Params, Photo, Region, Report, acquire, fit_modulation, shown, way,
};
use serde_json::json;
use stage::Run;
use std::path::PathBuf;

/// Measure on a film from rest to an expression how much of the wrinkles shows at which share of the way
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    neutral: Neutral,
    /// The film: pictures, e.g. film/{frame:04}.png, or a video, whose frames count from 0; the last one shows the full expression
    #[arg(long, value_name = "PATTERN|VIDEO")]
    frames: PathBuf,
    /// Only these frames, e.g. 12-40: from rest to the full expression
    #[arg(
        long,
        value_name = "A-B",
        default_value = "-",
        hide_default_value = true,
        allow_hyphen_values = true
    )]
    range: FrameRange,
    /// Landmarks in each, by its number, e.g. film/{frame:04}.json
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
    let film = Film::open(&arguments.frames, arguments.range, arguments.neutral.transfer)?;
    run.parameters(&json!({ "method": params, "region": region, "by": arguments.by }))?;
    let mut acquisition = Acquisition { arguments, rest, region, params, film, staged: Vec::new() };
    let (frames, end) = acquisition.measure(run)?;
    tell(run, &end, acquisition.rest.scheme.name);
    let modulation = fit_modulation(&frames)?;
    run.result("frames", frames.len());
    run.result("rms", modulation.rms);
    run.result("cosine_rms", modulation.cosine_rms);
    run.result("power", modulation.power);
    let document = json!({ "modulation": modulation.curve, "frames": modulation.frames, "rms": modulation.rms,
        "cosine_rms": modulation.cosine_rms, "power": modulation.power });
    let mut staged = acquisition.staged;
    staged.push(stage_bytes(&arguments.out, &serde_json::to_vec_pretty(&document)?)?);
    run.publish(staged)
}

/// The acquisition of a film's frames, one after the other: a film may be long.
struct Acquisition<'a> {
    arguments: &'a Arguments,
    rest: Rest,
    region: Region,
    params: Params,
    film: Film,
    /// The frames' maps.
    staged: Vec<Staged>,
}

impl Acquisition<'_> {
    /// Share of the way and of the wrinkles for each frame, and what the last one shows.
    fn measure(&mut self, run: &mut Run) -> anyhow::Result<(Vec<[f64; 2]>, Acquired)> {
        let (first, last) = match self.film.numbers[..] {
            [first, .., last] => (first, last),
            _ => anyhow::bail!("{}: has no frames", self.arguments.frames.display()),
        };
        let mut progress = run.progress("frames", Some(self.film.numbers.len() as u64));
        let mut end = None;
        let mut inputs = Vec::new();
        self.show([last, last], |acquisition, number, photograph| {
            end = Some(acquisition.acquired(number, &photograph, &mut inputs)?);
            Ok(())
        })?;
        let (end_pairs, end) = end.ok_or_else(|| {
            anyhow::anyhow!(
                "{}: its last frame cannot be read\n  to do: leave it out with --range",
                self.arguments.frames.display()
            )
        })?;
        progress.step();
        let count = self.film.numbers.len() as f64 - 1.0;
        let mut frames = Vec::new();
        self.show([first, last - 1], |acquisition, number, photograph| {
            let (pairs, found) = acquisition.acquired(number, &photograph, &mut inputs)?;
            let place = match acquisition.arguments.by.as_str() {
                "frames" => frames.len() as f64 / count,
                _ => way(&pairs, &end_pairs),
            };
            frames.push([place, shown(&found, &end)]);
            progress.step();
            Ok(())
        })?;
        drop(progress);
        frames.push([1.0, 1.0]);
        for (role, path) in inputs {
            run.input(role, &path)?;
        }
        Ok((frames, end))
    }

    fn show(
        &mut self,
        range: [i64; 2],
        mut each: impl FnMut(&mut Self, i64, Photograph) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let film = self.film.clone();
        film.show(range, |number, photograph| each(self, number, photograph))
    }

    /// What a frame shows. It may show the very pixels of the neutral photograph: then there are no wrinkles yet.
    fn acquired(
        &mut self,
        number: i64,
        photograph: &Photograph,
        inputs: &mut Vec<(&'static str, PathBuf)>,
    ) -> anyhow::Result<(Vec<Pair>, Acquired)> {
        let arguments = self.arguments;
        let file = self.film.file(number);
        let marks_path = numbered(&arguments.frame_landmarks, number);
        arguments.neutral.check_alike(&self.rest, photograph, &file)?;
        let marks = read_marks(&marks_path, photograph)?;
        let pairs = arguments.neutral.pairs(&self.rest, &marks, &marks_path)?;
        if inputs.last().is_none_or(|(_, last)| *last != file) {
            inputs.push(("frame", file));
        }
        inputs.push(("frame-landmarks", marks_path));
        let face = Face { pairs: pairs.clone(), ..self.rest.face.clone() };
        let shot = photo(photograph);
        let found = match shot.light == self.rest.photo.light {
            true => flat(&self.rest.photo),
            false => acquire(&self.rest.photo, &shot, &face, &self.region, &self.params)
                .with_context(|| format!("{}, frame {number}", self.film.file(number).display()))?,
        };
        if let Some(pattern) = &arguments.maps {
            self.staged.push(arguments.output.normals(&numbered(pattern, number), &found.normals)?);
        }
        Ok((pairs, found))
    }
}

/// No wrinkles.
fn flat(rest: &Photo) -> Acquired {
    let plane = |value: f64| rest.light.map(|_| value);
    Acquired {
        normals: [plane(0.0), plane(0.0), plane(1.0)],
        height: None,
        warped: rest.light.clone(),
        ratio: plane(1.0),
        weight: plane(0.0),
        residual: plane(0.0),
        doubt: plane(0.0),
        light: None,
        report: Report::default(),
    }
}
