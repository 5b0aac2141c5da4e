//! Where the points of a scan lie on the unrolled average face.
//!
//! People name landmarks on a scan ([`LANDMARKS`]). A similarity brings the average face onto them; an upright elliptic
//! cylinder in that frame unrolls the scan roughly; what is left over at the landmarks is spread smoothly between them
//! by moving least squares. The back of the head lands far outside of the face, where nothing is placed.

mod error;
mod landmarks;
#[cfg(test)]
mod tests;

pub use error::PlaceError;
pub use landmarks::{LANDMARKS, Landmark};
#[cfg(test)]
pub(super) use tests::test_head;

use super::face::{Person, surface};
use artifact::Unit;
use artifact::picks::{Pick, PickPlace};
use camera::fit_similarity;
use landmarks::closest_name;
use mesh::bounding_box;
use nalgebra::{Matrix3, Matrix3x2, Point2, Point3, Similarity3, Vector2};
use rayon::prelude::*;

/// Landmarks that a scan must name at least.
pub const LEAST: usize = 12;
/// Longest side of the box around a head (a bust, a face mask), mm.
const HEAD_MM: std::ops::RangeInclusive<f64> = 100.0..=500.0;
/// Size of a face relative to the average one.
const SCALE: std::ops::RangeInclusive<f64> = 0.6..=1.6;
/// A picked point lies no farther from the scan, mm.
const OFF_SCAN_MM: f64 = 12.0;
/// A landmark lies no farther from where the average face has it, mm: people differ by less.
const ASTRAY_MM: f64 = 22.0;
/// Semi-axes of the cylinder across and along, and the place of its axis, mm (the average head's).
const CYLINDER: [f64; 3] = [67.0, 83.0, -15.0];
/// Millimetres of s per radian around the head.
pub(super) const ROLL: f64 = 72.0;
/// Once around the head, mm of s.
pub(super) const TURN: f64 = ROLL * std::f64::consts::TAU;
/// Landmarks pull with 1/(r² + ε)², mm²: they are met within a thousandth of a millimetre.
const EPSILON: f64 = 1e-4;
/// How stiff the local affine maps are, relative to the spread of the landmarks that they are fitted to.
const STIFFNESS: f64 = 0.05;

/// A scan laid onto the average face.
#[derive(Debug, Clone)]
pub struct Placement {
    /// The average face's space into the scan's: a similarity, least squares over the landmarks [Umeyama1991].
    pub face_from_canonical: Similarity3<f64>,
    /// Per landmark its name and how far the average face's lies from it, mm in the average face's size.
    pub residuals: Vec<(String, f64)>,
    canonical_from_face: Similarity3<f64>,
    /// Per landmark where it is in the average face's space, and what the cylinder leaves over there.
    anchors: Vec<(Point3<f64>, Vector2<f64>)>,
}

impl Placement {
    /// Lays a scan onto the average face by its landmarks.
    ///
    /// `points`: the scan's vertices, mm; `unit`: what its file was read in, for messages.
    ///
    /// # Errors
    /// Unknown names, missing vertices, too few landmarks; a scan or landmarks that have not the size of a head; a
    /// landmark that cannot be where it was picked.
    pub fn of(points: &[Point3<f64>], unit: Unit, picks: &[Pick]) -> Result<Self, PlaceError> {
        check_size(points, unit)?;
        let named = named_points(points, picks)?;
        if named.len() < LEAST {
            return Err(PlaceError::TooFew { count: named.len() });
        }
        let average = Person::of_seed(0);
        let canonical: Vec<Point3<f64>> =
            named.iter().map(|(landmark, _)| surface::point(&average, landmark.at.into())).collect();
        let found: Vec<Point3<f64>> = named.iter().map(|(_, point)| *point).collect();
        let face_from_canonical = fit_similarity(&canonical, &found, None)?;
        let scale = face_from_canonical.scaling();
        if !SCALE.contains(&scale) {
            return Err(PlaceError::Scale { scale });
        }
        check_sides(&named, &average, &face_from_canonical)?;
        check_residuals(&named, &canonical)?;
        let canonical_from_face = face_from_canonical.inverse();
        let anchor = |(landmark, point): &(&Landmark, Point3<f64>)| {
            let place = canonical_from_face * point;
            (place, Vector2::from(landmark.at) - unroll(&place))
        };
        let residual = |((landmark, point), canonical): (&(&Landmark, Point3<f64>), &Point3<f64>)| {
            (landmark.name.to_string(), (canonical_from_face * point - canonical).norm())
        };
        Ok(Self {
            residuals: named.iter().zip(&canonical).map(residual).collect(),
            anchors: named.iter().map(anchor).collect(),
            face_from_canonical,
            canonical_from_face,
        })
    }

    /// The place of a point of the scan (mm) on the unrolled average face, mm.
    ///
    /// The cylinder's (s, t) and moving least squares of what it leaves over at the landmarks, affine, with weights
    /// 1/(r² + ε)² [Schaefer2006]: smooth, and exact at the landmarks. Deviation: the local maps are held back by a
    /// small penalty on their linear part, so that they do not run away outside of the landmarks.
    #[must_use]
    pub fn domain_at(&self, point: &Point3<f64>) -> Point2<f64> {
        let at = self.canonical_from_face * point;
        let weights: Vec<f64> =
            self.anchors.iter().map(|(place, _)| ((at - place).norm_squared() + EPSILON).powi(-2)).collect();
        let total: f64 = weights.iter().sum();
        let weighted = || weights.iter().map(|weight| weight / total).zip(&self.anchors);
        let (mut place_mean, mut rest_mean) = (nalgebra::Vector3::zeros(), Vector2::zeros());
        for (weight, (place, rest)) in weighted() {
            place_mean += weight * place.coords;
            rest_mean += weight * rest;
        }
        let (mut spread, mut cross) = (Matrix3::zeros(), Matrix3x2::zeros());
        for (weight, (place, rest)) in weighted() {
            let off = place.coords - place_mean;
            spread += weight * off * off.transpose();
            cross += weight * off * (rest - rest_mean).transpose();
        }
        spread += Matrix3::identity() * (STIFFNESS * spread.trace() + f64::MIN_POSITIVE);
        let linear = spread.cholesky().map_or_else(Matrix3x2::zeros, |factor| factor.solve(&cross));
        Point2::from(unroll(&at) + rest_mean + linear.transpose() * (at.coords - place_mean))
    }

    /// The places of many points, in their order.
    #[must_use]
    pub fn domain(&self, points: &[Point3<f64>]) -> Vec<Point2<f64>> {
        points.par_iter().map(|point| self.domain_at(point)).collect()
    }
}

/// Around the elliptic cylinder, and up.
fn unroll(at: &Point3<f64>) -> Vector2<f64> {
    let [across, along, axis] = CYLINDER;
    Vector2::new(ROLL * (at.x / across).atan2((at.z - axis) / along), at.y)
}

/// Refuses what has not the size of a head, and guesses the unit.
fn check_size(points: &[Point3<f64>], unit: Unit) -> Result<(), PlaceError> {
    let (low, high) = bounding_box(points);
    let size_mm = (high - low).max();
    if HEAD_MM.contains(&size_mm) {
        return Ok(());
    }
    let in_file = size_mm / unit.in_mm();
    let likely =
        [Unit::Mm, Unit::Cm, Unit::M].into_iter().find(|unit| HEAD_MM.contains(&(in_file * unit.in_mm())));
    Err(PlaceError::Size { size_mm, unit, likely })
}

fn named_points(
    points: &[Point3<f64>],
    picks: &[Pick],
) -> Result<Vec<(&'static Landmark, Point3<f64>)>, PlaceError> {
    let named = |pick: &Pick| {
        let name = || pick.marker.clone();
        let landmark = LANDMARKS
            .iter()
            .find(|landmark| landmark.name == pick.marker)
            .ok_or_else(|| PlaceError::Unknown { name: name(), closest: closest_name(&pick.marker) })?;
        let point = match pick.place {
            PickPlace::Vertex(vertex) => *points
                .get(vertex as usize)
                .ok_or_else(|| PlaceError::NoVertex { name: name(), vertex, count: points.len() })?,
            PickPlace::Point(point) => {
                let distance_mm =
                    points.iter().map(|vertex| (vertex - point).norm()).fold(f64::INFINITY, f64::min);
                if distance_mm > OFF_SCAN_MM {
                    return Err(PlaceError::OffScan { name: name(), distance_mm });
                }
                point
            }
        };
        Ok((landmark, point))
    };
    picks.iter().map(named).collect()
}

/// Whether the landmarks fit better with left and right exchanged.
fn check_sides(
    named: &[(&Landmark, Point3<f64>)],
    average: &Person,
    face_from_canonical: &Similarity3<f64>,
) -> Result<(), PlaceError> {
    let found: Vec<Point3<f64>> = named.iter().map(|(_, point)| *point).collect();
    let exchanged: Vec<Point3<f64>> = named
        .iter()
        .map(|(landmark, _)| surface::point(average, Point2::new(-landmark.at[0], landmark.at[1])))
        .collect();
    let error = |fit: &Similarity3<f64>, side: f64| -> f64 {
        let at = |landmark: &Landmark| Point2::new(side * landmark.at[0], landmark.at[1]);
        named
            .iter()
            .map(|(landmark, point)| (fit * surface::point(average, at(landmark)) - point).norm_squared())
            .sum()
    };
    let other = fit_similarity(&exchanged, &found, None)?;
    match error(&other, -1.0) < 0.5 * error(face_from_canonical, 1.0) {
        true => Err(PlaceError::Mirrored),
        false => Ok(()),
    }
}

/// Refuses the landmark that is farthest from where the others expect it, if it is too far.
fn check_residuals(named: &[(&Landmark, Point3<f64>)], canonical: &[Point3<f64>]) -> Result<(), PlaceError> {
    let found: Vec<Point3<f64>> = named.iter().map(|(_, point)| *point).collect();
    let mut worst = (0.0, "");
    for left_out in 0..named.len() {
        let weights: Vec<f64> = (0..named.len()).map(|i| if i == left_out { 0.0 } else { 1.0 }).collect();
        let fit = fit_similarity(canonical, &found, Some(&weights))?;
        let distance = (fit * canonical[left_out] - found[left_out]).norm() / fit.scaling();
        if distance > worst.0 {
            worst = (distance, named[left_out].0.name);
        }
    }
    match worst {
        (distance_mm, name) if distance_mm > ASTRAY_MM => {
            Err(PlaceError::Astray { name: name.to_string(), distance_mm })
        }
        _ => Ok(()),
    }
}
