//! Photographs of a face, and the film of the way to its expression.

use super::{Arguments, write_normals};
use anyhow::Context;
use artifact::picture::write_rgb8;
use artifact::{Staged, stage_bytes, write_document};
use serde_json::json;
use stage::Run;
use std::path::Path;
use virtual_rig::character::muscles_of;
use virtual_rig::pair::face::{FaceDegradation, FacePair, FaceScenario, FaceStudio};
use virtual_rig::wrinkle::{Family, Style};

pub(super) fn run(run: &mut Run, arguments: &Arguments, expression: &str) -> anyhow::Result<()> {
    let scenario = arguments.face_scenario(run, expression)?;
    let Arguments { seed, frames, out, .. } = arguments;
    run.parameters(&json!({ "face": scenario, "expression": expression, "seed": seed, "frames": frames }))?;
    run.check_folders(&[&out.join("neutral.png")])?;
    let studio = run.timed("face", || FaceStudio::set_up(&scenario, *seed))?;
    let pair = run.timed("photograph", || studio.pair())?;
    run.result("exposure", pair.truth.exposure);
    run.result("deepest_mm", pair.truth.deepest_mm);
    let mut staged = write(out, &pair)?;
    if let Some(count) = frames {
        staged.extend(film(run, out, &studio, *count, pair.side)?);
    }
    run.publish(staged)
}

impl Arguments {
    fn face_scenario(&self, run: &mut Run, expression: &str) -> anyhow::Result<FaceScenario> {
        let mut scenario = match self.scenario.as_str() {
            "round" => FaceScenario::default(),
            "crease" => {
                let mut scenario = FaceScenario::default();
                scenario.folds.family = Family::S;
                scenario
            }
            "flat" => {
                let none = Style {
                    forehead: false,
                    glabella: false,
                    crows_feet: false,
                    nasolabial: false,
                    ..Style::default()
                };
                FaceScenario { lines: none, ..FaceScenario::default() }
            }
            file => {
                let path = Path::new(file);
                let text = artifact::read_text(path)?;
                run.input("scenario", path)?;
                serde_json::from_str(&text).with_context(|| {
                    format!("{file}: holds no parameters of a face\n  to do: say round, crease or flat, or mend the file")
                })?
            }
        };
        if scenario.muscles.is_empty() {
            scenario.muscles = muscles_of(expression).unwrap_or_default();
        }
        scenario.flash_share = self.flash.unwrap_or(scenario.flash_share);
        scenario.flash_tilt = self.flash_tilt()?.unwrap_or(scenario.flash_tilt);
        scenario.vertices = self.vertices.unwrap_or(scenario.vertices);
        if let Some(side) = self.side {
            scenario.pixel_mm *= f64::from(scenario.side_px) / f64::from(side.max(1));
            scenario.side_px = side;
        }
        if self.clean {
            scenario.degradation = FaceDegradation::none();
        }
        scenario.check()?;
        Ok(scenario)
    }
}

fn write(out: &Path, pair: &FacePair) -> anyhow::Result<Vec<Staged>> {
    let picture = |name: &str, rgb: &[u8]| write_rgb8(&out.join(name), pair.side, pair.side, rgb);
    Ok(vec![
        picture("neutral.png", &pair.neutral)?,
        picture("expression.png", &pair.expression)?,
        write_document(&out.join("neutral-landmarks.json"), &pair.neutral_landmarks)?,
        write_document(&out.join("expression-landmarks.json"), &pair.expression_landmarks)?,
        write_normals(&out.join("truth/normals.png"), pair.side, &pair.normals)?,
        stage_bytes(&out.join("truth/pair.json"), &serde_json::to_vec_pretty(&pair.truth)?)?,
    ])
}

/// The film as numbered pictures, and how much of the wrinkles each truly shows.
fn film(
    run: &mut Run,
    out: &Path,
    studio: &FaceStudio,
    count: u32,
    side: usize,
) -> anyhow::Result<Vec<Staged>> {
    let (mut staged, mut shown) = (Vec::new(), Vec::new());
    let mut wrong: Option<artifact::Error> = None;
    let mut progress = run.progress("frames", Some(u64::from(count)));
    studio.film(count, |frame| {
        let number = shown.len();
        shown.push([frame.way, frame.shown]);
        let written = write_rgb8(&out.join(format!("frames/{number:04}.png")), side, side, &frame.picture)
            .and_then(|picture| {
                let landmarks =
                    write_document(&out.join(format!("frames/{number:04}.json")), &frame.landmarks)?;
                Ok([picture, landmarks])
            });
        match written {
            Ok(files) => staged.extend(files),
            Err(error) => wrong = wrong.take().or(Some(error)),
        }
        progress.step();
    })?;
    drop(progress);
    if let Some(error) = wrong {
        return Err(error.into());
    }
    let truth = serde_json::to_vec_pretty(&json!({ "frames": shown }))?;
    staged.push(stage_bytes(&out.join("truth/film.json"), &truth)?);
    Ok(staged)
}
