//! A camera of the studio, with what is wrong with it.

use crate::Error;
use crate::body::Body;
use crate::film::{Sensor, Transfer};
use crate::scenario::{FaultKind, Scenario};
use crate::take::{Placement, Role, Spaces};
use camera::Camera;
use nalgebra::{Isometry3, Vector3};
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

/// Share of the face's points that a camera must see.
const LEAST_SEEN: f64 = 0.2;

pub(super) fn stations(scenario: &Scenario, body: &Body) -> Result<BTreeMap<String, Station>, Error> {
    let mut stations = BTreeMap::new();
    for (number, (id, placement)) in scenario.placements().into_iter().enumerate() {
        placement.check(&id)?;
        let station = station(scenario, number as u32, &id, &placement);
        check_view(&id, &station.camera, body, scenario)?;
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
    let mut sensor = scenario.sensor.clone();
    if let Some(blur) = fault(FaultKind::Defocused) {
        sensor.lens_blur_px = sensor.lens_blur_px.hypot(blur);
    }
    if let Some(gamma) = fault(FaultKind::Gamma) {
        sensor.transfer = Transfer::Gamma(gamma);
    }
    let exposure_ms = fault(FaultKind::MotionBlur).unwrap_or(scenario.exposure_ms);
    let mirrored = fault(FaultKind::Mirrored).is_some();
    let exposure_s = 1e-3 * exposure_ms;
    Station { number, role: placement.role, camera, calibrated, sensor, exposure_s, mirrored }
}

/// Refuses a camera that looks past the face, or that the face is behind.
fn check_view(id: &str, camera: &Camera, body: &Body, scenario: &Scenario) -> Result<(), Error> {
    let sample = body.mesh.positions.iter().step_by(1 + body.mesh.positions.len() / 500);
    let (mut all, mut seen) = (0.0, 0.0);
    for point in sample {
        let pixel = camera.project(&scenario.spaces.mocap_from_face(*point));
        all += 1.0;
        seen += f64::from(pixel.is_some_and(|pixel| camera.contains(pixel)));
    }
    if seen >= LEAST_SEEN * all {
        return Ok(());
    }
    let what = format!(
        "sees {:.0} % of the face; move it with azimuth_deg, elevation_deg, distance_mm or target_mm, or shorten focal_px",
        100.0 * seen / all
    );
    Err(Error::parameter(format!("cameras.{id}"), what))
}
