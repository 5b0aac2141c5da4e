//! The tree of fronts, and how it is cut into tasks: by the work alone, never by the number of threads.

use crate::elimination_tree::{Children, NONE, first_descendants};
use std::ops::Range;

/// The tree, numbered in postorder.
pub(crate) struct Tree {
    parents: Vec<u32>,
    /// The smallest node of every subtree.
    first: Vec<u32>,
    child_starts: Vec<u32>,
    children: Vec<u32>,
    /// Work of the whole subtree.
    work: Vec<f64>,
    /// Subtrees of at most this much work are not cut.
    light: f64,
    /// Distance from the root.
    pub(crate) level: Vec<u32>,
}

/// Pieces that a tree is cut into, about: enough for any machine, few enough to cost nothing.
const PIECES: f64 = 64.0;
/// Work (multiplications) below which a task is not worth its while.
const LEAST_WORK: f64 = 4e6;

impl Tree {
    /// `work`: per node, multiplications.
    pub(crate) fn new(parents: Vec<u32>, mut work: Vec<f64>) -> Self {
        let linked = Children::of(&parents);
        let count = parents.len();
        let (mut child_starts, mut children) = (vec![0], Vec::with_capacity(count));
        for &first in &linked.first {
            let chain = std::iter::successors(Some(first), |&node| linked.next.get(node as usize).copied());
            children.extend(chain.take_while(|&node| node != NONE));
            child_starts.push(children.len() as u32);
        }
        let total: f64 = work.iter().sum();
        let mut level = vec![0; count];
        for node in 0..count {
            if parents[node] != NONE {
                work[parents[node] as usize] += work[node];
            }
        }
        for node in (0..count).rev().filter(|&node| parents[node] != NONE) {
            level[node] = level[parents[node] as usize] + 1;
        }
        let first = first_descendants(&parents);
        Self { parents, first, child_starts, children, work, light: (total / PIECES).max(LEAST_WORK), level }
    }

    pub(crate) fn len(&self) -> usize {
        self.parents.len()
    }

    pub(crate) fn parent(&self, node: usize) -> Option<usize> {
        let parent = self.parents[node];
        (parent != NONE).then_some(parent as usize)
    }

    /// Children of a node; of [`Tree::len`], the roots.
    pub(crate) fn children(&self, node: usize) -> &[u32] {
        &self.children[self.child_starts[node] as usize..self.child_starts[node + 1] as usize]
    }

    pub(crate) fn subtree(&self, node: u32) -> Range<usize> {
        self.first[node as usize] as usize..node as usize + 1
    }

    pub(crate) fn is_heavy(&self, node: u32) -> bool {
        self.work[node as usize] > self.light
    }

    /// Siblings cut into groups, in their order: every heavy one alone, light ones together up to a task's worth.
    pub(crate) fn groups<'a>(&self, siblings: &'a [u32]) -> Vec<&'a [u32]> {
        let mut groups = Vec::new();
        let mut start = 0;
        let mut sum = 0.0;
        for (at, &node) in siblings.iter().enumerate() {
            if sum + self.work[node as usize] > self.light && at > start {
                groups.push(&siblings[start..at]);
                (start, sum) = (at, 0.0);
            }
            sum += self.work[node as usize];
        }
        if start < siblings.len() {
            groups.push(&siblings[start..]);
        }
        groups
    }

    /// All nodes of a group of siblings' subtrees.
    pub(crate) fn nodes(&self, group: &[u32]) -> Range<usize> {
        match group {
            [first, .., last] => self.subtree(*first).start..self.subtree(*last).end,
            [only] => self.subtree(*only),
            [] => 0..0,
        }
    }

    /// The heavy nodes from `top` down, as long as there is only one heavy child: walked in a loop, since chains can be long.
    pub(crate) fn chain(&self, top: u32) -> Vec<u32> {
        let mut chain = vec![top];
        let mut node = top;
        loop {
            let mut heavy = self.children(node as usize).iter().filter(|&&child| self.is_heavy(child));
            match (heavy.next(), heavy.next()) {
                (Some(&only), None) => node = only,
                _ => return chain,
            }
            chain.push(node);
        }
    }
}
