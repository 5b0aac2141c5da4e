//! `landmarks/1`: places that a person or a detector found in a picture of a face.

use crate::{Document, FileRef, Kind, Violation, finite};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Landmarks of one picture. The same id means the same place on the skin in every picture; which place that is, they need
/// not say.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Landmarks {
    /// The picture.
    pub image: Option<FileRef>,
    /// Width and height of the picture, px, as it is seen: turned as its file says.
    pub size: Option<[u32; 2]>,
    /// Distance of the pupils, px: the scale of the face.
    pub interocular_px: Option<f64>,
    /// By id.
    pub points: BTreeMap<String, Landmark>,
}

/// A place in a picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Landmark {
    /// Where it is, px; pixel (0, 0) is the centre of the top-left pixel.
    pub at: [f64; 2],
    /// How far it lies behind the middle of the face, px; `null`: not known.
    pub depth_px: Option<f64>,
}

impl Kind for Landmarks {
    const NAME: &'static str = "landmarks";
    const VERSION: u32 = 1;
}

impl Document for Landmarks {
    fn check(&self) -> Result<(), Violation> {
        if self.interocular_px.is_some_and(|length| !(length.is_finite() && length > 0.0)) {
            return Err(Violation::new("interocular_px", "must be above 0"));
        }
        let mut taken = BTreeMap::new();
        for (id, point) in &self.points {
            let place = format!("landmark {id}");
            if id.is_empty() {
                return Err(Violation::new("points", "a landmark has an empty id"));
            }
            finite(&place, &point.at)?;
            finite(&place, &point.depth_px)?;
            if let Some(other) = taken.insert(point.at.map(f64::to_bits), id) {
                return Err(Violation::new(
                    place,
                    format!("sits at {:?}, as landmark {other} does", point.at),
                ));
            }
        }
        Ok(())
    }
}
