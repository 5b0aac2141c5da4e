//! The three steps, in order.

use crate::calculus::Calculus;
use crate::patch::Patch;
use crate::{Error, Params, detail, fill};
use mesh::Mesh;
use nalgebra::Point3;
use serde::Serialize;

/// A scan without its wrinkles.
#[derive(Debug, Clone, PartialEq)]
pub struct Smoothed {
    /// #V positions, mm; outside the region those of the scan, bit for bit.
    pub positions: Vec<Point3<f64>>,
    /// What was done.
    pub report: Report,
}

/// What a removal did, in numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Vertices that the region lets move.
    pub region_vertices: usize,
    /// Region vertices on the mesh's own boundary, which stay.
    pub held_on_boundary: usize,
    /// Root mean square of how far region vertices moved, mm.
    pub moved_rms_mm: f64,
    /// The farthest that one moved, mm.
    pub moved_max_mm: f64,
    /// Root mean square height of the fine detail that was put back, mm.
    pub detail_rms_mm: f64,
    /// Median edge length in and beside the region, mm.
    pub edge_mm: f64,
    /// Needle triangles whose cotangents were scaled down.
    pub tempered_triangles: usize,
}

/// How far beyond the region the split looks, in wavelengths of detail.
const MARGIN: f64 = 3.0;

/// Removes what is of medium scale from a region of a scan [BickelBotsch2007, Sec. 5.4]: fine detail is taken off and kept, the
/// region becomes the surface that bends least between its surroundings, and the detail goes back on along its normals.
///
/// `weights`: #V, how much a vertex takes part, 0 to 1: 0 is outside, where nothing changes, bit for bit; between 0 and 1 the
/// vertex goes that share of its way. Order of vertices, faces, UVs and labels are the mesh's.
///
/// # Errors
/// [`Error`]: a parameter, an empty region, one without anything around it, or a surface that is not a manifold there.
///
/// # Panics
/// If there is not one weight per vertex.
pub fn remove(mesh: &Mesh, weights: &[f64], params: &Params) -> Result<Smoothed, Error> {
    params.check()?;
    assert_eq!(weights.len(), mesh.positions.len(), "one weight per vertex");
    if !weights.iter().any(|&weight| weight > 0.0) {
        return Err(Error::EmptyRegion { why: "all weights are 0" });
    }
    let patch = Patch::cut(mesh, &mesh.triangles(), weights, MARGIN * params.detail_mm)?;
    let (smoothed, detail_rms_mm, tempered_triangles) = three_steps(&patch, params)?;
    let shares = shares(&patch, params);
    let mut positions = mesh.positions.clone();
    for (local, &vertex) in patch.vertices.iter().enumerate() {
        if shares[local] > 0.0 {
            positions[vertex as usize] += shares[local] * (smoothed[local] - patch.points[local]);
        }
    }
    let report = report(mesh, &positions, &patch, detail_rms_mm, tempered_triangles);
    Ok(Smoothed { positions, report })
}

/// The patch without its wrinkles, the root mean square of the detail that it got back, and the number of needles.
fn three_steps(patch: &Patch, params: &Params) -> Result<(Vec<Point3<f64>>, f64, usize), Error> {
    let calculus = Calculus::of(patch, params.cotangent_limit);
    let layers = detail::split(patch, &calculus, params)?;
    let filled = fill::fill(patch, &calculus, &layers.base, params.shape_mm)?;
    let normals = mesh::vertex_normals(&filled, &patch.triangles);
    let smoothed = filled
        .iter()
        .zip(&normals)
        .zip(&layers.heights)
        .map(|((point, normal), &height)| point + height * normal);
    let free = patch.free();
    let squares: Vec<f64> = layers
        .heights
        .iter()
        .zip(&free)
        .filter(|(_, free)| **free)
        .map(|(height, _)| height * height)
        .collect();
    Ok((smoothed.collect(), root_mean(&squares), calculus.slivers.tempered))
}

/// Per patch vertex the share of the way that it goes: 0 where it stays.
fn shares(patch: &Patch, params: &Params) -> Vec<f64> {
    let free = patch.free();
    let set_in = feather(patch, &free, params.feather_mm);
    let share = |vertex: usize| match free[vertex] {
        true => params.strength * patch.weights[vertex].min(1.0) * set_in[vertex],
        false => 0.0,
    };
    (0..free.len()).map(share).collect()
}

/// A smooth step over the distance from the nearest vertex that stays, along edges.
fn feather(patch: &Patch, free: &[bool], width: f64) -> Vec<f64> {
    if width == 0.0 {
        return vec![1.0; free.len()];
    }
    let outside: Vec<f64> = free.iter().map(|&free| if free { f64::INFINITY } else { 0.0 }).collect();
    let reached = crate::patch::distances(&patch.points, &patch.triangles, outside, width);
    let step = |distance: f64| {
        let share = (distance / width).min(1.0);
        share * share * (3.0 - 2.0 * share)
    };
    reached.into_iter().map(step).collect()
}

fn root_mean(squares: &[f64]) -> f64 {
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

fn report(
    mesh: &Mesh,
    positions: &[Point3<f64>],
    patch: &Patch,
    detail_rms_mm: f64,
    tempered_triangles: usize,
) -> Report {
    let free = patch.free();
    let region: Vec<usize> =
        (0..free.len()).filter(|&local| free[local]).map(|local| patch.vertices[local] as usize).collect();
    let squares: Vec<f64> =
        region.iter().map(|&vertex| (positions[vertex] - mesh.positions[vertex]).norm_squared()).collect();
    let held = (0..free.len()).filter(|&local| patch.rim[local] && patch.weights[local] > 0.0);
    Report {
        region_vertices: region.len(),
        held_on_boundary: held.count(),
        moved_rms_mm: root_mean(&squares),
        moved_max_mm: squares.iter().copied().fold(0.0, f64::max).sqrt(),
        detail_rms_mm,
        edge_mm: mesh::edge_length_median(&patch.points, &patch.triangles),
        tempered_triangles,
    }
}
