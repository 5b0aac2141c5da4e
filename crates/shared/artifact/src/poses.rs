//! `poses/1`: the reference poses of a character, each with its wrinkle map [DutreveMeyer2011, Sec. 4.1].

use crate::finite::{finite, within};
use crate::ids::check_ids;
use crate::{Document, FileRef, Kind, Violation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Reference poses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Poses {
    /// The character that they were made for; others with bones of the same names can wear them too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<FileRef>,
    /// The poses; their order is that of wrinkle maps in a shader.
    pub poses: Vec<ReferencePose>,
    /// How much of its wrinkles a bone shows over the share of its way, from [0, 0] to [1, 1], both rising; straight lines
    /// between. Absent: the cosine of [DutreveMeyer2011, Eq. 6].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modulation: Option<Vec<[f64; 2]>>,
}

/// One pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReferencePose {
    /// Its id, e.g. `brows-up`.
    pub id: String,
    /// Where bones stand in their parents, by name; a bone that is not named rests.
    pub bones: BTreeMap<String, BonePlacement>,
    /// Its wrinkle map, a file beside this one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<FileRef>,
}

/// Where a bone stands in its parent; what is absent is as at rest.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BonePlacement {
    /// The move, in units of the character's file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub translation: Option<[f64; 3]>,
    /// Unit quaternion, scalar part first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation_wxyz: Option<[f64; 4]>,
    /// Per axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f64; 3]>,
}

impl Kind for Poses {
    const NAME: &'static str = "poses";
    const VERSION: u32 = 1;
}

/// How far a quaternion's length may be from 1: files that people write have few digits.
const UNIT_TOLERANCE: f64 = 1e-3;

impl Document for Poses {
    fn check(&self) -> Result<(), Violation> {
        if self.poses.is_empty() {
            return Err(Violation::new("poses", "holds no pose"));
        }
        check_ids("poses", "pose", self.poses.iter().map(|pose| &pose.id))?;
        for pose in &self.poses {
            for (bone, placement) in &pose.bones {
                placement.check(&format!("pose {}, bone {bone}", pose.id))?;
            }
        }
        self.modulation.as_deref().map_or(Ok(()), check_curve)
    }
}

impl BonePlacement {
    fn check(&self, place: &str) -> Result<(), Violation> {
        finite(place, self.translation.iter().flatten().chain(self.scale.iter().flatten()))?;
        let Some(rotation) = self.rotation_wxyz else { return Ok(()) };
        finite(place, &rotation)?;
        let length = rotation.iter().map(|x| x * x).sum::<f64>().sqrt();
        match (length - 1.0).abs() <= UNIT_TOLERANCE {
            true => Ok(()),
            false => Err(Violation::new(place, format!("its quaternion has length {length}, not 1"))),
        }
    }
}

fn check_curve(points: &[[f64; 2]]) -> Result<(), Violation> {
    for [share, shown] in points {
        within("modulation", "a share of the way", *share, 0.0..=1.0)?;
        within("modulation", "a share of the wrinkles", *shown, 0.0..=1.0)?;
    }
    let rises = points.windows(2).all(|pair| pair[0][0] < pair[1][0] && pair[0][1] <= pair[1][1]);
    match rises && points.first() == Some(&[0.0; 2]) && points.last() == Some(&[1.0; 2]) {
        true => Ok(()),
        false => Err(Violation::new("modulation", "does not rise from [0, 0] to [1, 1]")),
    }
}
