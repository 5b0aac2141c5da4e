//! Forward and backward substitution for a few right-hand sides: every entry of the factor is read once for all of them,
//! so what it costs is the way from memory.
//!
//! The right-hand sides of one row stand side by side, as the lanes of a vector. Products and sums are rounded separately:
//! with or without fused instructions, on any width, the results are the same.

use crate::dense::{Block, Trapezoid};
use crate::prefetch::prefetch;
use crate::symbolic::Symbolic;
use crate::tree::Tree;
use crate::walk::{Ascent, Descent, Passed};
use pulp::{Arch, NullaryFnOnce};

/// The values of one row in `N` right-hand sides.
pub(crate) type Lanes<const N: usize> = [f64; N];

/// Columns of the factor that are gone through together.
const GROUP: usize = 4;
/// Values on a cache line.
const LINE: usize = 8;
/// How many values ahead of those at hand memory is asked for: 8 KiB.
const AHEAD: usize = 1024;

/// `L y = b`, in place.
pub(crate) struct Forward<'a> {
    pub(crate) symbolic: &'a Symbolic,
    pub(crate) values: &'a [f64],
}

/// `Lᵀ x = y`, in place.
pub(crate) struct Backward<'a> {
    pub(crate) symbolic: &'a Symbolic,
    pub(crate) values: &'a [f64],
}

/// Solves `L Lᵀ x = b` in place; `rows`: in the factor's order.
pub(crate) fn substitute<const N: usize>(symbolic: &Symbolic, values: &[f64], rows: &mut [Lanes<N>]) {
    let forward = Forward { symbolic, values };
    let Ok(()) = ForwardLanes::<N>(forward).ascend(rows);
    BackwardLanes::<N>(Backward { symbolic, values }).descend(rows);
}

struct ForwardLanes<'a, const N: usize>(Forward<'a>);
struct BackwardLanes<'a, const N: usize>(Backward<'a>);

impl<const N: usize> Ascent for ForwardLanes<'_, N> {
    type Item = Lanes<N>;
    /// The right-hand sides of the front at hand.
    type Scratch = Vec<Lanes<N>>;
    type Error = std::convert::Infallible;

    fn tree(&self) -> &Tree {
        &self.0.symbolic.tree
    }

    fn scratch(&self) -> Vec<Lanes<N>> {
        Vec::new()
    }

    fn start(&self, front: usize) -> usize {
        self.0.symbolic.starts[front] as usize
    }

    fn passes(&self, front: usize) -> usize {
        self.0.symbolic.below(front)
    }

    fn visit(
        &self,
        front: usize,
        part: &mut [Lanes<N>],
        children: Passed<'_, Lanes<N>>,
        up: &mut [Lanes<N>],
        rows: &mut Vec<Lanes<N>>,
        _wide: bool,
    ) -> Result<(), Self::Error> {
        let symbolic = self.0.symbolic;
        let shape = symbolic.shape(front);
        rows.clear();
        rows.extend_from_slice(part);
        rows.resize(shape.rows, [0.0; N]);
        for (child, passed) in children.iter() {
            for (&place, values) in symbolic.in_parent(child).iter().zip(passed) {
                add(&mut rows[place as usize], values);
            }
        }
        let (all, base) = (self.0.values, symbolic.value_starts[front]);
        Arch::new().dispatch(Job::<N, true> { shape, all, base, rows });
        part.copy_from_slice(&rows[..shape.columns]);
        up.copy_from_slice(&rows[shape.columns..]);
        Ok(())
    }
}

impl<const N: usize> Descent for BackwardLanes<'_, N> {
    type Item = Lanes<N>;
    type Value = Lanes<N>;

    fn tree(&self) -> &Tree {
        &self.0.symbolic.tree
    }

    fn start(&self, front: usize) -> usize {
        self.0.symbolic.starts[front] as usize
    }

    fn values(&self, front: usize) -> usize {
        self.0.symbolic.shape(front).rows
    }

    fn visit(&self, front: usize, part: &mut [Lanes<N>], above: &[Lanes<N>], own: &mut [Lanes<N>]) {
        let symbolic = self.0.symbolic;
        let (pivots, below) = own.split_at_mut(part.len());
        pivots.copy_from_slice(part);
        for (row, &place) in below.iter_mut().zip(symbolic.in_parent(front)) {
            *row = above[place as usize];
        }
        let (all, base) = (self.0.values, symbolic.value_starts[front]);
        Arch::new().dispatch(Job::<N, false> { shape: symbolic.shape(front), all, base, rows: own });
        part.copy_from_slice(&own[..part.len()]);
    }
}

/// The substitution within a front, compiled for every instruction set.
struct Job<'a, const N: usize, const FORWARD: bool> {
    shape: Trapezoid,
    /// The factor's values, of which the front's start at `base`.
    all: &'a [f64],
    base: usize,
    rows: &'a mut [Lanes<N>],
}

impl<const N: usize, const FORWARD: bool> NullaryFnOnce for Job<'_, N, FORWARD> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        match FORWARD {
            true => forward(self.shape, self.all, self.base, self.rows),
            false => backward(self.shape, self.all, self.base, self.rows),
        }
    }
}

#[inline(always)]
fn add<const N: usize>(sum: &mut Lanes<N>, values: &Lanes<N>) {
    for lane in 0..N {
        sum[lane] += values[lane];
    }
}

/// `row −= factor · x`.
#[inline(always)]
fn subtract<const N: usize>(row: &mut Lanes<N>, factor: f64, x: &Lanes<N>) {
    for lane in 0..N {
        row[lane] -= factor * x[lane];
    }
}

#[inline(always)]
fn forward<const N: usize>(shape: Trapezoid, all: &[f64], base: usize, rows: &mut [Lanes<N>]) {
    for block in shape.blocks() {
        let block = Block { start: base + block.start, ..block };
        let rows = &mut rows[block.column..];
        let grouped = block.columns / GROUP * GROUP;
        for column in (0..grouped).step_by(GROUP) {
            forward_group::<GROUP, N>(block, all, column, rows);
        }
        for column in grouped..block.columns {
            forward_group::<1, N>(block, all, column, rows);
        }
    }
}

/// Eliminates `G` columns of a block.
#[inline(always)]
fn forward_group<const G: usize, const N: usize>(
    block: Block,
    all: &[f64],
    column: usize,
    rows: &mut [Lanes<N>],
) {
    let columns = Columns::<G>::new(block, all, column);
    let (head, tail) = rows[column..block.rows].split_at_mut(G);
    for i in 0..G {
        let inverse = 1.0 / columns.head[i][i];
        head[i].iter_mut().for_each(|value| *value *= inverse);
        let solved = head[i];
        for j in i + 1..G {
            subtract(&mut head[j], columns.head[i][j], &solved);
        }
    }
    let solved: [Lanes<N>; G] = std::array::from_fn(|i| head[i]);
    let eliminate = |row: &mut Lanes<N>, values: [f64; G]| {
        let mut sum = *row;
        for i in 0..G {
            subtract(&mut sum, values[i], &solved[i]);
        }
        *row = sum;
    };
    let below = columns.below();
    let (chunks, rest) = tail.as_chunks_mut::<LINE>();
    for (at, chunk) in chunks.iter_mut().enumerate() {
        columns.prefetch(all, at, AHEAD.cast_signed());
        let values: [&[f64; LINE]; G] = std::array::from_fn(|i| &below[i].0[at]);
        for (place, row) in chunk.iter_mut().enumerate() {
            eliminate(row, std::array::from_fn(|i| values[i][place]));
        }
    }
    columns.prefetch(all, chunks.len(), AHEAD.cast_signed());
    for (place, row) in rest.iter_mut().enumerate() {
        eliminate(row, std::array::from_fn(|i| below[i].1[place]));
    }
}

#[inline(always)]
fn backward<const N: usize>(shape: Trapezoid, all: &[f64], base: usize, rows: &mut [Lanes<N>]) {
    for block in shape.blocks().rev() {
        let block = Block { start: base + block.start, ..block };
        let rows = &mut rows[block.column..];
        let grouped = block.columns / GROUP * GROUP;
        for column in (grouped..block.columns).rev() {
            backward_group::<1, N>(block, all, column, rows);
        }
        for column in (0..grouped).step_by(GROUP).rev() {
            backward_group::<GROUP, N>(block, all, column, rows);
        }
    }
}

/// Solves for `G` rows of a block from all rows below them.
#[inline(always)]
fn backward_group<const G: usize, const N: usize>(
    block: Block,
    all: &[f64],
    column: usize,
    rows: &mut [Lanes<N>],
) {
    let columns = Columns::<G>::new(block, all, column);
    let (head, tail) = rows[column..block.rows].split_at_mut(G);
    let mut sums: [Lanes<N>; G] = std::array::from_fn(|i| head[i]);
    let below = columns.below();
    let (chunks, rest) = tail.as_chunks::<LINE>();
    for (at, chunk) in chunks.iter().enumerate() {
        columns.prefetch(all, at, -AHEAD.cast_signed());
        let values: [&[f64; LINE]; G] = std::array::from_fn(|i| &below[i].0[at]);
        for (place, row) in chunk.iter().enumerate() {
            for i in 0..G {
                subtract(&mut sums[i], values[i][place], row);
            }
        }
    }
    columns.prefetch(all, chunks.len(), -AHEAD.cast_signed());
    for (place, row) in rest.iter().enumerate() {
        for i in 0..G {
            subtract(&mut sums[i], below[i].1[place], row);
        }
    }
    for i in (0..G).rev() {
        let inverse = 1.0 / columns.head[i][i];
        sums[i].iter_mut().for_each(|value| *value *= inverse);
        let solved = sums[i];
        for j in 0..i {
            subtract(&mut sums[j], columns.head[j][i], &solved);
        }
    }
    head.copy_from_slice(&sums);
}

/// Columns of the factor side by side, from the diagonal of the first on.
struct Columns<'a, const G: usize> {
    values: [&'a [f64]; G],
    /// Their rows among the diagonals.
    head: [[f64; G]; G],
    /// Where the first row below all diagonals stands among all values, per column.
    below: [usize; G],
}

impl<'a, const G: usize> Columns<'a, G> {
    #[inline(always)]
    fn new(block: Block, all: &'a [f64], column: usize) -> Self {
        let start = |i: usize| block.start + (column + i) * block.rows + column;
        let values: [&[f64]; G] = std::array::from_fn(|i| &all[start(i)..start(i) + block.rows - column]);
        Self {
            values,
            head: values.map(|values| std::array::from_fn(|row| values[row])),
            below: std::array::from_fn(|i| start(i) + G),
        }
    }

    /// The rows below, by cache lines and what is left of them.
    #[inline(always)]
    fn below(&self) -> [(&'a [[f64; LINE]], &'a [f64]); G] {
        std::array::from_fn(|i| self.values[i][G..].as_chunks())
    }

    /// Asks for what stands `ahead` values from the `at`-th lines.
    #[inline(always)]
    fn prefetch(&self, all: &[f64], at: usize, ahead: isize) {
        for start in self.below {
            prefetch(all, (start + at * LINE).wrapping_add_signed(ahead));
        }
    }
}
