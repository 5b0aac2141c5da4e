//! `head-pose/1`: where the head is in the world, frame by frame.

use crate::quantity::Rate;
use crate::{Kind, Stream, TakeRef, Violation, finite};
use nalgebra::{Isometry3, Quaternion, UnitQuaternion};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The kind of head poses.
pub struct HeadPose;

/// What holds for all frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeadPoseHeader {
    /// Frames per second; absent where the source did not say.
    pub rate: Option<Rate>,
    /// The frame whose pose defines head space: there the transform is the identity.
    pub reference_frame: i64,
    /// The markers that the pose was found from.
    pub markers: Vec<String>,
    /// The take.
    pub take: Option<TakeRef>,
}

/// The pose in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct HeadPoseFrame {
    /// Absolute frame number.
    pub frame: i64,
    /// Head to world, translation in mm; `None` where too few markers were seen.
    pub world_from_head: Option<Isometry3<f64>>,
    /// Root mean square distance of the markers used from their place on the rigid head, mm.
    pub residual_mm: Option<f64>,
    /// How many markers the pose was found from; 0 where it was interpolated over time.
    pub markers_used: usize,
}

/// A line of the file.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeadPoseLine {
    frame: i64,
    /// Null where too few markers were seen.
    world_from_head: Option<Transform>,
    /// Root mean square distance of the markers used from their place on the rigid head.
    residual_mm: Option<f64>,
    markers_used: usize,
}

/// A rigid transform.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Transform {
    /// Unit quaternion, scalar part first.
    rotation_wxyz: [f64; 4],
    translation_mm: [f64; 3],
}

impl Kind for HeadPose {
    const NAME: &'static str = "head-pose";
    const VERSION: u32 = 1;
}

/// How far a quaternion's length may be from 1.
const UNIT_TOLERANCE: f64 = 1e-6;

impl Stream for HeadPose {
    type Header = HeadPoseHeader;
    type Frame = HeadPoseFrame;
    type Line = HeadPoseLine;

    fn check(header: &HeadPoseHeader) -> Result<(), Violation> {
        header.rate.map_or(Ok(()), |rate| rate.check("rate"))?;
        crate::ids::check_marker_ids(&header.markers)
    }

    fn encode(_: &HeadPoseHeader, frame: &HeadPoseFrame) -> Result<HeadPoseLine, Violation> {
        let world_from_head = frame.world_from_head.map(|pose| {
            let q = pose.rotation;
            Transform { rotation_wxyz: [q.w, q.i, q.j, q.k], translation_mm: pose.translation.vector.into() }
        });
        if let Some(transform) = &world_from_head {
            finite(
                &format!("frame {}, world_from_head", frame.frame),
                transform.rotation_wxyz.iter().chain(&transform.translation_mm),
            )?;
        }
        finite(&format!("frame {}, residual_mm", frame.frame), &frame.residual_mm)?;
        let HeadPoseFrame { frame, residual_mm, markers_used, .. } = *frame;
        Ok(HeadPoseLine { frame, world_from_head, residual_mm, markers_used })
    }

    fn decode(_: &HeadPoseHeader, line: HeadPoseLine) -> Result<HeadPoseFrame, Violation> {
        let place = format!("frame {}", line.frame);
        let pose = |transform: Transform| {
            finite(&place, transform.rotation_wxyz.iter().chain(&transform.translation_mm))?;
            let [w, i, j, k] = transform.rotation_wxyz;
            let quaternion = Quaternion::new(w, i, j, k);
            if (quaternion.norm() - 1.0).abs() > UNIT_TOLERANCE {
                return Err(Violation::new(
                    &place,
                    format!("the rotation's quaternion has length {}, not 1", quaternion.norm()),
                ));
            }
            // Within tolerance the numbers stay as written, so that a file reads back exactly.
            let rotation = UnitQuaternion::new_unchecked(quaternion);
            Ok(Isometry3::from_parts(transform.translation_mm.into(), rotation))
        };
        Ok(HeadPoseFrame {
            frame: line.frame,
            world_from_head: line.world_from_head.map(pose).transpose()?,
            residual_mm: line.residual_mm,
            markers_used: line.markers_used,
        })
    }

    fn number(frame: &HeadPoseFrame) -> i64 {
        frame.frame
    }
}
