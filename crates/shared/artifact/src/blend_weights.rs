//! `blend-weights/1`: how much of each reference pose's wrinkles shows, over frames [DutreveMeyer2011, Eq. 4–5].

use crate::finite::within;
use crate::ids::check_ids;
use crate::quantity::Rate;
use crate::{FileRef, Kind, Stream, Violation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The kind of blend weights.
pub struct BlendWeights;

/// What holds for all frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BlendWeightsHeader {
    /// The character.
    pub model: FileRef,
    /// Its mesh that the vertices are of.
    pub mesh: String,
    /// How many vertices it has.
    pub vertex_count: usize,
    /// Ids of the reference poses.
    pub poses: Vec<String>,
    /// Names of the bones that move in any of them.
    pub bones: Vec<String>,
    /// Frames per second; absent where the source did not say.
    pub rate: Option<Rate>,
}

/// One frame, in memory and in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BlendWeightsFrame {
    /// Absolute frame number.
    pub frame: i64,
    /// Per pose and bone the share of its way that the bone went, α, 0 to 1. No entry: the bone does not move in the pose.
    pub bones: BTreeMap<String, BTreeMap<String, f64>>,
    /// Per pose one weight β per vertex, 0 to 1. No entry: all are 0. Absent as a whole where only bones were asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vertices: Option<BTreeMap<String, Vec<f32>>>,
}

impl Kind for BlendWeights {
    const NAME: &'static str = "blend-weights";
    const VERSION: u32 = 1;
}

impl Stream for BlendWeights {
    type Header = BlendWeightsHeader;
    type Frame = BlendWeightsFrame;
    type Line = BlendWeightsFrame;

    fn check(header: &BlendWeightsHeader) -> Result<(), Violation> {
        header.rate.map_or(Ok(()), |rate| rate.check("rate"))?;
        check_ids("poses", "pose", &header.poses)?;
        check_ids("bones", "bone", &header.bones)
    }

    fn encode(
        header: &BlendWeightsHeader,
        frame: &BlendWeightsFrame,
    ) -> Result<BlendWeightsFrame, Violation> {
        check_frame(header, frame)?;
        Ok(frame.clone())
    }

    fn decode(header: &BlendWeightsHeader, line: BlendWeightsFrame) -> Result<BlendWeightsFrame, Violation> {
        check_frame(header, &line)?;
        Ok(line)
    }

    fn number(frame: &BlendWeightsFrame) -> i64 {
        frame.frame
    }
}

fn check_frame(header: &BlendWeightsHeader, frame: &BlendWeightsFrame) -> Result<(), Violation> {
    let place = |pose: &String| {
        let place = format!("frame {}, pose {pose}", frame.frame);
        match header.poses.contains(pose) {
            true => Ok(place),
            false => Err(Violation::new(place, "is not among the header's poses")),
        }
    };
    for (pose, bones) in &frame.bones {
        let place = place(pose)?;
        for (bone, share) in bones {
            if !header.bones.contains(bone) {
                return Err(Violation::new(
                    format!("{place}, bone {bone}"),
                    "is not among the header's bones",
                ));
            }
            within(&format!("{place}, bone {bone}"), "the share", *share, 0.0..=1.0)?;
        }
    }
    for (pose, weights) in frame.vertices.iter().flatten() {
        let place = place(pose)?;
        if weights.len() != header.vertex_count {
            let what =
                format!("has {} weights, but the mesh {} vertices", weights.len(), header.vertex_count);
            return Err(Violation::new(place, what));
        }
        for (vertex, weight) in weights.iter().enumerate() {
            within(&format!("{place}, vertex {vertex}"), "the weight", f64::from(*weight), 0.0..=1.0)?;
        }
    }
    Ok(())
}
