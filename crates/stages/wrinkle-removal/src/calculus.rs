//! The operators of a patch, and fields on it.

use crate::Error;
use crate::patch::Patch;
use nalgebra::{Point3, Vector3};
use operators::{CsMat, Factor, Ordering, bilaplacian, cotan_stiffness, lumped_mass};
use rayon::prelude::*;

/// Stiffness, mass and elimination order of a patch; see `operators` for signs.
pub(crate) struct Calculus {
    pub(crate) stiffness: CsMat<f64>,
    /// Lumped areas, mm².
    pub(crate) mass: Vec<f64>,
    /// Areas with infinity where a ring is open: `L` has no curvature there, but the pull of a cut surface, and an energy that
    /// took it for curvature would shrink a flat patch.
    closed_mass: Vec<f64>,
    /// `L M⁻¹ L` without the rows of open vertices.
    pub(crate) bending: CsMat<f64>,
    pub(crate) ordering: Ordering,
    /// Needles and collapsed triangles.
    pub(crate) slivers: operators::Slivers,
}

impl Calculus {
    pub(crate) fn of(patch: &Patch, cotangent_limit: f64) -> Self {
        let (stiffness, slivers) = cotan_stiffness(&patch.points, &patch.triangles, cotangent_limit);
        let mass = lumped_mass(&patch.points, &patch.triangles);
        let closed = |(&mass, &open): (&f64, &bool)| if open { f64::INFINITY } else { mass };
        let closed_mass: Vec<f64> = mass.iter().zip(&patch.open).map(closed).collect();
        let bending = bilaplacian(&stiffness, &closed_mass, 0.0, 1.0);
        let ordering = Ordering::nested_dissection(&bending, &patch.points);
        Self { stiffness, mass, closed_mass, bending, ordering, slivers }
    }

    /// The gradient of the bending energy of positions, `scale · L M⁻¹ L x`, factor by factor and in differences, so that a flat
    /// surface gives nothing but rounding.
    pub(crate) fn bend(&self, points: &[Point3<f64>], scale: f64) -> Vec<Vector3<f64>> {
        let curvature = self.pull(points, scale);
        let pointwise =
            curvature.iter().zip(&self.closed_mass).map(|(value, &mass)| Point3::from(value / mass));
        self.pull(&pointwise.collect::<Vec<_>>(), 1.0)
    }

    /// `scale · L x`, in differences.
    pub(crate) fn pull(&self, points: &[Point3<f64>], scale: f64) -> Vec<Vector3<f64>> {
        let row = |at: usize| -> Vector3<f64> {
            let entries = self.stiffness.indptr().outer_inds_sz(at);
            let others =
                self.stiffness.indices()[entries.clone()].iter().zip(&self.stiffness.data()[entries]);
            others.map(|(&other, &entry)| scale * entry * (points[other] - points[at])).sum()
        };
        (0..points.len()).into_par_iter().map(row).collect()
    }

    /// `scale · matrix`, with the masses added to its diagonal.
    pub(crate) fn with_mass(&self, matrix: &CsMat<f64>, scale: f64) -> CsMat<f64> {
        with_diagonal(matrix, scale, &self.mass)
    }

    /// Factors the rows and columns of the vertices of `among`.
    pub(crate) fn factor(&self, matrix: &CsMat<f64>, among: impl Fn(usize) -> bool) -> Result<System, Error> {
        let order: Vec<u32> =
            self.ordering.vertices().iter().copied().filter(|&vertex| among(vertex as usize)).collect();
        let factor = if order.is_empty() { None } else { Some(Factor::new(matrix, &order)?) };
        Ok(System { factor, vertex_count: matrix.rows() })
    }
}

/// `scale · matrix`, with `diagonal` added to its diagonal.
pub(crate) fn with_diagonal(matrix: &CsMat<f64>, scale: f64, diagonal: &[f64]) -> CsMat<f64> {
    let count = diagonal.len();
    let places = ((0..=count).collect(), (0..count).collect());
    &matrix.map(|value| scale * value) + &CsMat::new((count, count), places.0, places.1, diagonal.to_vec())
}

/// A factored system for some vertices; all others are 0.
pub(crate) struct System {
    factor: Option<Factor>,
    vertex_count: usize,
}

impl System {
    /// Factors all of a matrix, in the given order.
    pub(crate) fn whole(matrix: &CsMat<f64>, ordering: &Ordering) -> Result<Self, Error> {
        Ok(Self { factor: Some(Factor::new(matrix, ordering.vertices())?), vertex_count: matrix.rows() })
    }

    /// Solves for N columns at once; `right`: per vertex.
    pub(crate) fn solve<const N: usize>(&self, right: impl Fn(usize) -> [f64; N]) -> Vec<[f64; N]> {
        let mut solution = vec![[0.0; N]; self.vertex_count];
        let Some(factor) = &self.factor else { return solution };
        let count = factor.order().len();
        let mut columns = vec![0.0; N * count];
        for (row, &vertex) in factor.order().iter().enumerate() {
            let values = right(vertex as usize).into_iter().enumerate();
            values.for_each(|(column, value)| columns[column * count + row] = value);
        }
        factor.solve_in_place(&mut columns, N);
        for (row, &vertex) in factor.order().iter().enumerate() {
            solution[vertex as usize] = std::array::from_fn(|column| columns[column * count + row]);
        }
        solution
    }
}
