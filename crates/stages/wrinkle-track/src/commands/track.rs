//! `wrinkle-track track`.

use super::masks::{MaskSource, MaskedShot};
use super::names::{Name, read_names};
use super::shots::Shot;
use anyhow::bail;
use artifact::{
    Curve2d, CurveState, FrameWriter, PaintModel, PerCamera, Wrinkle, Wrinkles2d, Wrinkles2dFrame,
    Wrinkles2dHeader,
};
use rayon::prelude::*;
use serde::Serialize;
use stage::{CameraImages, Footage, ImageSource, Run, check_take};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use wrinkle_track::{
    Classifier, Follower, MarkedPaint, MarkedWrinkle, NamedPlace, TrackParams, marked_wrinkles,
};

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
    let names = match &arguments.names {
        Some(path) => {
            let names = read_names(path)?;
            run.input("names", path)?;
            Some((path.as_path(), names))
        }
        None => None,
    };
    if let (Some(learnt), Some(take)) = (&model.take, &footage.take)
        && learnt.session == take.session
    {
        check_same_take(run, &arguments.model, &model, &footage)?;
    }
    let shots = arguments.masks.read(run, &footage)?;
    let start =
        Start { model: &model, footage: &footage, names: names.as_ref().map(|(p, n)| (*p, &n[..])), params };
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
    if learnt.map(|learnt| &learnt.take) == take.map(|take| &take.take) {
        check_take(run, path, learnt, take)?;
    }
    Ok(())
}

/// A camera at work.
struct Camera {
    id: String,
    images: CameraImages,
    follower: Follower,
    classifier: Classifier,
    /// Place of the marked frame.
    first: usize,
    /// Per frame wrinkles that appear in it.
    named: BTreeMap<usize, Vec<(usize, NamedPlace)>>,
    /// Per frame the curves of all wrinkles, if it has an image.
    curves: Vec<Option<Vec<Option<Curve2d>>>>,
    strays: usize,
    clipped: f64,
}

/// What is known before the first image is followed.
struct Start<'a> {
    model: &'a PaintModel,
    footage: &'a Footage,
    names: Option<(&'a Path, &'a [Name])>,
    params: TrackParams,
}

impl Start<'_> {
    fn cameras(&self, run: &mut Run, shots: Vec<MaskedShot>) -> anyhow::Result<(Vec<Camera>, Vec<Wrinkle>)> {
        self.check_names(&shots)?;
        let mut marked = Vec::new();
        for shot in &shots {
            marked.push(self.marked(run, shot)?);
        }
        let mut paints: BTreeMap<String, Option<u8>> = BTreeMap::new();
        for wrinkle in marked.iter().flatten() {
            if let Some(Some(other)) = paints.insert(wrinkle.id.clone(), Some(wrinkle.paint))
                && other != wrinkle.paint
            {
                let [one, other] = [other, wrinkle.paint].map(|paint| self.paint(paint));
                bail!(
                    "{}: the wrinkle {} lies on paint {one} and on paint {other}\n  to do: give two wrinkles two names",
                    self.names.map_or(Path::new("masks"), |(path, _)| path).display(),
                    wrinkle.id
                );
            }
        }
        for (_, name) in self.late(&shots) {
            paints.entry(name.place.wrinkle.clone()).or_insert(None);
        }
        let ids: Vec<String> = paints.keys().cloned().collect();
        let wrinkles = paints
            .iter()
            .map(|(id, paint)| Wrinkle { id: id.clone(), paint: paint.map(|paint| self.paint(paint)) })
            .collect();
        let numbers = self.footage.numbers();
        let late: Vec<(String, usize, usize, NamedPlace)> = self
            .late(&shots)
            .filter_map(|(frame, name)| {
                let place = numbers.iter().position(|number| *number == frame)?;
                let index = ids.iter().position(|id| *id == name.place.wrinkle)?;
                Some((name.camera.clone(), place, index, name.place.clone()))
            })
            .collect();
        let mut cameras = Vec::new();
        for (shot, marked) in shots.into_iter().zip(marked) {
            let mut named: BTreeMap<usize, Vec<(usize, NamedPlace)>> = BTreeMap::new();
            for (_, place, index, name) in late.iter().filter(|(camera, ..)| *camera == shot.camera) {
                named.entry(*place).or_default().push((*index, name.clone()));
            }
            cameras.push(Camera {
                follower: Follower::new(&ids, &marked, self.params),
                classifier: Classifier::new(self.model)?,
                first: shot.index,
                named,
                curves: vec![None; shot.images.paths.len()],
                id: shot.camera,
                images: shot.images,
                strays: 0,
                clipped: 0.0,
            });
        }
        Ok((cameras, wrinkles))
    }

    fn paint(&self, number: u8) -> String {
        self.model.paints.get(usize::from(number) - 1).map(|paint| paint.id.clone()).unwrap_or_default()
    }

    /// Names of other frames than the marked one, with their frames.
    fn late(&self, shots: &[MaskedShot]) -> impl Iterator<Item = (i64, &Name)> {
        let numbers = self.footage.numbers();
        let marked: BTreeMap<String, i64> =
            shots.iter().map(|shot| (shot.camera.clone(), numbers[shot.index])).collect();
        let names = self.names.map(|(_, names)| names).unwrap_or_default();
        names.iter().filter_map(move |name| {
            let frame = name.frame?;
            (marked.get(&name.camera) != Some(&frame)).then_some((frame, name))
        })
    }

    /// The marked wrinkles of a camera.
    fn marked(&self, run: &mut Run, shot: &MaskedShot) -> anyhow::Result<Vec<MarkedWrinkle>> {
        let paints: Vec<MarkedPaint> = self
            .model
            .paints
            .iter()
            .map(|paint| MarkedPaint { name: paint.id.clone(), mark: paint.mark })
            .collect();
        let labels = shot.labels(&paints);
        let (known, marks) = (
            labels.iter().filter(|label| (1..=paints.len() as u8).contains(label)).count(),
            shot.mask.marks.iter().flatten().count(),
        );
        if 2 * known < marks {
            bail!(
                "{}: most of it is marked in colours that {} does not know\n  to do: give the masks that the model was learnt from, or train again",
                shot.mask_path.display(),
                "the model"
            );
        }
        let ids: Vec<String> = paints.iter().map(|paint| paint.name.clone()).collect();
        let frame = self.footage.numbers()[shot.index];
        let names: Vec<&Name> = self
            .names
            .map(|(_, names)| names)
            .unwrap_or_default()
            .iter()
            .filter(|name| name.camera == shot.camera && name.frame.is_none_or(|of| of == frame))
            .collect();
        let places: Vec<NamedPlace> = names.iter().map(|name| name.place.clone()).collect();
        let size = [shot.mask.width, shot.mask.height];
        let prefix = format!("{}_", shot.camera);
        if self.names.is_some() && names.is_empty() {
            run.warn(format!(
                "camera {}: no name is given for any of its wrinkles; it is not followed",
                shot.camera
            ));
            return Ok(Vec::new());
        }
        let marked = marked_wrinkles(size, &labels, &ids, &places, &prefix, &self.params);
        if let (Some(wrong), Some((path, _))) = (marked.misplaced.first(), self.names) {
            let line = names.iter().find(|name| name.place == *wrong).map_or(0, |name| name.line);
            bail!(
                "{}, line {line}: nothing is marked at {}, {} in camera {}, where {} shall be\n  to do: name a place on the marked paint",
                path.display(),
                wrong.at.x,
                wrong.at.y,
                shot.camera,
                wrong.wrinkle
            );
        }
        if !marked.unnamed.is_empty() {
            let places: Vec<String> =
                marked.unnamed.iter().map(|at| format!("{:.0}, {:.0}", at.x, at.y)).collect();
            run.warn(format!("camera {}: marked, but without a name: at {}", shot.camera, places.join("; ")));
        }
        Ok(marked.wrinkles)
    }

    fn check_names(&self, shots: &[MaskedShot]) -> anyhow::Result<()> {
        let Some((path, names)) = self.names else { return Ok(()) };
        let numbers: BTreeSet<i64> = self.footage.numbers().into_iter().collect();
        for name in names {
            let place = format!("{}, line {}", path.display(), name.line);
            if !shots.iter().any(|shot| shot.camera == name.camera) {
                bail!(
                    "{place}: no mask is given for camera {}\n  to do: mark its first image, or leave the row out",
                    name.camera
                );
            }
            if let Some(frame) = name.frame.filter(|frame| !numbers.contains(frame)) {
                bail!("{place}: the take has no frame {frame}");
            }
        }
        Ok(())
    }
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
