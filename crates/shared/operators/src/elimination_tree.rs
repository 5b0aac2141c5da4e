//! The elimination tree of a matrix in a given order, and how many entries each column of its factor has.

use sprs::CsMat;

/// No column, no parent, no place.
pub(crate) const NONE: u32 = u32::MAX;

/// The rows and columns of a symmetric matrix that belong to some vertices, in their order; never copied.
pub(crate) struct Permuted<'a> {
    matrix: &'a CsMat<f64>,
    order: &'a [u32],
    places: Vec<u32>,
}

impl<'a> Permuted<'a> {
    pub(crate) fn new(matrix: &'a CsMat<f64>, order: &'a [u32]) -> Self {
        let mut places = vec![NONE; matrix.rows()];
        order.iter().enumerate().for_each(|(place, &vertex)| places[vertex as usize] = place as u32);
        Self { matrix, order, places }
    }

    pub(crate) fn len(&self) -> usize {
        self.order.len()
    }

    /// Entries of a column, in no order: (row, value).
    pub(crate) fn column(&self, column: usize) -> impl Iterator<Item = (u32, f64)> {
        let range = self.matrix.indptr().outer_inds_sz(self.order[column] as usize);
        let rows = self.matrix.indices()[range.clone()].iter().map(|&vertex| self.places[vertex]);
        rows.zip(self.matrix.data()[range].iter().copied()).filter(|&(row, _)| row != NONE)
    }

    /// Rows of a column's entries, in no order.
    pub(crate) fn rows(&self, column: usize) -> impl Iterator<Item = u32> {
        let range = self.matrix.indptr().outer_inds_sz(self.order[column] as usize);
        let rows = self.matrix.indices()[range].iter().map(|&vertex| self.places[vertex]);
        rows.filter(|&row| row != NONE)
    }
}

/// Parent of every column [Liu1986]; [`NONE`] at roots.
pub(crate) fn parents(matrix: &Permuted) -> Vec<u32> {
    let mut parents = vec![NONE; matrix.len()];
    let mut ancestors = vec![NONE; matrix.len()];
    for column in 0..matrix.len() as u32 {
        for mut node in matrix.rows(column as usize) {
            while node < column {
                let next = std::mem::replace(&mut ancestors[node as usize], column);
                if next == NONE {
                    parents[node as usize] = column;
                    break;
                }
                node = next;
            }
        }
    }
    parents
}

/// Children as linked lists: the first child of every node, of all roots at the last place, and everyone's next sibling.
pub(crate) struct Children {
    pub(crate) first: Vec<u32>,
    pub(crate) next: Vec<u32>,
}

impl Children {
    /// In ascending order.
    pub(crate) fn of(parents: &[u32]) -> Self {
        let mut children = Self { first: vec![NONE; parents.len() + 1], next: vec![NONE; parents.len()] };
        for node in (0..parents.len()).rev() {
            let parent = (parents[node] as usize).min(parents.len());
            children.next[node] = children.first[parent];
            children.first[parent] = node as u32;
        }
        children
    }

    /// The nodes, every one after its children and every subtree in one piece; without recursion, since trees can be as deep
    /// as the matrix is large.
    pub(crate) fn postorder(mut self) -> Vec<u32> {
        let root = self.next.len() as u32;
        let mut order = Vec::with_capacity(self.next.len());
        let mut path = vec![root];
        while let Some(&node) = path.last() {
            let child = self.first[node as usize];
            if child == NONE {
                path.pop();
                if node != root {
                    order.push(node);
                }
            } else {
                self.first[node as usize] = self.next[child as usize];
                path.push(child);
            }
        }
        order
    }
}

/// Parents after the nodes are renamed to their places in `order`.
pub(crate) fn renamed(parents: &[u32], order: &[u32]) -> Vec<u32> {
    let mut places = vec![NONE; parents.len()];
    order.iter().enumerate().for_each(|(place, &node)| places[node as usize] = place as u32);
    let parent = |&node: &u32| parents[node as usize];
    let place = |parent: u32| if parent == NONE { NONE } else { places[parent as usize] };
    order.iter().map(parent).map(place).collect()
}

/// Entries of every column of the factor, the diagonal's included [GilbertNgPeyton1994]; the order must be a postorder.
pub(crate) fn column_counts(matrix: &Permuted, parents: &[u32]) -> Vec<u32> {
    let first = first_descendants(parents);
    let mut leaves = Leaves::new(matrix.len());
    // May dip below zero on the way.
    let mut counts: Vec<i32> = (0..matrix.len()).map(|node| i32::from(first[node] == node as u32)).collect();
    for column in 0..matrix.len() {
        let parent = parents[column];
        if parent != NONE {
            counts[parent as usize] -= 1;
        }
        for row in matrix.rows(column).filter(|&row| row > column as u32) {
            match leaves.visit(row as usize, column as u32, &first) {
                Leaf::No => {}
                Leaf::First => counts[column] += 1,
                Leaf::Later { meeting } => {
                    counts[column] += 1;
                    counts[meeting as usize] -= 1;
                }
            }
        }
        if parent != NONE {
            leaves.ancestors[column] = parent;
        }
    }
    for column in 0..matrix.len() {
        if parents[column] != NONE {
            counts[parents[column] as usize] += counts[column];
        }
    }
    counts.into_iter().map(|count| count as u32).collect()
}

/// The smallest node of every subtree; the order must be a postorder.
pub(crate) fn first_descendants(parents: &[u32]) -> Vec<u32> {
    let mut first: Vec<u32> = (0..parents.len() as u32).collect();
    for node in 0..parents.len() {
        if parents[node] != NONE {
            let parent = parents[node] as usize;
            first[parent] = first[parent].min(first[node]);
        }
    }
    first
}

/// Leaves of the row subtrees, as columns are gone through.
struct Leaves {
    largest_first: Vec<u32>,
    previous: Vec<u32>,
    ancestors: Vec<u32>,
}

enum Leaf {
    No,
    First,
    /// Where its path joins the previous leaf's.
    Later {
        meeting: u32,
    },
}

impl Leaves {
    fn new(count: usize) -> Self {
        Self {
            // One more than the largest first descendant.
            largest_first: vec![0; count],
            previous: vec![NONE; count],
            ancestors: (0..count as u32).collect(),
        }
    }

    fn visit(&mut self, row: usize, column: u32, first: &[u32]) -> Leaf {
        if first[column as usize] < self.largest_first[row] {
            return Leaf::No;
        }
        self.largest_first[row] = first[column as usize] + 1;
        let previous = std::mem::replace(&mut self.previous[row], column);
        if previous == NONE {
            return Leaf::First;
        }
        let mut meeting = previous;
        while meeting != self.ancestors[meeting as usize] {
            meeting = self.ancestors[meeting as usize];
        }
        let mut node = previous;
        while node != meeting {
            node = std::mem::replace(&mut self.ancestors[node as usize], meeting);
        }
        Leaf::Later { meeting }
    }
}
