//! A camera of the studio, with what is wrong with it.

use crate::Error;
use crate::body::Body;
use crate::film::Sensor;
use crate::scenario::{FaultKind, Scenario};
use crate::take::{Placement, Role, Spaces};
use camera::Camera;
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// A camera, as it was when it was calibrated, and as it films.
#[derive(Debug, Clone)]
pub struct Station {
    /// Its number, in the order of ids.
    pub number: u32,
    /// What it films.
    pub role: Role,
    /// As it films.
    pub camera: Camera,
    /// As it was when it was calibrated.
    pub calibrated: Camera,
    /// From light to stored values.
    pub sensor: Sensor,
    /// How long its shutter is open, s.
    pub exposure_s: f64,
    /// Whether its images are mirrored left to right.
    pub mirrored: bool,
}

/// Share of the face's points that must lie in a camera's view, and of its markers that must face it.
const LEAST_SEEN: f64 = 0.2;
const LEAST_FACING: f64 = 0.1;
/// The face must measure this much in the image, px: dots are 60 times smaller.
const LEAST_SIZE_PX: f64 = 32.0;

/// `normals`: of the body at rest, per vertex.
pub(super) fn stations(
    scenario: &Scenario,
    body: &Body,
    normals: &[Vector3<f64>],
) -> Result<BTreeMap<String, Station>, Error> {
    let mut stations = BTreeMap::new();
    for (number, (id, placement)) in scenario.placements().into_iter().enumerate() {
        placement.check(&id)?;
        let station = station(scenario, number as u32, &id, &placement);
        let view = View { camera: &station.camera, body, normals, spaces: &scenario.spaces };
        view.check(&id)?;
        stations.insert(id, station);
    }
    Ok(stations)
}

fn station(scenario: &Scenario, number: u32, id: &str, placement: &Placement) -> Station {
    let fault = |kind| scenario.fault(kind, id);
    let calibrated = placement.camera(&Spaces::world_from_face());
    let mut camera = calibrated.clone();
    if let Some(degrees) = fault(FaultKind::Rotated) {
        let mut rng = ChaCha8Rng::seed_from_u64(scenario.seed ^ (0x0b_0000 + u64::from(number)));
        let axis = Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0)).normalize();
        camera.cam_from_world = Isometry3::rotation(axis * degrees.to_radians()) * camera.cam_from_world;
    }
    if let Some(share) = fault(FaultKind::Focal) {
        camera.lens.focal_px *= 1.0 + share;
    }
    let sensor = scenario.sensor_of(id);
    let exposure_ms = fault(FaultKind::MotionBlur).unwrap_or(scenario.exposure_ms);
    let mirrored = fault(FaultKind::Mirrored).is_some();
    let exposure_s = 1e-3 * exposure_ms;
    Station { number, role: placement.role, camera, calibrated, sensor, exposure_s, mirrored }
}

/// What a camera has before it.
struct View<'a> {
    camera: &'a Camera,
    body: &'a Body,
    normals: &'a [Vector3<f64>],
    spaces: &'a Spaces,
}

impl View<'_> {
    /// Refuses a camera that looks past the face or at the back of it, or that shows it too small.
    fn check(&self, id: &str) -> Result<(), Error> {
        let wrong = |what: String| Err(Error::parameter(format!("cameras.{id}"), what));
        let count = self.body.mesh.positions.len();
        let sample: Vec<usize> = (0..count).step_by(1 + count / 500).collect();
        let pixels: Vec<Vector2<f64>> =
            sample.iter().filter_map(|&vertex| self.pixel(&self.point(vertex))).collect();
        let seen = pixels.len() as f64 / sample.len() as f64;
        if seen < LEAST_SEEN {
            return wrong(format!(
                "sees {:.0} % of the face; move it with azimuth_deg, elevation_deg, distance_mm or target_mm, or shorten \
                 focal_px",
                100.0 * seen
            ));
        }
        let size = size_of(&pixels);
        if size < LEAST_SIZE_PX {
            return wrong(format!(
                "shows the face {size:.1} px large, and {LEAST_SIZE_PX} are the least; lengthen focal_px, shorten \
                 distance_mm, or choose a larger image_scale"
            ));
        }
        let facing = self.facing();
        match facing >= LEAST_FACING {
            true => Ok(()),
            false => wrong(format!(
                "{:.0} % of the markers face it; move it before the face with azimuth_deg or elevation_deg",
                100.0 * facing
            )),
        }
    }

    /// Share of the markers' places that are in view and turned towards the camera.
    fn facing(&self) -> f64 {
        let markers = self.body.markers();
        let eye = self.camera.eye_in_world();
        let faces = |vertex: usize| {
            let point = self.point(vertex);
            let normal = Spaces::world_from_face() * self.normals[vertex];
            normal.dot(&(eye - point)) > 0.0 && self.pixel(&point).is_some()
        };
        let facing = markers.iter().filter(|marker| faces(marker.vertex as usize)).count();
        facing as f64 / markers.len().max(1) as f64
    }

    /// A vertex in the world, with the head at rest.
    fn point(&self, vertex: usize) -> Point3<f64> {
        self.spaces.mocap_from_face(self.body.mesh.positions[vertex])
    }

    /// Where a point lies in the image, if it does.
    fn pixel(&self, point: &Point3<f64>) -> Option<Vector2<f64>> {
        self.camera.project(point).filter(|pixel| self.camera.contains(*pixel))
    }
}

/// The longer side of the rectangle around some pixels, px.
fn size_of(pixels: &[Vector2<f64>]) -> f64 {
    let corner = |pick: fn(f64, f64) -> f64, start: f64| {
        pixels.iter().fold(Vector2::repeat(start), |corner, pixel| corner.zip_map(pixel, pick))
    };
    (corner(f64::max, f64::NEG_INFINITY) - corner(f64::min, f64::INFINITY)).max()
}
