//! One normal map from two photographs.

use super::inputs::{Neutral, Rest, check_crossed, landmarks, photo};
use super::options::Options;
use super::output::Output;
use anyhow::{bail, ensure};
use artifact::read_landmarks;
use normalmap_acquire::{Acquired, Face, Pair, acquire, texture_spread, textured};
use serde_json::json;
use stage::Run;
use std::path::{Path, PathBuf};

/// Make a normal map of the wrinkles that an expression has beyond the face at rest
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    neutral: Neutral,
    /// Photograph of the expression
    #[arg(long, value_name = "FILE")]
    expression: PathBuf,
    /// Landmarks in it
    #[arg(long, value_name = "FILE")]
    expression_landmarks: PathBuf,
    /// Normal map to write, PNG: in the frame of the neutral photograph or, with --texture-landmarks, in the texture
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    options: Options,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    texture: Texture,
}

/// The character's texture
#[derive(clap::Args)]
#[command(next_help_heading = "Texture")]
struct Texture {
    /// The same landmarks in the character's texture: px (.json, .pts, .tem, .csv with id,x,y) or texture coordinates (.csv with id,u,v)
    #[arg(long, value_name = "FILE")]
    texture_landmarks: Option<PathBuf>,
    /// Width and height of the texture, px
    #[arg(long, value_name = "PX", default_value_t = 2048, value_parser = clap::value_parser!(u32).range(16..=16384))]
    texture_size: u32,
    /// UDIM tile to write, of texture coordinates in several [default: 1001]
    #[arg(long, value_name = "TILE", default_value_t = 1001, value_parser = clap::value_parser!(u32).range(1001..=9999))]
    tile: u32,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("acquire");
    let params = arguments.options.params()?;
    let region = arguments.options.region(&params);
    let mut paths = arguments.output.paths();
    paths.push(arguments.out.clone());
    run.check_folders(&paths.iter().map(PathBuf::as_path).collect::<Vec<_>>())?;
    let rest = arguments.neutral.read(run)?;
    let photograph = arguments.neutral.expression(run, &rest, &arguments.expression)?;
    let marks = landmarks(run, "expression-landmarks", &arguments.expression_landmarks, &photograph)?;
    let pairs = arguments.neutral.pairs(&rest, &marks, &arguments.expression_landmarks)?;
    let face = Face { pairs, ..rest.face.clone() };
    let expression = photo(&photograph);
    let found = run.timed("acquire", || acquire(&rest.photo, &expression, &face, &region, &params))?;
    run.parameters(&json!({ "method": params, "region": region }))?;
    tell(run, &found, rest.scheme.name);
    let (normals, height) = match arguments.texture.pairs(run, &rest)? {
        None => (found.normals.clone(), found.height.clone()),
        Some(pairs) => {
            let side = arguments.texture.texture_size as usize;
            let map = run.timed("texture", || textured(&found, &pairs, side, side, region.smoothing))?;
            run.result("texture_folded_px", map.folded);
            if map.folded > 0 {
                run.warn(format!(
                    "the warp into the texture folds over {} texels, which stay flat: its landmarks there contradict each other",
                    map.folded
                ));
            }
            (map.normals, found.height.is_some().then_some(map.height))
        }
    };
    let mut staged = vec![arguments.output.normals(&arguments.out, &normals)?];
    staged.extend(arguments.output.displacement(height.as_ref())?);
    staged.extend(arguments.output.numbers(&normals)?);
    staged.extend(arguments.output.steps(&found)?);
    run.publish(staged)
}

/// What was found, for the summary and the side-cars.
pub(crate) fn tell(run: &mut Run, found: &Acquired, scheme: Option<&str>) {
    let report = &found.report;
    run.result("landmarks", report.landmarks);
    run.result("landmark_scheme", scheme.unwrap_or("own"));
    run.result("left_out_median_px", report.left_out_median_px);
    run.result("folded_px", report.folded_px);
    run.result("refined_median_px", report.refined_median_px);
    run.result("ratio_noise", report.noise);
    run.result("exposure", report.exposure);
    run.result("counted_px", report.counted_px);
    match found.light {
        Some(light) => {
            run.result("flash_share", light.flash_share);
            run.result("flash_tilt", light.tilt);
        }
        None => run.result("flash_share", "unknown"),
    }
    if report.folded_px > 0 {
        run.warn(format!(
            "the warp folds over {} pixels, which do not count: landmarks there contradict each other",
            report.folded_px
        ));
    }
    if !(0.5..2.0).contains(&report.exposure) {
        run.warn(format!(
            "the expression is exposed {:.2} times as much as the neutral photograph",
            report.exposure
        ));
    }
    if report.counted_px == 0 {
        run.warn("no pixel counts after all masks: the map is flat".to_string());
    }
}

impl Texture {
    /// From texels to the neutral photograph.
    fn pairs(&self, run: &mut Run, rest: &Rest) -> anyhow::Result<Option<Vec<Pair>>> {
        let Some(path) = &self.texture_landmarks else { return Ok(None) };
        let file = read_landmarks(path)?;
        run.input("texture-landmarks", path)?;
        let side = f64::from(self.texture_size);
        let tile = [f64::from((self.tile - 1001) % 10), f64::from((self.tile - 1001) / 10)];
        let place = |at: [f64; 2]| match file.is_uv {
            // Texel centres lie half a texel in; v runs up.
            true => [(at[0] - tile[0]) * side - 0.5, (1.0 - (at[1] - tile[1])) * side - 0.5],
            false => at,
        };
        let known = |(id, mark): (&String, &artifact::Landmark)| {
            let to = rest.landmarks.points.get(id)?.at;
            Some(Pair { id: id.clone(), from: place(mark.at), to })
        };
        let pairs: Vec<Pair> = file.landmarks.points.iter().filter_map(known).collect();
        ensure!(
            pairs.len() >= 4,
            "{}: {} of its landmarks are in the neutral photograph's too; at least 4 are needed\n  to do: give the same ids in both",
            path.display(),
            pairs.len()
        );
        self.check_inside(&pairs, path)?;
        check_crossed(&pairs, [texture_spread(&pairs), rest.face.io_px], path)?;
        Ok(Some(pairs))
    }

    fn check_inside(&self, pairs: &[Pair], path: &Path) -> anyhow::Result<()> {
        let side = f64::from(self.texture_size);
        let inside = |pair: &&Pair| pair.from.iter().all(|x| (-0.5..=side - 0.5).contains(x));
        match pairs.iter().find(inside) {
            Some(_) => Ok(()),
            None => bail!(
                "{}: none of its landmarks lies in the texture of {side} × {side} px, tile {}\n  to do: check --texture-size and --tile",
                path.display(),
                self.tile
            ),
        }
    }
}
