//! Photographs of a patch of skin, or of a whole face, at rest and wrinkled.

mod face;

use anyhow::Context;
use artifact::picture::{write_rgb8, write_rgb16};
use artifact::{Staged, stage_bytes, write_document};
use serde_json::json;
use stage::Run;
use std::path::{Path, PathBuf};
use virtual_rig::pair::{Degradation, Groove, Pair, PairScenario, photograph};

/// Photograph a patch of skin at rest and wrinkled, whose normals are known: for maps from ratio images
///
/// With `--face`, a whole face from the front.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Photograph a whole face with an expression: brows-up, frown, smile, snarl, joy, sad, disgust, surprise, fear, angry
    #[arg(long, value_name = "EXPRESSION", value_parser = clap::builder::PossibleValuesParser::new(virtual_rig::character::pose_names()))]
    face: Option<String>,
    /// Vertices of the face
    #[arg(long, value_name = "N", requires = "face")]
    vertices: Option<usize>,
    /// Grooves: round, crease or flat; or a file of parameters, JSON
    #[arg(long, value_name = "NAME|FILE", default_value = "round")]
    scenario: String,
    /// Share of the light that comes from a flash beside the lens, 0 to 1; the rest is open sky
    #[arg(long, value_name = "SHARE")]
    flash: Option<f64>,
    /// The flash stands off the line of sight, towards X,Y,1; y up
    #[arg(long, value_name = "X,Y", value_delimiter = ',', num_args = 1, allow_hyphen_values = true)]
    flash_tilt: Option<Vec<f64>>,
    /// Side of the photographs, px; a face stays as large in the picture
    #[arg(long, value_name = "PX")]
    side: Option<u32>,
    /// Nothing but the wrinkles differs: no texture, motion that landmarks miss, exposure, sheen, blur or noise
    #[arg(long)]
    clean: bool,
    /// What is drawn
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Also film the way from rest to the expression, in so many frames
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1000))]
    frames: Option<u32>,
    /// Folder to write
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("pair");
    if let Some(expression) = &arguments.face {
        return face::run(run, arguments, expression);
    }
    let scenario = arguments.scenario(run)?;
    run.parameters(&json!({ "scenario": scenario, "seed": arguments.seed, "frames": arguments.frames }))?;
    run.check_folders(&[&arguments.out.join("neutral.png")])?;
    let amplitudes = amplitudes(arguments.frames, arguments.seed);
    let pair = run.timed("photograph", || photograph(&scenario, arguments.seed, &amplitudes));
    run.result("misregistration_px", pair.truth.misregistration_px);
    run.result("exposure", pair.truth.exposure);
    run.publish(write(&arguments.out, &pair, arguments.frames.is_some())?)
}

impl Arguments {
    fn scenario(&self, run: &mut Run) -> anyhow::Result<PairScenario> {
        let named = |groove| PairScenario { groove, ..PairScenario::default() };
        let mut scenario = match self.scenario.as_str() {
            "round" => named(Groove::Round),
            "crease" => named(Groove::Crease),
            "flat" => named(Groove::Flat),
            file => {
                let path = Path::new(file);
                let text = artifact::read_text(path)?;
                run.input("scenario", path)?;
                serde_json::from_str(&text).with_context(|| {
                    format!("{file}: holds no parameters of a pair\n  to do: say round, crease or flat, or mend the file")
                })?
            }
        };
        scenario.flash_share = self.flash.unwrap_or(scenario.flash_share);
        scenario.side_px = self.side.unwrap_or(scenario.side_px);
        scenario.flash_tilt = self.flash_tilt()?.unwrap_or(scenario.flash_tilt);
        if self.clean {
            scenario.degradation = Degradation::none();
        }
        scenario.check()?;
        Ok(scenario)
    }

    fn flash_tilt(&self) -> anyhow::Result<Option<[f64; 2]>> {
        match self.flash_tilt.as_deref() {
            None => Ok(None),
            Some(&[x, y]) => Ok(Some([x, y])),
            Some(other) => anyhow::bail!("--flash-tilt: {} numbers\n  to do: give two, X,Y", other.len()),
        }
    }
}

/// Heights of the wrinkles from rest to the expression, over their last: late at first, as skin buckles.
fn amplitudes(frames: Option<u32>, seed: u64) -> Vec<f64> {
    let Some(frames) = frames else { return vec![1.0] };
    // Between x^1.5 and x^3, by the seed.
    let power = 1.5 + 1.5 * ((seed * 7 % 11) as f64 / 10.0);
    (0..frames).map(|frame| (f64::from(frame) / f64::from(frames - 1)).powf(power)).collect()
}

fn write(out: &Path, pair: &Pair, is_film: bool) -> anyhow::Result<Vec<Staged>> {
    let side = pair.side;
    let mut staged = vec![
        write_rgb8(&out.join("neutral.png"), side, side, &pair.neutral)?,
        write_document(&out.join("neutral-landmarks.json"), &pair.neutral_landmarks)?,
    ];
    if let (Some(expression), Some(landmarks)) = (pair.expressions.last(), pair.expression_landmarks.last()) {
        staged.push(write_rgb8(&out.join("expression.png"), side, side, expression)?);
        staged.push(write_document(&out.join("expression-landmarks.json"), landmarks)?);
    }
    if is_film {
        for (frame, (picture, landmarks)) in
            pair.expressions.iter().zip(&pair.expression_landmarks).enumerate()
        {
            staged.push(write_rgb8(&out.join(format!("frames/{frame:04}.png")), side, side, picture)?);
            staged.push(write_document(&out.join(format!("frames/{frame:04}.json")), landmarks)?);
        }
    }
    staged.push(write_normals(&out.join("truth/normals.png"), side, &pair.normals)?);
    let grooves: Vec<u8> = pair.grooves.iter().flat_map(|is| [255 * u8::from(*is); 3]).collect();
    staged.push(write_rgb8(&out.join("truth/grooves.png"), side, side, &grooves)?);
    let truth = serde_json::to_vec_pretty(&pair.truth)?;
    staged.push(stage_bytes(&out.join("truth/pair.json"), &truth)?);
    Ok(staged)
}

/// Unit normals as codes of 16 bits; black where there is none.
fn write_normals(path: &Path, side: usize, normals: &[[f64; 3]]) -> artifact::Result<Staged> {
    let code = |value: f64| (65535.0 * (0.5 * value + 0.5)).round() as u16;
    let codes = |normal: &[f64; 3]| if *normal == [0.0; 3] { [0; 3] } else { normal.map(code) };
    let pixels: Vec<u16> = normals.iter().flat_map(codes).collect();
    write_rgb16(path, side, side, &pixels)
}
