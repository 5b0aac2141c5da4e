//! The volume that all cameras see.

use camera::Camera;
use nalgebra::{Matrix3, Point3, Vector3};

/// A ball.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume {
    /// Its middle in world space, mm.
    pub middle: Point3<f64>,
    /// mm
    pub radius_mm: f64,
}

/// Directions in which the ball's reach is tried.
const DIRECTIONS: [[f64; 3]; 14] = [
    [1., 0., 0.],
    [-1., 0., 0.],
    [0., 1., 0.],
    [0., -1., 0.],
    [0., 0., 1.],
    [0., 0., -1.],
    [1., 1., 1.],
    [1., 1., -1.],
    [1., -1., 1.],
    [1., -1., -1.],
    [-1., 1., 1.],
    [-1., 1., -1.],
    [-1., -1., 1.],
    [-1., -1., -1.],
];

/// The largest ball around the place where the cameras' views meet that all of them see; none if there is no such place
/// before all cameras. The place is the point with the least sum of squared distances to the optical axes; of a single
/// camera (or parallel ones), 1 m before it.
#[must_use]
pub fn common_volume(cameras: &[Camera]) -> Option<Volume> {
    let middle = meeting_point(cameras)?;
    let is_seen = |point: &Point3<f64>| {
        cameras.iter().all(|camera| camera.project(point).is_some_and(|pixel| camera.contains(pixel)))
    };
    if !is_seen(&middle) {
        return None;
    }
    let fits = |radius: f64| {
        DIRECTIONS.iter().all(|&step| is_seen(&(middle + radius * Vector3::from(step).normalize())))
    };
    let distances = cameras.iter().map(|camera| (camera.eye_in_world() - middle).norm());
    let (mut low, mut high) = (0.0, distances.fold(f64::INFINITY, f64::min));
    for _ in 0..40 {
        let radius = 0.5 * (low + high);
        if fits(radius) { low = radius } else { high = radius }
    }
    Some(Volume { middle, radius_mm: low })
}

/// How far before a lone camera its view is looked at, mm.
const LONE_DISTANCE_MM: f64 = 1000.0;
/// Cameras count as parallel below this ratio of the sums' smallest to largest singular value.
const PARALLEL: f64 = 1e-4;

fn meeting_point(cameras: &[Camera]) -> Option<Point3<f64>> {
    let (mut sum, mut side) = (Matrix3::zeros(), Vector3::zeros());
    let axis = |camera: &Camera| camera.cam_from_world.inverse_transform_vector(&Vector3::z());
    for camera in cameras {
        let across = Matrix3::identity() - axis(camera) * axis(camera).transpose();
        sum += across;
        side += across * camera.eye_in_world().coords;
    }
    let singular = sum.singular_values();
    if singular[2] > PARALLEL * singular[0] {
        return sum.try_inverse().map(|inverse| Point3::from(inverse * side));
    }
    let count = cameras.len() as f64;
    let middle = |of: &dyn Fn(&Camera) -> Vector3<f64>| cameras.iter().map(of).sum::<Vector3<f64>>() / count;
    let eye = middle(&|camera| camera.eye_in_world().coords);
    (!cameras.is_empty()).then(|| Point3::from(eye + LONE_DISTANCE_MM * middle(&axis)))
}
