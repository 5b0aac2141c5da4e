//! Sparse Cholesky factorisation in a given elimination order, on faer's supernodal kernels.

use faer::Par;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Conj, MatMut, Side};
use sprs::CsMat;

/// Why a matrix could not be factored.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FactorError {
    /// A pivot was not positive: the system does not determine this vertex.
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
    /// The unknowns' vertices, first eliminated first.
    order: Vec<u32>,
    symbolic: SymbolicCholesky<u32>,
    values: Vec<f64>,
}

const NOT_FREE: u32 = u32::MAX;

impl Factor {
    /// Factors the rows and columns of `matrix` (symmetric) that belong to `order`. The order is postordered first, which
    /// keeps the fill and lets faer join columns into dense blocks.
    ///
    /// # Errors
    /// [`FactorError`]: not positive definite, out of memory, or nothing to factor.
    pub fn new(matrix: &CsMat<f64>, order: &[u32]) -> Result<Self, FactorError> {
        if order.is_empty() {
            return Err(FactorError::NothingFree);
        }
        let order = postordered(matrix, order);
        let upper = upper_triangle(matrix, &order);
        let out_of_memory = |_| FactorError::OutOfMemory { unknown_count: order.len() };
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic =
            factorize_symbolic_cholesky(upper.symbolic(), Side::Upper, SymmetricOrdering::Identity, params)
                .map_err(out_of_memory)?;
        let mut values = vec![0.0; symbolic.len_val()];
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch)
            .map_err(|_| FactorError::OutOfMemory { unknown_count: order.len() })?;
        symbolic
            .factorize_numeric_llt(
                &mut values,
                upper.as_ref(),
                Side::Upper,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|error| not_positive(&error, &order))?;
        Ok(Self { order, symbolic, values })
    }

    /// The unknowns' vertices, in the order in which [`Factor::solve_in_place`] takes them.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Number of stored entries of the factor, padding included.
    #[must_use]
    pub fn entry_count(&self) -> usize {
        self.values.len()
    }

    /// Solves `A x = b` for `column_count` columns, in place: `columns` holds them one after the other, each in the
    /// order of [`Factor::order`].
    ///
    /// # Panics
    /// If the length is not unknowns × columns.
    pub fn solve_in_place(&self, columns: &mut [f64], column_count: usize) {
        let rows = self.order.len();
        assert_eq!(columns.len(), rows * column_count, "unknowns × columns");
        let mut memory = MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(column_count, Par::Seq));
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(columns, rows, column_count),
            Par::Seq,
            MemStack::new(&mut memory),
        );
    }
}

fn not_positive(error: &LltError, order: &[u32]) -> FactorError {
    let LltError::NonPositivePivot { index } = error;
    FactorError::NotPositive { vertex: order.get(*index).copied().unwrap_or(order[0]) }
}

/// Per vertex its place in the order.
fn places(order: &[u32], vertex_count: usize) -> Vec<u32> {
    let mut places = vec![NOT_FREE; vertex_count];
    order.iter().enumerate().for_each(|(place, &vertex)| places[vertex as usize] = place as u32);
    places
}

/// The same order with every subtree of the elimination tree [Liu1986] in one piece; the fill stays what it is.
fn postordered(matrix: &CsMat<f64>, order: &[u32]) -> Vec<u32> {
    let parents = elimination_tree(matrix, order);
    let root = order.len();
    let mut first_child = vec![root; root + 1];
    let mut next_sibling = vec![root; root];
    for node in (0..root).rev() {
        let parent = parents[node].min(root as u32) as usize;
        next_sibling[node] = first_child[parent];
        first_child[parent] = node;
    }
    let mut post = Vec::with_capacity(root);
    let mut path = vec![root];
    while let Some(&node) = path.last() {
        let child = first_child[node];
        if child == root {
            path.pop();
            if node != root {
                post.push(order[node]);
            }
        } else {
            first_child[node] = next_sibling[child];
            path.push(child);
        }
    }
    post
}

/// Parent of every column in the elimination tree; [`NOT_FREE`] at roots.
fn elimination_tree(matrix: &CsMat<f64>, order: &[u32]) -> Vec<u32> {
    let places = places(order, matrix.rows());
    let mut parents = vec![NOT_FREE; order.len()];
    let mut ancestors = vec![NOT_FREE; order.len()];
    for (column, &vertex) in order.iter().enumerate() {
        let row = matrix.indptr().outer_inds_sz(vertex as usize);
        for &other in &matrix.indices()[row] {
            let mut node = places[other];
            while node < column as u32 {
                let next = std::mem::replace(&mut ancestors[node as usize], column as u32);
                if next == NOT_FREE {
                    parents[node as usize] = column as u32;
                    break;
                }
                node = next;
            }
        }
    }
    parents
}

/// The upper triangle of the ordered matrix, column by column.
fn upper_triangle(matrix: &CsMat<f64>, order: &[u32]) -> SparseColMat<u32, f64> {
    let places = places(order, matrix.rows());
    let mut starts = vec![0u32];
    let (mut rows, mut values) = (Vec::new(), Vec::new());
    let mut column_entries: Vec<(u32, f64)> = Vec::new();
    for (column, &vertex) in order.iter().enumerate() {
        let row = matrix.indptr().outer_inds_sz(vertex as usize);
        column_entries.clear();
        for (&other, &value) in matrix.indices()[row.clone()].iter().zip(&matrix.data()[row]) {
            if places[other] <= column as u32 {
                column_entries.push((places[other], value));
            }
        }
        column_entries.sort_unstable_by_key(|entry| entry.0);
        rows.extend(column_entries.iter().map(|entry| entry.0));
        values.extend(column_entries.iter().map(|entry| entry.1));
        starts.push(rows.len() as u32);
    }
    let pattern = SymbolicSparseColMat::new_checked(order.len(), order.len(), starts, None, rows);
    SparseColMat::new(pattern, values)
}
