//! `trajectories-3d/1` (mocap space) and `head-trajectories/1` (head space): markers in 3D over frames.

use crate::ids::check_marker_ids;
use crate::quantity::Rate;
use crate::{
    Error, FrameReader, FrameWriter, Kind, Result, Staged, Stream, TakeRef, Unit, Violation, finite,
};
use nalgebra::Point3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// What holds for all frames of a set of trajectories.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MarkerHeader {
    /// Unit of all positions; always `mm` in this kind.
    pub unit: Unit,
    /// Frames per second; absent where the source did not say.
    pub rate: Option<Rate>,
    /// Marker ids; the order of the points in memory.
    pub markers: Vec<String>,
    /// The take that the markers were recorded in; absent for markers without a manifest.
    pub take: Option<TakeRef>,
}

/// Where a sample comes from, when it was not simply measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SampleStatus {
    /// Measured.
    #[default]
    Measured,
    /// Seen by one camera only.
    SingleCamera,
    /// Filled from neighbouring markers.
    NeighborFilled,
    /// Interpolated over time.
    Interpolated,
}

/// All markers in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct MarkerFrame {
    /// Absolute frame number.
    pub frame: i64,
    /// Per marker of the header its position, mm; `None` where it is missing.
    pub points: Vec<Option<Point3<f64>>>,
    /// Per marker where its sample comes from.
    pub status: Vec<SampleStatus>,
}

/// A line of the file.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MarkerLine {
    frame: i64,
    /// Per marker id its position; null (or no entry) where it is missing.
    points: BTreeMap<String, Option<[f64; 3]>>,
    /// Ids of samples that were not simply measured.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    status: BTreeMap<String, SampleStatus>,
    /// Per marker id how well its position was measured: the covariance's xx, xy, xz, yy, yz, zz, mm².
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    covariance_mm2: BTreeMap<String, [f64; 6]>,
    /// Per marker id the cameras that its position was found from.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    views: BTreeMap<String, Vec<String>>,
}

impl MarkerLine {
    /// Every id that stands in the line.
    fn named(&self) -> impl Iterator<Item = &String> {
        let said = self.covariance_mm2.keys().chain(self.views.keys());
        self.points.keys().chain(self.status.keys()).chain(said)
    }
}

/// How well a sample was measured, and from what.
#[derive(Debug, Clone, PartialEq)]
pub struct Accuracy {
    /// Covariance of the measured position: xx, xy, xz, yy, yz, zz, mm².
    pub covariance_mm2: [f64; 6],
    /// Ids of the cameras that it was found from.
    pub views: Vec<String>,
}

/// All markers in one frame, and how well they were measured.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredFrame {
    /// The markers.
    pub markers: MarkerFrame,
    /// Per marker of the header how well it was measured; `None` where nothing is said of it.
    pub accuracy: Vec<Option<Accuracy>>,
}

/// The kind of trajectories in mocap space (= world).
pub struct Trajectories3d;

/// The same kind, read and written with what it says of the samples' accuracy; [`Trajectories3d`] passes over that.
pub struct MeasuredTrajectories;

/// The kind of trajectories in head space: the head's rigid motion taken out.
pub struct HeadTrajectories;

impl Kind for Trajectories3d {
    const NAME: &'static str = "trajectories-3d";
    const VERSION: u32 = 1;
}

impl Kind for MeasuredTrajectories {
    const NAME: &'static str = Trajectories3d::NAME;
    const VERSION: u32 = Trajectories3d::VERSION;
}

impl Kind for HeadTrajectories {
    const NAME: &'static str = "head-trajectories";
    const VERSION: u32 = 1;
}

macro_rules! marker_stream {
    ($kind:ty) => {
        impl Stream for $kind {
            type Header = MarkerHeader;
            type Frame = MarkerFrame;
            type Line = MarkerLine;

            fn check(header: &MarkerHeader) -> std::result::Result<(), Violation> {
                check_header(header)
            }
            fn encode(
                header: &MarkerHeader,
                frame: &MarkerFrame,
            ) -> std::result::Result<MarkerLine, Violation> {
                encode(header, frame)
            }
            fn decode(
                header: &MarkerHeader,
                line: MarkerLine,
            ) -> std::result::Result<MarkerFrame, Violation> {
                decode(header, &line)
            }
            fn number(frame: &MarkerFrame) -> i64 {
                frame.frame
            }
        }
    };
}
marker_stream!(Trajectories3d);
marker_stream!(HeadTrajectories);

impl Stream for MeasuredTrajectories {
    type Header = MarkerHeader;
    type Frame = MeasuredFrame;
    type Line = MarkerLine;

    fn check(header: &MarkerHeader) -> std::result::Result<(), Violation> {
        check_header(header)
    }

    fn encode(header: &MarkerHeader, frame: &MeasuredFrame) -> std::result::Result<MarkerLine, Violation> {
        let mut line = encode(header, &frame.markers)?;
        for (id, accuracy) in header.markers.iter().zip(&frame.accuracy) {
            let Some(accuracy) = accuracy else { continue };
            line.covariance_mm2.insert(id.clone(), accuracy.covariance_mm2);
            line.views.insert(id.clone(), accuracy.views.clone());
        }
        check_accuracy(&line)?;
        Ok(line)
    }

    fn decode(header: &MarkerHeader, line: MarkerLine) -> std::result::Result<MeasuredFrame, Violation> {
        let markers = decode(header, &line)?;
        let accuracy = |id: &String| {
            let covariance_mm2 = *line.covariance_mm2.get(id)?;
            Some(Accuracy { covariance_mm2, views: line.views.get(id).cloned().unwrap_or_default() })
        };
        Ok(MeasuredFrame { markers, accuracy: header.markers.iter().map(accuracy).collect() })
    }

    fn number(frame: &MeasuredFrame) -> i64 {
        frame.markers.frame
    }
}

/// Refuses what is said of the accuracy of a sample that is not there, and covariances that are none.
fn check_accuracy(line: &MarkerLine) -> std::result::Result<(), Violation> {
    let place = |id: &String| format!("frame {}, marker {id}", line.frame);
    let is_there = |id: &&String| line.points.get(*id).copied().flatten().is_some();
    if let Some(id) = line.covariance_mm2.keys().chain(line.views.keys()).find(|id| !is_there(id)) {
        return Err(Violation::new(place(id), "has an accuracy, but no position"));
    }
    for (id, covariance) in &line.covariance_mm2 {
        finite(&place(id), covariance)?;
        if let Some(variance) = [0, 3, 5].map(|i| covariance[i]).into_iter().find(|&variance| variance < 0.0)
        {
            return Err(Violation::new(place(id), format!("the variance {variance} mm² is negative")));
        }
    }
    match line.views.iter().find(|(_, views)| views.iter().any(String::is_empty)) {
        Some((id, _)) => Err(Violation::new(place(id), "a camera has an empty id")),
        None => Ok(()),
    }
}

fn check_header(header: &MarkerHeader) -> std::result::Result<(), Violation> {
    if header.unit != Unit::Mm {
        return Err(Violation::new("unit", format!("is {}; this kind is always in mm", header.unit)));
    }
    header.rate.map_or(Ok(()), |rate| rate.check("rate"))?;
    check_marker_ids(&header.markers)
}

fn encode(header: &MarkerHeader, frame: &MarkerFrame) -> std::result::Result<MarkerLine, Violation> {
    let mut points = BTreeMap::new();
    let mut status = BTreeMap::new();
    for (i, marker) in header.markers.iter().enumerate() {
        let point = frame.points[i].map(|point| [point.x, point.y, point.z]);
        if let Some(point) = &point {
            finite(&format!("frame {}, marker {marker}", frame.frame), point)?;
        }
        points.insert(marker.clone(), point);
        if frame.status[i] != SampleStatus::Measured && point.is_some() {
            status.insert(marker.clone(), frame.status[i]);
        }
    }
    let (covariance_mm2, views) = Default::default();
    Ok(MarkerLine { frame: frame.frame, points, status, covariance_mm2, views })
}

fn decode(header: &MarkerHeader, line: &MarkerLine) -> std::result::Result<MarkerFrame, Violation> {
    let place = |id: &String| format!("frame {}, marker {id}", line.frame);
    if let Some(id) = line.named().find(|id| !header.markers.contains(id)) {
        return Err(Violation::new(place(id), "is not among the header's markers"));
    }
    for (id, point) in &line.points {
        finite(&place(id), point.iter().flatten())?;
    }
    check_accuracy(line)?;
    let points = header.markers.iter().map(|id| line.points.get(id).copied().flatten().map(Point3::from));
    let status = header.markers.iter().map(|id| line.status.get(id).copied().unwrap_or_default());
    Ok(MarkerFrame { frame: line.frame, points: points.collect(), status: status.collect() })
}

/// A whole take's markers in memory: what the methods work on.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectories {
    /// What holds for all frames.
    pub header: MarkerHeader,
    /// Frames, numbers rising; gaps stay gaps.
    pub frames: Vec<MarkerFrame>,
}

impl Trajectories {
    /// Index of a marker id.
    #[must_use]
    pub fn marker(&self, id: &str) -> Option<usize> {
        self.header.markers.iter().position(|marker| marker == id)
    }

    /// Reads all frames of a JSON Lines artifact of kind `S`.
    ///
    /// # Errors
    /// As [`FrameReader`].
    pub fn read<S: Stream<Header = MarkerHeader, Frame = MarkerFrame>>(path: &Path) -> Result<Self> {
        let reader = FrameReader::<S>::open(path)?;
        let header = reader.header().clone();
        let frames: Vec<MarkerFrame> = reader.collect::<Result<_>>()?;
        if frames.is_empty() {
            return Err(
                Error::new(path, "holds no frames").fix("the stage that wrote it may have been cut off")
            );
        }
        Ok(Self { header, frames })
    }

    /// Writes all frames as kind `S`.
    ///
    /// # Errors
    /// As [`FrameWriter`].
    pub fn write<S: Stream<Header = MarkerHeader, Frame = MarkerFrame>>(
        &self,
        path: &Path,
    ) -> Result<Staged> {
        let mut writer = FrameWriter::<S>::create(path, self.header.clone())?;
        self.frames.iter().try_for_each(|frame| writer.write(frame))?;
        writer.finish()
    }
}
