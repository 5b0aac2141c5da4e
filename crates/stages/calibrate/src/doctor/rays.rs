//! Rays of all that cameras saw, and where they meet.

use super::Evidence;
use nalgebra::{Matrix3, Point3, Vector3};

/// A view in world space: camera, eye, direction.
pub(super) type Ray = (usize, Point3<f64>, Vector3<f64>);

/// Rays of all views.
pub(super) struct Rays {
    /// Per sighting.
    pub(super) views: Vec<Vec<Ray>>,
}

impl Rays {
    pub(super) fn of(evidence: &Evidence) -> Self {
        let ray = |&(c, pixel): &(usize, nalgebra::Vector2<f64>)| {
            let camera = &evidence.patients[c].camera;
            Some((c, camera.eye_in_world(), camera.ray_in_world(pixel)?.into_inner()))
        };
        let views = evidence.sightings.iter().map(|sighting| sighting.views.iter().filter_map(ray).collect());
        Self { views: views.collect() }
    }

    pub(super) fn count(&self, camera: usize) -> usize {
        self.views.iter().filter(|views| views.len() > 1 && views.iter().any(|view| view.0 == camera)).count()
    }

    /// Per sighting the point nearest to the rays of trusted cameras, one left out; none from fewer than two.
    pub(super) fn points(&self, trusted: &[bool], without: Option<usize>) -> Vec<Option<Point3<f64>>> {
        let place = |views: &Vec<Ray>| {
            nearest(views.iter().filter(|view| trusted[view.0] && Some(view.0) != without))
        };
        self.views.iter().map(place).collect()
    }
}

/// Rays whose normal matrix has a smaller share than this across are parallel.
const PARALLEL: f64 = 1e-6;

/// The point with the least squared distance to rays, wherever it lies along them.
pub(super) fn nearest<'a>(views: impl Iterator<Item = &'a Ray>) -> Option<Point3<f64>> {
    let (mut normal, mut right, mut count) = (Matrix3::zeros(), Vector3::zeros(), 0);
    for (_, eye, direction) in views {
        let across = Matrix3::identity() - direction * direction.transpose();
        normal += across;
        right += across * eye.coords;
        count += 1;
    }
    let is_open = count < 2 || normal.determinant() <= PARALLEL * f64::from(count).powi(3);
    (!is_open).then(|| normal.cholesky().map(|factor| Point3::from(factor.solve(&right))))?
}
