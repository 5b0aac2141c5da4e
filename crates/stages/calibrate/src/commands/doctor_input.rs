//! What the doctor is shown.

use super::shared::read_corners;
use anyhow::bail;
use artifact::{
    CameraRig, Error, FrameReader, SyncFrame, SyncHeader, TimeBase, TrackState, Tracks2d, Tracks2dFrame,
    Tracks2dHeader,
};
use calibrate::Corners;
use calibrate::doctor::{
    Evidence, KnownLength, LengthEnds, Patient, Sighting, at_frame_times, numbered_alike,
};
use calibrate::wand::{Ends, Length};
use nalgebra::Vector2;
use stage::Run;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The files.
pub(super) struct Given<'a> {
    pub(super) cameras: &'a Path,
    pub(super) tracks: &'a [PathBuf],
    pub(super) sync: Option<&'a Path>,
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
    let in_tracks = add_distances(given.lengths, &mut evidence);
    if given.tracks.is_empty() && !in_tracks.is_empty() {
        bail!("--scale says a length in tracks, but no --tracks are given\n  to do: give them");
    }
    let clocks = given.sync.map(|path| Clocks::read(run, path)).transpose()?;
    for path in given.tracks {
        add_tracks(run, path, clocks.as_ref(), &in_tracks, &mut evidence)?;
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

/// When images were taken.
struct Clocks<'a> {
    path: &'a Path,
    header: SyncHeader,
    frames: BTreeMap<i64, SyncFrame>,
}

impl<'a> Clocks<'a> {
    fn read(run: &mut Run, path: &'a Path) -> anyhow::Result<Self> {
        let reader = FrameReader::<TimeBase>::open(path)?;
        let header = reader.header().clone();
        let frames = reader.map(|frame| frame.map(|frame| (frame.frame, frame))).collect::<Result<_, _>>()?;
        run.input("sync", path)?;
        Ok(Self { path, header, frames })
    }

    /// Refuses cameras of which it says nothing.
    fn check(&self, ids: &[String]) -> Result<(), Error> {
        let missing = ids.iter().find(|id| !self.header.cameras.contains_key(*id));
        missing.map_or(Ok(()), |id| {
            let error = Error::new(self.path, "the time base says nothing of it").at(format!("camera {id}"));
            Err(error.fix("give the time base of the tracks' take, or leave --sync out"))
        })
    }

    /// Whether a camera's image of a frame only repeats the one before it.
    fn is_doubled(&self, id: &str, frame: i64) -> bool {
        let shown = self.frames.get(&frame).and_then(|frame| frame.shows.get(id).copied().flatten());
        shown.is_some_and(|shown| shown.doubled)
    }
}

/// Takes the distances of cameras out of the known lengths; what is left lies in the tracks.
fn add_distances(lengths: &[Length], evidence: &mut Evidence) -> Vec<Length> {
    let place = |id: &String| evidence.patients.iter().position(|patient| patient.id == *id);
    let distance = |length: &Length| match &length.ends {
        Ends::Cameras(a, b) => {
            let ends = LengthEnds::Cameras([place(a)?, place(b)?]);
            Some(KnownLength { ends, mm: length.mm })
        }
        Ends::Frames(..) => None,
    };
    let distances: Vec<KnownLength> = lengths.iter().filter_map(distance).collect();
    let in_tracks = lengths.iter().filter(|length| distance(length).is_none()).cloned().collect();
    evidence.lengths.extend(distances);
    in_tracks
}

fn add_tracks(
    run: &mut Run,
    path: &Path,
    clocks: Option<&Clocks>,
    lengths: &[Length],
    evidence: &mut Evidence,
) -> anyhow::Result<()> {
    run.input("tracks", path)?;
    let reader = FrameReader::<Tracks2d>::open(path)?;
    let header = reader.header().clone();
    let place = |id: &String| {
        let place = evidence.patients.iter().position(|patient| patient.id == *id);
        place.ok_or_else(|| foreign(path, id))
    };
    let cameras: Vec<usize> = header.cameras.iter().map(place).collect::<Result<_, _>>()?;
    if let Some(clocks) = clocks {
        clocks.check(&header.cameras)?;
    }
    let mut sightings: Vec<Sighting> = Vec::new();
    for frame in reader {
        let mut frame = frame?;
        for (id, samples) in header.cameras.iter().zip(&mut frame.cameras) {
            if clocks.is_some_and(|clocks| clocks.is_doubled(id, frame.frame)) {
                *samples = None;
            }
        }
        for (marker, name) in header.markers.iter().enumerate() {
            let views = views(&frame, &cameras, marker);
            if !views.is_empty() {
                sightings.push(Sighting { frame: frame.frame, name: name.clone(), views });
            }
        }
    }
    if let Some(clocks) = clocks {
        let clock = |camera: usize| &clocks.header.cameras[&evidence.patients[camera].id];
        sightings = at_frame_times(&sightings, |camera, frame| clock(camera).lag_frames(frame));
    }
    let first = evidence.sightings.len();
    let names = sightings.iter().map(|sighting| (sighting.name.clone(), sighting.frame));
    let index: BTreeMap<(String, i64), usize> = names.zip(first..).collect();
    evidence.sightings.extend(sightings);
    for length in lengths {
        let known = known(length, &header, &index);
        if known.is_empty() {
            let what = "a length is stated between what it does not have";
            let error = Error::new(path, what).at(format!("--scale {}={}", length.ends, length.mm));
            return Err(error.fix("name two markers, two frames of a single point, or two cameras").into());
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
            vec![KnownLength { ends: LengthEnds::Sightings([a, b]), mm }]
        }
        (ends, _) => {
            let [a, b] = match ends {
                Ends::Frames(a, b) => [a.to_string(), b.to_string()],
                Ends::Cameras(a, b) => [a.clone(), b.clone()],
            };
            let first = index.iter().filter(|((name, _), _)| *name == a);
            let pair = |((_, frame), &at): (&(String, i64), &usize)| {
                let ends = LengthEnds::Sightings([at, *index.get(&(b.clone(), *frame))?]);
                Some(KnownLength { ends, mm })
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
                let length = |&to: &usize| KnownLength { ends: LengthEnds::Sightings([from, to]), mm };
                evidence.lengths.extend(at.get(&next).map(length));
            }
        }
    }
}
