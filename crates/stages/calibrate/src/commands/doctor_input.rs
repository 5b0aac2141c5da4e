//! What the doctor is shown.

use super::shared::read_corners;
use anyhow::bail;
use artifact::{CameraRig, Error, FrameReader, TrackState, Tracks2d, Tracks2dFrame, Tracks2dHeader};
use calibrate::Corners;
use calibrate::doctor::{Evidence, KnownLength, Patient, Sighting, numbered_alike};
use calibrate::wand::{Ends, Length};
use nalgebra::Vector2;
use stage::Run;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The files.
pub(super) struct Given<'a> {
    pub(super) cameras: &'a Path,
    pub(super) tracks: &'a [PathBuf],
    pub(super) corners: Option<&'a Path>,
    pub(super) take: Option<&'a Path>,
    pub(super) lengths: &'a [Length],
}

/// Reads all of it.
pub(super) fn read(run: &mut Run, given: &Given) -> anyhow::Result<Evidence> {
    let rig: CameraRig = artifact::read_document(given.cameras)?;
    run.input("cameras", given.cameras)?;
    let mut sizes: BTreeMap<String, [u32; 2]> = BTreeMap::new();
    if let Some(path) = given.take {
        let (take, _) = stage::load_take(run, path)?;
        sizes.extend(take.cameras.into_iter().map(|camera| (camera.id, camera.image_size)));
    }
    let corners = given.corners.map(|path| read_corners(run, path)).transpose()?;
    if let (Some(path), Some(corners)) = (given.corners, &corners) {
        if let Some(id) = corners.header.cameras.keys().find(|id| !rig.cameras.contains_key(*id)) {
            return Err(foreign(path, id).into());
        }
        let stated = corners.header.cameras.iter().map(|(id, size)| (id.clone(), *size));
        stated.for_each(|(id, size)| _ = sizes.entry(id).or_insert(size));
    }
    let patient = |(id, camera): (&String, &artifact::RigCamera)| Patient {
        id: id.clone(),
        camera: camera.camera.clone(),
        footage_size: sizes.get(id).copied(),
    };
    let patients = rig.cameras.iter().map(patient).collect();
    let mut evidence = Evidence { patients, sightings: Vec::new(), lengths: Vec::new() };
    for path in given.tracks {
        add_tracks(run, path, given.lengths, &mut evidence)?;
    }
    if given.tracks.is_empty() && !given.lengths.is_empty() {
        bail!("--length says a length in tracks, but no --tracks are given");
    }
    if let Some(corners) = &corners {
        add_corners(corners, &mut evidence);
    }
    Ok(evidence)
}

/// A camera that the calibration does not know.
fn foreign(path: &Path, id: &str) -> Error {
    let error = Error::new(path, "the calibration has no such camera").at(format!("camera {id}"));
    error.fix("give the cameras, and the tracks or corners, of one rig")
}

fn add_tracks(run: &mut Run, path: &Path, lengths: &[Length], evidence: &mut Evidence) -> anyhow::Result<()> {
    run.input("tracks", path)?;
    let reader = FrameReader::<Tracks2d>::open(path)?;
    let header = reader.header().clone();
    let place = |id: &String| {
        let place = evidence.patients.iter().position(|patient| patient.id == *id);
        place.ok_or_else(|| foreign(path, id))
    };
    let cameras: Vec<usize> = header.cameras.iter().map(place).collect::<Result<_, _>>()?;
    let mut index: BTreeMap<(String, i64), usize> = BTreeMap::new();
    for frame in reader {
        let frame = frame?;
        for (marker, name) in header.markers.iter().enumerate() {
            let views = views(&frame, &cameras, marker);
            if !views.is_empty() {
                index.insert((name.clone(), frame.frame), evidence.sightings.len());
                evidence.sightings.push(Sighting { frame: frame.frame, name: name.clone(), views });
            }
        }
    }
    for length in lengths {
        let known = known(length, &header, &index);
        if known.is_empty() {
            let what = "a length is stated between markers or frames that it does not have";
            return Err(Error::new(path, what).at(format!("--length {}={}", length.ends, length.mm)).into());
        }
        evidence.lengths.extend(known);
    }
    Ok(())
}

/// Points that were really seen: predictions prove nothing.
fn views(frame: &Tracks2dFrame, cameras: &[usize], marker: usize) -> Vec<(usize, Vector2<f64>)> {
    let seen = cameras.iter().zip(&frame.cameras).filter_map(|(camera, samples)| {
        let sample = samples.as_ref()?[marker].filter(|sample| sample.state != TrackState::Predicted)?;
        Some((*camera, sample.at.coords))
    });
    seen.collect()
}

fn known(
    length: &Length,
    header: &Tracks2dHeader,
    index: &BTreeMap<(String, i64), usize>,
) -> Vec<KnownLength> {
    let mm = length.mm;
    match (&length.ends, header.markers.as_slice()) {
        (Ends::Frames(a, b), [only]) => {
            let ends = [a, b].map(|frame| index.get(&(only.clone(), *frame)).copied());
            let [Some(a), Some(b)] = ends else { return Vec::new() };
            vec![KnownLength { ends: [a, b], mm }]
        }
        (ends, _) => {
            let [a, b] = match ends {
                Ends::Frames(a, b) => [a.to_string(), b.to_string()],
                Ends::Cameras(a, b) => [a.clone(), b.clone()],
            };
            let first = index.iter().filter(|((name, _), _)| *name == a);
            let pair = |((_, frame), &at): (&(String, i64), &usize)| {
                Some(KnownLength { ends: [at, *index.get(&(b.clone(), *frame))?], mm })
            };
            first.filter_map(pair).collect()
        }
    }
}

/// Corners become points of their own in every instant: boards are carried about between, so they tell nothing of the clock.
fn add_corners(corners: &Corners, evidence: &mut Evidence) {
    let board = &corners.header.board;
    let [columns, rows] = board.grid();
    let place = |id: &String| evidence.patients.iter().position(|patient| patient.id == *id);
    let places: BTreeMap<&String, usize> =
        corners.header.cameras.keys().filter_map(|id| Some((id, place(id)?))).collect();
    for frame in &corners.frames {
        let seen: Vec<(usize, BTreeMap<u32, Vector2<f64>>)> = frame
            .seen
            .iter()
            .filter_map(|(id, seen)| {
                Some((*places.get(id)?, seen.iter().map(|(&corner, at)| (corner, at.coords)).collect()))
            })
            .collect();
        let seen = numbered_alike(&evidence.patients, seen, &board.numberings());
        let mut at: BTreeMap<u32, usize> = BTreeMap::new();
        for corner in 0..columns * rows {
            let views: Vec<(usize, Vector2<f64>)> =
                seen.iter().filter_map(|(camera, seen)| Some((*camera, *seen.get(&corner)?))).collect();
            if !views.is_empty() {
                at.insert(corner, evidence.sightings.len());
                let name = format!("corner {corner} of instant {}", frame.frame);
                evidence.sightings.push(Sighting { frame: frame.frame, name, views });
            }
        }
        let mm = board.square_mm();
        for (&corner, &from) in &at {
            let right = (corner % columns + 1 < columns).then_some(corner + 1);
            for next in [right, Some(corner + columns)].into_iter().flatten() {
                evidence.lengths.extend(at.get(&next).map(|&to| KnownLength { ends: [from, to], mm }));
            }
        }
    }
}
