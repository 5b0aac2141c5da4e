//! The answer of every unknown to each of many sparse right-hand sides, all at once.
//!
//! Forwards, a right-hand side reaches only the fronts above its entries [Gilbert1994]; there it is kept, and nothing
//! else is computed. Backwards, one walk down the tree solves for all columns together as matrix products, so the factor is
//! read once, and every row goes straight to where it is wanted.

use crate::elimination_tree::NONE;
use crate::factor::Factor;
use crate::symbolic::Symbolic;
use crate::tree::Tree;
use crate::walk::Descent;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, MatMut, MatRef, Par};

/// `L Z = B` in the fronts that a sparse B reaches.
pub(crate) struct Reached<'a> {
    factor: &'a Factor,
    column_count: usize,
    /// Per front its place in `fronts`, or [`NONE`].
    places: Vec<u32>,
    /// Ascending.
    fronts: Vec<ReachedFront>,
}

struct ReachedFront {
    front: usize,
    /// The columns that reach this front, ascending.
    columns: Vec<u32>,
    /// Row after row of the front, one value per column: solved at the pivots, what is passed up below.
    rows: Vec<f64>,
}

/// A sparse right-hand side: (place in the factor's order, value).
pub(crate) type Sparse = Vec<(u32, f64)>;

impl<'a> Reached<'a> {
    pub(crate) fn forward(factor: &'a Factor, sides: &[Sparse]) -> Self {
        let symbolic = &factor.symbolic;
        let mut columns_of = columns_by_front(symbolic, sides);
        let mut reached = Self {
            factor,
            column_count: sides.len(),
            places: vec![NONE; symbolic.front_count()],
            fronts: Vec::new(),
        };
        for front in 0..symbolic.front_count() {
            if columns_of[front].is_empty() {
                continue;
            }
            let mut columns = std::mem::take(&mut columns_of[front]);
            columns.sort_unstable();
            columns.dedup();
            if let Some(parent) = symbolic.tree.parent(front) {
                columns_of[parent].extend(&columns);
            }
            reached.places[front] = reached.fronts.len() as u32;
            let front = reached.solved(front, columns, sides);
            reached.fronts.push(front);
        }
        reached
    }

    fn at(&self, front: usize) -> Option<&ReachedFront> {
        self.fronts.get(self.places[front] as usize)
    }

    /// Gathers the right-hand sides' entries and what the children pass up, and eliminates the pivots.
    fn solved(&self, front: usize, columns: Vec<u32>, sides: &[Sparse]) -> ReachedFront {
        let symbolic = &self.factor.symbolic;
        let shape = symbolic.shape(front);
        let width = columns.len();
        let mut rows = vec![0.0; shape.rows * width];
        let pivots = symbolic.starts[front]..symbolic.starts[front + 1];
        for (at, &column) in columns.iter().enumerate() {
            let inside = sides[column as usize].iter().filter(|(row, _)| pivots.contains(row));
            inside.for_each(|&(row, value)| rows[(row - pivots.start) as usize * width + at] += value);
        }
        for child in symbolic.tree.children(front).iter().filter_map(|&child| self.at(child as usize)) {
            child.pass_up(symbolic, &columns, &mut rows);
        }
        let mut matrix = MatMut::from_column_major_slice_mut(&mut rows, width, shape.rows);
        for block in shape.blocks() {
            let values = &self.factor.values[symbolic.value_starts[front]..];
            let (diagonal, below) = block.of(values).split_at_row(block.columns);
            let (_, rest) = matrix.as_mut().split_at_col_mut(block.column);
            let (mut solved, rest) = rest.split_at_col_mut(block.columns);
            solve_lower_triangular_in_place(diagonal, solved.as_mut().transpose_mut(), Par::Seq);
            matmul(rest, Accum::Add, solved.as_ref(), below.transpose(), -1.0, Par::Seq);
        }
        ReachedFront { front, columns, rows }
    }

    /// `Bᵀ (L Lᵀ)⁻¹ B = Zᵀ Z`: no way back is needed.
    pub(crate) fn gram(&self) -> Vec<Vec<f64>> {
        let mut gram = vec![vec![0.0; self.column_count]; self.column_count];
        for front in &self.fronts {
            let (width, pivots) = (front.columns.len(), self.factor.symbolic.width(front.front));
            let z = MatRef::from_column_major_slice(&front.rows[..width * pivots], width, pivots);
            let mut product = vec![0.0; width * width];
            let into = MatMut::from_column_major_slice_mut(&mut product, width, width);
            matmul(into, Accum::Replace, z, z.transpose(), 1.0, Par::Seq);
            for (row, values) in front.columns.iter().zip(product.chunks_exact(width)) {
                for (column, value) in front.columns.iter().zip(values) {
                    gram[*row as usize][*column as usize] += value;
                }
            }
        }
        gram
    }

    /// `−Lᵀ⁻¹ Z`, rounded: to every row, in the factor's order, one value per right-hand side.
    pub(crate) fn backward(&self, rows: &mut [&'a mut [f32]]) {
        self.descend(rows);
    }
}

/// Per front the right-hand sides with entries among its pivots, possibly more than once.
fn columns_by_front(symbolic: &Symbolic, sides: &[Sparse]) -> Vec<Vec<u32>> {
    let mut columns: Vec<Vec<u32>> = vec![Vec::new(); symbolic.front_count()];
    for (column, side) in sides.iter().enumerate() {
        for (row, _) in side {
            columns[symbolic.starts.partition_point(|start| start <= row) - 1].push(column as u32);
        }
    }
    columns
}

impl ReachedFront {
    /// Adds what is below this front's pivots to the parent's rows, `columns` being the parent's.
    fn pass_up(&self, symbolic: &Symbolic, columns: &[u32], rows: &mut [f64]) {
        let into: Vec<usize> =
            self.columns.iter().map(|column| columns.partition_point(|other| other < column)).collect();
        let below = &self.rows[symbolic.width(self.front) * self.columns.len()..];
        for (&place, values) in symbolic.in_parent(self.front).iter().zip(below.chunks_exact(into.len())) {
            let row = &mut rows[place as usize * columns.len()..][..columns.len()];
            into.iter().zip(values).for_each(|(&column, value)| row[column] += value);
        }
    }
}

impl<'r> Descent for Reached<'r> {
    type Item = &'r mut [f32];
    type Value = f64;

    fn tree(&self) -> &Tree {
        &self.factor.symbolic.tree
    }

    fn start(&self, front: usize) -> usize {
        self.factor.symbolic.starts[front] as usize
    }

    fn values(&self, front: usize) -> usize {
        self.factor.symbolic.shape(front).rows * self.column_count
    }

    fn visit(&self, front: usize, part: &mut [Self::Item], above: &[f64], own: &mut [f64]) {
        let symbolic = &self.factor.symbolic;
        let (shape, width) = (symbolic.shape(front), self.column_count);
        let (pivots, below) = own.split_at_mut(shape.columns * width);
        pivots.fill(0.0);
        for (row, &place) in below.chunks_exact_mut(width).zip(symbolic.in_parent(front)) {
            row.copy_from_slice(&above[place as usize * width..][..width]);
        }
        if let Some(reached) = self.at(front) {
            let rows = pivots.chunks_exact_mut(width).zip(reached.rows.chunks_exact(reached.columns.len()));
            for (row, values) in rows {
                let columns = reached.columns.iter().zip(values);
                columns.for_each(|(&column, value)| row[column as usize] = -value);
            }
        }
        let values = &self.factor.values[symbolic.value_starts[front]..];
        let mut matrix = MatMut::from_column_major_slice_mut(own, width, shape.rows);
        for block in shape.blocks().rev() {
            let (diagonal, under) = block.of(values).split_at_row(block.columns);
            let (_, rest) = matrix.as_mut().split_at_col_mut(block.column);
            let (mut solved, rest) = rest.split_at_col_mut(block.columns);
            matmul(solved.as_mut(), Accum::Add, rest.as_ref(), under, -1.0, Par::Seq);
            solve_upper_triangular_in_place(diagonal.transpose(), solved.transpose_mut(), Par::Seq);
        }
        for (out, row) in part.iter_mut().zip(own.chunks_exact(width)) {
            out.iter_mut().zip(row).for_each(|(out, &value)| *out = value as f32);
        }
    }
}
