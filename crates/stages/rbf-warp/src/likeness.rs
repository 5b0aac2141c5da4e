//! Whether markers and scan look like one face at all.

use crate::warning::Warning;
use nalgebra::{Point3, Similarity3, Vector3};

/// The reflection must fit this much better before the sets are called mirrored.
const MIRRORED: f64 = 0.5;
/// Residuals below this share of the spread are noise, which a reflection of a flat set may fit better by chance.
const NOISE: f64 = 0.01;
/// Residuals above this share of the spread are wrong pairs or an expression far from rest (a wide-open mouth: 0.13).
const UNLIKE: f64 = 0.1;

/// What is wrong between the markers at rest and their vertices, if a similarity cannot bring them together. A
/// similarity turns and scales but never reflects, so that mirrored coordinates, or left and right picked as each
/// other, leave a residual that goes away when one side is reflected.
pub(crate) fn doubt(
    mocap: &[Point3<f64>],
    face: &[Point3<f64>],
    similarity: &Similarity3<f64>,
) -> Option<Warning> {
    let rms_mm = residual(mocap, face, similarity);
    let spread_mm = spread(face);
    if rms_mm <= NOISE * spread_mm {
        return None;
    }
    let reflected: Vec<Point3<f64>> = mocap.iter().map(|p| Point3::new(-p.x, p.y, p.z)).collect();
    let fit = camera::fit_similarity(&reflected, face, None).ok();
    let mirrored_mm = fit.map_or(f64::INFINITY, |fit| residual(&reflected, face, &fit));
    if mirrored_mm < MIRRORED * rms_mm {
        return Some(Warning::Mirrored { rms_mm, mirrored_mm });
    }
    (rms_mm > UNLIKE * spread_mm).then_some(Warning::Unlike { rms_mm, spread_mm })
}

fn residual(from: &[Point3<f64>], to: &[Point3<f64>], similarity: &Similarity3<f64>) -> f64 {
    root_mean(from.iter().zip(to).map(|(from, to)| (to - similarity * from).norm_squared()), from.len())
}

/// Root mean square distance from the centroid.
fn spread(points: &[Point3<f64>]) -> f64 {
    let centre = points.iter().map(|point| point.coords).sum::<Vector3<f64>>() / points.len() as f64;
    root_mean(points.iter().map(|point| (point.coords - centre).norm_squared()), points.len())
}

fn root_mean(squares: impl Iterator<Item = f64>, count: usize) -> f64 {
    (squares.sum::<f64>() / count as f64).sqrt()
}
