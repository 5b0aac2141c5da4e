//! Parameters, with their units and defaults.

use crate::Error;
use serde::Serialize;

/// How a ratio image becomes normals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// The paper's [DutreveMeyer2011, Eq. 1–3].
    Paper,
    /// Local exposure, dead zone, the side from a smoothed ratio, one surface under all slopes.
    #[default]
    Estimator,
}

/// How the exposure of the expression's photograph over the neutral one's is taken out of the ratio.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Exposure {
    /// Not at all.
    None,
    /// The median over the region.
    Global,
    /// A smooth one that wrinkles do not pull at.
    Local,
}

/// What is known of the light.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Light {
    /// Share of the light on skin that faces the camera which comes from a flash beside the lens: 1 flash, 0 open sky.
    pub flash_share: f64,
    /// How far the flash stands off the line of sight, towards (x, y, 1); y up.
    pub tilt: [f64; 2],
}

/// How normals are found. Lengths that grow with the face are shares of the distance between the pupils (io).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Params {
    /// The method.
    pub mode: Mode,
    /// What is known of the light; none: nothing.
    pub light: Option<Light>,
    /// How exposure is taken out; by the method if absent: none in the paper's, else local.
    pub exposure: Option<Exposure>,
    /// Standard deviation of the blur before anything else, io.
    pub blur_io: f64,
    /// Standard deviation over which exposure may change, io.
    pub exposure_io: f64,
    /// Standard deviation of the blur of the ratio whose gradient tells the side; by the light if absent, io.
    pub side_io: Option<f64>,
    /// Wrinkles beyond this length are flattened, io.
    pub reach_io: f64,
    /// Noise levels of the dead zone.
    pub dead_zone: f64,
    /// Tilt for a darkening, over that under a flash; by the light if absent.
    pub gain: Option<f64>,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            mode: Mode::default(),
            light: None,
            exposure: None,
            blur_io: 0.005,
            exposure_io: 0.08,
            side_io: None,
            reach_io: 0.1,
            dead_zone: 1.0,
            gain: None,
        }
    }
}

impl Params {
    /// Refuses values that make no sense.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn check(&self) -> Result<(), Error> {
        let within =
            |name, value: f64, range: std::ops::RangeInclusive<f64>, allowed| match range.contains(&value) {
                true => Ok(()),
                false => Err(Error::Parameter { name, value, allowed }),
            };
        within(
            "blur",
            self.blur_io,
            0.0..=0.1,
            "it must lie between 0 and 0.1 of the distance of the pupils",
        )?;
        within(
            "exposure-reach",
            self.exposure_io,
            0.02..=2.0,
            "it must lie between 0.02 and 2 distances of the pupils",
        )?;
        within("reach", self.reach_io, 0.01..=2.0, "it must lie between 0.01 and 2 distances of the pupils")?;
        within("dead-zone", self.dead_zone, 0.0..=20.0, "it must lie between 0 and 20 noise levels")?;
        within("gain", self.gain.unwrap_or(1.0), 0.1..=5.0, "it must lie between 0.1 and 5")?;
        within(
            "side-blur",
            self.side_io.unwrap_or(0.02),
            0.001..=0.2,
            "it must lie between 0.001 and 0.2 of the distance of the pupils",
        )?;
        let Some(light) = self.light else { return Ok(()) };
        within("the flash's share", light.flash_share, 0.0..=1.0, "it must lie between 0 and 1")?;
        for tilt in light.tilt {
            within("the flash's tilt", tilt, -1.0..=1.0, "it must lie between -1 and 1")?;
        }
        Ok(())
    }

    /// How exposure is taken out.
    #[must_use]
    pub fn exposure(&self) -> Exposure {
        let usual = if self.mode == Mode::Paper { Exposure::None } else { Exposure::Local };
        self.exposure.unwrap_or(usual)
    }
}
