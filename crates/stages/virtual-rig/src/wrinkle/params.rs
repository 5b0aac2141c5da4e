//! What a user can choose about wrinkles, with defaults and units.

use crate::Error;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The form of the sections across a wrinkle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// The paper's S(p) [BickelBotsch2007, Eq. 6]: a sharp crease.
    S,
    /// S(p) with a rounded bottom, its two sides of different width.
    Rounded,
    /// A round valley with a bulge of its own on each side: not of the family that stages fit.
    #[default]
    Foreign,
}

/// The same section everywhere, whatever the face does.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fixed {
    /// Distance from the bottom to where the section crosses the large-scale surface, mm.
    pub w_mm: f64,
    /// Depth as a share of that width.
    pub d_over_w: f64,
}

/// How wrinkles fold.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Params {
    /// The form of the sections.
    pub family: Family,
    /// How far from a line, in widths, the skin gathers into its fold; towards a neighbour only half way.
    pub reach: f64,
    /// From here to the reach, in widths, a section fades to nothing.
    pub fade_from: f64,
    /// Deepest fold, in widths.
    pub d_over_w_max: f64,
    /// The more a fold takes up, the wider it gets, up to this factor.
    pub growth_max: f64,
    /// Compression (a share of length) from which on the fold takes up all of it; less stays in the skin in part, so
    /// that folds set in smoothly.
    pub onset: f64,
    /// Distance of the sections along a line, and of the samples of a section, mm.
    pub station_mm: f64,
    /// Folds do not follow changes of the compression along a line that are shorter than this, mm.
    pub smoothing_mm: f64,
    /// If given, the section of all wrinkles, whatever the compression; nothing slides along the skin then.
    pub fixed: Option<Fixed>,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            family: Family::default(),
            reach: 7.0,
            fade_from: 5.0,
            d_over_w_max: 0.8,
            growth_max: 1.4,
            onset: 0.01,
            station_mm: 0.5,
            smoothing_mm: 2.0,
            fixed: None,
        }
    }
}

impl Params {
    /// Whether the values make sense.
    ///
    /// # Errors
    /// [`Error::Parameter`] that names the one that does not.
    pub fn check(&self) -> Result<(), Error> {
        within("folds.reach", self.reach, 3.0, 20.0)?;
        within("folds.fade_from", self.fade_from, 2.0, self.reach)?;
        within("folds.d_over_w_max", self.d_over_w_max, 0.0, 1.0)?;
        within("folds.growth_max", self.growth_max, 1.0, 2.0)?;
        within("folds.onset", self.onset, 0.0, 0.1)?;
        within("folds.station_mm", self.station_mm, 0.05, 5.0)?;
        within("folds.smoothing_mm", self.smoothing_mm, 0.0, 20.0)?;
        match self.fixed {
            Some(fixed) => {
                within("folds.fixed.w_mm", fixed.w_mm, 0.05, 20.0)?;
                within("folds.fixed.d_over_w", fixed.d_over_w, 0.0, 1.0)
            }
            None => Ok(()),
        }
    }
}

pub(super) fn within(place: &str, value: f64, low: f64, high: f64) -> Result<(), Error> {
    match (low..=high).contains(&value) {
        true => Ok(()),
        false => Err(Error::Parameter {
            place: place.to_string(),
            what: format!("{value} is not possible; say a number from {low} to {high}"),
        }),
    }
}

/// Which lines a face has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Style {
    /// Long lines across the forehead.
    pub forehead: bool,
    /// Upright lines between the brows.
    pub glabella: bool,
    /// Fans beside the eyes.
    pub crows_feet: bool,
    /// From the wings of the nose past the corners of the mouth.
    pub nasolabial: bool,
    /// Factor on all widths.
    pub width: f64,
    /// How much width and form vary along a line: 0 not at all, 1 as on skin.
    pub variation: f64,
    /// Colours of the paint; neighbours take turns.
    pub paints: Vec<String>,
}

impl Default for Style {
    fn default() -> Self {
        Self {
            forehead: true,
            glabella: true,
            crows_feet: true,
            nasolabial: true,
            width: 1.0,
            variation: 1.0,
            paints: vec!["green".to_string(), "violet".to_string()],
        }
    }
}

impl Style {
    /// Whether the values make sense.
    ///
    /// # Errors
    /// [`Error::Parameter`] that names the one that does not.
    pub fn check(&self) -> Result<(), Error> {
        within("lines.width", self.width, 0.3, 3.0)?;
        within("lines.variation", self.variation, 0.0, 2.0)?;
        match self.paints.is_empty() {
            true => Err(Error::Parameter {
                place: "lines.paints".to_string(),
                what: "no colour is named; name at least one".to_string(),
            }),
            false => Ok(()),
        }
    }
}
