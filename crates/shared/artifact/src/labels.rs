//! `labels/1`: which marker is where in one frame of each camera, as a person saw it.

use crate::ids::PerCamera;
use crate::{Document, Kind, TakeRef, Violation, finite};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Labelled markers of one frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Labels {
    /// The take.
    pub take: Option<TakeRef>,
    /// Absolute number of the mocap frame.
    pub frame: i64,
    /// Per camera id, per marker id its centre, px; pixel (0, 0) is the centre of the top-left pixel. A marker that a
    /// camera does not see has no entry.
    pub cameras: PerCamera<[f64; 2]>,
}

impl Kind for Labels {
    const NAME: &'static str = "labels";
    const VERSION: u32 = 1;
}

impl Document for Labels {
    fn check(&self) -> Result<(), Violation> {
        for (camera, markers) in &self.cameras {
            let place = format!("camera {camera}");
            if camera.is_empty() || markers.contains_key("") {
                return Err(Violation::new(place, "a camera or a marker has an empty id"));
            }
            for (marker, at) in markers {
                finite(&format!("{place}, marker {marker}"), at)?;
            }
            check_apart(&place, markers.iter())?;
        }
        Ok(())
    }
}

/// Refuses two labels on the very same point: one of them was meant for another marker.
fn check_apart<'a>(
    place: &str,
    markers: impl Iterator<Item = (&'a String, &'a [f64; 2])>,
) -> Result<(), Violation> {
    let mut taken = std::collections::HashMap::new();
    for (marker, at) in markers {
        if let Some(other) = taken.insert(at.map(f64::to_bits), marker) {
            let what = format!("sits at {at:?}, as marker {other} does");
            return Err(Violation::new(format!("{place}, marker {marker}"), what));
        }
    }
    Ok(())
}
