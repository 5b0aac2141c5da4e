//! Shortest ways along edges.

use nalgebra::Point3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The shortest way along edges from one vertex to another, both included, if there is one no longer than `limit`
/// [Dijkstra1959]. Of two ways of the same length the one over lower vertices is taken.
///
/// `points`: #V; `neighbors`: the vertices that share an edge with a vertex.
#[must_use]
pub fn shortest_way<'a>(
    points: &[Point3<f64>],
    neighbors: impl Fn(u32) -> &'a [u32],
    from: u32,
    to: u32,
    limit: f64,
) -> Option<Vec<u32>> {
    let mut distance = vec![f64::INFINITY; points.len()];
    let mut before = vec![u32::MAX; points.len()];
    let mut open = BinaryHeap::from([Reverse((Length(0.0), from))]);
    distance[from as usize] = 0.0;
    while let Some(Reverse((Length(reached), vertex))) = open.pop() {
        if vertex == to {
            let step = |&at: &u32| (at != from).then(|| before[at as usize]);
            let mut way: Vec<u32> = std::iter::successors(Some(to), step).collect();
            way.reverse();
            return Some(way);
        }
        if reached > distance[vertex as usize] {
            continue;
        }
        for &next in neighbors(vertex) {
            let length = reached + (points[next as usize] - points[vertex as usize]).norm();
            if length <= limit && length < distance[next as usize] {
                distance[next as usize] = length;
                before[next as usize] = vertex;
                open.push(Reverse((Length(length), next)));
            }
        }
    }
    None
}

/// A length that sorts.
#[derive(PartialEq)]
struct Length(f64);

impl Eq for Length {}

impl PartialOrd for Length {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Length {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}
