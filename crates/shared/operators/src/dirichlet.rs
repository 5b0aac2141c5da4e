//! Systems whose values are prescribed at some vertices.

use crate::factor::{Factor, FactorError};
use crate::ordering::Ordering;
use rayon::prelude::*;
use sprs::CsMat;

/// Columns that are solved together; a fixed number, so that results do not depend on the threads.
const BLOCK: usize = 8;

/// A quadratic energy `½ uᵀ K u` to be minimised with u prescribed at the *handles* and zero at the *held* vertices.
/// Factored once, solved often.
pub struct Dirichlet {
    vertex_count: usize,
    handles: Vec<u32>,
    factor: Factor,
    /// Per handle the entries of its column of K in the free rows: (place in the factor's order, value).
    couplings: Vec<Vec<(u32, f64)>>,
    /// K among the handles, n × n.
    among_handles: Vec<Vec<f64>>,
}

/// The answer of every vertex to each handle.
pub struct Responses {
    /// #V × n, row after row: u at the vertex when one handle is 1 and all others 0.
    pub values: Vec<f32>,
    /// n × n Schur complement `K_hh − K_hf K_ff⁻¹ K_fh`: the energy's Hessian in the handles alone.
    pub schur: Vec<Vec<f64>>,
}

impl Dirichlet {
    /// Eliminates the handles and the held vertices and factors the rest.
    ///
    /// `matrix`: #V × #V, symmetric positive semi-definite. `handles` and `held` are vertex indices; a vertex that is both is a
    /// handle.
    ///
    /// # Errors
    /// [`FactorError`] where the prescribed vertices do not determine the rest.
    pub fn factor(
        matrix: &CsMat<f64>,
        handles: &[u32],
        held: &[u32],
        ordering: &Ordering,
    ) -> Result<Self, FactorError> {
        let vertex_count = matrix.rows();
        let mut free = vec![true; vertex_count];
        handles.iter().chain(held).for_each(|&vertex| free[vertex as usize] = false);
        let order: Vec<u32> =
            ordering.vertices().iter().copied().filter(|&vertex| free[vertex as usize]).collect();
        let factor = Factor::new(matrix, &order)?;
        let mut places = vec![u32::MAX; vertex_count];
        factor.order().iter().enumerate().for_each(|(at, &vertex)| places[vertex as usize] = at as u32);
        let entries = |handle: u32| {
            let row = matrix.indptr().outer_inds_sz(handle as usize);
            matrix.indices()[row.clone()].iter().copied().zip(matrix.data()[row].iter().copied())
        };
        let coupling = |&handle: &u32| -> Vec<(u32, f64)> {
            let in_free = entries(handle).filter(|&(vertex, _)| free[vertex]);
            in_free.map(|(vertex, value)| (places[vertex], value)).collect()
        };
        let value_at = |row: u32, column: u32| {
            entries(row).find(|&(vertex, _)| vertex == column as usize).map_or(0.0, |(_, value)| value)
        };
        let among = |&row: &u32| handles.iter().map(|&column| value_at(row, column)).collect();
        Ok(Self {
            vertex_count,
            handles: handles.to_vec(),
            couplings: handles.iter().map(coupling).collect(),
            among_handles: handles.iter().map(among).collect(),
            factor,
        })
    }

    /// The factorisation of the free part.
    #[must_use]
    pub fn free_factor(&self) -> &Factor {
        &self.factor
    }

    /// Minimises the energy for several right-hand sides at once. `prescribed`: per column n handle values; returns per
    /// column #V values.
    ///
    /// # Panics
    /// If a column does not have one value per handle.
    #[must_use]
    pub fn solve(&self, prescribed: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let rows = self.factor.order().len();
        let mut columns = vec![0.0; rows * prescribed.len()];
        for (values, column) in prescribed.iter().zip(columns.chunks_exact_mut(rows)) {
            assert_eq!(values.len(), self.handles.len(), "one value per handle");
            for (coupling, value) in self.couplings.iter().zip(values) {
                coupling.iter().for_each(|&(row, entry)| column[row as usize] -= entry * value);
            }
        }
        self.factor.solve_in_place(&mut columns, prescribed.len());
        let spread = |(values, column): (&Vec<f64>, &[f64])| {
            let mut all = vec![0.0; self.vertex_count];
            self.factor.order().iter().zip(column).for_each(|(&vertex, &value)| all[vertex as usize] = value);
            self.handles.iter().zip(values).for_each(|(&vertex, &value)| all[vertex as usize] = value);
            all
        };
        prescribed.iter().zip(columns.chunks_exact(rows)).map(spread).collect()
    }

    /// Solves for every handle alone: n columns, in blocks, on all threads. `keep` says whether the responses themselves
    /// are wanted or only their Schur complement.
    #[must_use]
    pub fn responses(&self, keep: bool) -> Responses {
        let count = self.handles.len();
        let starts: Vec<usize> = (0..count).step_by(BLOCK).collect();
        let solve_block = |&start: &usize| {
            let block = start..(start + BLOCK).min(count);
            let columns = self.response_columns(block.clone());
            let schur: Vec<Vec<f64>> = columns
                .chunks_exact(self.factor.order().len())
                .zip(block)
                .map(|(column, handle)| self.schur_row(handle, column))
                .collect();
            let kept: Vec<f32> = if keep { columns.iter().map(|&x| x as f32).collect() } else { Vec::new() };
            (kept, schur)
        };
        // A few blocks at a time: the f64 columns of all of them would not fit.
        let mut values = vec![0f32; if keep { self.vertex_count * count } else { 0 }];
        let mut schur = Vec::with_capacity(count);
        for group in starts.chunks(rayon::current_num_threads()) {
            let blocks: Vec<_> = group.par_iter().map(solve_block).collect();
            for (&start, (kept, rows)) in group.iter().zip(blocks) {
                self.scatter(&kept, start, rows.len(), &mut values);
                schur.extend(rows);
            }
        }
        if keep {
            for (column, &handle) in self.handles.iter().enumerate() {
                values[handle as usize * count + column] = 1.0;
            }
        }
        Responses { values, schur: symmetric(schur) }
    }

    fn response_columns(&self, handles: std::ops::Range<usize>) -> Vec<f64> {
        let rows = self.factor.order().len();
        let count = handles.len();
        let mut columns = vec![0.0; rows * count];
        for (handle, column) in handles.zip(columns.chunks_exact_mut(rows)) {
            self.couplings[handle].iter().for_each(|&(row, entry)| column[row as usize] = -entry);
        }
        self.factor.solve_in_place(&mut columns, count);
        columns
    }

    fn schur_row(&self, handle: usize, response: &[f64]) -> Vec<f64> {
        let reaction = |coupling: &Vec<(u32, f64)>| -> f64 {
            coupling.iter().map(|&(row, entry)| entry * response[row as usize]).sum()
        };
        self.couplings
            .iter()
            .zip(&self.among_handles[handle])
            .map(|(coupling, k)| k + reaction(coupling))
            .collect()
    }

    /// Writes a block of response columns into their places in the row-major array.
    fn scatter(&self, kept: &[f32], start: usize, block: usize, values: &mut [f32]) {
        let rows = self.factor.order().len();
        let count = self.handles.len();
        if kept.is_empty() {
            return;
        }
        for (row, &vertex) in self.factor.order().iter().enumerate() {
            let out = &mut values[vertex as usize * count + start..][..block];
            out.iter_mut().enumerate().for_each(|(column, out)| *out = kept[column * rows + row]);
        }
    }
}

/// The symmetric part; the solves leave rounding errors that differ across the diagonal.
fn symmetric(matrix: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mean = |row: usize, column: usize| 0.5 * (matrix[row][column] + matrix[column][row]);
    (0..matrix.len()).map(|row| (0..matrix.len()).map(|column| mean(row, column)).collect()).collect()
}
