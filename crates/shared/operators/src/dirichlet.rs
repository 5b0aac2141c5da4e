//! Systems whose values are prescribed at some vertices.

use crate::factor::{Factor, FactorError};
use crate::ordering::Ordering;
use crate::responses::{Reached, Sparse};
use sprs::CsMat;

/// A quadratic energy `½ uᵀ K u` to be minimised with u prescribed at the *handles* and zero at the *held* vertices.
/// Factored once, solved often.
pub struct Dirichlet {
    vertex_count: usize,
    handles: Vec<u32>,
    factor: Factor,
    /// Per handle the entries of its column of K in the free rows: (place in the factor's order, value).
    couplings: Vec<Sparse>,
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
        let coupling = |&handle: &u32| -> Sparse {
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
        let mut columns = self.right_hand_sides(prescribed);
        self.factor.solve_in_place(&mut columns, prescribed.len());
        self.spread(prescribed, &columns)
    }

    /// The same with a step of refinement, at about twice the price: where needles of triangles cost a plain solve digits.
    /// `matrix`: the one that was factored.
    ///
    /// # Panics
    /// If a column does not have one value per handle.
    #[must_use]
    pub fn solve_refined(&self, matrix: &CsMat<f64>, prescribed: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let right = self.right_hand_sides(prescribed);
        let mut columns = right.clone();
        self.factor.solve_in_place(&mut columns, prescribed.len());
        self.factor.refine_in_place(matrix, &right, &mut columns, prescribed.len());
        self.spread(prescribed, &columns)
    }

    /// `−K_fh u_h`, column after column, in the factor's order.
    fn right_hand_sides(&self, prescribed: &[Vec<f64>]) -> Vec<f64> {
        let rows = self.factor.order().len();
        let mut columns = vec![0.0; rows * prescribed.len()];
        for (values, column) in prescribed.iter().zip(columns.chunks_exact_mut(rows)) {
            assert_eq!(values.len(), self.handles.len(), "one value per handle");
            for (coupling, value) in self.couplings.iter().zip(values) {
                coupling.iter().for_each(|&(row, entry)| column[row as usize] -= entry * value);
            }
        }
        columns
    }

    /// Per column the values of all vertices.
    fn spread(&self, prescribed: &[Vec<f64>], columns: &[f64]) -> Vec<Vec<f64>> {
        let rows = self.factor.order().len();
        let spread = |(values, column): (&Vec<f64>, &[f64])| {
            let mut all = vec![0.0; self.vertex_count];
            self.factor.order().iter().zip(column).for_each(|(&vertex, &value)| all[vertex as usize] = value);
            self.handles.iter().zip(values).for_each(|(&vertex, &value)| all[vertex as usize] = value);
            all
        };
        prescribed.iter().zip(columns.chunks_exact(rows)).map(spread).collect()
    }

    /// Solves for every handle alone: n columns together, on all threads. `keep` says whether the responses themselves
    /// are wanted or only their Schur complement, which costs next to nothing.
    #[must_use]
    pub fn responses(&self, keep: bool) -> Responses {
        let reached = Reached::forward(&self.factor, &self.couplings);
        let taken = reached.gram();
        let left = |(row, taken): (&Vec<f64>, &Vec<f64>)| row.iter().zip(taken).map(|(k, z)| k - z).collect();
        let schur: Vec<Vec<f64>> = self.among_handles.iter().zip(&taken).map(left).collect();
        let values = if keep { self.response_rows(&reached) } else { Vec::new() };
        Responses { values, schur: symmetric(schur) }
    }

    /// #V × n responses, those of the free vertices solved for.
    fn response_rows(&self, reached: &Reached) -> Vec<f32> {
        let count = self.handles.len();
        let mut values = vec![0f32; self.vertex_count * count];
        for (column, &handle) in self.handles.iter().enumerate() {
            values[handle as usize * count + column] = 1.0;
        }
        let mut rows: Vec<&mut [f32]> = values.chunks_exact_mut(count.max(1)).collect();
        let row_of = |&vertex: &u32| std::mem::take(&mut rows[vertex as usize]);
        let mut ordered: Vec<&mut [f32]> = self.factor.order().iter().map(row_of).collect();
        reached.backward(&mut ordered);
        values
    }
}

/// The symmetric part; rounding errors may differ across the diagonal.
fn symmetric(matrix: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mean = |row: usize, column: usize| 0.5 * (matrix[row][column] + matrix[column][row]);
    (0..matrix.len()).map(|row| (0..matrix.len()).map(|column| mean(row, column)).collect()).collect()
}
