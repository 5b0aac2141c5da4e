//! What the sky is like, and how closely it is looked at.

use crate::Error;
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Ambient light and how it is sampled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Ambient {
    /// Whether the surface stands in its own light. Without shadows all of it is lit alike: what a tracker then still gets
    /// wrong is not due to shading.
    pub shadows: bool,
    /// Rays over the hemisphere of a point that is looked at closely: in and around painted wrinkles. The error of the
    /// irradiance at a groove's bottom stands in [`super::groove`].
    pub rays: u32,
    /// Rays over the hemisphere of any other point.
    pub cheap_rays: u32,
    /// g of the sky's radiance L(ω) = 1 + g·ω, in the space of the surface; no unit. Its length is the relative change
    /// from the sky's mean to its brightest direction (0.1: from 0.9 to 1.1); 0 is a uniform sky.
    pub gradient: [f64; 3],
    /// How far rays start above the surface, mm. It must stay well below the edges of the mesh: a point lifted by e sees
    /// about e / edge (rad) further over a wall.
    pub epsilon_mm: f64,
    /// Vertices around which triangles differ by more than this lie on creases: there each side is lit with its own
    /// normal, degrees. It may be small: on a smooth surface the mean over sides differs by ⅛ of the angle (rad) squared,
    /// 0.4 % at the default, and by as much the light is wrong on a crease that is taken for smooth.
    pub crease_deg: f64,
    /// How often the cheap points' irradiance is averaged over their one-rings.
    pub smoothing: u32,
    /// Light between facing walls; none: the sky only.
    pub interreflection: Option<Interreflection>,
}

/// Light that the surface throws onto itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Interreflection {
    /// Bounces after the direct light; what is left out is below albedo^(bounces + 1).
    pub bounces: u32,
}

impl Default for Ambient {
    fn default() -> Self {
        Self {
            shadows: true,
            rays: 512,
            cheap_rays: 64,
            gradient: [0.0; 3],
            epsilon_mm: 1e-4,
            crease_deg: 10.0,
            smoothing: 2,
            interreflection: None,
        }
    }
}

impl Default for Interreflection {
    fn default() -> Self {
        Self { bounces: 2 }
    }
}

impl Ambient {
    /// Whether the numbers make a sky.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first that does not.
    pub fn check(&self) -> Result<(), Error> {
        let length = Vector3::from(self.gradient).norm();
        let bounces = self.interreflection.as_ref().map_or(1, |light| light.bounces);
        let count = |rays: u32| (8..=1 << 20).contains(&rays);
        for (name, good, what) in [
            ("rays", count(self.rays), "must lie between 8 and 1048576"),
            ("cheap_rays", count(self.cheap_rays), "must lie between 8 and 1048576"),
            ("gradient", length < 1.0, "must be shorter than 1, so that no part of the sky is negative"),
            ("epsilon_mm", (1e-7..=0.1).contains(&self.epsilon_mm), "must lie between 0.0000001 and 0.1 mm"),
            ("crease_deg", (0.0..=180.0).contains(&self.crease_deg), "must lie between 0 and 180 degrees"),
            ("smoothing", self.smoothing <= 100, "must be at most 100"),
            ("interreflection.bounces", (1..=16).contains(&bounces), "must lie between 1 and 16"),
        ] {
            if !good {
                return Err(Error::Parameter { place: format!("light.{name}"), what: what.into() });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_pass() {
        assert!(Ambient::default().check().is_ok());
    }

    #[test]
    fn a_negative_sky_is_named() {
        let sky = Ambient { gradient: [0.9, 0.9, 0.0], ..Ambient::default() };
        assert!(sky.check().unwrap_err().to_string().starts_with("light.gradient"));
        let sky = Ambient { gradient: [f64::NAN, 0.0, 0.0], ..Ambient::default() };
        assert!(sky.check().is_err());
    }

    #[test]
    fn unknown_keys_are_refused() {
        assert!(serde_json::from_str::<Ambient>(r#"{"ray": 5}"#).is_err());
    }
}
