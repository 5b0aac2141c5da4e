//! Shortest ways along the edges of a mesh.

use crate::Error;
use mesh::Mesh;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The edges of all polygons: per vertex its neighbours, rising.
pub(crate) struct Edges<'a> {
    mesh: &'a Mesh,
    neighbors: Vec<Vec<u32>>,
}

impl<'a> Edges<'a> {
    pub(crate) fn of(mesh: &'a Mesh) -> Self {
        let mut neighbors = vec![Vec::new(); mesh.positions.len()];
        for polygon in mesh.polygons.iter() {
            for (i, &from) in polygon.iter().enumerate() {
                let to = polygon[(i + 1) % polygon.len()];
                neighbors[from as usize].push(to);
                neighbors[to as usize].push(from);
            }
        }
        for around in &mut neighbors {
            around.sort_unstable();
            around.dedup();
        }
        Self { mesh, neighbors }
    }

    /// The line through `picks`, the shortest way along edges between each two (Dijkstra). Of two ways of the same
    /// length the one over lower vertices is taken.
    ///
    /// # Errors
    /// [`Error::VertexOutOfRange`], [`Error::NoWay`].
    pub(crate) fn line(&self, picks: &[u32]) -> Result<Vec<u32>, Error> {
        check_range(self.mesh, picks)?;
        let mut line: Vec<u32> = picks.first().copied().into_iter().collect();
        for pair in picks.windows(2) {
            line.extend(self.way(pair[0], pair[1])?.into_iter().skip(1));
        }
        Ok(line)
    }

    fn way(&self, from: u32, to: u32) -> Result<Vec<u32>, Error> {
        let mut distance = vec![f64::INFINITY; self.neighbors.len()];
        let mut before = vec![u32::MAX; self.neighbors.len()];
        let mut open = BinaryHeap::new();
        distance[from as usize] = 0.0;
        open.push(Reverse((Length(0.0), from)));
        while let Some(Reverse((Length(reached), vertex))) = open.pop() {
            if vertex == to {
                break;
            }
            if reached > distance[vertex as usize] {
                continue;
            }
            for &next in &self.neighbors[vertex as usize] {
                let step = self.mesh.positions[next as usize] - self.mesh.positions[vertex as usize];
                let length = reached + step.norm();
                if length < distance[next as usize] {
                    distance[next as usize] = length;
                    before[next as usize] = vertex;
                    open.push(Reverse((Length(length), next)));
                }
            }
        }
        if distance[to as usize].is_infinite() {
            return Err(Error::NoWay { from, to });
        }
        let mut way: Vec<u32> =
            std::iter::successors(Some(to), |&at| (at != from).then(|| before[at as usize])).collect();
        way.reverse();
        Ok(way)
    }
}

pub(crate) fn check_range(mesh: &Mesh, vertices: &[u32]) -> Result<(), Error> {
    let vertex_count = mesh.positions.len();
    match vertices.iter().find(|&&vertex| vertex as usize >= vertex_count) {
        Some(&vertex) => Err(Error::VertexOutOfRange { vertex, vertex_count }),
        None => Ok(()),
    }
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
