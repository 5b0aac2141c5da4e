//! `handles/1`: displacements of handle vertices in face space, over frames [BickelBotsch2007, Eq. 2].

use crate::ids::check_marker_ids;
use crate::quantity::Rate;
use crate::{FileRef, Kind, MeshRef, Stream, TakeRef, Violation, finite};
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};

/// The kind of handle displacements.
pub struct Handles;

/// What holds for all frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HandlesHeader {
    /// The mesh whose vertices are handles.
    pub mesh: MeshRef,
    /// Frames per second; absent where the source did not say.
    pub rate: Option<Rate>,
    /// The handles; the order of the displacements in memory.
    pub handles: Vec<Handle>,
    /// The take that the motion comes from.
    pub take: Option<TakeRef>,
    /// The warp that mapped it; absent where the handles were made by hand.
    pub warp: Option<FileRef>,
}

/// A vertex that is told where to go.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Handle {
    /// Marker id.
    pub marker: String,
    /// Vertex index, 0-based.
    pub vertex: u32,
}

/// All handles in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct HandleFrame {
    /// Absolute frame number.
    pub frame: i64,
    /// Per handle its displacement from rest, mm; `None` where the marker is missing.
    pub displacements: Vec<Option<Vector3<f64>>>,
    /// Per handle how firmly it is met, `None` = exactly: the stiffness of a spring, relative to the surface's own
    /// stiffness at the handle (1 = as stiff as the surface).
    pub weights: Vec<Option<f64>>,
}

/// A line of the file.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HandleLine {
    frame: i64,
    /// Per marker id its displacement, mm; null (or no entry) where it is missing.
    displacements_mm: BTreeMap<String, Option<[f64; 3]>>,
    /// Per marker id the weight of a handle that is met softly; no entry = met exactly.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    weights: BTreeMap<String, f64>,
}

impl Kind for Handles {
    const NAME: &'static str = "handles";
    const VERSION: u32 = 1;
}

impl Stream for Handles {
    type Header = HandlesHeader;
    type Frame = HandleFrame;
    type Line = HandleLine;

    fn check(header: &HandlesHeader) -> Result<(), Violation> {
        check_marker_ids(header.handles.iter().map(|handle| &handle.marker))?;
        header.rate.map_or(Ok(()), |rate| rate.check("rate"))?;
        let mut taken = HashMap::new();
        for handle in &header.handles {
            let place = format!("marker {}", handle.marker);
            if handle.vertex as usize >= header.mesh.vertex_count {
                let what =
                    format!("names vertex {} of a mesh that has {}", handle.vertex, header.mesh.vertex_count);
                return Err(Violation::new(place, what));
            }
            if let Some(other) = taken.insert(handle.vertex, &handle.marker) {
                let what = format!("sits on vertex {}, as marker {other} does", handle.vertex);
                return Err(Violation::new(place, what));
            }
        }
        Ok(())
    }

    fn encode(header: &HandlesHeader, frame: &HandleFrame) -> Result<HandleLine, Violation> {
        let mut line =
            HandleLine { frame: frame.frame, displacements_mm: BTreeMap::new(), weights: BTreeMap::new() };
        for (i, handle) in header.handles.iter().enumerate() {
            let displacement = frame.displacements[i].map(|displacement| displacement.into());
            line.displacements_mm.insert(handle.marker.clone(), displacement);
            if let Some(weight) = frame.weights[i] {
                line.weights.insert(handle.marker.clone(), weight);
            }
        }
        check_line(header, &line)?;
        Ok(line)
    }

    fn decode(header: &HandlesHeader, line: HandleLine) -> Result<HandleFrame, Violation> {
        check_line(header, &line)?;
        let displacement =
            |handle: &Handle| line.displacements_mm.get(&handle.marker).copied().flatten().map(Vector3::from);
        Ok(HandleFrame {
            frame: line.frame,
            displacements: header.handles.iter().map(displacement).collect(),
            weights: header.handles.iter().map(|handle| line.weights.get(&handle.marker).copied()).collect(),
        })
    }

    fn number(frame: &HandleFrame) -> i64 {
        frame.frame
    }
}

fn check_line(header: &HandlesHeader, line: &HandleLine) -> Result<(), Violation> {
    let place = |id: &String| format!("frame {}, marker {id}", line.frame);
    let known = |id: &&String| header.handles.iter().any(|handle| handle.marker == **id);
    if let Some(id) = line.displacements_mm.keys().chain(line.weights.keys()).find(|id| !known(id)) {
        return Err(Violation::new(place(id), "is not among the header's handles"));
    }
    for (id, displacement) in &line.displacements_mm {
        finite(&place(id), displacement.iter().flatten())?;
    }
    match line.weights.iter().find(|(_, weight)| !(weight.is_finite() && **weight > 0.0)) {
        Some((id, weight)) => Err(Violation::new(place(id), format!("the weight {weight} is not positive"))),
        None => Ok(()),
    }
}
