//! What stands around the photographs: the camera, things about the face, how the head moves.

use super::params::FaceScenario;
use crate::body::Prop;
use crate::film::{Moment, Skin, Solid};
use crate::take::{Placement, Role};
use crate::wrinkle::Wrinkles;
use artifact::Landmark;
use camera::Camera;
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// Where the camera looks, mm of the average face.
pub(super) const TARGET_MM: [f64; 3] = [0.0, 22.0, 60.0];
/// Near a line, in widths: the light is looked at closely there.
const CLOSE: f64 = 5.0;

/// A thing about the face, as it is lit and where it is.
pub(super) struct Thing<'a> {
    triangles: Vec<[u32; 3]>,
    points: Vec<Point3<f64>>,
    light: Vec<[f32; 3]>,
    albedo: &'a [[f32; 3]],
}

impl<'a> Thing<'a> {
    pub(super) fn of(prop: &'a Prop, head: &Isometry3<f64>, light: f32) -> Self {
        let points: Vec<_> = prop.mesh.positions.iter().map(|point| head * point).collect();
        Self {
            triangles: prop.mesh.triangles(),
            light: vec![[light; 3]; points.len()],
            points,
            albedo: &prop.albedo,
        }
    }

    pub(super) fn solid(&self) -> Solid<'_> {
        Solid {
            skin: Skin { triangles: &self.triangles, albedo: self.albedo },
            moment: Moment {
                open: &self.points,
                close: None,
                middle: None,
                normals: &[],
                irradiance: &self.light,
            },
        }
    }
}

/// Distance of the middles of the eyes, px.
pub(super) fn interocular(points: &BTreeMap<String, Landmark>) -> Option<f64> {
    let middle = |name: &str| {
        let around: Vec<_> =
            points.iter().filter(|(id, _)| id.starts_with(name)).map(|(_, p)| p.at).collect();
        let mean = |axis: usize| around.iter().map(|at| at[axis]).sum::<f64>() / around.len() as f64;
        (!around.is_empty()).then(|| [mean(0), mean(1)])
    };
    let (left, right) = (middle("eye_l_")?, middle("eye_r_")?);
    Some((left[0] - right[0]).hypot(left[1] - right[1]))
}

pub(super) fn camera(scenario: &FaceScenario) -> Camera {
    let placement = Placement {
        role: Role::Wrinkle,
        image_size: [scenario.side_px; 2],
        focal_px: scenario.distance_mm / scenario.pixel_mm,
        distance_mm: scenario.distance_mm,
        azimuth_deg: 0.0,
        elevation_deg: 0.0,
        roll_deg: 0.0,
        target_mm: TARGET_MM,
        distortion: [0.0; 5],
    };
    placement.camera(&Isometry3::identity())
}

/// A turn about a point, and a shift.
pub(super) fn about(center: &Point3<f64>, [x, y, z]: [f64; 3], shift: [f64; 3]) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_euler_angles(x, y, z);
    let back = center.coords - turn * center.coords + Vector3::from(shift);
    Isometry3::from_parts(Translation3::from(back), turn)
}

/// Per vertex whether it lies near a line.
pub(super) fn close(wrinkles: &Wrinkles, count: usize) -> Vec<bool> {
    let mut close = vec![false; count];
    for line in 0..wrinkles.lines().len() {
        let widest = wrinkles.widths(line).iter().map(|station| station.1).fold(0.0, f64::max);
        let near = wrinkles.coordinates(line);
        for (vertex, p) in near.vertices.iter().zip(&near.p_mm) {
            close[*vertex as usize] |= p.abs() <= CLOSE * widest;
        }
    }
    close
}

/// A number of the standard normal distribution, after Box and Muller.
pub(super) fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * rng.random::<f64>()).cos()
}
