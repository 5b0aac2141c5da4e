//! Where the cameras stand, and what they are.

use crate::Error;
use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What a camera films.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// Markers, at the mocap rate.
    Mocap,
    /// Wrinkles, closer and slower.
    Wrinkle,
}

/// A camera as the scenario places it: on a sphere around the face, looking at a point of the face.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Placement {
    /// What it films.
    pub role: Role,
    /// Image width, height, px.
    pub image_size: [u32; 2],
    /// Focal length, px.
    pub focal_px: f64,
    /// Distance from the point that it looks at, mm.
    pub distance_mm: f64,
    /// Angle to the subject's left of the face's own direction, degrees.
    pub azimuth_deg: f64,
    /// Angle above the face's own direction, degrees.
    pub elevation_deg: f64,
    /// Turn about the view, degrees.
    #[serde(default)]
    pub roll_deg: f64,
    /// Point that it looks at, in face space of the average face, mm.
    pub target_mm: [f64; 3],
    /// Lens distortion k₁ k₂ p₁ p₂ k₃.
    #[serde(default)]
    pub distortion: [f64; 5],
}

/// Mocap cameras of the paper: six of 656 × 490 px at 50 frames a second [BickelBotsch2007, §3].
const MOCAP_SIZE: [u32; 2] = [656, 490];
/// Wrinkle cameras of the paper: two of 1384 × 1038 px at 12.5 frames a second [BickelBotsch2007, §3].
const WRINKLE_SIZE: [u32; 2] = [1384, 1038];
/// Azimuth and elevation of the mocap cameras, degrees: staggered, so that each side of the nose is seen by four.
const MOCAP_DIRECTIONS: [[f64; 2]; 6] =
    [[-48.0, 10.0], [-28.0, -14.0], [-9.0, 16.0], [9.0, -16.0], [28.0, 14.0], [48.0, -10.0]];
const WRINKLE_DIRECTIONS: [[f64; 2]; 2] = [[-22.0, 3.0], [22.0, 3.0]];

/// The rig of the paper: ids m1 … m6 and w1, w2. Lenses and places vary a little with the seed, as on a real rig.
#[must_use]
pub fn paper_rig(seed: u64) -> BTreeMap<String, Placement> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x0c0a_11e7);
    let mut place =
        |role, image_size, [azimuth_deg, elevation_deg]: [f64; 2], focal_px, distance_mm, target_mm| {
            let mut vary = |middle: f64, range: f64| middle + range * rng.random_range(-1.0..1.0);
            Placement {
                role,
                image_size,
                focal_px: vary(focal_px, 0.01 * focal_px),
                distance_mm: vary(distance_mm, 15.0),
                azimuth_deg: vary(azimuth_deg, 1.5),
                elevation_deg: vary(elevation_deg, 1.5),
                roll_deg: vary(0.0, 2.0),
                target_mm,
                distortion: [vary(-0.12, 0.03), vary(0.08, 0.03), vary(0.0, 4e-4), vary(0.0, 4e-4), 0.0],
            }
        };
    let mut rig = BTreeMap::new();
    for (i, direction) in MOCAP_DIRECTIONS.into_iter().enumerate() {
        let camera = place(Role::Mocap, MOCAP_SIZE, direction, 1450.0, 720.0, [0.0, 12.0, 45.0]);
        rig.insert(format!("m{}", i + 1), camera);
    }
    for (i, direction) in WRINKLE_DIRECTIONS.into_iter().enumerate() {
        let camera = place(Role::Wrinkle, WRINKLE_SIZE, direction, 4740.0, 900.0, [0.0, 34.0, 60.0]);
        rig.insert(format!("w{}", i + 1), camera);
    }
    rig
}

impl Placement {
    /// The same camera with an image `scale` times as large.
    #[must_use]
    pub fn scaled(&self, scale: f64) -> Self {
        let image_size = self.image_size.map(|pixels| (f64::from(pixels) * scale).round() as u32);
        Self { image_size, focal_px: self.focal_px * scale, ..self.clone() }
    }

    /// Whether such a camera can be.
    ///
    /// # Errors
    /// Names the camera and what is wrong.
    pub fn check(&self, id: &str) -> Result<(), Error> {
        let wrong = |field: &str, what: &str| Err(Error::parameter(format!("cameras.{id}.{field}"), what));
        let numbers = [self.azimuth_deg, self.elevation_deg, self.roll_deg];
        if self.image_size.iter().any(|pixels| !(16..=16_384).contains(pixels)) {
            return wrong("image_size", "must lie between 16 and 16384 px");
        }
        if !(self.focal_px > 0.0 && self.focal_px.is_finite()) {
            return wrong("focal_px", "must be positive, in pixels");
        }
        if !(self.distance_mm > 0.0 && self.distance_mm.is_finite()) {
            return wrong("distance_mm", "must be positive, in millimetres");
        }
        if numbers.iter().chain(&self.target_mm).chain(&self.distortion).any(|x| !x.is_finite()) {
            return wrong("azimuth_deg", "angles, target and distortion must be finite");
        }
        if self.elevation_deg.abs() > 85.0 {
            return wrong("elevation_deg", "must lie within ±85°");
        }
        Ok(())
    }

    /// The camera in the world, before a face that stands at `world_from_face`.
    #[must_use]
    pub fn camera(&self, world_from_face: &Isometry3<f64>) -> Camera {
        let (azimuth, elevation) = (self.azimuth_deg.to_radians(), self.elevation_deg.to_radians());
        let towards =
            Vector3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
        let target = Point3::from(self.target_mm);
        let upright = Camera::pose_looking_at(
            world_from_face * (target + towards * self.distance_mm),
            world_from_face * target,
            world_from_face * Vector3::y(),
        );
        let [width, height] = self.image_size.map(f64::from);
        let [k1, k2, p1, p2, k3] = self.distortion;
        Camera {
            image_size: self.image_size,
            lens: Lens {
                focal_px: Vector2::repeat(self.focal_px),
                center_px: Vector2::new(0.5 * (width - 1.0), 0.5 * (height - 1.0)),
                distortion: BrownConrady { k1, k2, p1, p2, k3 },
            },
            cam_from_world: Isometry3::rotation(Vector3::z() * self.roll_deg.to_radians()) * upright,
        }
    }
}
