//! Cutting a graph in two by a plane through its coordinates: the step of nested dissection.

use nalgebra::{Matrix3, Point3, Vector3};
use sprs::CsMat;

/// A set of vertices cut into two parts that no edge joins, and the separator between them.
pub(crate) struct Cut {
    pub(crate) parts: [Vec<u32>; 2],
    pub(crate) separator: Vec<u32>,
}

/// Cuts `vertices` at the median along the better of a few directions: the principal axes of their coordinates. The
/// separator is a minimum vertex cover of the edges that cross the plane [König's theorem], so it is as small as that plane
/// allows. `side` is scratch, one entry per vertex of the graph, all [`OUTSIDE`] before and after.
pub(crate) fn bisect(pattern: &CsMat<f64>, points: &[Point3<f64>], vertices: &[u32], side: &mut [u8]) -> Cut {
    let mut best: Option<Cut> = None;
    for direction in directions(points, vertices) {
        let cut = cut_along(pattern, points, vertices, direction, side);
        if best.as_ref().is_none_or(|best| cut.separator.len() < best.separator.len()) {
            best = Some(cut);
        }
    }
    best.unwrap_or(Cut { parts: [Vec::new(), Vec::new()], separator: vertices.to_vec() })
}

/// Mark of vertices that are not in the set at hand.
pub(crate) const OUTSIDE: u8 = 2;

/// The two longest principal axes of the points.
fn directions(points: &[Point3<f64>], vertices: &[u32]) -> [Vector3<f64>; 2] {
    let at = |vertex: &u32| points[*vertex as usize].coords;
    let mean = vertices.iter().map(at).sum::<Vector3<f64>>() / vertices.len() as f64;
    let mut spread = Matrix3::zeros();
    for vertex in vertices {
        let offset = at(vertex) - mean;
        spread += offset * offset.transpose();
    }
    let eigen = spread.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    [order[0], order[1]].map(|axis| eigen.eigenvectors.column(axis).into())
}

fn cut_along(
    pattern: &CsMat<f64>,
    points: &[Point3<f64>],
    vertices: &[u32],
    direction: Vector3<f64>,
    side: &mut [u8],
) -> Cut {
    let height = |vertex: u32| points[vertex as usize].coords.dot(&direction);
    let mut order: Vec<(f64, u32)> = vertices.iter().map(|&vertex| (height(vertex), vertex)).collect();
    let half = order.len() / 2;
    // The index breaks ties, so that equal coordinates are still halved, and always alike.
    order.select_nth_unstable_by(half, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (rank, &(_, vertex)) in order.iter().enumerate() {
        side[vertex as usize] = u8::from(rank >= half);
    }
    let separator = minimum_cover(pattern, vertices, side);
    separator.iter().for_each(|&vertex| side[vertex as usize] = OUTSIDE);
    let part =
        |which: u8| vertices.iter().copied().filter(|&vertex| side[vertex as usize] == which).collect();
    let parts = [part(0), part(1)];
    vertices.iter().for_each(|&vertex| side[vertex as usize] = OUTSIDE);
    Cut { parts, separator }
}

/// The bipartite graph of the edges that cross: left vertices (side 0), each with its right neighbours (side 1).
struct Crossing {
    left: Vec<u32>,
    right: Vec<u32>,
    starts: Vec<usize>,
    /// Indices into `right`.
    neighbors: Vec<u32>,
}

impl Crossing {
    fn of(pattern: &CsMat<f64>, vertices: &[u32], side: &[u8]) -> Self {
        let mut crossing =
            Self { left: Vec::new(), right: Vec::new(), starts: vec![0], neighbors: Vec::new() };
        for &vertex in vertices.iter().filter(|&&vertex| side[vertex as usize] == 0) {
            let before = crossing.neighbors.len();
            let row = pattern.indptr().outer_inds_sz(vertex as usize);
            let across = pattern.indices()[row].iter().filter(|&&other| side[other] == 1);
            crossing.neighbors.extend(across.map(|&other| other as u32));
            if crossing.neighbors.len() > before {
                crossing.left.push(vertex);
                crossing.starts.push(crossing.neighbors.len());
            }
        }
        crossing.right = crossing.neighbors.clone();
        crossing.right.sort_unstable();
        crossing.right.dedup();
        for neighbor in &mut crossing.neighbors {
            *neighbor = crossing.right.partition_point(|vertex| vertex < neighbor) as u32;
        }
        crossing
    }

    fn of_left(&self, left: usize) -> &[u32] {
        &self.neighbors[self.starts[left]..self.starts[left + 1]]
    }
}

const FREE: u32 = u32::MAX;

/// A smallest set of vertices that touches every crossing edge: from a maximum matching, the left vertices that no
/// alternating path from a free left vertex reaches, and the right vertices that one does.
fn minimum_cover(pattern: &CsMat<f64>, vertices: &[u32], side: &[u8]) -> Vec<u32> {
    let crossing = Crossing::of(pattern, vertices, side);
    let matching = Matching::maximum(&crossing);
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
