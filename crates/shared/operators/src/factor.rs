//! Sparse Cholesky factorisation in a given elimination order.

use crate::elimination::Elimination;
use crate::elimination_tree::Permuted;
use crate::substitution::substitute;
use crate::symbolic::Symbolic;
use crate::walk::Ascent;
use sprs::CsMat;

/// Why a matrix could not be factored.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FactorError {
    /// A pivot was not positive, or nothing but rounding error: the system does not determine this vertex.
    #[error("the system is not positive definite at vertex {vertex}")]
    NotPositive {
        /// Vertex of the pivot.
        vertex: u32,
    },
    /// The factor does not fit.
    #[error("not enough memory for a factor of {unknown_count} unknowns")]
    OutOfMemory {
        /// Number of unknowns.
        unknown_count: usize,
    },
    /// Fewer unknowns than one.
    #[error("no vertex is left free")]
    NothingFree,
}

/// `P A Pᵀ = L Lᵀ` of the part of a symmetric matrix that belongs to some vertices.
pub struct Factor {
    pub(crate) symbolic: Symbolic,
    pub(crate) values: Vec<f64>,
}

impl Factor {
    /// Factors the rows and columns of `matrix` (symmetric) that belong to `order`, by the multifrontal method
    /// [DuffReid1983, Liu1992] on all threads; the same bytes for any number of them.
    ///
    /// # Errors
    /// [`FactorError`]: not positive definite, out of memory, or nothing to factor.
    pub fn new(matrix: &CsMat<f64>, order: &[u32]) -> Result<Self, FactorError> {
        Self::of_blocks(matrix, order, 1, matrix)
    }

    /// Factors a matrix of which each vertex has `size` unknowns, number `size · vertex` and after, that share all their neighbours: it
    /// is analysed by its blocks, at a `size²`-th of the cost. `pattern`: #V × #V, symmetric, its values are not looked at;
    /// `order`: vertices; `matrix`: of the unknowns; entries of rows that are eliminated before their column may be left out.
    ///
    /// # Errors
    /// As [`Factor::new`].
    pub fn of_blocks(
        pattern: &CsMat<f64>,
        order: &[u32],
        size: usize,
        matrix: &CsMat<f64>,
    ) -> Result<Self, FactorError> {
        if order.is_empty() {
            return Err(FactorError::NothingFree);
        }
        let symbolic = Symbolic::new(pattern, order, size);
        let values = zeros(symbolic.value_starts[symbolic.front_count()])
            .ok_or(FactorError::OutOfMemory { unknown_count: order.len() * size })?;
        let mut factor = Self { symbolic, values };
        factor.renew(matrix)?;
        Ok(factor)
    }

    /// Factors another matrix of the same pattern: the analysis and the memory are used again. After an error the factor solves
    /// nothing, but can be renewed again.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`].
    pub fn renew(&mut self, matrix: &CsMat<f64>) -> Result<(), FactorError> {
        let Self { symbolic, values } = self;
        let elimination = Elimination { symbolic, matrix: Permuted::new(matrix, &symbolic.order) };
        elimination
            .ascend(values)
            .map_err(|column| FactorError::NotPositive { vertex: symbolic.order[column] })
    }

    /// The unknowns' vertices, in the order in which [`Factor::solve_in_place`] takes them.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.symbolic.order
    }

    /// Entries of the factor that are not zero by structure.
    #[must_use]
    pub fn entry_count(&self) -> usize {
        self.symbolic.entry_count
    }

    /// Number of stored entries of the factor, padding included; 8 bytes each.
    #[must_use]
    pub fn stored_count(&self) -> usize {
        self.values.len()
    }

    /// Solves `A x = b` for `column_count` columns, in place: `columns` holds them one after the other, each in the
    /// order of [`Factor::order`].
    ///
    /// # Panics
    /// If the length is not unknowns × columns.
    pub fn solve_in_place(&self, columns: &mut [f64], column_count: usize) {
        let rows = self.order().len();
        assert_eq!(columns.len(), rows * column_count, "unknowns × columns");
        for some in columns.chunks_mut(rows * 8) {
            match some.len() / rows {
                1 => self.solve_lanes::<1>(some),
                2..=4 => self.solve_lanes::<4>(some),
                _ => self.solve_lanes::<8>(some),
            }
        }
    }

    fn solve_lanes<const N: usize>(&self, columns: &mut [f64]) {
        let count = self.order().len();
        let mut rows = vec![[0.0; N]; count];
        for (lane, column) in columns.chunks_exact(count).enumerate() {
            rows.iter_mut().zip(column).for_each(|(row, &value)| row[lane] = value);
        }
        substitute(&self.symbolic, &self.values, &mut rows);
        for (lane, column) in columns.chunks_exact_mut(count).enumerate() {
            column.iter_mut().zip(&rows).for_each(|(value, row)| *value = row[lane]);
        }
    }
}

/// Zeros, or nothing if there is no memory for them. Asked for in two steps, since only `vec!` gets zeroed pages from the
/// system, and only `try_reserve` says no.
fn zeros(count: usize) -> Option<Vec<f64>> {
    Vec::<f64>::new().try_reserve_exact(count).ok()?;
    Some(vec![0.0; count])
}
