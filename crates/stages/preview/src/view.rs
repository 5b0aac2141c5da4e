//! Where the camera stands and how much it shows.

use crate::Error;
use camera::Pinhole;
use nalgebra::{Point3, Vector2, Vector3};
use serde::Serialize;
use std::str::FromStr;

/// Angle that the bounding sphere of the mesh fills, degrees: a portrait lens.
const FIELD_DEG: f64 = 22.0;
/// Share of the picture that stays empty on each side.
const MARGIN: f64 = 0.05;
/// Highest elevation, degrees: straight above, up has no direction.
const ELEVATION_MAX_DEG: f64 = 89.0;

/// A direction along a coordinate axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct SignedAxis {
    /// 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Whether it points to smaller coordinates.
    pub negative: bool,
}

impl SignedAxis {
    /// Its unit vector.
    #[must_use]
    pub fn vector(self) -> Vector3<f64> {
        let mut vector = Vector3::zeros();
        vector[self.axis] = if self.negative { -1.0 } else { 1.0 };
        vector
    }
}

impl std::fmt::Display for SignedAxis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", if self.negative { '-' } else { '+' }, ["x", "y", "z"][self.axis])
    }
}

impl FromStr for SignedAxis {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lower = text.trim().to_ascii_lowercase();
        let (negative, name) = match lower.strip_prefix('-') {
            Some(name) => (true, name),
            None => (false, lower.strip_prefix('+').unwrap_or(&lower)),
        };
        let axis = ["x", "y", "z"].iter().position(|axis| *axis == name);
        axis.map(|axis| Self { axis, negative })
            .ok_or_else(|| format!("'{text}' is not an axis; say x, y, z, -x, -y or -z"))
    }
}

/// Which way is up, and which way the face looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Axes {
    up: SignedAxis,
    front: SignedAxis,
}

impl Default for Axes {
    /// Up +y, front +z.
    fn default() -> Self {
        let along = |axis| SignedAxis { axis, negative: false };
        Self { up: along(1), front: along(2) }
    }
}

impl Axes {
    /// Axes with these directions.
    ///
    /// # Errors
    /// [`Error::Axes`] where both lie on one axis.
    pub fn new(up: SignedAxis, front: SignedAxis) -> Result<Self, Error> {
        match up.axis == front.axis {
            true => Err(Error::Axes { up: up.to_string(), front: front.to_string() }),
            false => Ok(Self { up, front }),
        }
    }
}

/// The direction that a surface is seen from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct View {
    /// Turn about the up axis from the front, degrees; positive towards the side that is on the viewer's right (the
    /// left side of a face).
    pub azimuth_deg: f64,
    /// Height above the horizon, degrees.
    pub elevation_deg: f64,
}

impl View {
    /// Straight from the front.
    pub const FRONT: Self = Self { azimuth_deg: 0.0, elevation_deg: 0.0 };

    /// The unit vector from the surface to the camera.
    #[must_use]
    pub fn toward_camera(self, axes: Axes) -> Vector3<f64> {
        let (up, front) = (axes.up.vector(), axes.front.vector());
        let (azimuth, elevation) = (self.azimuth_deg.to_radians(), self.elevation_deg.to_radians());
        let level = front * azimuth.cos() + up.cross(&front) * azimuth.sin();
        level * elevation.cos() + up * elevation.sin()
    }
}

impl FromStr for View {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let at = |azimuth_deg, elevation_deg| Self { azimuth_deg, elevation_deg };
        match text.trim() {
            "front" => return Ok(Self::FRONT),
            "three-quarter" => return Ok(at(35.0, 6.0)),
            "left" => return Ok(at(90.0, 0.0)),
            "right" => return Ok(at(-90.0, 0.0)),
            "back" => return Ok(at(180.0, 0.0)),
            _ => {}
        }
        let angles = text.split_once(',').and_then(|(azimuth, elevation)| {
            Some(at(azimuth.trim().parse().ok()?, elevation.trim().parse().ok()?))
        });
        match angles {
            Some(view) if view.azimuth_deg.is_finite() && view.elevation_deg.abs() <= ELEVATION_MAX_DEG => {
                Ok(view)
            }
            Some(_) => Err(format!("'{text}' looks from outside −89° to 89° of elevation")),
            None => Err(format!(
                "'{text}' is not a view; say front, three-quarter, left, right, back, or azimuth,elevation in degrees"
            )),
        }
    }
}

/// What part of the surface fills the picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CloseUp {
    /// All of it.
    None,
    /// A box: lowest and highest corner, mm.
    Box([f64; 3], [f64; 3]),
    /// The surroundings of a point (mm), magnified.
    Point {
        /// Comes to stand in the middle.
        focus: [f64; 3],
        /// Times as large as without.
        zoom: f64,
    },
}

/// A camera position, and the part of its picture that was asked for so far.
#[derive(Debug, Clone)]
pub struct Frame {
    /// Focal length 1, principal point (0, 0).
    camera: Pinhole,
    low: Vector2<f64>,
    high: Vector2<f64>,
}

impl Frame {
    /// A camera that looks at the middle of `points` from far enough to see them all as with a portrait lens.
    #[must_use]
    pub fn around(view: View, axes: Axes, points: &[Point3<f64>]) -> Self {
        let (low, high) = mesh::bounding_box(points);
        let radius = (0.5 * (high - low).norm()).max(f64::MIN_POSITIVE.sqrt());
        let distance = radius / (0.5 * FIELD_DEG).to_radians().sin();
        let middle = nalgebra::center(&low, &high);
        let eye = middle + distance * view.toward_camera(axes);
        let camera = Pinhole::looking_at(eye, middle, axes.up.vector(), 1.0, Vector2::zeros());
        Self { camera, low: Vector2::repeat(f64::INFINITY), high: Vector2::repeat(f64::NEG_INFINITY) }
    }

    /// Widens the picture so that it shows these points too. Points behind the camera are left out.
    pub fn include(&mut self, points: &[Point3<f64>]) {
        for point in points {
            let (image, depth) = self.camera.project(point);
            if depth > 0.0 {
                self.low = self.low.inf(&image);
                self.high = self.high.sup(&image);
            }
        }
    }

    /// The camera whose picture of `size` pixels (width, height) holds what was included, or the close-up.
    #[must_use]
    pub fn camera(&self, size: [u32; 2], close_up: &CloseUp) -> Pinhole {
        match close_up {
            CloseUp::None => self.fitted(size),
            CloseUp::Box(low, high) => {
                let corner = |bits: usize| {
                    Point3::from(std::array::from_fn(|i| if bits >> i & 1 == 0 { low[i] } else { high[i] }))
                };
                let empty = Vector2::repeat(f64::INFINITY);
                let mut frame = Self { camera: self.camera.clone(), low: empty, high: -empty };
                frame.include(&[0, 1, 2, 3, 4, 5, 6, 7].map(corner));
                frame.fitted(size)
            }
            CloseUp::Point { focus, zoom } => {
                let mut camera = self.fitted(size);
                camera.focal_px *= zoom;
                camera.center_px = Vector2::zeros();
                camera.center_px = middle_px(size) - camera.project(&Point3::from(*focus)).0;
                camera
            }
        }
    }

    fn fitted(&self, size: [u32; 2]) -> Pinhole {
        let extent = self.high - self.low;
        let shown = if extent.x.is_finite() && extent.y.is_finite() { extent } else { Vector2::repeat(1.0) };
        let room = Vector2::from(size.map(f64::from)) * (1.0 - 2.0 * MARGIN);
        let focal_px = (room.x / shown.x.max(1e-12)).min(room.y / shown.y.max(1e-12));
        let middle = if shown == extent { (self.low + self.high) / 2.0 } else { Vector2::zeros() };
        Pinhole { focal_px, center_px: middle_px(size) - middle * focal_px, ..self.camera.clone() }
    }
}

/// The middle of a picture whose pixel (0, 0) is the centre of the first pixel.
fn middle_px(size: [u32; 2]) -> Vector2<f64> {
    Vector2::from(size.map(f64::from)) / 2.0 - Vector2::repeat(0.5)
}
