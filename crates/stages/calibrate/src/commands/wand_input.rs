//! Where a waved point was seen: from images, tracks or a table.

use super::shots::{self, Choice, Looked, Shot, Shots};
use anyhow::{Context, bail};
use artifact::{CameraRig, Error, FrameReader, Take, Tracks2d, Transfer};
use calibrate::wand::{BlobParams, Luminance, Shown, Sightings, Track, WandCamera, bright_point};
use nalgebra::Vector2;
use serde_json::json;
use stage::Run;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// What is known beside the points.
pub(super) struct Given<'a> {
    /// How images are named; of a folder only.
    pub(super) name: Option<&'a str>,
    pub(super) take: Option<&'a Take>,
    pub(super) lenses: Option<&'a CameraRig>,
    pub(super) without: &'a [String],
}

/// Per camera and frame a pixel.
type Seen = BTreeMap<String, BTreeMap<i64, Vector2<f64>>>;

/// Reads the points of a folder of images, of tracks or of a table.
pub(super) fn read(run: &mut Run, input: &Path, given: &Given) -> anyhow::Result<Sightings> {
    let ending = input.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let (mut seen, sizes) = match ending.as_deref() {
        _ if input.is_dir() => from_images(run, input, given)?,
        _ if given.name.is_some() => {
            bail!("--name: {} is no folder of images\n  to do: leave --name out", input.display())
        }
        Some("jsonl") => (from_tracks(run, input)?, BTreeMap::new()),
        Some("csv") => (from_table(run, input)?, BTreeMap::new()),
        _ => {
            let what = "is neither a folder of images nor points as .jsonl or .csv";
            return Err(Error::new(input, what).fix("name such a folder or file").into());
        }
    };
    for id in given.without {
        if seen.remove(id).is_none() {
            bail!("--without {id}: {} has no such camera\n  to do: name one of its cameras", input.display());
        }
    }
    let frames: BTreeSet<i64> = seen.values().flat_map(|seen| seen.keys().copied()).collect();
    let camera = |(id, seen): (String, BTreeMap<i64, Vector2<f64>>)| {
        let image_size = size(input, &id, &sizes, given)?;
        let lens = match given.lenses {
            Some(rig) => Some(lens(&id, image_size, rig)?),
            None => None,
        };
        let track: Track = frames.iter().map(|frame| seen.get(frame).copied()).collect();
        Ok(WandCamera { id, image_size, lens, track })
    };
    let cameras = seen.into_iter().map(camera).collect::<anyhow::Result<_>>()?;
    Ok(Sightings { frames: frames.into_iter().collect(), cameras })
}

fn size(
    input: &Path,
    id: &str,
    sizes: &BTreeMap<String, [u32; 2]>,
    given: &Given,
) -> anyhow::Result<[u32; 2]> {
    let in_take = given.take.and_then(|take| take.cameras.iter().find(|camera| camera.id == id));
    match (sizes.get(id).copied(), in_take.map(|camera| camera.image_size)) {
        (Some(found), Some(stated)) if found != stated => Err(Error::new(
            input,
            format!(
                "its images have {} × {} px, but the take manifest says {} × {} px",
                found[0], found[1], stated[0], stated[1]
            ),
        )
        .at(format!("camera {id}"))
        .fix("calibrate with the image size of the footage")
        .into()),
        (Some(size), _) | (None, Some(size)) => Ok(size),
        (None, None) => match given.lenses.and_then(|rig| rig.cameras.get(id)) {
            Some(camera) => Ok(camera.camera.image_size),
            None => {
                let error = Error::new(input, "its image size is not known").at(format!("camera {id}"));
                Err(error.fix("give the take manifest with --take").into())
            }
        },
    }
}

fn lens(id: &str, image_size: [u32; 2], rig: &CameraRig) -> anyhow::Result<camera::Lens> {
    let Some(known) = rig.cameras.get(id) else {
        bail!("--intrinsics: there is no camera {id}\n  to do: add it there, or leave it out with --without")
    };
    let [width, height] = known.camera.image_size;
    if known.camera.image_size != image_size {
        bail!(
            "--intrinsics: camera {id} has {width} × {height} px there, but {} × {} px here\n  to do: give lenses of this image size",
            image_size[0],
            image_size[1]
        );
    }
    Ok(known.camera.lens)
}

/// Finds the point in every image.
fn from_images(
    run: &mut Run,
    folder: &Path,
    given: &Given,
) -> anyhow::Result<(Seen, BTreeMap<String, [u32; 2]>)> {
    let all: Vec<Shots> =
        shots::in_folder(folder, given.name.unwrap_or("{frame:06}.png"))?.into_values().collect();
    let mut light = BTreeMap::new();
    for shots in &all {
        light.insert(shots.camera.as_str(), transfer(&shots.camera, given)?.light_of_codes());
    }
    let find = |shot: &Shot| {
        let [width, height] = shot.size.map(|side| side as usize);
        let values = luminance(shot.rgb, &light[shot.camera]);
        Ok(bright_point(&Luminance { width, height, values }, &BlobParams::default()))
    };
    // The sizes are compared with the take's where all of them are known.
    let looked = shots::look(run, &all, &Choice { every: 1, take: None }, find)?;
    let (mut seen, mut sizes, mut record) = (Seen::new(), BTreeMap::new(), serde_json::Map::new());
    for Looked { camera, size, sha256, shown, .. } in looked {
        let unclear = shown.iter().filter(|(_, shown)| *shown == Shown::Unclear).count();
        let row = json!({ "images": shown.len(), "sha256": sha256, "unclear": unclear });
        record.insert(camera.clone(), row);
        let points = shown.into_iter().filter_map(|(number, shown)| match shown {
            Shown::Point(at) => Some((number, at)),
            _ => None,
        });
        seen.insert(camera.clone(), points.collect());
        sizes.insert(camera, size);
    }
    run.result("images", record);
    Ok((seen, sizes))
}

/// How a camera stores light: as the take says, or else as sRGB.
fn transfer(camera: &str, given: &Given) -> anyhow::Result<Transfer> {
    let stated = given.take.and_then(|take| take.cameras.iter().find(|known| known.id == camera));
    let transfer = stated.map(|camera| camera.transfer.parse()).transpose();
    Ok(transfer.with_context(|| format!("the take manifest, camera {camera}"))?.unwrap_or_default())
}

/// Linear light, summed over the channels.
fn luminance(codes: &[u8], light: &[f64; 256]) -> Vec<f64> {
    codes.chunks_exact(3).map(|rgb| rgb.iter().map(|&code| light[usize::from(code)]).sum()).collect()
}

/// Reads tracks of one point.
fn from_tracks(run: &mut Run, path: &Path) -> anyhow::Result<Seen> {
    run.input("points", path)?;
    let reader = FrameReader::<Tracks2d>::open(path)?;
    let header = reader.header().clone();
    if header.markers.len() != 1 {
        let what = format!("holds {} markers; a wand has one", header.markers.len());
        return Err(Error::new(path, what).fix("give the tracks of the one point that was waved").into());
    }
    let mut seen: Seen = header.cameras.iter().map(|id| (id.clone(), BTreeMap::new())).collect();
    for frame in reader {
        let frame = frame?;
        for (id, samples) in header.cameras.iter().zip(frame.cameras) {
            if let Some(sample) = samples.and_then(|samples| samples.into_iter().flatten().next()) {
                seen.entry(id.clone()).or_default().insert(frame.frame, sample.at.coords);
            }
        }
    }
    Ok(seen)
}

const COLUMNS: &str = "frame,camera,x,y";

/// Reads a table of points.
fn from_table(run: &mut Run, path: &Path) -> anyhow::Result<Seen> {
    run.input("points", path)?;
    let text = artifact::read_text(path)?;
    let mut lines = text.lines().enumerate();
    let header: Option<String> =
        lines.next().map(|(_, line)| line.chars().filter(|c| !c.is_whitespace()).collect());
    if header.as_deref() != Some(COLUMNS) {
        let error = Error::new(path, format!("its first line is not {COLUMNS}")).at("line 1");
        return Err(error.fix("name the columns there, in this order").into());
    }
    let mut seen = Seen::new();
    for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let refuse = |what: &str| {
            let error = Error::new(path, what).at(format!("line {}", number + 1));
            error.fix(format!("correct the line; its columns are {COLUMNS}"))
        };
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let [frame, camera, x, y] = cells[..] else { return Err(refuse("has not four cells").into()) };
        let coordinate = |text: &str| match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(refuse(&format!("'{text}' is not a number"))),
        };
        let frame: i64 = frame.parse().map_err(|_| refuse(&format!("'{frame}' is not a frame number")))?;
        let at = Vector2::new(coordinate(x)?, coordinate(y)?);
        if seen.entry(camera.to_string()).or_default().insert(frame, at).is_some() {
            return Err(refuse(&format!("camera {camera} saw the point in frame {frame} already")).into());
        }
    }
    Ok(seen)
}
