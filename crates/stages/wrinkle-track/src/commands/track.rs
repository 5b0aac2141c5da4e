//! `wrinkle-track track`.

use super::masks::MaskSource;
use super::names::read_names;
use super::shots::Shot;
use super::start::{Camera, Start};
use artifact::{
    Curve2d, CurveState, FrameWriter, PaintModel, PerCamera, Wrinkles2d, Wrinkles2dFrame, Wrinkles2dHeader,
};
use rayon::prelude::*;
use serde::Serialize;
use stage::{Footage, ImageSource, Run, check_take};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use wrinkle_track::TrackParams;

/// Follows marked wrinkles through all images, and writes their valley curves
///
/// Wrinkles have the names that a table gives them, or those that `train --picture` shows: camera, paint and a number.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: ImageSource,
    #[command(flatten)]
    masks: MaskSource,
    /// What the paints look like (paint-model)
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// Names of wrinkles (CSV: camera, x, y, wrinkle; optionally frame, for those that appear later); several rows may name parts
    /// of one
    #[arg(long, value_name = "FILE")]
    names: Option<PathBuf>,
    #[command(flatten)]
    choice: Choice,
    /// Curves to write (wrinkles-2d; - for standard output)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(clap::Args)]
struct Choice {
    /// Steps of the opening and the closing that tidy classified pixels, px
    #[arg(long, value_name = "PX", default_value_t = TrackParams::default().tidy_px)]
    tidy_px: usize,
    /// Patches of fewer pixels are noise
    #[arg(long, value_name = "PX2", default_value_t = TrackParams::default().least_area_px)]
    least_area_px: usize,
    /// How far beside its wrinkle's last place a patch may lie, px
    #[arg(long, value_name = "PX", default_value_t = TrackParams::default().gate_px)]
    gate_px: f64,
    /// Pieces of one paint so near to each other in the mask are one wrinkle, px
    #[arg(long, value_name = "PX", default_value_t = TrackParams::default().join_px)]
    join_px: f64,
    /// A wrinkle that is not found is kept for so many images
    #[arg(long, value_name = "N", default_value_t = TrackParams::default().hold)]
    hold: usize,
    /// Weight of the darkest pixels over that of the brightest, at most
    #[arg(long, value_name = "RATIO", default_value_t = TrackParams::default().most_weight)]
    most_weight: f64,
    /// Length of wrinkle per control point, px; there are 5 to 12
    #[arg(long, value_name = "PX", default_value_t = TrackParams::default().px_per_control)]
    px_per_control: f64,
    /// A wrinkle that turns further from its axis goes along its skeleton, degrees
    #[arg(long, value_name = "DEGREES", default_value_t = TrackParams::default().bent_deg)]
    bent_deg: f64,
}

impl Choice {
    fn params(&self) -> TrackParams {
        TrackParams {
            tidy_px: self.tidy_px,
            least_area_px: self.least_area_px,
            gate_px: self.gate_px,
            join_px: self.join_px,
            hold: self.hold,
            most_weight: self.most_weight,
            px_per_control: self.px_per_control,
            bent_deg: self.bent_deg,
        }
    }
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("track");
    let params = arguments.choice.params();
    params.check()?;
    run.parameters(&params)?;
    let model: PaintModel = artifact::read_document(&arguments.model)?;
    run.input("model", &arguments.model)?;
    let footage = arguments.source.open(run)?;
    let names = match arguments.names.as_deref() {
        Some(path) => Some((path, read_names(path)?)),
        None => None,
    };
    if let Some((path, _)) = &names {
        run.input("names", path)?;
    }
    check_same_take(run, &arguments.model, &model, &footage)?;
    let shots = arguments.masks.read(run, &footage)?;
    let names = names.as_ref().map(|(path, names)| (*path, names.as_slice()));
    let start = Start { model: &model, footage: &footage, names, params };
    let (mut cameras, wrinkles) = start.cameras(run, shots)?;
    run.check_outputs(&[&arguments.out])?;
    follow(run, &mut cameras, &footage.numbers())?;
    let header = Wrinkles2dHeader {
        cameras: cameras.iter().map(|camera| camera.id.clone()).collect(),
        wrinkles,
        rate: Some(footage.rate),
        take: footage.take.clone(),
    };
    report(run, &header, &cameras);
    write(run, &arguments.out, header, &cameras, &footage.numbers())
}

/// The paint of one session serves all of its takes: only a changed manifest is worth a word.
fn check_same_take(run: &mut Run, path: &Path, model: &PaintModel, footage: &Footage) -> anyhow::Result<()> {
    let (learnt, take) = (model.take.as_ref(), footage.take.as_ref());
    let name = |take: Option<&artifact::TakeRef>| take.map(|take| (take.session.clone(), take.take.clone()));
    if name(learnt) == name(take) { check_take(run, path, learnt, take) } else { Ok(()) }
}

/// Images read ahead, per camera.
const BLOCK: usize = 8;

/// Follows all cameras from their marked frames to both ends of the take.
fn follow(run: &mut Run, cameras: &mut [Camera], numbers: &[i64]) -> anyhow::Result<()> {
    let steps: usize = cameras.iter().map(|camera| camera.images.paths.iter().flatten().count()).sum();
    let mut progress = run.progress("tracking", Some(steps as u64));
    for camera in cameras {
        let start = camera.follower.clone();
        let forward: Vec<usize> = (camera.first..numbers.len()).collect();
        let backward: Vec<usize> = (0..camera.first).rev().collect();
        for order in [forward, backward] {
            camera.follower = start.clone();
            for block in order.chunks(BLOCK) {
                let shots: Vec<Option<Shot>> = run.timed("decode", || {
                    let read = |index: &usize| {
                        let path = camera.images.paths[*index].as_deref();
                        path.map(|path| Shot::read(&camera.images, path)).transpose()
                    };
                    block.par_iter().map(read).collect::<anyhow::Result<_>>()
                })?;
                for (index, shot) in block.iter().zip(shots) {
                    let Some(shot) = shot else { continue };
                    camera.step(run, *index, &shot);
                    progress.step();
                }
            }
        }
    }
    Ok(())
}

impl Camera {
    fn step(&mut self, run: &mut Run, index: usize, shot: &Shot) {
        let classified = run.timed("classify", || self.classifier.classify(&shot.picture));
        let named = self.named.get(&index).cloned().unwrap_or_default();
        let curves = run.timed("follow", || self.follower.step(&shot.picture, &classified, &named));
        self.curves[index] = Some(curves);
        self.strays += self.follower.strays();
        self.clipped = self.clipped.max(self.follower.clipped());
    }
}

/// What became of a camera's wrinkles.
#[derive(Debug, Default, Serialize)]
struct Tally {
    images: usize,
    seen: usize,
    held: usize,
    absent: usize,
    strays: usize,
}

/// With a larger share of clipped pixels, depths will be wrong.
const CLIPPED: f64 = 0.02;

fn report(run: &mut Run, header: &Wrinkles2dHeader, cameras: &[Camera]) {
    let mut tallies = BTreeMap::new();
    for camera in cameras {
        let mut tally = Tally { strays: camera.strays, ..Tally::default() };
        let mut ever = vec![false; header.wrinkles.len()];
        for curves in camera.curves.iter().flatten() {
            tally.images += 1;
            for (curve, ever) in curves.iter().zip(&mut ever) {
                match curve.as_ref().map(|curve| curve.state) {
                    Some(CurveState::Seen) => {
                        tally.seen += 1;
                        *ever = true;
                    }
                    Some(_) => tally.held += 1,
                    None if *ever => tally.absent += 1,
                    None => {}
                }
            }
        }
        if tally.seen == 0 {
            run.warn(format!("camera {} sees no wrinkle in any image", camera.id));
        }
        if camera.clipped > CLIPPED {
            run.warn(format!(
                "camera {}: up to {:.0} % of the painted pixels are black or saturated; depths cannot be measured there",
                camera.id,
                100.0 * camera.clipped
            ));
        }
        tallies.insert(camera.id.clone(), tally);
    }
    run.result("images", tallies.values().map(|tally| tally.images).sum::<usize>());
    run.result("wrinkles", header.wrinkles.len());
    run.result("curves", tallies.values().map(|tally| tally.seen).sum::<usize>());
    run.result("held", tallies.values().map(|tally| tally.held).sum::<usize>());
    run.result("cameras", tallies);
}

fn write(
    run: &mut Run,
    path: &Path,
    header: Wrinkles2dHeader,
    cameras: &[Camera],
    numbers: &[i64],
) -> anyhow::Result<()> {
    let ids: Vec<String> = header.wrinkles.iter().map(|wrinkle| wrinkle.id.clone()).collect();
    let mut writer = FrameWriter::<Wrinkles2d>::create(path, header)?;
    for (index, frame) in numbers.iter().enumerate() {
        let mut curves: PerCamera<Curve2d> = PerCamera::new();
        for camera in cameras {
            let Some(found) = &camera.curves[index] else { continue };
            let seen = ids.iter().zip(found).filter_map(|(id, curve)| Some((id.clone(), curve.clone()?)));
            curves.insert(camera.id.clone(), seen.collect());
        }
        // Frames between those of the wrinkle cameras have no line.
        if !curves.is_empty() {
            writer.write(&Wrinkles2dFrame { frame: *frame, curves })?;
        }
    }
    run.publish(vec![writer.finish()?])
}
