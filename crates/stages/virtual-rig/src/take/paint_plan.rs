//! Which paint goes where: dots on the markers' places, strokes along the wrinkles.

use crate::Error;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Paint on the face. Colours are linear reflectances, red, green, blue.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PaintPlan {
    /// Colour of the dots.
    pub dot_color: [f32; 3],
    /// Smallest and largest radius of a dot, mm.
    pub dot_radius_mm: [f64; 2],
    /// Largest departure of a dot from a circle, share of its radius.
    pub out_of_round: f64,
    /// Colours of strokes by name; neighbouring wrinkles take turns.
    pub stroke_colors: BTreeMap<String, [f32; 3]>,
    /// Half-width of a stroke over the width w of its wrinkle, smallest and largest along it.
    pub stroke_width: [f64; 2],
    /// Width over which the edge of a stroke fades, mm; 0: sharp.
    pub smear_mm: f64,
    /// Share of a stroke's length where the paint is gone.
    pub missing: f64,
    /// Uneven paint of strokes: standard deviation of their reflectance, as a share of it.
    pub texture: f64,
}

/// More uneven paint would have darker places than black.
const MOST_TEXTURE: f64 = 0.2;

impl Default for PaintPlan {
    fn default() -> Self {
        let color = |name: &str, rgb| (name.to_string(), rgb);
        Self {
            dot_color: [0.015, 0.06, 0.32],
            dot_radius_mm: [1.0, 2.0],
            out_of_round: 0.0,
            stroke_colors: [color("green", [0.05, 0.34, 0.10]), color("violet", [0.30, 0.07, 0.38])].into(),
            stroke_width: [0.7, 3.0],
            smear_mm: 0.0,
            missing: 0.0,
            texture: 0.0,
        }
    }
}

impl PaintPlan {
    /// Whether such paint can be.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self) -> Result<(), Error> {
        let wrong = |field: &str, what: &str| Err(Error::parameter(format!("paint.{field}"), what));
        let rises = |[low, high]: [f64; 2]| low > 0.0 && high >= low && high.is_finite();
        let share = |x: f64| (0.0..=1.0).contains(&x);
        if !rises(self.dot_radius_mm) || self.dot_radius_mm[1] > 10.0 {
            return wrong("dot_radius_mm", "must be two positive lengths in rising order, at most 10 mm");
        }
        if !rises(self.stroke_width) {
            return wrong("stroke_width", "must be two positive shares in rising order");
        }
        if !(0.0..=0.5).contains(&self.out_of_round) {
            return wrong("out_of_round", "must lie between 0 and 0.5");
        }
        if !(self.smear_mm >= 0.0 && self.smear_mm.is_finite()) {
            return wrong("smear_mm", "must not be negative");
        }
        if !share(self.missing) {
            return wrong("missing", "is a share from 0 to 1");
        }
        if !(0.0..=MOST_TEXTURE).contains(&self.texture) {
            return wrong("texture", "is a share from 0 to 0.2");
        }
        if self.stroke_colors.len() < 2 {
            return wrong("stroke_colors", "name at least two colours: neighbouring wrinkles take turns");
        }
        let colors = self.stroke_colors.values().chain([&self.dot_color]);
        if colors.flatten().any(|channel| !(0.0..=1.0).contains(channel)) {
            return wrong("stroke_colors", "reflectances lie between 0 and 1");
        }
        Ok(())
    }
}
