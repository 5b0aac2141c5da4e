//! Joining columns into fronts: those with the same rows, then fronts with their parents where that stores few zeros
//! [AshcraftGrimes1989].

use crate::elimination_tree::{Children, NONE};

/// Fronts while they are being joined, in postorder of their first shape.
pub(crate) struct Fronts {
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
    pub(crate) fn joined(column_parents: &[u32], counts: &[u32]) -> Self {
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
    pub(crate) fn laid_out(self) -> (Vec<u32>, Vec<u32>, Vec<u32>, Vec<u32>) {
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
