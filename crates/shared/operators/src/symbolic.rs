//! Where the entries of a factor stand: columns joined into dense fronts.

use crate::dense::Trapezoid;
use crate::elimination_tree::{Children, NONE, Permuted, column_counts, parents, renamed};
use crate::fronts::Fronts;
use crate::tree::Tree;
use sprs::CsMat;

/// The pattern of `L`. Columns with the same rows below them form a *front*: a dense trapezoid of pivot columns, of as many
/// pivot rows and the rows below. Fronts form a tree, numbered in postorder, like the columns.
pub(crate) struct Symbolic {
    /// The unknowns' vertices, first eliminated first.
    pub(crate) order: Vec<u32>,
    /// Per front its first column; one more at the end.
    pub(crate) starts: Vec<u32>,
    pub(crate) tree: Tree,
    /// Per front where its rows stand; one more at the end.
    row_starts: Vec<usize>,
    /// Rows below the pivots, ascending.
    rows: Vec<u32>,
    /// Each of these rows' place in the parent's front.
    in_parent: Vec<u32>,
    /// Per front where its values start; one more at the end.
    pub(crate) value_starts: Vec<usize>,
    /// Entries of L that are not zero by structure.
    pub(crate) entry_count: usize,
}

impl Symbolic {
    /// Analyses the rows and columns of a matrix that belong to `order`, which is changed to an order of the same fill in
    /// which every subtree and every front is in one piece. Every row of `pattern` stands for `size` unknowns that have the same
    /// neighbours, number `size · row` and after: the pattern of such blocks is a `size²`-th of the matrix', and a front's columns
    /// are whole blocks.
    pub(crate) fn new(pattern: &CsMat<f64>, order: &[u32], size: usize) -> Self {
        let (order, block_parents) = {
            let tree = parents(&Permuted::new(pattern, order));
            let post = Children::of(&tree).postorder();
            (post.iter().map(|&column| order[column as usize]).collect::<Vec<_>>(), renamed(&tree, &post))
        };
        let counts = column_counts(&Permuted::new(pattern, &order), &block_parents);
        let (column_parents, counts) = expanded(&block_parents, &counts, size as u32);
        let fronts = Fronts::joined(&column_parents, &counts);
        let (columns, starts, parents, heights) = fronts.laid_out();
        let blocks: Vec<u32> =
            columns.iter().step_by(size).map(|&column| order[column as usize / size]).collect();
        let row_counts =
            heights.iter().zip(starts.windows(2)).map(|(height, s)| (height - (s[1] - s[0])) as usize);
        let row_starts = running_sum(row_counts);
        let rows = rows_below(&Permuted::new(pattern, &blocks), &starts, &parents, &row_starts, size);
        let unknowns = |&block: &u32| (0..size as u32).map(move |part| block * size as u32 + part);
        let order = blocks.iter().flat_map(unknowns).collect();
        let shape = |front: usize| {
            Trapezoid::new(heights[front] as usize, (starts[front + 1] - starts[front]) as usize)
        };
        let value_starts = running_sum((0..heights.len()).map(|front| shape(front).len()));
        let work = (0..heights.len()).map(|front| shape(front).elimination_work()).collect();
        let entry_count = counts.iter().map(|&count| count as usize).sum();
        let mut symbolic = Self {
            order,
            starts,
            tree: Tree::new(parents, work),
            row_starts,
            rows,
            in_parent: Vec::new(),
            value_starts,
            entry_count,
        };
        symbolic.in_parent = symbolic.rows_in_parents();
        symbolic
    }

    pub(crate) fn front_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Rows and pivot columns of a front.
    pub(crate) fn shape(&self, front: usize) -> Trapezoid {
        let width = self.width(front);
        Trapezoid::new(width + self.below(front), width)
    }

    /// Pivot columns of a front.
    pub(crate) fn width(&self, front: usize) -> usize {
        (self.starts[front + 1] - self.starts[front]) as usize
    }

    /// How many rows a front has below its pivots.
    pub(crate) fn below(&self, front: usize) -> usize {
        self.row_starts[front + 1] - self.row_starts[front]
    }

    /// The rows below a front's pivots, ascending.
    pub(crate) fn rows(&self, front: usize) -> &[u32] {
        &self.rows[self.row_starts[front]..self.row_starts[front + 1]]
    }

    /// The same rows as places in the parent's front.
    pub(crate) fn in_parent(&self, front: usize) -> &[u32] {
        &self.in_parent[self.row_starts[front]..self.row_starts[front + 1]]
    }

    fn rows_in_parents(&self) -> Vec<u32> {
        let mut places = Vec::with_capacity(self.rows.len());
        for front in 0..self.front_count() {
            let Some(parent) = self.tree.parent(front) else { continue };
            let (start, end) = (self.starts[parent], self.starts[parent + 1]);
            let parents_rows = self.rows(parent);
            let mut at = 0;
            for &row in self.rows(front) {
                places.push(if row < end {
                    row - start
                } else {
                    at += parents_rows[at..].iter().take_while(|&&other| other < row).count();
                    end - start + at as u32
                });
            }
        }
        places
    }
}

fn running_sum(counts: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut sum = 0;
    let sums = counts.map(|count| {
        sum += count;
        sum
    });
    std::iter::once(0).chain(sums).collect()
}

/// Parents and column counts of the unknowns from those of their blocks.
fn expanded(parents: &[u32], counts: &[u32], size: u32) -> (Vec<u32>, Vec<u32>) {
    let (mut column_parents, mut column_counts) = (Vec::new(), Vec::new());
    for (block, (&parent, &count)) in (0u32..).zip(parents.iter().zip(counts)) {
        for part in 0..size {
            let above = if parent == NONE { NONE } else { parent * size };
            column_parents.push(if part + 1 < size { block * size + part + 1 } else { above });
            column_counts.push(count * size - part);
        }
    }
    (column_parents, column_counts)
}

/// The rows of every front, by going along the rows of the matrix: row i belongs to every front on the way from an entry
/// left of the diagonal up to the front of i. Rows come out ascending. `matrix`: of blocks of `size` unknowns; all else is of unknowns.
fn rows_below(
    matrix: &Permuted,
    starts: &[u32],
    parents: &[u32],
    row_starts: &[usize],
    size: usize,
) -> Vec<u32> {
    let mut front_of = vec![0u32; matrix.len()];
    for (front, range) in starts.windows(2).enumerate() {
        front_of[range[0] as usize / size..range[1] as usize / size].fill(front as u32);
    }
    let mut rows = vec![0u32; row_starts[row_starts.len() - 1]];
    let mut ends = row_starts.to_vec();
    let mut seen_by = vec![NONE; parents.len()];
    for row in 0..matrix.len() as u32 {
        let own = front_of[row as usize];
        for column in matrix.rows(row as usize).filter(|&column| column < row) {
            let mut front = front_of[column as usize];
            while front != own && seen_by[front as usize] != row {
                seen_by[front as usize] = row;
                let end = &mut ends[front as usize];
                let unknowns = row * size as u32..;
                rows[*end..*end + size].iter_mut().zip(unknowns).for_each(|(into, unknown)| *into = unknown);
                *end += size;
                front = parents[front as usize];
            }
        }
    }
    rows
}
