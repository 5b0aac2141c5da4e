//! Smallest vertex covers of bipartite graphs, by maximum matching.

/// The bipartite graph of the edges that cross a cut.
pub(crate) struct Crossing {
    left: Vec<u32>,
    right: Vec<u32>,
    starts: Vec<usize>,
    /// Indices into `right`.
    neighbors: Vec<u32>,
}

impl Crossing {
    /// From the vertices of one side that have neighbours on the other, each with these neighbours.
    pub(crate) fn new(left: Vec<u32>, starts: Vec<usize>, mut neighbors: Vec<u32>) -> Self {
        let mut right = neighbors.clone();
        right.sort_unstable();
        right.dedup();
        for neighbor in &mut neighbors {
            *neighbor = right.partition_point(|vertex| vertex < neighbor) as u32;
        }
        Self { left, right, starts, neighbors }
    }

    fn of_left(&self, left: usize) -> &[u32] {
        &self.neighbors[self.starts[left]..self.starts[left + 1]]
    }
}

const FREE: u32 = u32::MAX;

/// A smallest set of vertices that touches every crossing edge [König's theorem]: from a maximum matching, the left vertices
/// that no alternating path from a free left vertex reaches, and the right vertices that one does.
pub(crate) fn minimum_cover(crossing: &Crossing) -> Vec<u32> {
    let matching = Matching::maximum(crossing);
    let mut left_reached = vec![false; crossing.left.len()];
    let mut right_reached = vec![false; crossing.right.len()];
    let mut queue: Vec<usize> =
        (0..crossing.left.len()).filter(|&left| matching.of_left[left] == FREE).collect();
    queue.iter().for_each(|&left| left_reached[left] = true);
    while let Some(left) = queue.pop() {
        for &right in crossing.of_left(left) {
            if std::mem::replace(&mut right_reached[right as usize], true) {
                continue;
            }
            let next = matching.of_right[right as usize] as usize;
            if next != FREE as usize && !std::mem::replace(&mut left_reached[next], true) {
                queue.push(next);
            }
        }
    }
    let left = (0..crossing.left.len()).filter(|&left| !left_reached[left]).map(|left| crossing.left[left]);
    let right =
        (0..crossing.right.len()).filter(|&right| right_reached[right]).map(|right| crossing.right[right]);
    left.chain(right).collect()
}

/// Partners in a bipartite matching.
struct Matching {
    of_left: Vec<u32>,
    of_right: Vec<u32>,
}

impl Matching {
    /// A maximum matching by shortest augmenting paths, level by level [HopcroftKarp1973].
    fn maximum(crossing: &Crossing) -> Self {
        let mut matching =
            Self { of_left: vec![FREE; crossing.left.len()], of_right: vec![FREE; crossing.right.len()] };
        while let Some(levels) = matching.levels(crossing) {
            let mut next = crossing.starts.clone();
            for left in 0..crossing.left.len() {
                if matching.of_left[left] == FREE {
                    matching.augment(crossing, &levels, &mut next, left);
                }
            }
        }
        matching
    }

    /// Breadth-first levels of the left vertices, or `None` when no augmenting path is left.
    fn levels(&self, crossing: &Crossing) -> Option<Vec<u32>> {
        let mut levels = vec![FREE; crossing.left.len()];
        let mut queue: Vec<usize> = (0..levels.len()).filter(|&left| self.of_left[left] == FREE).collect();
        queue.iter().for_each(|&left| levels[left] = 0);
        let mut found = false;
        let mut at = 0;
        while at < queue.len() {
            let left = queue[at];
            at += 1;
            for &right in crossing.of_left(left) {
                match self.of_right[right as usize] {
                    FREE => found = true,
                    partner if levels[partner as usize] == FREE => {
                        levels[partner as usize] = levels[left] + 1;
                        queue.push(partner as usize);
                    }
                    _ => {}
                }
            }
        }
        found.then_some(levels)
    }

    /// Follows the levels from a free left vertex to a free right one and flips the path; without recursion, since
    /// paths can be long.
    fn augment(&mut self, crossing: &Crossing, levels: &[u32], next: &mut [usize], start: usize) {
        let mut path: Vec<(usize, u32)> = Vec::new();
        let mut left = start;
        loop {
            if next[left] == crossing.starts[left + 1] {
                let Some((previous, _)) = path.pop() else { return };
                left = previous;
                continue;
            }
            let right = crossing.neighbors[next[left]];
            next[left] += 1;
            match self.of_right[right as usize] {
                FREE => {
                    path.push((left, right));
                    for (left, right) in path {
                        self.of_left[left] = right;
                        self.of_right[right as usize] = left as u32;
                    }
                    return;
                }
                partner if levels[partner as usize] == levels[left] + 1 => {
                    path.push((left, right));
                    left = partner as usize;
                }
                _ => {}
            }
        }
    }
}
