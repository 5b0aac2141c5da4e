//! Where the entries of a factor stand: columns joined into dense fronts.

use crate::dense::Trapezoid;
use crate::elimination_tree::{Children, NONE, Permuted, column_counts, parents, renamed};
use crate::walk::Tree;
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
    /// Analyses the rows and columns of `matrix` that belong to `order`, which is changed to an order of the same fill in
    /// which every subtree and every front is in one piece.
    pub(crate) fn new(matrix: &CsMat<f64>, order: &[u32]) -> Self {
        let (order, column_parents) = {
            let tree = parents(&Permuted::new(matrix, order));
            let post = Children::of(&tree).postorder();
            (post.iter().map(|&column| order[column as usize]).collect::<Vec<_>>(), renamed(&tree, &post))
        };
        let counts = column_counts(&Permuted::new(matrix, &order), &column_parents);
        let fronts = Fronts::joined(&column_parents, &counts);
        let (columns, starts, parents, heights) = fronts.laid_out();
        let order: Vec<u32> = columns.iter().map(|&column| order[column as usize]).collect();
        let row_counts = heights.iter().zip(starts.windows(2)).map(|(height, s)| (height - (s[1] - s[0])) as usize);
        let row_starts = running_sum(row_counts);
        let rows = rows_below(&Permuted::new(matrix, &order), &starts, &parents, &row_starts);
        let shape = |front: usize| Trapezoid::new(heights[front] as usize, (starts[front + 1] - starts[front]) as usize);
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

/// The rows of every front, by going along the rows of the matrix: row i belongs to every front on the way from an entry
/// left of the diagonal up to the front of i. Rows come out ascending.
fn rows_below(matrix: &Permuted, starts: &[u32], parents: &[u32], row_starts: &[usize]) -> Vec<u32> {
    let mut front_of = vec![0u32; matrix.len()];
    for (front, range) in starts.windows(2).enumerate() {
        front_of[range[0] as usize..range[1] as usize].fill(front as u32);
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
                rows[ends[front as usize]] = row;
                ends[front as usize] += 1;
                front = parents[front as usize];
            }
        }
    }
    rows
}

/// Fronts while they are being joined, in postorder of their first shape.
struct Fronts {
    parents: Vec<u32>,
    children: Children,
    /// Pivot columns.
    widths: Vec<u32>,
    /// Pivot columns and rows below.
    heights: Vec<u32>,
    /// Entries that are stored though they are zero.
    padding: Vec<u64>,
    /// Per front its parts as a linked list: the first and the last part, every part's successor.
    parts: Vec<(u32, u32)>,
    next_part: Vec<u32>,
    /// Per part its first column.
    part_starts: Vec<u32>,
}

/// Joined fronts of up to so many columns may have such a share of stored zeros: small fronts cost more in overhead than in
/// arithmetic.
const PADDING: [(u32, f64); 3] = [(16, 0.35), (48, 0.1), (u32::MAX, 0.025)];
/// Fronts of up to so many columns are joined whatever it costs.
const TINY: u32 = 6;

impl Fronts {
    /// Columns of the same rows, then fronts with their parents where that stores few zeros.
    fn joined(column_parents: &[u32], counts: &[u32]) -> Self {
        let mut fronts = Self::fundamental(column_parents, counts);
        for front in 0..fronts.widths.len() {
            fronts.absorb_children(front);
        }
        fronts
    }

    fn fundamental(column_parents: &[u32], counts: &[u32]) -> Self {
        let mut part_starts = Vec::new();
        let mut part_of = vec![0u32; counts.len()];
        for column in 0..counts.len() {
            let continues = column > 0
                && column_parents[column - 1] == column as u32
                && counts[column - 1] == counts[column] + 1;
            if !continues {
                part_starts.push(column as u32);
            }
            part_of[column] = part_starts.len() as u32 - 1;
        }
        let count = part_starts.len();
        part_starts.push(counts.len() as u32);
        let above = |part: usize| match column_parents[part_starts[part + 1] as usize - 1] {
            NONE => NONE,
            column => part_of[column as usize],
        };
        let parents: Vec<u32> = (0..count).map(above).collect();
        Self {
            children: Children::of(&parents),
            widths: part_starts.windows(2).map(|range| range[1] - range[0]).collect(),
            heights: part_starts[..count].iter().map(|&column| counts[column as usize]).collect(),
            padding: vec![0; count],
            parts: (0..count as u32).map(|part| (part, part)).collect(),
            next_part: vec![NONE; count],
            parents,
            part_starts,
        }
    }

    fn absorb_children(&mut self, front: usize) {
        let mut kept: Option<u32> = None;
        let mut child = std::mem::replace(&mut self.children.first[front], NONE);
        while child != NONE {
            let next = self.children.next[child as usize];
            if let Some(padding) = self.padding_if_joined(child as usize, front) {
                let (first, last) = self.join(child as usize, front, padding);
                self.append(front, &mut kept, first, last);
            } else {
                self.append(front, &mut kept, child, child);
            }
            child = next;
        }
    }

    /// Appends a chain of siblings to a front's children.
    fn append(&mut self, front: usize, kept: &mut Option<u32>, first: u32, last: u32) {
        if first == NONE {
            return;
        }
        match *kept {
            Some(end) => self.children.next[end as usize] = first,
            None => self.children.first[front] = first,
        }
        self.children.next[last as usize] = NONE;
        *kept = Some(last);
    }

    /// Stored zeros of a child and its parent as one front, if they are few enough. All rows of the child are among the
    /// pivots and rows of the parent, so the joined front is as high as the parent and the child's pivots together.
    fn padding_if_joined(&self, child: usize, front: usize) -> Option<u64> {
        let width = self.widths[child] + self.widths[front];
        let height = u64::from(self.widths[child] + self.heights[front]);
        let fresh = u64::from(self.widths[child]) * (height - u64::from(self.heights[child]));
        let padding = self.padding[child] + self.padding[front] + fresh;
        let wide = u64::from(width);
        let entries = wide * (wide + 1) / 2 + wide * (height - wide);
        let allowed = |&&(limit, _): &&(u32, f64)| width <= limit;
        let share = PADDING.iter().find(allowed).map_or(0.0, |limit| limit.1);
        (width <= TINY || fresh == 0 || padding as f64 <= share * entries as f64).then_some(padding)
    }

    /// Joins a child into its parent; returns the ends of the chain of the child's children, which move up.
    fn join(&mut self, child: usize, front: usize, padding: u64) -> (u32, u32) {
        self.widths[front] += self.widths[child];
        self.heights[front] += self.widths[child];
        self.padding[front] = padding;
        self.widths[child] = 0;
        let (first, last) = self.parts[child];
        self.next_part[last as usize] = self.parts[front].0;
        self.parts[front].0 = first;
        let chain = self.children.first[child];
        let mut end = chain;
        let mut grandchild = chain;
        while grandchild != NONE {
            self.parents[grandchild as usize] = front as u32;
            end = grandchild;
            grandchild = self.children.next[grandchild as usize];
        }
        (chain, end)
    }

    /// The columns in a postorder of the fronts; per front its first column (one more at the end), parent and height.
    fn laid_out(self) -> (Vec<u32>, Vec<u32>, Vec<u32>, Vec<u32>) {
        let mut roots = None;
        let mut this = self;
        let root = this.widths.len();
        this.children.first[root] = NONE;
        for front in 0..root as u32 {
            if this.widths[front as usize] > 0 && this.parents[front as usize] == NONE {
                this.append(root, &mut roots, front, front);
            }
        }
        let Self { parents, children, widths, heights, parts, next_part, part_starts, .. } = this;
        let post = children.postorder();
        let mut columns = Vec::new();
        let mut starts = vec![0];
        for &front in &post {
            let mut part = parts[front as usize].0;
            while part != NONE {
                columns.extend(part_starts[part as usize]..part_starts[part as usize + 1]);
                part = next_part[part as usize];
            }
            starts.push(columns.len() as u32);
            debug_assert_eq!(starts[starts.len() - 1] - starts[starts.len() - 2], widths[front as usize]);
        }
        let mut places = vec![NONE; widths.len()];
        post.iter().enumerate().for_each(|(place, &front)| places[front as usize] = place as u32);
        let above = |&front: &u32| match parents[front as usize] {
            NONE => NONE,
            parent => places[parent as usize],
        };
        let heights = post.iter().map(|&front| heights[front as usize]).collect();
        (columns, starts, post.iter().map(above).collect(), heights)
    }
}
