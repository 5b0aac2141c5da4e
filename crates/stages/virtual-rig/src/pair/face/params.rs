//! What a pair of photographs of a face shows.

use crate::Error;
use crate::wrinkle::{self, Style};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A face, its expression, its light, and how the photographs are spoilt.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FaceScenario {
    /// What each muscle does in the expression, 0 to 1.
    pub muscles: BTreeMap<String, f64>,
    /// Vertices of the face; half of them lie at its lines.
    pub vertices: usize,
    /// Longest edge at a line, mm.
    pub crease_mm: f64,
    /// Which lines the face has.
    pub lines: Style,
    /// How it folds.
    pub folds: wrinkle::Params,
    /// Side of the photographs, px.
    pub side_px: u32,
    /// Size of a pixel on the face, mm.
    pub pixel_mm: f64,
    /// Distance of the camera, mm.
    pub distance_mm: f64,
    /// Share of the light on skin that faces the camera which comes from a flash beside the lens; the rest is open sky.
    pub flash_share: f64,
    /// How far the flash stands off the line of sight: its direction is (x, y, 1), y up.
    pub flash_tilt: [f64; 2],
    /// Rays from a place near a line; others get an eighth.
    pub rays: u32,
    /// Times that light goes on from skin to skin.
    pub bounces: u32,
    /// What else differs.
    pub degradation: FaceDegradation,
}

/// What makes photographs of a face differ though nothing wrinkled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FaceDegradation {
    /// Standard deviation of a landmark's place, per axis, px.
    pub landmark_px: f64,
    /// How far the head turns between the photographs, per axis at most, degrees.
    pub turn_deg: f64,
    /// How far it moves, per axis at most, mm.
    pub shift_mm: f64,
    /// Change of exposure between the photographs, least and most, as a share, up or down.
    pub exposure: [f64; 2],
    /// How much the light changes slowly over the picture, as a share.
    pub uneven: f64,
    /// Brightness of the sheen where skin faces half-way to the flash, as a share of its light.
    pub specular: f64,
    /// Standard deviation of the lens's blur, px.
    pub blur_px: f64,
    /// Noise of mid-grey, as a share of it.
    pub noise: f64,
}

impl Default for FaceScenario {
    fn default() -> Self {
        Self {
            muscles: BTreeMap::new(),
            vertices: 300_000,
            crease_mm: 0.0,
            lines: Style::default(),
            folds: wrinkle::Params::default(),
            side_px: 1024,
            pixel_mm: 0.22,
            distance_mm: 1500.0,
            flash_share: 0.0,
            flash_tilt: [0.0; 2],
            rays: 256,
            bounces: 2,
            degradation: FaceDegradation::default(),
        }
    }
}

impl Default for FaceDegradation {
    fn default() -> Self {
        Self {
            landmark_px: 1.0,
            turn_deg: 1.5,
            shift_mm: 8.0,
            exposure: [0.05, 0.15],
            uneven: 0.02,
            specular: 0.06,
            blur_px: 0.8,
            noise: 0.02,
        }
    }
}

impl FaceDegradation {
    /// Nothing differs.
    #[must_use]
    pub fn none() -> Self {
        Self {
            landmark_px: 0.0,
            turn_deg: 0.0,
            shift_mm: 0.0,
            exposure: [0.0; 2],
            uneven: 0.0,
            specular: 0.0,
            blur_px: 0.0,
            noise: 0.0,
        }
    }
}

impl FaceScenario {
    /// Whether the numbers make photographs.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first that does not.
    pub fn check(&self) -> Result<(), Error> {
        let known = |name: &String| crate::body::MUSCLES.contains(&name.as_str());
        if let Some(name) = self.muscles.keys().find(|name| !known(name)) {
            let what = format!("is no muscle; there are {}", crate::body::MUSCLES.join(", "));
            return Err(Error::parameter(format!("muscles.{name}"), what));
        }
        self.lines.check()?;
        self.folds.check()?;
        let within = |value: f64, low: f64, high: f64| (low..=high).contains(&value);
        let own = &self.degradation;
        let [least, most] = own.exposure;
        for (name, good, what) in [
            (
                "muscles",
                self.muscles.values().all(|weight| within(*weight, 0.0, 1.5)),
                "must lie between 0 and 1.5",
            ),
            ("vertices", (1000..=1_500_000).contains(&self.vertices), "must lie between 1000 and 1500000"),
            ("crease_mm", within(self.crease_mm, 0.0, 2.0), "must lie between 0 and 2 mm"),
            ("side_px", (64..=4096).contains(&self.side_px), "must lie between 64 and 4096"),
            ("pixel_mm", within(self.pixel_mm, 0.02, 5.0), "must lie between 0.02 and 5 mm"),
            ("distance_mm", within(self.distance_mm, 300.0, 1e5), "must lie between 300 and 100000 mm"),
            ("flash_share", within(self.flash_share, 0.0, 1.0), "must lie between 0 and 1"),
            ("flash_tilt", self.flash_tilt.iter().all(|tilt| tilt.abs() <= 2.0), "must lie between -2 and 2"),
            ("rays", (64..=1 << 16).contains(&self.rays), "must lie between 64 and 65536"),
            ("bounces", self.bounces <= 16, "must be at most 16"),
            ("degradation.landmark_px", within(own.landmark_px, 0.0, 20.0), "must lie between 0 and 20 px"),
            ("degradation.turn_deg", within(own.turn_deg, 0.0, 20.0), "must lie between 0 and 20 degrees"),
            ("degradation.shift_mm", within(own.shift_mm, 0.0, 50.0), "must lie between 0 and 50 mm"),
            (
                "degradation.exposure",
                0.0 <= least && least <= most && most <= 0.5,
                "must rise, from 0 to 0.5",
            ),
            ("degradation.uneven", within(own.uneven, 0.0, 0.3), "must lie between 0 and 0.3"),
            ("degradation.specular", within(own.specular, 0.0, 1.0), "must lie between 0 and 1"),
            ("degradation.blur_px", within(own.blur_px, 0.0, 10.0), "must lie between 0 and 10 px"),
            ("degradation.noise", within(own.noise, 0.0, 0.5), "must lie between 0 and 0.5"),
        ] {
            if !good {
                return Err(Error::parameter(name, what));
            }
        }
        Ok(())
    }
}
