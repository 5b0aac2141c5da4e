//! Iterative refinement: a solution corrected by solving for what it leaves over.
//!
//! Where triangles are needles, neighbouring entries of a shell's matrix differ by ten orders of magnitude, and a substitution
//! in f64 leaves 1e-5 mm. The left-over `b − A x` is summed as if in twice the precision [OgitaRumpOishi2005]; in plain f64 it would
//! be rounding error, and the step would mend nothing.

use crate::factor::Factor;
use pulp::Arch;
use rayon::prelude::*;
use sprs::CsMat;

/// Rows that one task sums; a fixed number, though rows do not touch each other.
const ROWS: usize = 4096;

impl Factor {
    /// One step of refinement [Wilkinson1963] of a solution of `A x = b`, in place. `matrix`: the one that was factored;
    /// `right` and `columns`: b and x, `column_count` columns one after the other in the order of [`Factor::order`].
    ///
    /// # Panics
    /// If a length is not unknowns × columns.
    pub fn refine_in_place(
        &self,
        matrix: &CsMat<f64>,
        right: &[f64],
        columns: &mut [f64],
        column_count: usize,
    ) {
        let rows = self.order().len();
        assert_eq!(
            (right.len(), columns.len()),
            (rows * column_count, rows * column_count),
            "unknowns × columns"
        );
        let mut left = vec![0.0; columns.len()];
        let mut field = vec![0.0; matrix.rows()];
        for ((left, right), column) in
            left.chunks_exact_mut(rows).zip(right.chunks_exact(rows)).zip(columns.chunks_exact(rows))
        {
            self.order().iter().zip(column).for_each(|(&vertex, &value)| field[vertex as usize] = value);
            self.left_over(matrix, right, &field, left);
        }
        self.solve_in_place(&mut left, column_count);
        columns.iter_mut().zip(&left).for_each(|(value, correction)| *value += correction);
    }

    /// `b − A x` of one column; `field`: x at its vertices, 0 at all others.
    fn left_over(&self, matrix: &CsMat<f64>, right: &[f64], field: &[f64], left: &mut [f64]) {
        let arch = Arch::new();
        let tasks = left.par_chunks_mut(ROWS).zip(right.par_chunks(ROWS)).zip(self.order().par_chunks(ROWS));
        tasks.for_each(|((left, right), vertices)| {
            arch.dispatch(|| {
                for ((left, &right), &vertex) in left.iter_mut().zip(right).zip(vertices) {
                    let row = matrix.indptr().outer_inds_sz(vertex as usize);
                    *left = difference(right, &matrix.indices()[row.clone()], &matrix.data()[row], field);
                }
            });
        });
    }
}

/// `right − Σ values · field`, as if in twice the precision. Inlined, so that the fused products are one instruction each.
#[inline(always)]
fn difference(right: f64, columns: &[usize], values: &[f64], field: &[f64]) -> f64 {
    let (mut sum, mut lost) = (right, 0.0f64);
    for (&column, &value) in columns.iter().zip(values) {
        let (a, b) = (-value, field[column]);
        let product = a * b;
        let next = sum + product;
        let part = next - sum;
        lost += a.mul_add(b, -product) + ((sum - (next - part)) + (product - part));
        sum = next;
    }
    sum + lost
}
