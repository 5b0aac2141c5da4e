//! The take itself, frame by frame.

use super::Arguments;
use super::footage::FootageSink;
use super::paper::Paper;
use super::records::Records;
use artifact::{FrameRange, Labels, PerCamera, Staged, TrackState, picture};
use rayon::prelude::*;
use stage::Run;
use std::collections::BTreeMap;
use std::path::Path;
use virtual_rig::clock::Schedule;
use virtual_rig::take::{ImageTruth, Role, Set, Shot, Station, Studio, shots_by_frame};

/// An image on its way to the disk.
struct Image {
    shot: Shot,
    rgb: Vec<u8>,
    truth: ImageTruth,
    normals: Option<Vec<u16>>,
}

/// Films the take, and writes what is true of each frame.
pub(super) fn film(
    run: &mut Run,
    studio: &Studio,
    schedule: &Schedule,
    paper: &Paper,
    mut footage: FootageSink,
    arguments: &Arguments,
) -> anyhow::Result<Vec<Staged>> {
    let extent = studio.scenario().extent;
    let range = arguments.frames.unwrap_or(FrameRange::ALL);
    let Plan { frames, labelled, masked } = Plan::new(studio, schedule);
    let wanted: Vec<(i64, Vec<Shot>)> =
        frames.into_iter().filter(|(frame, _)| range.contains(studio.filmed_with(*frame))).collect();
    let is_captured = |frame: i64| (0..i64::from(extent.frames)).contains(&frame);
    let captured = wanted.iter().map(|(frame, _)| *frame).filter(|frame| is_captured(*frame));
    let mut records = Records::create(studio, paper, schedule, captured)?;
    let mut labels: PerCamera<[f64; 2]> = BTreeMap::new();
    let mut images = 0u64;
    let mut progress = run.progress("film", Some(wanted.len() as u64));
    for (frame, shots) in &wanted {
        let taken = if arguments.no_footage { &[][..] } else { shots };
        let (own, filmed) = run.timed("film", || film_frame(studio, *frame, taken, !arguments.no_normals))?;
        for image in &filmed {
            let (camera, station) = (&image.shot.camera, &studio.stations()[&image.shot.camera]);
            footage.write(&image.shot, station, &image.rgb)?;
            images += 1;
            if !is_captured(*frame) {
                continue;
            }
            write_pictures(&arguments.out, image, station, extent.first_frame + frame)?;
            match station.role {
                Role::Mocap if *frame == labelled => {
                    labels.insert(camera.clone(), first_labels(studio, image));
                }
                Role::Wrinkle if masked.get(camera) == Some(frame) => {
                    write_mask(&arguments.out, studio, image, station)?;
                }
                _ => {}
            }
        }
        if is_captured(*frame) {
            let truths = filmed.into_iter().map(|image| (image.shot, image.truth)).collect();
            records.write(studio, extent.first_frame + frame, &own, truths, shots)?;
        }
        progress.step();
    }
    drop(progress);
    run.result("images", images);
    let mut outputs = footage.finish()?;
    outputs.extend(records.finish(!arguments.no_footage)?);
    if !labels.is_empty() {
        let frame = extent.first_frame + labelled;
        let labels = Labels { take: Some(paper.take.clone()), frame, cameras: labels };
        outputs.push(artifact::write_document(&arguments.out.join("take/labels.json"), &labels)?);
    }
    Ok(outputs)
}

/// What is filmed when, of the whole take: its parts shall not differ from it.
struct Plan {
    /// The images of each frame, counted from the first one; also those from before the first and after the last frame.
    frames: BTreeMap<i64, Vec<Shot>>,
    /// The frame that is labelled by hand: the first that all mocap cameras show, or else the first.
    labelled: i64,
    /// Per wrinkle camera the frame of its first image, whose paint is marked by hand.
    masked: BTreeMap<String, i64>,
}

impl Plan {
    fn new(studio: &Studio, schedule: &Schedule) -> Self {
        let count = studio.scenario().extent.frames;
        let frames = shots_by_frame(schedule, count);
        let ids = |role| studio.stations().iter().filter(move |(_, s)| s.role == role).map(|(id, _)| id);
        let shows = |shots: &[Shot], id: &String| shots.iter().any(|shot| shot.camera == *id);
        let first = |shown: &dyn Fn(&[Shot]) -> bool| {
            frames.range(0..i64::from(count)).find(|(_, shots)| shown(shots)).map(|(frame, _)| *frame)
        };
        let labelled = first(&|shots| ids(Role::Mocap).all(|id| shows(shots, id))).unwrap_or(0);
        let masked = ids(Role::Wrinkle)
            .filter_map(|id| Some((id.clone(), first(&|shots| shows(shots, id))?)))
            .collect();
        Self { frames, labelled, masked }
    }
}

/// The face at a frame's own time, and all its images. Cameras that film at the same time share one set.
fn film_frame(
    studio: &Studio,
    frame: i64,
    shots: &[Shot],
    with_normals: bool,
) -> anyhow::Result<(Set, Vec<Image>)> {
    let own_s = frame as f64 / studio.scenario().extent.rate.hz();
    let when = |shot: &Shot| (shot.entry.time_s, studio.stations()[&shot.camera].exposure_s);
    let mut times: Vec<(f64, f64)> = Vec::new();
    for time in shots.iter().map(when) {
        if !times.contains(&time) {
            times.push(time);
        }
    }
    let mut images = Vec::with_capacity(shots.len());
    let mut own = None;
    for (time_s, exposure_s) in times {
        let group: Vec<&Shot> = shots.iter().filter(|shot| when(shot) == (time_s, exposure_s)).collect();
        let close = group.iter().any(|shot| studio.stations()[&shot.camera].role == Role::Wrinkle);
        let set = studio.set(time_s, exposure_s, close);
        let filmed: Vec<Image> = group
            .into_par_iter()
            .map(|shot| image(studio, &set, shot, with_normals))
            .collect::<anyhow::Result<_>>()?;
        images.extend(filmed);
        if (time_s - own_s).abs() < 1e-9 {
            own = Some(set);
        }
    }
    Ok((own.unwrap_or_else(|| studio.set(own_s, 0.0, false)), images))
}

fn image(studio: &Studio, set: &Set, shot: &Shot, with_normals: bool) -> anyhow::Result<Image> {
    let station = &studio.stations()[&shot.camera];
    let exposure = studio.expose(set, station)?;
    let truth = studio.truth_of(set, station, &exposure);
    let rgb = studio.develop(&exposure, station, shot.entry.exposure, shot.entry.time_s)?;
    let normals = match with_normals && station.role == Role::Wrinkle {
        true => Some(studio.normals_of(set, station)?),
        false => None,
    };
    Ok(Image { shot: shot.clone(), rgb, truth, normals })
}

/// What is true of an image in each of its pixels.
fn write_pictures(out: &Path, image: &Image, station: &Station, frame: i64) -> anyhow::Result<()> {
    let [width, height] = station.camera.image_size.map(|side| side as usize);
    let camera = &image.shot.camera;
    if station.role == Role::Wrinkle {
        let gray = |share: f32| (255.0 * share).round() as u8;
        let coverage: Vec<u8> =
            image.truth.coverage.iter().flat_map(|(share, _)| [gray(*share); 3]).collect();
        let path = out.join(format!("truth/paint/{camera}/{frame:06}.png"));
        picture::write_rgb8(&path, width, height, &coverage)?.publish()?;
    }
    if let Some(normals) = &image.normals {
        let path = out.join(format!("truth/normals/{camera}/{frame:06}.png"));
        picture::write_rgb16(&path, width, height, normals)?.publish()?;
    }
    Ok(())
}

/// Paint from this coverage on is marked by whoever paints the training mask.
const MARKED: f32 = 0.5;

/// The paint of a first wrinkle image, marked in its colours on black.
fn write_mask(out: &Path, studio: &Studio, image: &Image, station: &Station) -> anyhow::Result<()> {
    let [width, height] = station.camera.image_size.map(|side| side as usize);
    let strokes = studio.layers().strokes();
    let mark = |(share, stroke): &(f32, u32)| match *share >= MARKED {
        true => vivid(strokes[*stroke as usize].paint),
        false => [0; 3],
    };
    let mask: Vec<u8> = image.truth.coverage.iter().flat_map(mark).collect();
    let path = out.join(format!("take/paint-mask/{}.png", image.shot.camera));
    picture::write_rgb8(&path, width, height, &mask)?.publish()?;
    Ok(())
}

/// A colour as bright as it can be.
fn vivid(paint: [f32; 3]) -> [u8; 3] {
    let most = paint.into_iter().fold(f32::MIN_POSITIVE, f32::max);
    paint.map(|channel| (255.0 * (channel / most).powf(1.0 / 2.2)).round() as u8)
}

/// Who labels by hand hits the middle of a dot to about a third of a pixel.
const HAND_PX: f64 = 0.35;

fn first_labels(studio: &Studio, image: &Image) -> BTreeMap<String, [f64; 2]> {
    let shake = |number: usize, axis: f64| HAND_PX * (12.9898 * (number as f64 + 1.0) + 78.233 * axis).sin();
    let seen = studio.marker_names().into_iter().zip(&image.truth.tracks).enumerate();
    seen.filter_map(|(number, (marker, sample))| {
        let sample = sample.filter(|sample| sample.state == TrackState::Seen)?;
        Some((marker, [sample.at.x + shake(number, 0.0), sample.at.y + shake(number, 1.0)]))
    })
    .collect()
}
