//! What a pair of photographs shows.

use crate::Error;
use serde::{Deserialize, Serialize};

/// The bottoms of the grooves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Groove {
    /// exp(−p²): rounded.
    Round,
    /// (|p| − 1) e^(−|p|): a sharp crease between bulges.
    Crease,
    /// No grooves at all: whatever is found is false.
    Flat,
}

/// A patch of skin, its light, and how the photographs are spoilt.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PairScenario {
    /// The grooves.
    pub groove: Groove,
    /// How many there are, fewest and most.
    pub count: [u32; 2],
    /// Their widths, mm.
    pub width_mm: [f64; 2],
    /// Their depths over their widths; the depth itself stays within [`PairScenario::depth_mm`].
    pub depth_over_width: [f64; 2],
    /// Their depths, mm.
    pub depth_mm: [f64; 2],
    /// Side of the photographs, px.
    pub side_px: u32,
    /// Size of a pixel on the skin, mm.
    pub pixel_mm: f64,
    /// Distance of the pupils of the face that the patch belongs to, mm.
    pub interocular_mm: f64,
    /// Share of the light on flat skin that comes from a flash beside the lens; the rest is open sky.
    pub flash_share: f64,
    /// How far the flash stands off the line of sight: its direction is (x, y, 1), y up.
    pub flash_tilt: [f64; 2],
    /// Share of the light that skin throws back.
    pub albedo: f64,
    /// What else differs.
    pub degradation: Degradation,
}

/// What makes photographs differ though nothing wrinkled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Degradation {
    /// Standard deviation of the skin's albedo, as a share.
    pub texture: f64,
    /// How far the landmarks' map leaves the skin from its place, root mean square, fewest and most, px.
    pub misregistration_px: [f64; 2],
    /// Change of exposure between the photographs, least and most, as a share, up or down.
    pub exposure: [f64; 2],
    /// Brightness of the sheen where skin faces the flash, as a share of white skin's light.
    pub specular: f64,
    /// Standard deviation of the lens's blur, px.
    pub blur_px: f64,
    /// Noise of white, as a share of white; shot noise, so that darker places have less.
    pub noise: f64,
}

impl Default for PairScenario {
    fn default() -> Self {
        Self {
            groove: Groove::Round,
            count: [3, 5],
            width_mm: [1.0, 4.0],
            depth_over_width: [0.12, 0.45],
            depth_mm: [0.2, 1.5],
            side_px: 384,
            pixel_mm: 0.15,
            interocular_mm: 62.0,
            flash_share: 0.0,
            flash_tilt: [0.0; 2],
            albedo: 0.4,
            degradation: Degradation::default(),
        }
    }
}

impl Default for Degradation {
    fn default() -> Self {
        Self {
            texture: 0.05,
            misregistration_px: [0.5, 2.0],
            exposure: [0.05, 0.15],
            specular: 0.06,
            blur_px: 0.8,
            noise: 0.012,
        }
    }
}

impl Degradation {
    /// Nothing differs.
    #[must_use]
    pub fn none() -> Self {
        Self {
            texture: 0.0,
            misregistration_px: [0.0; 2],
            exposure: [0.0; 2],
            specular: 0.0,
            blur_px: 0.0,
            noise: 0.0,
        }
    }
}

impl PairScenario {
    /// Whether the numbers make photographs.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first that does not.
    pub fn check(&self) -> Result<(), Error> {
        let rises =
            |[low, high]: [f64; 2], top: f64| 0.0 <= low && low <= high && high <= top && high.is_finite();
        let Degradation { texture, misregistration_px, exposure, specular, blur_px, noise } =
            &self.degradation;
        let share = |value: f64, top: f64| (0.0..=top).contains(&value);
        for (name, good, what) in [
            ("count", self.count[0] <= self.count[1] && self.count[1] <= 20, "must rise and be at most 20"),
            (
                "width_mm",
                rises(self.width_mm, 20.0) && self.width_mm[0] > 0.0,
                "must rise, from above 0 to 20 mm",
            ),
            ("depth_over_width", rises(self.depth_over_width, 1.0), "must rise, from 0 to 1"),
            ("depth_mm", rises(self.depth_mm, 5.0), "must rise, from 0 to 5 mm"),
            ("side_px", (64..=4096).contains(&self.side_px), "must lie between 64 and 4096"),
            ("pixel_mm", (0.01..=2.0).contains(&self.pixel_mm), "must lie between 0.01 and 2 mm"),
            (
                "interocular_mm",
                (20.0..=120.0).contains(&self.interocular_mm),
                "must lie between 20 and 120 mm",
            ),
            ("flash_share", share(self.flash_share, 1.0), "must lie between 0 and 1"),
            ("flash_tilt", self.flash_tilt.iter().all(|tilt| tilt.abs() <= 2.0), "must lie between -2 and 2"),
            ("albedo", share(self.albedo, 0.95), "must lie between 0 and 0.95"),
            ("degradation.texture", share(*texture, 0.3), "must lie between 0 and 0.3"),
            (
                "degradation.misregistration_px",
                rises(*misregistration_px, 10.0),
                "must rise, from 0 to 10 px",
            ),
            ("degradation.exposure", rises(*exposure, 0.5), "must rise, from 0 to 0.5"),
            ("degradation.specular", share(*specular, 1.0), "must lie between 0 and 1"),
            ("degradation.blur_px", share(*blur_px, 10.0), "must lie between 0 and 10 px"),
            ("degradation.noise", share(*noise, 0.5), "must lie between 0 and 0.5"),
        ] {
            if !good {
                return Err(Error::parameter(name, what));
            }
        }
        Ok(())
    }
}
