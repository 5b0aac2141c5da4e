//! `tracks-2d/1`: markers in the images of every camera, over frames.

use crate::finite::within;
use crate::ids::{Known, PerCamera};
use crate::{Kind, Rate, Stream, TakeRef, Violation, finite};
use nalgebra::Point2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The kind of tracks.
pub struct Tracks2d;

/// What holds for all frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tracks2dHeader {
    /// Camera ids; the order in memory.
    pub cameras: Vec<String>,
    /// Marker ids; the order in memory.
    pub markers: Vec<String>,
    /// Frames per second; absent where the source did not say.
    pub rate: Option<Rate>,
    /// The take that the markers were recorded in.
    pub take: Option<TakeRef>,
}

/// Where a point comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TrackState {
    /// Found in the image.
    #[default]
    Seen,
    /// Hidden; the tracker's prediction, kept.
    Predicted,
    /// Set by a person.
    Edited,
}

impl TrackState {
    #[allow(clippy::trivially_copy_pass_by_ref, reason = "used as a predicate on map values")]
    fn is_seen(&self) -> bool {
        *self == Self::Seen
    }
}

/// A marker in an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample2d {
    /// The marker's centre, px; pixel (0, 0) is the centre of the top-left pixel.
    pub at: Point2<f64>,
    /// Where the point comes from.
    pub state: TrackState,
    /// How sure the tracker is, 0–1.
    pub confidence: f64,
}

impl Sample2d {
    /// A point that is surely seen.
    #[must_use]
    pub fn seen(at: Point2<f64>) -> Self {
        Self { at, state: TrackState::Seen, confidence: 1.0 }
    }
}

/// All markers in all cameras in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Tracks2dFrame {
    /// Absolute frame number.
    pub frame: i64,
    /// Per camera of the header, per marker of the header its sample; `None` for a camera that has no image of the frame,
    /// and for a marker that is lost.
    pub cameras: Vec<Option<Vec<Option<Sample2d>>>>,
}

/// A line of the file.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tracks2dLine {
    frame: i64,
    /// Per camera id, per marker id its centre, px. No entry of a camera: it has no image of the frame; no entry of a marker: it
    /// is lost.
    points: PerCamera<[f64; 2]>,
    /// How sure the tracker is, 0–1, where it is not 1.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    confidence: PerCamera<f64>,
    /// States of points that were not simply seen.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    state: PerCamera<TrackState>,
}

impl Kind for Tracks2d {
    const NAME: &'static str = "tracks-2d";
    const VERSION: u32 = 1;
}

fn known(header: &Tracks2dHeader) -> Known<'_> {
    Known { cameras: &header.cameras, thing: "marker", things: header.markers.iter().collect() }
}

impl Stream for Tracks2d {
    type Header = Tracks2dHeader;
    type Frame = Tracks2dFrame;
    type Line = Tracks2dLine;

    fn check(header: &Tracks2dHeader) -> Result<(), Violation> {
        header.rate.map_or(Ok(()), |rate| rate.check("rate"))?;
        known(header).check()
    }

    fn encode(header: &Tracks2dHeader, frame: &Tracks2dFrame) -> Result<Tracks2dLine, Violation> {
        check_shape(header, frame)?;
        let mut line = Tracks2dLine {
            frame: frame.frame,
            points: PerCamera::new(),
            confidence: PerCamera::new(),
            state: PerCamera::new(),
        };
        for (camera, samples) in header.cameras.iter().zip(&frame.cameras) {
            let Some(samples) = samples else { continue };
            let there = || {
                let pairs = header.markers.iter().zip(samples);
                pairs.filter_map(|(marker, sample)| sample.as_ref().map(|sample| (marker.clone(), sample)))
            };
            let points = there().map(|(marker, sample)| (marker, sample.at.into())).collect();
            line.points.insert(camera.clone(), points);
            let confidence = there().map(|(marker, sample)| (marker, sample.confidence));
            keep(&mut line.confidence, camera, confidence.filter(|(_, confidence)| *confidence != 1.0));
            let state = there().map(|(marker, sample)| (marker, sample.state));
            keep(&mut line.state, camera, state.filter(|(_, state)| !state.is_seen()));
        }
        check_line(header, &line)?;
        Ok(line)
    }

    fn decode(header: &Tracks2dHeader, line: Tracks2dLine) -> Result<Tracks2dFrame, Violation> {
        check_line(header, &line)?;
        let sample = |camera: &String, marker: &String| {
            Some(Sample2d {
                at: (*entry(&line.points, camera, marker)?).into(),
                state: entry(&line.state, camera, marker).copied().unwrap_or_default(),
                confidence: entry(&line.confidence, camera, marker).copied().unwrap_or(1.0),
            })
        };
        let samples = |camera: &String| {
            line.points
                .contains_key(camera)
                .then(|| header.markers.iter().map(|marker| sample(camera, marker)).collect())
        };
        Ok(Tracks2dFrame { frame: line.frame, cameras: header.cameras.iter().map(samples).collect() })
    }

    fn number(frame: &Tracks2dFrame) -> i64 {
        frame.frame
    }
}

/// Refuses a frame whose cameras or markers are not those of the header.
fn check_shape(header: &Tracks2dHeader, frame: &Tracks2dFrame) -> Result<(), Violation> {
    let refuse = |place: &str, what: &str, [found, wanted]: [usize; 2]| match found == wanted {
        true => Ok(()),
        false => Err(Violation::new(place, format!("holds {found} {what}, the header names {wanted}"))),
    };
    let place = format!("frame {}", frame.frame);
    refuse(&place, "cameras", [frame.cameras.len(), header.cameras.len()])?;
    for (camera, samples) in header.cameras.iter().zip(&frame.cameras) {
        let count = samples.as_ref().map_or(header.markers.len(), Vec::len);
        refuse(&format!("{place}, camera {camera}"), "markers", [count, header.markers.len()])?;
    }
    Ok(())
}

/// Adds a camera's entries where there are any.
fn keep<T>(map: &mut PerCamera<T>, camera: &str, entries: impl Iterator<Item = (String, T)>) {
    let entries: BTreeMap<String, T> = entries.collect();
    if !entries.is_empty() {
        map.insert(camera.to_string(), entries);
    }
}

fn entry<'a, T>(map: &'a PerCamera<T>, camera: &str, marker: &str) -> Option<&'a T> {
    map.get(camera)?.get(marker)
}

fn check_line(header: &Tracks2dHeader, line: &Tracks2dLine) -> Result<(), Violation> {
    let known = known(header);
    known.check_values(line.frame, &line.points, |place, at| finite(place, at))?;
    known.check_values(line.frame, &line.confidence, |place, &confidence| {
        within(place, "the confidence", confidence, 0.0..=1.0)
    })?;
    known.check_values(line.frame, &line.state, |_, _| Ok(()))?;
    check_points(line, &line.confidence, "confidence")?;
    check_points(line, &line.state, "state")
}

/// Refuses what is said of a point that is not there.
fn check_points<T>(line: &Tracks2dLine, said: &PerCamera<T>, what: &str) -> Result<(), Violation> {
    for (camera, said) in said {
        if let Some(marker) = said.keys().find(|marker| entry(&line.points, camera, marker).is_none()) {
            let place = format!("frame {}, camera {camera}, marker {marker}", line.frame);
            return Err(Violation::new(place, format!("has a {what}, but no point")));
        }
    }
    Ok(())
}
