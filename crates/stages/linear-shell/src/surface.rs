//! The surface under the shell: looked over, and its operators assembled.

use crate::{BowTies, Constraints, Error, FreeComponents, Model, Params};
use mesh::{Connectivity, Mesh};
use nalgebra::Point3;
use operators::{CsMat, Ordering, Slivers, bilaplacian, cotan_stiffness, lumped_mass};
use serde::Serialize;
use std::collections::HashSet;
use std::sync::Arc;

/// What a look over the mesh found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Survey {
    /// Vertices of the mesh.
    pub vertices: usize,
    /// Triangles, polygons split.
    pub triangles: usize,
    /// Vertices that no triangle uses; they stay still.
    pub unreferenced_vertices: usize,
    /// Bow-tie vertices that were joined.
    pub bow_ties: usize,
    /// Parts without a handle that are held still.
    pub held_components: usize,
    /// Needle triangles whose cotangents were scaled down to the limit.
    pub tempered_triangles: usize,
    /// Triangles whose corners lie in one place, left out.
    pub collapsed_triangles: usize,
    /// Lengths of the openings, mm, longest first: the boundary loops inside the surface that are no outer rim.
    pub openings_mm: Vec<f64>,
    /// Whether none of the openings can be the mouth: there is none, or only a pair of eyes.
    pub mouth_is_missing: bool,
}

/// A mesh that a shell can be solved on, with its operators.
pub struct Surface {
    pub(crate) points: Vec<Point3<f64>>,
    pub(crate) stiffness: Arc<CsMat<f64>>,
    pub(crate) still: Vec<u32>,
    pub(crate) around: Connectivity,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Boundary loops of mouth and eyes.
    pub(crate) openings: Vec<Vec<u32>>,
    pub(crate) params: Params,
    survey: Survey,
}

impl Surface {
    /// Looks over the mesh and assembles `K = k_s L + k_b L M⁻¹ L` [BickelBotsch2007, Eq. 4]; for the model with soft openings,
    /// `L M⁻¹ L`, which continues a coarse solution.
    ///
    /// # Errors
    /// A parameter, a handle or a defect of the mesh that makes the shell unsolvable; see [`Error`].
    pub fn survey(mesh: &Mesh, constraints: &Constraints, params: &Params) -> Result<Self, Error> {
        params.check()?;
        constraints.check(mesh.positions.len())?;
        let triangles = mesh.triangles();
        let around = Connectivity::of(mesh.positions.len(), &triangles);
        let bow_ties = check_manifold(&around, params)?;
        let unreferenced = around.unreferenced();
        let loose: HashSet<u32> = unreferenced.iter().copied().collect();
        if let Some(&vertex) = constraints.handles.iter().find(|handle| loose.contains(handle)) {
            return Err(Error::LooseHandle { vertex });
        }
        let (still, held_components) = free_parts(&around, &loose, constraints, params)?;
        let (laplacian, slivers) = cotan_stiffness(&mesh.positions, &triangles, params.cotangent_limit);
        let mass = lumped_mass(&mesh.positions, &triangles);
        let stiffness = match params.model {
            Model::Paper => bilaplacian(&laplacian, &mass, params.stretching, params.bending_mm2),
            Model::SoftOpenings => bilaplacian(&laplacian, &mass, 0.0, 1.0),
        };
        let openings = mesh::openings(&around, &mesh.positions, params.smallest_opening_mm);
        let openings_mm: Vec<f64> =
            openings.iter().map(|vertices| mesh::loop_length(&mesh.positions, vertices)).collect();
        let Slivers { tempered, collapsed } = slivers;
        let survey = Survey {
            vertices: mesh.positions.len(),
            triangles: triangles.len(),
            unreferenced_vertices: unreferenced.len(),
            bow_ties,
            held_components,
            tempered_triangles: tempered,
            collapsed_triangles: collapsed,
            mouth_is_missing: mouth_is_missing(&openings_mm),
            openings_mm,
        };
        Ok(Self {
            points: mesh.positions.clone(),
            stiffness: Arc::new(stiffness),
            still,
            around,
            triangles,
            openings,
            params: params.clone(),
            survey,
        })
    }

    /// What was found.
    #[must_use]
    pub fn report(&self) -> &Survey {
        &self.survey
    }

    /// The openings as closed polylines, mm.
    pub(crate) fn opening_points(&self) -> Vec<Vec<Point3<f64>>> {
        let at = |&vertex: &u32| self.points[vertex as usize];
        self.openings.iter().map(|vertices| vertices.iter().map(at).collect()).collect()
    }

    /// The vertices' places, mm.
    #[must_use]
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// An elimination order for this mesh; it serves any set of handles.
    #[must_use]
    pub fn ordering(&self) -> Ordering {
        Ordering::nested_dissection(&self.stiffness, &self.points)
    }

    /// The system matrix K, #V × #V: for tests and for comparison with other solvers.
    #[must_use]
    pub fn system(&self) -> &CsMat<f64> {
        &self.stiffness
    }
}

/// Refuses what the operators are not defined on; returns the number of bow ties that are let pass.
fn check_manifold(around: &Connectivity, params: &Params) -> Result<usize, Error> {
    if let [first, ..] = &around.non_manifold_edges()[..] {
        return Err(Error::NonManifold {
            count: around.non_manifold_edges().len(),
            vertices: first.vertices,
        });
    }
    if let [first, ..] = &around.flipped_edges()[..] {
        return Err(Error::Flipped { count: around.flipped_edges().len(), vertices: first.vertices });
    }
    let bow_ties = around.bow_ties();
    match bow_ties.first() {
        Some(&vertex) if params.bow_ties == BowTies::Refuse => {
            Err(Error::BowTies { count: bow_ties.len(), vertex })
        }
        _ => Ok(bow_ties.len()),
    }
}

/// The vertices of parts that no handle or held vertex holds, and of none; and how many such parts there are.
fn free_parts(
    around: &Connectivity,
    loose: &HashSet<u32>,
    constraints: &Constraints,
    params: &Params,
) -> Result<(Vec<u32>, usize), Error> {
    let (component, count) = around.components();
    let mut anchored = vec![false; count];
    let anchors = constraints.handles.iter().chain(&constraints.held);
    anchors.for_each(|&vertex| anchored[component[vertex as usize] as usize] = true);
    let free: Vec<u32> = (0..component.len() as u32)
        .filter(|&vertex| !anchored[component[vertex as usize] as usize])
        .collect();
    let mut sizes = vec![0usize; count];
    for &vertex in free.iter().filter(|vertex| !loose.contains(vertex)) {
        sizes[component[vertex as usize] as usize] += 1;
    }
    let parts = sizes.iter().filter(|&&size| size > 0).count();
    let largest = (0..count).max_by_key(|&part| (sizes[part], std::cmp::Reverse(part))).unwrap_or(0);
    if parts > 0 && params.free_components == FreeComponents::Refuse {
        let vertex = free.iter().copied().find(|&vertex| component[vertex as usize] as usize == largest);
        let (vertex, vertex_count) = (vertex.unwrap_or(0), sizes[largest]);
        return Err(Error::FreeComponent { count: parts, vertex, vertex_count });
    }
    Ok((free, parts))
}

/// Two openings whose lengths are at least this much alike are a pair of eyes.
const EYE_LIKENESS: f64 = 0.8;

/// Whether none of the openings can be a mouth: there is none, or only a pair of eyes.
fn mouth_is_missing(lengths_mm: &[f64]) -> bool {
    match lengths_mm {
        [] => true,
        [longer, shorter] => shorter / longer >= EYE_LIKENESS,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::mouth_is_missing;

    #[test]
    fn a_pair_of_eyes_is_no_mouth() {
        assert!(mouth_is_missing(&[]) && mouth_is_missing(&[66.0, 65.0]));
        assert!(!mouth_is_missing(&[102.0]) && !mouth_is_missing(&[102.0, 66.0]));
        assert!(!mouth_is_missing(&[102.0, 66.0, 65.0]));
    }
}
