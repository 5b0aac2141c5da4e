//! Parameters, with their units and defaults.

use crate::Error;
use serde::Serialize;

/// Which model is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Default)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// The paper's: a sharp, symmetric profile under a uniform sky, seen from above by a perfect camera.
    Paper,
    /// Rounded and asymmetric, with what light, paint, view and lens do to its image.
    #[default]
    Extended,
}

/// How sections are measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Params {
    /// The model.
    pub model: Model,
    /// Distance of the sections along a wrinkle, px.
    pub step_px: f64,
    /// How far from a curve paint is looked for, px.
    pub reach_px: f64,
    /// Standard deviation of the lens's blur, px.
    pub lens_blur_px: f64,
    /// Share of the light that the paint's brightest channel throws back; estimated from the channels if absent.
    pub albedo: Option<f64>,
    /// Angle by which the camera stands off the skin's normal across all wrinkles, degrees, positive on their right; fitted if absent.
    pub tilt_deg: Option<f64>,
    /// How much better than flat skin a valley must explain the image: twice the gain in log-likelihood, after the correlation of
    /// neighbouring pixels.
    pub gate: f64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            model: Model::default(),
            step_px: 2.0,
            reach_px: 48.0,
            lens_blur_px: 0.7,
            albedo: None,
            tilt_deg: None,
            gate: 10.5,
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
        within("step-px", self.step_px, 0.5..=50.0, "it must lie between 0.5 and 50 px")?;
        within("reach-px", self.reach_px, 4.0..=400.0, "it must lie between 4 and 400 px")?;
        within("lens-blur-px", self.lens_blur_px, 0.0..=20.0, "it must lie between 0 and 20 px")?;
        if let Some(albedo) = self.albedo {
            within("albedo", albedo, 0.0..=0.95, "it must lie between 0 and 0.95")?;
        }
        if let Some(tilt) = self.tilt_deg {
            within("tilt-deg", tilt, -75.0..=75.0, "it must lie between -75 and 75 degrees")?;
        }
        within("gate", self.gate, 0.0..=1e6, "it must lie between 0 and 1000000")
    }
}
