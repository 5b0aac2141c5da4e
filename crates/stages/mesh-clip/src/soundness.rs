//! Dropping faces until a surface is a manifold with boundary.

use mesh::{Connectivity, Mesh, triangle_areas};
use std::collections::BTreeMap;

/// What was dropped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Dropped {
    /// Edges that had more than two faces.
    pub non_manifold_edges: usize,
    /// Vertices where several fans of faces met.
    pub bow_ties: usize,
    /// Faces that went.
    pub faces: usize,
}

/// Marks as gone, among the faces still kept, a small set whose loss leaves no edge with more than two triangles and no
/// bow tie: at such an edge all but the two largest faces, at such a vertex all but the fan with most faces, again
/// until there are none. Greedy: the fewest at each place, not always the fewest in all.
pub(crate) fn drop_non_manifold(mesh: &Mesh, keep: &mut [bool]) -> Dropped {
    let mut dropped = Dropped::default();
    loop {
        let kept = Kept::of(mesh, keep);
        let around = Connectivity::of(mesh.positions.len(), &kept.triangles);
        let edges = around.non_manifold_edges();
        dropped.non_manifold_edges += edges.len();
        let mut going: Vec<u32> =
            edges.iter().flat_map(|edge| kept.superfluous(mesh, &edge.triangles)).collect();
        // Bow ties are often where such edges end, so they are looked at when those are gone.
        if edges.is_empty() {
            let ties = around.bow_ties();
            dropped.bow_ties += ties.len();
            going = kept.smaller_fans(&ties);
        }
        if going.is_empty() {
            return dropped;
        }
        for face in going {
            dropped.faces += usize::from(std::mem::replace(&mut keep[face as usize], false));
        }
    }
}

/// The triangles of the faces that are still kept.
struct Kept {
    triangles: Vec<[u32; 3]>,
    /// Per triangle its face.
    faces: Vec<u32>,
}

impl Kept {
    fn of(mesh: &Mesh, keep: &[bool]) -> Self {
        let mut kept = Self { triangles: Vec::new(), faces: Vec::new() };
        for (face, polygon) in mesh.polygons.iter().enumerate().filter(|(face, _)| keep[*face]) {
            for pair in polygon[1..].windows(2) {
                kept.triangles.push([polygon[0], pair[0], pair[1]]);
                kept.faces.push(face as u32);
            }
        }
        kept
    }

    /// All faces on an edge but the two largest.
    fn superfluous(&self, mesh: &Mesh, triangles: &[u32]) -> Vec<u32> {
        let mut faces: Vec<(f64, u32)> = triangles
            .iter()
            .map(|&t| {
                let area = triangle_areas(&mesh.positions, &[self.triangles[t as usize]])[0];
                (area, self.faces[t as usize])
            })
            .collect();
        faces.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        faces.iter().skip(2).map(|&(_, face)| face).collect()
    }

    /// Around each of `vertices` the faces of all fans but the one with most.
    fn smaller_fans(&self, vertices: &[u32]) -> Vec<u32> {
        let mut around: BTreeMap<u32, Vec<usize>> =
            vertices.iter().map(|&vertex| (vertex, Vec::new())).collect();
        for (t, triangle) in self.triangles.iter().enumerate() {
            for vertex in triangle {
                if let Some(triangles) = around.get_mut(vertex) {
                    triangles.push(t);
                }
            }
        }
        around.iter().flat_map(|(&vertex, triangles)| self.smaller_fans_at(vertex, triangles)).collect()
    }

    fn smaller_fans_at(&self, vertex: u32, around: &[usize]) -> Vec<u32> {
        let mut left: Vec<usize> = around.to_vec();
        let mut fans: Vec<Vec<usize>> = Vec::new();
        while let Some(first) = left.pop() {
            let mut fan = vec![first];
            let mut next = 0;
            while next < fan.len() {
                let beside = |other: &usize| self.share_edge_at(vertex, fan[next], *other);
                let (joined, apart): (Vec<usize>, Vec<usize>) = left.iter().partition(|other| beside(other));
                fan.extend(joined);
                left = apart;
                next += 1;
            }
            fans.push(fan);
        }
        fans.sort_by_key(|fan| (std::cmp::Reverse(fan.len()), fan.iter().min().copied()));
        fans.iter().skip(1).flatten().map(|&triangle| self.faces[triangle]).collect()
    }

    /// Whether two triangles at a vertex share another vertex, too.
    fn share_edge_at(&self, vertex: u32, one: usize, other: usize) -> bool {
        self.triangles[one].iter().any(|&end| end != vertex && self.triangles[other].contains(&end))
    }
}
