//! Walks over a tree of fronts, from the leaves up or from the roots down, on all threads.
//!
//! Data that belongs to the nodes lies in their order, so a subtree owns one piece of it. Subtrees of little work are walked
//! through by one thread with what is passed on in two stacks; above them, siblings are tasks of their own. How the tree
//! is cut does not depend on the number of threads, nor does any node's arithmetic.

use crate::tree::Tree;
use rayon::prelude::*;
use std::ops::Range;

/// What nodes pass on.
pub(crate) trait Zero: Copy + Send + Sync {
    const ZERO: Self;
}

impl Zero for f64 {
    const ZERO: Self = 0.0;
}

impl<const N: usize> Zero for [f64; N] {
    const ZERO: Self = [0.0; N];
}

/// What the children of a node passed up, in their order.
pub(crate) struct Passed<'a, T> {
    groups: &'a [(&'a [u32], &'a [T])],
    lengths: &'a dyn Fn(usize) -> usize,
}

impl<'a, T> Passed<'a, T> {
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, &'a [T])> {
        let lengths = self.lengths;
        self.groups.iter().flat_map(move |&(nodes, values)| {
            let mut rest = values;
            nodes.iter().map(move |&node| {
                let (head, tail) = rest.split_at(lengths(node as usize));
                rest = tail;
                (node as usize, head)
            })
        })
    }
}

/// Work that goes from the leaves up.
pub(crate) trait Ascent: Sync {
    type Item: Zero;
    type Scratch;
    type Error: Send;
    fn tree(&self) -> &Tree;
    fn scratch(&self) -> Self::Scratch;
    /// Where a node's part of the data starts; at [`Tree::len`], the data's length.
    fn start(&self, node: usize) -> usize;
    /// How much a node passes up.
    fn passes(&self, node: usize) -> usize;
    /// Does a node's work on its part of the data and writes all of `up`. `wide`: the work is worth spreading over threads.
    fn visit(
        &self,
        node: usize,
        part: &mut [Self::Item],
        children: Passed<'_, Self::Item>,
        up: &mut [Self::Item],
        scratch: &mut Self::Scratch,
        wide: bool,
    ) -> Result<(), Self::Error>;

    /// Visits every node after its children. Of several errors, that of the first node.
    fn ascend(&self, data: &mut [Self::Item]) -> Result<(), Self::Error> {
        self.ascend_groups(self.tree().children(self.tree().len()), data, 0).map(|_| ())
    }

    /// Walks the subtrees of some siblings, the first of whose data stands at `start`; returns what every group passes up.
    fn ascend_groups(
        &self,
        siblings: &[u32],
        mut data: &mut [Self::Item],
        mut start: usize,
    ) -> Result<Vec<Vec<Self::Item>>, Self::Error> {
        let tree = self.tree();
        let mut tasks = Vec::new();
        for group in tree.groups(siblings) {
            let end = self.start(tree.nodes(group).end);
            let (head, tail) = data.split_at_mut(end - start);
            tasks.push((group, head));
            (data, start) = (tail, end);
        }
        let work = |(group, data): (&[u32], &mut [Self::Item])| match group {
            [only] if tree.is_heavy(*only) => self.ascend_heavy(*only, data),
            _ => self.ascend_light(group, data),
        };
        let results: Vec<_> = match tasks.len() {
            1 => tasks.into_iter().map(work).collect(),
            _ => tasks.into_par_iter().map(work).collect(),
        };
        results.into_iter().collect()
    }

    fn ascend_heavy(&self, top: u32, data: &mut [Self::Item]) -> Result<Vec<Self::Item>, Self::Error> {
        let tree = self.tree();
        let base = self.start(tree.subtree(top).start);
        let mut below: Option<(u32, Vec<Self::Item>)> = None;
        for &node in tree.chain(top).iter().rev() {
            let children = tree.children(node as usize);
            // What the chain has done already stands among the children.
            let (before, after) = match &below {
                Some((done, _)) => {
                    let at = children.partition_point(|child| child < done);
                    (&children[..at], &children[at + 1..])
                }
                None => (children, &children[..0]),
            };
            let mut walk = |siblings: &[u32]| {
                let nodes = tree.nodes(siblings);
                let range = self.start(nodes.start)..self.start(nodes.end);
                match siblings.is_empty() {
                    true => Ok(Vec::new()),
                    false => self.ascend_groups(
                        siblings,
                        &mut data[range.start - base..range.end - base],
                        range.start,
                    ),
                }
            };
            let (left, right) = (walk(before)?, walk(after)?);
            let own = self.start(node as usize) - base..self.start(node as usize + 1) - base;
            let mut up = vec![Self::Item::ZERO; self.passes(node as usize)];
            let left = tree.groups(before).into_iter().zip(left.iter().map(Vec::as_slice));
            let right = tree.groups(after).into_iter().zip(right.iter().map(Vec::as_slice));
            let middle = below.as_ref().map(|(node, values)| (std::slice::from_ref(node), values.as_slice()));
            let groups: Vec<(&[u32], &[Self::Item])> = left.chain(middle).chain(right).collect();
            let passed = Passed { groups: &groups, lengths: &|node| self.passes(node) };
            self.visit(node as usize, &mut data[own], passed, &mut up, &mut self.scratch(), true)?;
            below = Some((node, up));
        }
        Ok(below.map_or_else(Vec::new, |(_, up)| up))
    }

    /// One thread's walk. A node's children and itself use two stacks by turns, so that nothing is moved.
    fn ascend_light(&self, group: &[u32], data: &mut [Self::Item]) -> Result<Vec<Self::Item>, Self::Error> {
        let tree = self.tree();
        let nodes = tree.nodes(group);
        let base = self.start(nodes.start);
        let heights = self.stack_heights(nodes.clone());
        let mut stacks = heights.map(|height| vec![Self::Item::ZERO; height]);
        let mut tops = [0; 2];
        let mut scratch = self.scratch();
        for node in nodes {
            let own = (tree.level[node] % 2) as usize;
            let children = tree.children(node);
            let taken: usize = children.iter().map(|&child| self.passes(child as usize)).sum();
            let [even, odd] = &mut stacks;
            let (stack, other) = if own == 0 { (even, odd) } else { (odd, even) };
            let groups = [(children, &other[tops[1 - own] - taken..tops[1 - own]])];
            let passed = Passed { groups: &groups, lengths: &|node| self.passes(node) };
            let up = &mut stack[tops[own]..tops[own] + self.passes(node)];
            let part = &mut data[self.start(node) - base..self.start(node + 1) - base];
            self.visit(node, part, passed, up, &mut scratch, false)?;
            tops[1 - own] -= taken;
            tops[own] += self.passes(node);
        }
        let own = group.first().map_or(0, |&root| (tree.level[root as usize] % 2) as usize);
        Ok(stacks[own][..tops[own]].to_vec())
    }

    fn stack_heights(&self, nodes: Range<usize>) -> [usize; 2] {
        let tree = self.tree();
        let (mut tops, mut heights) = ([0; 2], [0; 2]);
        for node in nodes {
            let own = (tree.level[node] % 2) as usize;
            tops[own] += self.passes(node);
            heights[own] = heights[own].max(tops[own]);
            tops[1 - own] -=
                tree.children(node).iter().map(|&child| self.passes(child as usize)).sum::<usize>();
        }
        heights
    }
}

/// Work that goes from the roots down. Every node has values of its own that its children read.
pub(crate) trait Descent: Sync {
    /// What the data consists of.
    type Item: Send;
    /// What the values of a node consist of.
    type Value: Zero;
    fn tree(&self) -> &Tree;
    /// Where a node's part of the data starts; at [`Tree::len`], the data's length.
    fn start(&self, node: usize) -> usize;
    /// How many values a node has.
    fn values(&self, node: usize) -> usize;
    /// Does a node's work on its part of the data and writes all of its values.
    fn visit(&self, node: usize, part: &mut [Self::Item], above: &[Self::Value], own: &mut [Self::Value]);

    /// Visits every node after its parent.
    fn descend(&self, data: &mut [Self::Item]) {
        self.descend_groups(self.tree().children(self.tree().len()), data, 0, &[]);
    }

    /// Walks the subtrees of some siblings, the first of whose data stands at `start`; `above`: their parent's values.
    fn descend_groups(
        &self,
        siblings: &[u32],
        mut data: &mut [Self::Item],
        mut start: usize,
        above: &[Self::Value],
    ) {
        let tree = self.tree();
        let mut tasks = Vec::new();
        for group in tree.groups(siblings) {
            let end = self.start(tree.nodes(group).end);
            let (head, tail) = data.split_at_mut(end - start);
            tasks.push((group, head));
            (data, start) = (tail, end);
        }
        let work = |(group, data): (&[u32], &mut [Self::Item])| match group {
            [only] if tree.is_heavy(*only) => self.descend_heavy(*only, data, above),
            _ => self.descend_light(group, data, above),
        };
        match tasks.len() {
            1 => tasks.into_iter().for_each(work),
            _ => tasks.into_par_iter().for_each(work),
        }
    }

    fn descend_heavy(&self, top: u32, mut data: &mut [Self::Item], above: &[Self::Value]) {
        let tree = self.tree();
        let mut base = self.start(tree.subtree(top).start);
        let chain = tree.chain(top);
        let mut parent: Option<Vec<Self::Value>> = None;
        for (at, &node) in chain.iter().enumerate() {
            let mut own = vec![Self::Value::ZERO; self.values(node as usize)];
            let part = &mut data[self.start(node as usize) - base..self.start(node as usize + 1) - base];
            self.visit(node as usize, part, parent.as_deref().unwrap_or(above), &mut own);
            let children = tree.children(node as usize);
            let Some(&next) = chain.get(at + 1) else {
                let end = self.start(node as usize) - base;
                return self.descend_groups(children, &mut data[..end], base, &own);
            };
            let place = children.partition_point(|&child| child < next);
            let nodes = tree.subtree(next);
            let (start, end) = (self.start(nodes.start), self.start(nodes.end));
            let (before, rest) = data.split_at_mut(start - base);
            let (middle, after) = rest.split_at_mut(end - start);
            self.descend_groups(&children[..place], before, base, &own);
            let after = &mut after[..self.start(node as usize) - end];
            self.descend_groups(&children[place + 1..], after, end, &own);
            (data, base, parent) = (middle, start, Some(own));
        }
    }

    /// One thread's walk: the values of a node's ancestors stand on a stack.
    fn descend_light(&self, group: &[u32], data: &mut [Self::Item], above: &[Self::Value]) {
        let tree = self.tree();
        let nodes = tree.nodes(group);
        let base = self.start(nodes.start);
        let Some(root_level) = group.first().map(|&root| tree.level[root as usize]) else { return };
        let mut stack: Vec<Self::Value> = Vec::new();
        // Where the values of every level on the stack start.
        let mut starts: Vec<usize> = Vec::new();
        for node in nodes.rev() {
            let depth = (tree.level[node] - root_level) as usize;
            let start = starts.get(depth).copied().unwrap_or(stack.len());
            let parent = depth.checked_sub(1).map(|level| starts[level]);
            starts.truncate(depth);
            starts.push(start);
            stack.truncate(start);
            stack.resize(start + self.values(node), Self::Value::ZERO);
            let (ancestors, own) = stack.split_at_mut(start);
            let parent = parent.map_or(above, |parent| &ancestors[parent..]);
            let part = &mut data[self.start(node) - base..self.start(node + 1) - base];
            self.visit(node, part, parent, own);
        }
    }
}
