//! The surface that a marker's neighbours make, as seen along a ray.

use crate::affine::{Neighbor, nearest};
use crate::fill::Placed;
use crate::solve::Ray;
use nalgebra::{Matrix4, Unit, Vector3, Vector4};

/// With fewer neighbours there is no fit.
const LEAST_NEIGHBORS: usize = 8;
/// A surface that the neighbours are off by more, root mean square, is not smooth, or the ray passes beside it, mm.
const ROUGH_MM: f64 = 1.0;
/// Surfaces whose depths vary by more than this share of the distances across the ray are seen at a grazing angle.
const STEEP: f64 = 0.5;
/// Squared coefficients that sum to more than this reach out of the neighbours' midst.
const EXTRAPOLATED: f64 = 1.5;

/// How far along a ray the surface lies that a marker's nearest neighbours make: a paraboloid about the ray fitted to their
/// depths, for faces are convex, and a plane would cut them off by millimetres. None where the ray grazes the surface, where the
/// neighbours stand to one side of it, and where the fit is bad.
pub(crate) fn surface_depth(frame: &Placed, marker: usize, ray: &Ray) -> Option<f64> {
    let along = ray.direction.into_inner();
    let depth = |arm: &Vector3<f64>| along.dot(arm);
    let arm = |place: nalgebra::Point3<f64>| place - ray.origin;
    // As seen along the ray: depths taken away.
    let flat = |place| ray.origin + (arm(place) - along * depth(&arm(place)));
    let others = frame.shared(frame, marker).map(|(other, place)| (other, flat(place)));
    let neighbors = nearest(&ray.origin, others);
    let depths = neighbors.iter().map(|n| frame.position(n.marker).map(|place| depth(&arm(place))));
    let depths: Vec<f64> = depths.collect::<Option<_>>()?;
    if neighbors.len() < LEAST_NEIGHBORS || is_grazed(&neighbors, &depths) {
        return None;
    }
    apex(&neighbors, &depths, &ray.direction)
}

fn is_grazed(neighbors: &[Neighbor], depths: &[f64]) -> bool {
    let across = neighbors.iter().map(|neighbor| neighbor.arm.norm()).sum::<f64>();
    let middle = depths.iter().sum::<f64>() / depths.len() as f64;
    depths.iter().map(|depth| (depth - middle).abs()).sum::<f64>() > STEEP * across
}

/// Depth on the ray of the paraboloid a x + b y + c (x² + y²) + d fitted to depths at the neighbours.
fn apex(neighbors: &[Neighbor], depths: &[f64], direction: &Unit<Vector3<f64>>) -> Option<f64> {
    let side = direction.cross(&Vector3::ith(direction.iamin(), 1.0)).normalize();
    let up = direction.cross(&side);
    let size = (neighbors.iter().map(|n| n.arm.norm_squared()).sum::<f64>() / neighbors.len() as f64).sqrt();
    let row = |neighbor: &Neighbor| {
        let arm = neighbor.arm / size;
        Vector4::new(arm.dot(&side), arm.dot(&up), arm.norm_squared(), 1.0)
    };
    let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for (neighbor, depth) in neighbors.iter().zip(depths) {
        normal += neighbor.weight * row(neighbor) * row(neighbor).transpose();
        right += neighbor.weight * *depth * row(neighbor);
    }
    let factor = normal.cholesky()?;
    let (fit, at_ray) = (factor.solve(&right), factor.solve(&Vector4::w()));
    let reach: f64 = neighbors.iter().map(|n| (n.weight * row(n).dot(&at_ray)).powi(2)).sum();
    let off = |(n, depth): (&Neighbor, &f64)| n.weight * (depth - row(n).dot(&fit)).powi(2);
    let squares: f64 = neighbors.iter().zip(depths).map(off).sum();
    let weights: f64 = neighbors.iter().map(|n| n.weight).sum();
    (reach < EXTRAPOLATED && squares < ROUGH_MM * ROUGH_MM * weights).then_some(fit.w)
}
