//! Where a warp folds space over: det ∂c/∂x ≤ 0 near the face.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::Point3;
use operators::{Inverse, RbfMap};
use rayon::prelude::*;

/// The face's worst place.
#[derive(Debug, Clone, PartialEq)]
pub struct Folding {
    /// Smallest det ∂c/∂x at the centers and at the preimages of the mesh's vertices near them.
    pub smallest_determinant: f64,
    /// The vertex where it is; `None` = at a center.
    pub vertex: Option<usize>,
    /// Vertices near the markers without a preimage.
    pub unreached: Vec<usize>,
}

/// Smallest Jacobian determinant of c at its centers and on the vertices of the mesh (face space, mm) that are at most
/// `near_mm` from one of `handles` (mm).
#[must_use]
pub fn folding(
    map: &RbfMap,
    inverse: &Inverse,
    handles: &[Point3<f64>],
    vertices: &[Point3<f64>],
    near_mm: f64,
) -> Folding {
    let at_centers = map.centers().into_iter().map(|center| map.with_jacobian(&center).1.determinant());
    let mut smallest = at_centers.fold(f64::INFINITY, f64::min);
    let (mut place, mut unreached) = (None, Vec::new());
    let near = vertices_near(handles, vertices, near_mm);
    let points: Vec<_> = near.iter().map(|&vertex| vertices[vertex]).collect();
    for (&vertex, preimage) in near.iter().zip(inverse.preimages(&points)) {
        if !inverse.is_found(&preimage) {
            unreached.push(vertex);
        } else if preimage.determinant < smallest {
            (smallest, place) = (preimage.determinant, Some(vertex));
        }
    }
    Folding { smallest_determinant: smallest, vertex: place, unreached }
}

fn vertices_near(handles: &[Point3<f64>], vertices: &[Point3<f64>], near_mm: f64) -> Vec<usize> {
    let handles: Vec<[f64; 3]> = handles.iter().map(|&point| point.into()).collect();
    let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&handles) else { return Vec::new() };
    let is_near = |&vertex: &usize| {
        let point: [f64; 3] = vertices[vertex].into();
        tree.query(&point).nearest_one::<SquaredEuclidean<f64>>().execute().distance <= near_mm * near_mm
    };
    (0..vertices.len()).into_par_iter().filter(is_near).collect()
}
