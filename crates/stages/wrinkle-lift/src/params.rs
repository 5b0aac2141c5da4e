//! What a user can choose, with defaults and units.

use crate::{Error, Result};
use serde::{Deserialize, Serialize};

/// Parameters of lifting.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Params {
    /// Whether curves are shifted by what the depth of their valley moves it in the image, before they are cast. The paper does not.
    pub parallax: bool,
    /// Normals are averaged over this length, standard deviation, mm: relief finer than this does not turn a valley.
    pub normal_mm: f64,
    /// Bulges of a measured profile are believed to be so high at most, as share of its depth: where its rounding promises higher ones,
    /// the skin around is set anew between the same bottom and the same tops. The paper's profile has e⁻² = 0.135.
    pub bulge: f64,
    /// Sections seen more obliquely than this are left out, degrees off the surface's normal.
    pub max_view_deg: f64,
    /// Distance of the points along a valley, mm.
    pub step_mm: f64,
    /// Gaps along a wrinkle are bridged up to this length, mm; longer ones split it.
    pub gap_mm: f64,
    /// Where one camera's curve ends and another's goes on, one passes into the other over this length, mm.
    pub blend_mm: f64,
    /// Cameras that put a wrinkle farther apart than this disagree, mm: the surer one is followed.
    pub disagree_mm: f64,
    /// Whether wrinkles that are open in a single image, between flat ones, stay.
    pub keep_fleeting: bool,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            parallax: true,
            normal_mm: 1.5,
            bulge: 0.18,
            max_view_deg: 75.0,
            step_mm: 0.5,
            gap_mm: 4.0,
            blend_mm: 4.0,
            disagree_mm: 1.0,
            keep_fleeting: false,
        }
    }
}

impl Params {
    /// Whether the values make sense.
    ///
    /// # Errors
    /// [`Error::Parameter`] that names the one that does not.
    pub fn check(&self) -> Result<()> {
        let lengths = [
            ("normal-mm", self.normal_mm, 0.0, 20.0),
            ("bulge", self.bulge, (-2.0f64).exp(), 10.0),
            ("max-view-deg", self.max_view_deg, 10.0, 89.0),
            ("step-mm", self.step_mm, 0.05, 10.0),
            ("gap-mm", self.gap_mm, 0.0, 50.0),
            ("blend-mm", self.blend_mm, 0.1, 50.0),
            ("disagree-mm", self.disagree_mm, 0.01, 50.0),
        ];
        match lengths.iter().find(|(_, value, low, high)| !(*low..=*high).contains(value)) {
            Some((name, value, low, high)) => {
                Err(Error::Parameter(format!("{name} is {value}; it must lie between {low} and {high}")))
            }
            None => Ok(()),
        }
    }
}
