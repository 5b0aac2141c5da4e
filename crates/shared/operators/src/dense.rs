//! Dense parts of a factorisation: lower trapezoids in blocks of columns, on faer's kernels.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{BlockStructure, matmul as triangular_matmul};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Columns of a block; above the diagonal only squares of this size are stored in vain.
pub(crate) const BLOCK: usize = 128;
/// Rows that one task works on.
const CHUNK: usize = 512;

/// The lower part of a dense matrix, stored in blocks of columns one after the other: each starts at its diagonal and is
/// stored column by column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Trapezoid {
    pub(crate) rows: usize,
    pub(crate) columns: usize,
}

/// A block of columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Block {
    /// Where its values start.
    pub(crate) start: usize,
    /// Its first column, which is also its first row.
    pub(crate) column: usize,
    pub(crate) rows: usize,
    pub(crate) columns: usize,
}

impl Block {
    fn end(&self) -> usize {
        self.start + self.rows * self.columns
    }

    /// Its values, as a matrix.
    pub(crate) fn of<'a>(&self, values: &'a [f64]) -> MatRef<'a, f64> {
        MatRef::from_column_major_slice(&values[self.start..self.end()], self.rows, self.columns)
    }
}

impl Trapezoid {
    pub(crate) fn new(rows: usize, columns: usize) -> Self {
        Self { rows, columns }
    }

    pub(crate) fn len(&self) -> usize {
        self.blocks().last().map_or(0, |block| block.end())
    }

    pub(crate) fn blocks(self) -> impl DoubleEndedIterator<Item = Block> + Clone {
        (0..self.columns.div_ceil(BLOCK)).map(move |index| self.block(index))
    }

    fn block(&self, index: usize) -> Block {
        let column = index * BLOCK;
        // All blocks before are BLOCK columns wide and lose BLOCK rows each.
        let start = column * self.rows - BLOCK * BLOCK * (index * index.saturating_sub(1) / 2);
        Block { start, column, rows: self.rows - column, columns: BLOCK.min(self.columns - column) }
    }

    /// Where a column's diagonal entry stands.
    pub(crate) fn diagonal(&self, column: usize) -> usize {
        let block = self.block(column / BLOCK);
        block.start + (column - block.column) * (block.rows + 1)
    }

    /// Multiplications of a front of this shape, its update included.
    pub(crate) fn elimination_work(&self) -> f64 {
        let (rows, columns) = (self.rows as f64, self.columns as f64);
        columns * rows * rows
    }
}

/// Values that the blocks of a trapezoid occupy, each as a matrix.
fn blocks_mut(values: &mut [f64], blocks: impl Iterator<Item = Block>) -> Vec<(Block, MatMut<'_, f64>)> {
    let mut rest = values;
    let mut matrices = Vec::new();
    for block in blocks {
        let (head, tail) = rest.split_at_mut(block.rows * block.columns);
        matrices.push((block, MatMut::from_column_major_slice_mut(head, block.rows, block.columns)));
        rest = tail;
    }
    matrices
}

/// Runs over items, on all threads if it is worth it.
fn each<T: Send>(items: Vec<T>, wide: bool, work: impl Fn(T) + Sync + Send) {
    match wide {
        true => items.into_par_iter().for_each(work),
        false => items.into_iter().for_each(work),
    }
}

/// A pivot column that is not positive.
pub(crate) struct NotPositive {
    pub(crate) column: usize,
}

/// Eliminates the pivot columns of a front, in place. `limits`: per column the least pivot that is not rounding error.
pub(crate) fn eliminate(
    shape: Trapezoid,
    values: &mut [f64],
    limits: &[f64],
    wide: bool,
) -> Result<(), NotPositive> {
    for block in shape.blocks() {
        let (done, later) = values.split_at_mut(block.end());
        let current =
            MatMut::from_column_major_slice_mut(&mut done[block.start..], block.rows, block.columns);
        factor_block(block, current, limits, wide)?;
        let done = block.of(done);
        let following = shape.blocks().skip_while(|other| other.column <= block.column);
        each(blocks_mut(later, following), wide, |(other, matrix)| {
            let rows = done.subrows(other.column - block.column, other.rows);
            subtract_lower(matrix, rows, Accum::Add);
        });
    }
    Ok(())
}

fn factor_block(
    block: Block,
    current: MatMut<'_, f64>,
    limits: &[f64],
    wide: bool,
) -> Result<(), NotPositive> {
    let (mut diagonal, below) = current.split_at_row_mut(block.columns);
    let mut memory =
        MemBuffer::new(cholesky_in_place_scratch::<f64>(block.columns, Par::Seq, Default::default()));
    let stack = MemStack::new(&mut memory);
    let factored = cholesky_in_place(
        diagonal.as_mut(),
        LltRegularization::default(),
        Par::Seq,
        stack,
        Default::default(),
    );
    let valid = factored.map_or_else(
        |faer::linalg::cholesky::llt::factor::LltError::NonPositivePivot { index }| index,
        |_| block.columns,
    );
    let lost = |&column: &usize| {
        let root = diagonal[(column, column)];
        root.is_nan() || root * root <= limits[block.column + column]
    };
    if let Some(column) = (0..valid).find(lost).or((valid < block.columns).then_some(valid)) {
        return Err(NotPositive { column: block.column + column });
    }
    let diagonal = diagonal.as_ref();
    let solve =
        |rows: MatMut<'_, f64>| solve_lower_triangular_in_place(diagonal, rows.transpose_mut(), Par::Seq);
    match wide && below.nrows() > CHUNK {
        true => below.par_row_chunks_mut(CHUNK).for_each(solve),
        false => solve(below),
    }
    Ok(())
}

/// What the pivots take from the rows below them: `U = −B Bᵀ`, B the rows of the front below its pivots; lower part, written
/// over what `update` holds.
pub(crate) fn update_of(shape: Trapezoid, values: &[f64], update: &mut [f64], wide: bool) {
    let below = shape.rows - shape.columns;
    let blocks = blocks_mut(update, Trapezoid::new(below, below).blocks());
    each(blocks, wide, |(block, mut matrix)| {
        for pivots in shape.blocks() {
            let first = shape.columns + block.column - pivots.column;
            let rows = pivots.of(values).subrows(first, block.rows);
            let accumulate = if pivots.column == 0 { Accum::Replace } else { Accum::Add };
            subtract_lower(matrix.as_mut(), rows, accumulate);
        }
    });
}

/// `matrix −= rows · topᵀ`, top being as many of the rows as the matrix has columns; of its upper square only the lower part.
fn subtract_lower(matrix: MatMut<'_, f64>, rows: MatRef<'_, f64>, accumulate: Accum) {
    let columns = matrix.ncols();
    let (square, below) = matrix.split_at_row_mut(columns);
    let (top, bottom) = rows.split_at_row(columns);
    triangular_matmul(
        square,
        BlockStructure::TriangularLower,
        accumulate,
        top,
        BlockStructure::Rectangular,
        top.transpose(),
        BlockStructure::Rectangular,
        -1.0,
        Par::Seq,
    );
    if below.nrows() > 0 {
        matmul(below, accumulate, bottom, top.transpose(), -1.0, Par::Seq);
    }
}
