//! What a user can choose about film and sensor, with defaults and units.

use crate::Error;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

fn require(holds: bool, place: &str, what: impl FnOnce() -> String) -> Result<(), Error> {
    match holds {
        true => Ok(()),
        false => Err(Error::Parameter { place: place.to_string(), what: what() }),
    }
}

/// How light is gathered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Film {
    /// Samples per pixel and side: 4 or 8.
    pub samples_per_side: u32,
    /// What is seen beside the face, linear RGB.
    pub background: [f32; 3],
    /// Gloss of the skin; none is matte.
    pub gloss: Option<Gloss>,
}

impl Default for Film {
    fn default() -> Self {
        Self { samples_per_side: 4, background: [0.015, 0.016, 0.018], gloss: None }
    }
}

impl Film {
    /// Whether the values make sense.
    ///
    /// # Errors
    /// [`Error::Parameter`] that names the one that does not.
    pub fn check(&self) -> Result<(), Error> {
        require(matches!(self.samples_per_side, 4 | 8), "film.samples_per_side", || {
            format!("is {}; 4 or 8 would do", self.samples_per_side)
        })?;
        let light = |&x: &f32| x.is_finite() && x >= 0.0;
        require(self.background.iter().all(light), "film.background", || {
            format!("is {:?}; radiances are finite and not negative", self.background)
        })?;
        self.gloss.as_ref().map_or(Ok(()), Gloss::check)
    }
}

/// A shine on the skin that moves with the camera, so that paint is not the only thing that changes an image: a lobe
/// towards a key light [Blinn1977] and a rim that mirrors the ambient light at grazing angles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Gloss {
    /// Radiance in the middle of the lobe, as a share of the irradiance.
    pub strength: f32,
    /// Sharpness of the lobe: the exponent of cos(normal, half-way direction).
    pub exponent: f32,
    /// Radiance of the rim at 90° to the view, as a share of the irradiance.
    pub rim: f32,
    /// Towards the key light, in world space; any length.
    pub toward_key: [f64; 3],
}

impl Default for Gloss {
    fn default() -> Self {
        Self { strength: 0.25, exponent: 24.0, rim: 0.3, toward_key: [0.3, 0.8, 0.6] }
    }
}

impl Gloss {
    fn check(&self) -> Result<(), Error> {
        for (name, value) in [("strength", self.strength), ("rim", self.rim)] {
            require(value.is_finite() && value >= 0.0, &format!("film.gloss.{name}"), || {
                format!("is {value}; it must not be negative")
            })?;
        }
        require((1.0..=1e4).contains(&self.exponent), "film.gloss.exponent", || {
            format!("is {}; 1 to 10000 would do", self.exponent)
        })?;
        let length: f64 = self.toward_key.iter().map(|x| x * x).sum();
        require(length.is_finite() && length > 0.0, "film.gloss.toward_key", || {
            format!("is {:?}; a direction has a length", self.toward_key)
        })
    }
}

/// From linear light to what is stored.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Transfer {
    /// IEC 61966-2-1.
    #[default]
    Srgb,
    /// None.
    Linear,
    /// v^(1/γ). In footage said to be sRGB, a fault.
    Gamma(f64),
}

/// From light on the sensor to stored values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sensor {
    /// Standard deviation of the lens's blur, px; a defocused camera has several.
    pub lens_blur_px: f64,
    /// Standard deviation of the noise at mid-grey (linear 0.18), as a share of it; half of the variance there is shot
    /// noise, which grows with the light, half is read noise, which does not.
    pub noise_at_mid_grey: f64,
    /// What radiance is multiplied by before it is stored; 1 is stored as white.
    pub gain: f64,
    /// Bits per stored value: 8, which is all that footage has.
    pub bits: u32,
    /// From linear light to stored values.
    pub transfer: Transfer,
}

impl Default for Sensor {
    fn default() -> Self {
        Self { lens_blur_px: 0.7, noise_at_mid_grey: 0.01, gain: 1.0, bits: 8, transfer: Transfer::Srgb }
    }
}

impl Sensor {
    /// A sensor that adds nothing: no blur, no noise.
    #[must_use]
    pub fn ideal() -> Self {
        Self { lens_blur_px: 0.0, noise_at_mid_grey: 0.0, ..Self::default() }
    }

    /// Whether the values make sense.
    ///
    /// # Errors
    /// [`Error::Parameter`] that names the one that does not.
    pub fn check(&self) -> Result<(), Error> {
        let blur = self.lens_blur_px;
        require((0.0..=50.0).contains(&blur), "sensor.lens_blur_px", || {
            format!("is {blur}; 0 to 50 would do")
        })?;
        let noise = self.noise_at_mid_grey;
        require((0.0..=1.0).contains(&noise), "sensor.noise_at_mid_grey", || {
            format!("is {noise}; 0 to 1 would do")
        })?;
        let gain = self.gain;
        require((1e-6..=1e6).contains(&gain), "sensor.gain", || {
            format!("is {gain}; 0.000001 to 1000000 would do")
        })?;
        require(self.bits == 8, "sensor.bits", || {
            format!("is {}; images are stored with 8 bits, so say 8", self.bits)
        })?;
        match self.transfer {
            Transfer::Gamma(gamma) => require((0.2..=5.0).contains(&gamma), "sensor.transfer.gamma", || {
                format!("is {gamma}; 0.2 to 5 would do")
            }),
            Transfer::Srgb | Transfer::Linear => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complaint(result: Result<(), Error>) -> String {
        result.unwrap_err().to_string()
    }

    #[test]
    fn defaults_hold_and_bad_values_are_named() {
        Film::default().check().unwrap();
        Film { gloss: Some(Gloss::default()), ..Film::default() }.check().unwrap();
        Sensor::default().check().unwrap();
        assert!(
            complaint(Film { samples_per_side: 5, ..Film::default() }.check())
                .contains("film.samples_per_side")
        );
        let flat = Gloss { toward_key: [0.0; 3], ..Gloss::default() };
        assert!(
            complaint(Film { gloss: Some(flat), ..Film::default() }.check())
                .contains("film.gloss.toward_key")
        );
        let nan = Sensor { lens_blur_px: f64::NAN, ..Sensor::default() };
        assert!(complaint(nan.check()).contains("sensor.lens_blur_px"));
        let deep = Sensor { bits: 16, ..Sensor::default() };
        assert!(complaint(deep.check()).contains("sensor.bits"));
        let gamma = Sensor { transfer: Transfer::Gamma(0.0), ..Sensor::default() };
        assert!(complaint(gamma.check()).contains("sensor.transfer.gamma"));
    }

    #[test]
    fn a_sensor_reads_as_it_is_written_and_refuses_unknown_keys() {
        let sensor: Sensor = serde_json::from_str(r#"{"transfer": {"gamma": 2.2}, "gain": 2.0}"#).unwrap();
        assert_eq!((sensor.transfer, sensor.gain), (Transfer::Gamma(2.2), 2.0));
        let again: Sensor = serde_json::from_str(&serde_json::to_string(&sensor).unwrap()).unwrap();
        assert_eq!(again, sensor);
        assert!(serde_json::from_str::<Sensor>(r#"{"blur": 1}"#).is_err());
    }
}
