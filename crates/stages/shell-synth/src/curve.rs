//! A crease as a line on the rest mesh.

use crate::locator::Place;
use crate::surface::Surface;
use nalgebra::{Point3, Vector3};

/// Samples along a crease, at rest.
#[derive(Debug, Clone)]
pub(crate) struct Curve {
    pub(crate) places: Vec<Place>,
    /// The samples at rest, mm.
    pub(crate) points: Vec<Point3<f64>>,
    /// Unit vectors on the skin across the crease, from its left to its right side as seen from outside.
    pub(crate) across: Vec<Vector3<f64>>,
    pub(crate) normals: Vec<Vector3<f64>>,
}

impl Curve {
    /// `normals`: of the vertices at rest.
    pub(crate) fn new(surface: &Surface, normals: &[Vector3<f64>], places: Vec<Place>) -> Self {
        let points: Vec<Point3<f64>> =
            places.iter().map(|place| place.on(&surface.rest, &surface.triangles)).collect();
        let normals: Vec<Vector3<f64>> =
            places.iter().map(|place| normal_at(surface, normals, place)).collect();
        let across = (0..points.len())
            .map(|k| tangent(&points, k).cross(&normals[k]).try_normalize(0.0).unwrap_or_else(Vector3::zeros))
            .collect();
        Self { places, points, across, normals }
    }

    /// Where the samples are when the vertices are at `points`.
    pub(crate) fn on(&self, surface: &Surface, points: &[Point3<f64>]) -> Vec<Point3<f64>> {
        self.places.iter().map(|place| place.on(points, &surface.triangles)).collect()
    }
}

fn normal_at(surface: &Surface, normals: &[Vector3<f64>], place: &Place) -> Vector3<f64> {
    let corners = surface.triangles[place.triangle as usize];
    let sum: Vector3<f64> =
        corners.iter().zip(place.shares).map(|(&vertex, share)| normals[vertex as usize] * share).sum();
    sum.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
}

/// Direction of a polyline at one of its points.
pub(crate) fn tangent(points: &[Point3<f64>], k: usize) -> Vector3<f64> {
    let (before, after) = (k.saturating_sub(1), (k + 1).min(points.len() - 1));
    (points[after] - points[before]).try_normalize(0.0).unwrap_or_else(Vector3::zeros)
}

/// A place along a polyline: segment and share of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Foot {
    pub(crate) segment: u32,
    pub(crate) share: f64,
    /// From the polyline to the point, mm.
    pub(crate) distance: f64,
}

impl Foot {
    /// Mixes what stands at both ends of its segment.
    pub(crate) fn between<T>(&self, values: &[T], mix: impl Fn(&T, &T, f64) -> T) -> T {
        let at = self.segment as usize;
        mix(&values[at], &values[at + 1], self.share)
    }

    pub(crate) fn point(&self, points: &[Point3<f64>]) -> Point3<f64> {
        self.between(points, |a, b, share| a + (b - a) * share)
    }

    pub(crate) fn direction(&self, vectors: &[Vector3<f64>]) -> Vector3<f64> {
        self.between(vectors, |a, b, share| a + (b - a) * share)
    }
}

/// The place of a polyline that is nearest to a point, going downhill from a segment.
pub(crate) fn nearest_from(points: &[Point3<f64>], segment: u32, to: &Point3<f64>) -> Foot {
    let last = points.len() as u32 - 2;
    let mut best = foot_on(points, segment.min(last), to);
    loop {
        let beside = [best.segment.checked_sub(1), Some(best.segment + 1).filter(|&next| next <= last)];
        let nearer = beside
            .into_iter()
            .flatten()
            .map(|next| foot_on(points, next, to))
            .filter(|foot| foot.distance < best.distance)
            .min_by(|a, b| a.distance.total_cmp(&b.distance));
        match nearer {
            Some(foot) => best = foot,
            None => return best,
        }
    }
}

fn foot_on(points: &[Point3<f64>], segment: u32, to: &Point3<f64>) -> Foot {
    let [a, b] = [points[segment as usize], points[segment as usize + 1]];
    let along = b - a;
    let share = ((to - a).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    Foot { segment, share, distance: (a + along * share - to).norm() }
}
