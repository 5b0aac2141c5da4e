//! The tree of boxes as beams walk it: two boxes, two lines of cache, triangles in the order of the leaves.

use super::beam::{Beam, Corner, Hits};
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;

/// The children of an inner node.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(16))]
struct Pair {
    /// Per child its low and its high corner.
    corners: [[Corner; 2]; 2],
    /// Per child the first triangle if it is a leaf, else its pair.
    first: [u32; 2],
    /// Per child the number of triangles; 0: an inner node.
    count: [u32; 2],
}

/// Boxes and triangles.
#[derive(Debug, Clone, Default)]
pub(super) struct Tree {
    pairs: Vec<Pair>,
    corners: Vec<[Corner; 3]>,
    /// Per triangle its place in the caller's list.
    ids: Vec<u32>,
}

impl Tree {
    /// From the library's tree over `triangles`; boxes grow by `margin` mm, so that rounding loses no triangle.
    pub(super) fn new(bvh: &Bvh2, triangles: &[[Corner; 3]], margin: f32) -> Self {
        let ids = bvh.primitive_indices.clone();
        let corners = ids.iter().map(|&id| triangles[id as usize]).collect();
        let mut tree = Self { pairs: Vec::with_capacity(bvh.nodes.len() / 2 + 1), corners, ids };
        match bvh.nodes.first() {
            Some(root) if root.prim_count > 0 => tree.pairs.push(Pair::of([root, root], margin).left_only()),
            Some(_) => tree.join(bvh, margin),
            None => {}
        }
        tree
    }

    /// Pairs in depth-first order.
    fn join(&mut self, bvh: &Bvh2, margin: f32) {
        let pair_of = |node: u32| {
            let first = bvh.nodes[node as usize].first_index as usize;
            Pair::of([&bvh.nodes[first], &bvh.nodes[first + 1]], margin)
        };
        let mut open = vec![(0u32, None)];
        while let Some((node, parent)) = open.pop() {
            let at = self.pairs.len() as u32;
            if let Some((parent, side)) = parent {
                let parent: &mut Pair = &mut self.pairs[parent as usize];
                parent.first[side] = at;
            }
            let pair = pair_of(node);
            let first = bvh.nodes[node as usize].first_index;
            for side in [1, 0] {
                if pair.count[side] == 0 {
                    open.push((first + side as u32, Some((at, side))));
                }
            }
            self.pairs.push(pair);
        }
    }

    /// Follows the rays of a beam until each is blocked (`ANY`), or through to its nearest hit. `stack` is scratch.
    #[inline(always)]
    pub(super) fn trace<const ANY: bool>(&self, beam: &Beam, hits: &mut Hits, stack: &mut Vec<u32>) {
        stack.clear();
        if !self.pairs.is_empty() {
            stack.push(0);
        }
        while let Some(at) = stack.pop() {
            let pair = &self.pairs[at as usize];
            let first = beam.enters_first(&pair.corners);
            // The nearer child goes on the stack last; leaves are looked at at once.
            for turn in [1, 0] {
                let side = (first ^ turn) & 1;
                if !beam.meets(&pair.corners[side], &hits.reach) {
                    continue;
                }
                if pair.count[side] == 0 {
                    stack.push(pair.first[side]);
                    continue;
                }
                let leaf = pair.first[side] as usize..(pair.first[side] + pair.count[side]) as usize;
                for (corners, &id) in self.corners[leaf.clone()].iter().zip(&self.ids[leaf]) {
                    beam.cross::<ANY>(corners, id, hits);
                }
                if ANY && hits.all_blocked() {
                    return;
                }
            }
        }
    }
}

impl Pair {
    fn of(nodes: [&Bvh2Node; 2], margin: f32) -> Self {
        let corners = nodes.map(|node| {
            let (low, high) = (node.aabb.min, node.aabb.max);
            [
                [low.x, low.y, low.z, 0.0].map(|x| x - margin),
                [high.x, high.y, high.z, 0.0].map(|x| x + margin),
            ]
        });
        Self { corners, first: nodes.map(|node| node.first_index), count: nodes.map(|node| node.prim_count) }
    }

    /// The second child as a box that nothing meets.
    fn left_only(mut self) -> Self {
        self.corners[1] = [[f32::MAX; 4], [f32::MIN; 4]];
        self
    }
}
