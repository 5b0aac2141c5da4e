//! What lies beside what: edges, boundary loops, components, and the places where a surface is not a manifold.

use crate::forest::Forest;
use std::collections::HashMap;

/// An edge and the triangles on it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Edge {
    /// Its ends, the lower index first.
    pub vertices: [u32; 2],
    /// Its triangles: one on a boundary, two inside, more where the surface is not a manifold.
    pub triangles: Vec<u32>,
}

/// Connectivity of a triangle list.
#[derive(Debug, Clone)]
pub struct Connectivity {
    vertex_count: usize,
    triangles: Vec<[u32; 3]>,
    /// Sides (triangle × 3 + corner that the side starts at), sorted by the ends of their edge.
    sides: Vec<u32>,
    /// Where each edge's sides start in `sides`.
    edge_starts: Vec<u32>,
    /// Per corner the representative of its fan: corners of one vertex that hang together across edges.
    fans: Vec<u32>,
}

impl Connectivity {
    /// Builds the connectivity of `triangles` (vertex indices below `vertex_count`).
    #[must_use]
    pub fn of(vertex_count: usize, triangles: &[[u32; 3]]) -> Self {
        let key = |side: u32| sorted_ends(triangles, side);
        let mut sides: Vec<u32> = (0..triangles.len() as u32 * 3).collect();
        sides.sort_unstable_by_key(|&side| (key(side), side));
        let mut edge_starts: Vec<u32> = Vec::with_capacity(sides.len() / 2 + 1);
        for at in 0..sides.len() {
            if at == 0 || key(sides[at]) != key(sides[at - 1]) {
                edge_starts.push(at as u32);
            }
        }
        edge_starts.push(sides.len() as u32);
        let mut around =
            Self { vertex_count, triangles: triangles.to_vec(), sides, edge_starts, fans: Vec::new() };
        around.fans = around.corner_fans();
        around
    }

    /// Number of edges.
    #[must_use]
    pub fn edge_count(&self) -> usize {
        self.edge_starts.len() - 1
    }

    /// All edges, sorted by their ends.
    pub fn edges(&self) -> impl Iterator<Item = Edge> {
        (0..self.edge_count()).map(|edge| Edge {
            vertices: sorted_ends(&self.triangles, self.sides_of(edge)[0]),
            triangles: self.sides_of(edge).iter().map(|side| side / 3).collect(),
        })
    }

    /// Edges with more than two triangles.
    #[must_use]
    pub fn non_manifold_edges(&self) -> Vec<Edge> {
        self.edges().filter(|edge| edge.triangles.len() > 2).collect()
    }

    /// Edges whose two triangles run along them in the same direction: one of the two is turned over.
    #[must_use]
    pub fn flipped_edges(&self) -> Vec<Edge> {
        let flipped = |edge: &usize| {
            let sides = self.sides_of(*edge);
            sides.len() == 2 && self.start(sides[0]) == self.start(sides[1])
        };
        let edges: Vec<usize> = (0..self.edge_count()).filter(flipped).collect();
        edges
            .into_iter()
            .map(|edge| Edge {
                vertices: sorted_ends(&self.triangles, self.sides_of(edge)[0]),
                triangles: self.sides_of(edge).iter().map(|side| side / 3).collect(),
            })
            .collect()
    }

    /// Vertices where several fans of triangles meet in a point only.
    #[must_use]
    pub fn bow_ties(&self) -> Vec<u32> {
        let mut first_fan = vec![u32::MAX; self.vertex_count];
        let mut torn = vec![false; self.vertex_count];
        for corner in 0..self.fans.len() {
            let vertex = self.triangles[corner / 3][corner % 3] as usize;
            match first_fan[vertex] {
                u32::MAX => first_fan[vertex] = self.fans[corner],
                fan => torn[vertex] |= fan != self.fans[corner],
            }
        }
        (0..self.vertex_count as u32).filter(|&vertex| torn[vertex as usize]).collect()
    }

    /// Vertices that no triangle uses.
    #[must_use]
    pub fn unreferenced(&self) -> Vec<u32> {
        let mut used = vec![false; self.vertex_count];
        self.triangles.iter().flatten().for_each(|&vertex| used[vertex as usize] = true);
        (0..self.vertex_count as u32).filter(|&vertex| !used[vertex as usize]).collect()
    }

    /// The closed loops of boundary edges, each as vertices in the direction of its triangles, longest (by count)
    /// first. Around a bow-tie vertex a loop stays within its fan.
    #[must_use]
    pub fn boundary_loops(&self) -> Vec<Vec<u32>> {
        let boundary: Vec<u32> = (0..self.edge_count())
            .filter(|&edge| self.sides_of(edge).len() == 1)
            .map(|edge| self.sides_of(edge)[0])
            .collect();
        let mut leaving: HashMap<u32, Vec<u32>> = HashMap::new();
        for &side in boundary.iter().rev() {
            leaving.entry(self.fans[side as usize]).or_default().push(side);
        }
        let mut loops: Vec<Vec<u32>> = Vec::new();
        for &first in &boundary {
            let mut vertices = Vec::new();
            let mut fan = self.fans[first as usize];
            while let Some(side) = leaving.get_mut(&fan).and_then(Vec::pop) {
                vertices.push(self.start(side));
                fan = self.fans[next_in_triangle(side) as usize];
            }
            if !vertices.is_empty() {
                loops.push(vertices);
            }
        }
        loops.sort_by_key(|vertices| std::cmp::Reverse(vertices.len()));
        loops
    }

    /// Per vertex the number of its component, and how many there are. Components are numbered by their lowest
    /// vertex; an unreferenced vertex is a component of its own.
    #[must_use]
    pub fn components(&self) -> (Vec<u32>, usize) {
        let mut forest = Forest::new(self.vertex_count);
        for triangle in &self.triangles {
            forest.join(triangle[0], triangle[1]);
            forest.join(triangle[0], triangle[2]);
        }
        let mut number: HashMap<u32, u32> = HashMap::new();
        let labels = (0..self.vertex_count as u32)
            .map(|vertex| {
                let next = number.len() as u32;
                *number.entry(forest.root(vertex)).or_insert(next)
            })
            .collect();
        (labels, number.len())
    }

    /// The one-ring neighbours of every vertex: `neighbors[starts[v]..starts[v + 1]]`, rising.
    #[must_use]
    pub fn one_rings(&self) -> (Vec<usize>, Vec<u32>) {
        let mut starts = vec![0usize; self.vertex_count + 1];
        let ends: Vec<[u32; 2]> =
            (0..self.edge_count()).map(|edge| sorted_ends(&self.triangles, self.sides_of(edge)[0])).collect();
        ends.iter().flatten().for_each(|&vertex| starts[vertex as usize + 1] += 1);
        for vertex in 0..self.vertex_count {
            starts[vertex + 1] += starts[vertex];
        }
        let mut fill = starts.clone();
        let mut neighbors = vec![0u32; ends.len() * 2];
        // Lower neighbours first, then higher ones: edges are sorted, so both runs come out rising.
        for &[low, high] in &ends {
            neighbors[fill[high as usize]] = low;
            fill[high as usize] += 1;
        }
        for &[low, high] in &ends {
            neighbors[fill[low as usize]] = high;
            fill[low as usize] += 1;
        }
        (starts, neighbors)
    }

    fn sides_of(&self, edge: usize) -> &[u32] {
        &self.sides[self.edge_starts[edge] as usize..self.edge_starts[edge + 1] as usize]
    }

    fn start(&self, side: u32) -> u32 {
        self.triangles[side as usize / 3][side as usize % 3]
    }

    /// Joins the corners that meet at each end of every edge; a side is named like the corner it starts at.
    fn corner_fans(&self) -> Vec<u32> {
        let mut forest = Forest::new(self.triangles.len() * 3);
        for edge in 0..self.edge_count() {
            for pair in self.sides_of(edge).windows(2) {
                let (one, other) = (pair[0], pair[1]);
                if self.start(one) == self.start(other) {
                    forest.join(one, other);
                    forest.join(next_in_triangle(one), next_in_triangle(other));
                } else {
                    forest.join(one, next_in_triangle(other));
                    forest.join(next_in_triangle(one), other);
                }
            }
        }
        (0..self.triangles.len() as u32 * 3).map(|corner| forest.root(corner)).collect()
    }
}

fn sorted_ends(triangles: &[[u32; 3]], side: u32) -> [u32; 2] {
    let triangle = triangles[side as usize / 3];
    let (a, b) = (triangle[side as usize % 3], triangle[(side as usize + 1) % 3]);
    [a.min(b), a.max(b)]
}

fn next_in_triangle(side: u32) -> u32 {
    side - side % 3 + (side + 1) % 3
}
