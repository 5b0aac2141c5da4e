//! A crease as it was found in one frame.

use crate::locator::Place;
use crate::profile::between;
use crate::surface::Surface;
use artifact::{ProfileShape, ValleyPoint};
use nalgebra::{Point3, Vector3};

/// Spacing of the samples along a crease, mm.
const SPACING_MM: f64 = 0.5;
/// How far, mm, a crease may wander to be taken for the same.
const FARTHEST_MM: f64 = 5.0;
/// A valley that ends open ends on a slope of so many mm per mm.
const END_SLOPE: f64 = 0.7;

/// A crease as it was found in one frame, on the rest mesh.
pub(crate) struct Line {
    pub(crate) points: Vec<Point3<f64>>,
    places: Vec<Place>,
    /// Length from the start, mm.
    along: Vec<f64>,
    sections: Vec<ProfileShape>,
}

impl Line {
    pub(crate) fn new(surface: &Surface, points: &[ValleyPoint]) -> Self {
        let places: Vec<Place> =
            points.iter().map(|point| Place { triangle: point.face, shares: point.barycentric }).collect();
        let mut line = Self {
            points: places.iter().map(|place| place.on(&surface.rest, &surface.triangles)).collect(),
            places,
            along: Vec::new(),
            sections: points.iter().map(ValleyPoint::shape).collect(),
        };
        let mut length = 0.0;
        for k in 0..line.points.len() {
            length += if k == 0 { 0.0 } else { (line.points[k] - line.points[k - 1]).norm() };
            line.along.push(length);
        }
        for (section, at) in line.sections.iter_mut().zip(&line.along) {
            section.d = section.d.min(END_SLOPE * at.min(length - at));
        }
        line
    }

    pub(crate) fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    pub(crate) fn deepest(&self) -> f64 {
        self.sections.iter().map(|section| section.d).fold(0.0, f64::max)
    }

    /// Where it crosses the plane across another curve at one of its samples: the distance along `across`, and the section.
    pub(crate) fn crossing(
        &self,
        at: &Point3<f64>,
        along: &Vector3<f64>,
        across: &Vector3<f64>,
    ) -> Option<(f64, ProfileShape)> {
        let before = |point: &Point3<f64>| (point - at).dot(along);
        let mut best: Option<(f64, f64, ProfileShape)> = None;
        for k in 1..self.points.len() {
            let (a, b) = (before(&self.points[k - 1]), before(&self.points[k]));
            if (a > 0.0) == (b > 0.0) && a != 0.0 {
                continue;
            }
            let share = if a == b { 0.0 } else { a / (a - b) };
            let from = self.points[k - 1] + (self.points[k] - self.points[k - 1]) * share - at;
            let distance = from.norm();
            if distance <= FARTHEST_MM && best.is_none_or(|best| distance < best.0) {
                best = Some((
                    distance,
                    from.dot(across),
                    between(&self.sections[k - 1], &self.sections[k], share),
                ));
            }
        }
        best.map(|(_, offset, section)| (offset, section))
    }

    /// Places at equal distances along it.
    pub(crate) fn resampled(&self) -> Vec<Place> {
        let count = (self.length() / SPACING_MM).ceil().max(1.0) as usize;
        let place = |k: usize| {
            let at = self.length() * k as f64 / count as f64;
            let next = self.along.partition_point(|&along| along < at).clamp(1, self.along.len() - 1);
            let share = (at - self.along[next - 1])
                / (self.along[next] - self.along[next - 1]).max(f64::MIN_POSITIVE);
            (next, share)
        };
        (0..=count)
            .map(place)
            .map(|(next, share)| self.places[if share < 0.5 { next - 1 } else { next }])
            .collect()
    }
}
