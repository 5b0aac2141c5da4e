//! Loop subdivision as a linear map, so that anything that lives on vertices is refined alike.
//!
//! [Loop1987]: a new vertex on an inner edge takes 3/8 of its ends and 1/8 of the opposite corners; an old inner vertex
//! of valence n keeps 1 − nβ and takes β = (5/8 − (3/8 + cos(2π/n)/4)²)/n of each neighbour. Boundaries are cubic
//! splines of their own vertices (½ ½, and 1/8 ¾ 1/8), so that a mouth stays as it was cut. Edges with more than two
//! triangles count as boundaries; a vertex where other than two boundary edges meet stays.

#[cfg(test)]
mod tests;

use mesh::{Connectivity, Edge, Label, Mesh, NO_UV, Polygons};
use nalgebra::{Point3, SVector, Vector2, Vector3};
use rayon::prelude::*;
use std::collections::HashMap;

/// New values as weighted sums of old ones; the weights of a row add up to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Stencil {
    old_count: usize,
    starts: Vec<u32>,
    entries: Vec<(u32, f64)>,
}

impl Stencil {
    /// Values at the new vertices.
    ///
    /// # Panics
    /// If `field` has not one value per old vertex: a bug of the caller.
    #[must_use]
    pub fn apply<const D: usize>(&self, field: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        assert_eq!(field.len(), self.old_count, "one value per vertex");
        let sum = |row: usize| {
            self.row(row).iter().map(|&(old, weight)| field[old as usize] * weight).sum::<SVector<f64, D>>()
        };
        (0..self.starts.len() - 1).into_par_iter().map(sum).collect()
    }

    /// The old vertices that a new one is made of, and their weights.
    #[must_use]
    pub fn row(&self, new: usize) -> &[(u32, f64)] {
        &self.entries[self.starts[new] as usize..self.starts[new + 1] as usize]
    }

    fn of_rows(old_count: usize, rows: &[Vec<(u32, f64)>]) -> Self {
        let mut starts = vec![0];
        rows.iter()
            .scan(0, |sum, row| {
                *sum += row.len() as u32;
                Some(*sum)
            })
            .for_each(|end| starts.push(end));
        Self { old_count, starts, entries: rows.concat() }
    }
}

/// A refined mesh, and the way there.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined {
    /// Triangles only. Old vertices come first, in their order; each triangle becomes four, in its place.
    pub mesh: Mesh,
    stencils: Vec<Stencil>,
}

impl Refined {
    /// Subdivides a mesh `levels` times. Polygons are split as fans first, also with no level; texture coordinates are
    /// refined by the same rules on their own islands, so that seams stay seams; labels stay with their faces.
    #[must_use]
    pub fn of(mesh: &Mesh, levels: usize) -> Self {
        let mut refined = Self { mesh: triangulated(mesh), stencils: Vec::new() };
        for _ in 0..levels {
            let (mesh, stencil) = refine_once(&refined.mesh);
            refined.mesh = mesh;
            refined.stencils.push(stencil);
        }
        refined
    }

    /// A field of the old vertices at the new ones.
    ///
    /// # Panics
    /// If `field` has not one value per old vertex: a bug of the caller.
    #[must_use]
    pub fn field<const D: usize>(&self, field: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        self.stencils.iter().fold(field.to_vec(), |field, stencil| stencil.apply(&field))
    }
}

/// The mesh with every polygon split as a fan from its first corner; triangles that name a vertex twice are left out.
#[must_use]
pub fn triangulated(mesh: &Mesh) -> Mesh {
    let mut polygons = Polygons::default();
    let mut corner_uvs = Vec::new();
    let mut first_triangle = Vec::with_capacity(mesh.polygons.len() + 1);
    for (face, polygon) in mesh.polygons.iter().enumerate() {
        first_triangle.push(polygons.len());
        let uvs = mesh.corner_uvs.get(mesh.polygons.corner_range(face));
        for second in 1..polygon.len().saturating_sub(1) {
            let corners = [0, second, second + 1];
            let [a, b, c] = corners.map(|corner| polygon[corner]);
            if a != b && b != c && c != a {
                polygons.push(&[a, b, c]);
                corner_uvs.extend(uvs.into_iter().flat_map(|uvs| corners.map(|corner| uvs[corner])));
            }
        }
    }
    first_triangle.push(polygons.len());
    let label = |label: &Label| Label {
        first_face: first_triangle[label.first_face.min(mesh.polygons.len())],
        ..label.clone()
    };
    Mesh { polygons, corner_uvs, labels: mesh.labels.iter().map(label).collect(), ..mesh.clone() }
}

/// One level, on triangles.
fn refine_once(mesh: &Mesh) -> (Mesh, Stencil) {
    let triangles = mesh.triangles();
    let (stencil, children) = subdivide(mesh.positions.len(), &triangles);
    let positions = stencil.apply(&coordinates(&mesh.positions)).into_iter().map(Point3::from).collect();
    let mut polygons = Polygons::default();
    children.iter().for_each(|child| polygons.push(child));
    let (uvs, corner_uvs) = refined_uvs(mesh, &triangles);
    let colors = match mesh.colors.is_empty() {
        true => Vec::new(),
        false => {
            let wide: Vec<Vector3<f64>> =
                mesh.colors.iter().map(|color| Vector3::from(color.map(f64::from))).collect();
            stencil
                .apply(&wide)
                .into_iter()
                .map(|color| [color.x as f32, color.y as f32, color.z as f32])
                .collect()
        }
    };
    let labels =
        mesh.labels.iter().map(|label| Label { first_face: 4 * label.first_face, ..label.clone() }).collect();
    (Mesh { positions, polygons, uvs, corner_uvs, colors, labels }, stencil)
}

/// Texture coordinates, refined on their own triangles. Coordinates that a file repeats per corner are joined where
/// they belong to one vertex.
fn refined_uvs(mesh: &Mesh, triangles: &[[u32; 3]]) -> (Vec<Vector2<f64>>, Vec<u32>) {
    if mesh.corner_uvs.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let mut joined: HashMap<(u32, [u64; 2]), u32> = HashMap::new();
    let mut uvs = Vec::new();
    let mut islands = Vec::new();
    let mut island_of = Vec::with_capacity(triangles.len());
    for (triangle, corners) in triangles.iter().zip(mesh.corner_uvs.chunks_exact(3)) {
        if corners.contains(&NO_UV) {
            island_of.push(None);
            continue;
        }
        island_of.push(Some(islands.len()));
        islands.push([0, 1, 2].map(|i| {
            let uv = mesh.uvs[corners[i] as usize];
            *joined.entry((triangle[i], [uv.x.to_bits(), uv.y.to_bits()])).or_insert_with(|| {
                uvs.push(uv);
                uvs.len() as u32 - 1
            })
        }));
    }
    let (stencil, children) = subdivide(uvs.len(), &islands);
    let corners_of = |island: &Option<usize>| match island {
        Some(island) => children[4 * island..4 * island + 4].concat(),
        None => vec![NO_UV; 12],
    };
    (stencil.apply(&uvs), island_of.iter().flat_map(corners_of).collect())
}

/// The stencil of one level, and four triangles for each: those at its corners in order, then the middle one.
fn subdivide(vertex_count: usize, triangles: &[[u32; 3]]) -> (Stencil, Vec<[u32; 3]>) {
    let around = Connectivity::of(vertex_count, triangles);
    let edges: Vec<Edge> = around.edges().collect();
    let mut rows = even_rows(vertex_count, &edges);
    rows.extend(edges.iter().map(|edge| odd_row(edge, triangles)));
    let middle = |a: u32, b: u32| {
        let ends = [a.min(b), a.max(b)];
        // Every side of a triangle is an edge.
        let edge = edges.binary_search_by_key(&ends, |edge| edge.vertices).unwrap_or(0);
        (vertex_count + edge) as u32
    };
    let split = |&[a, b, c]: &[u32; 3]| {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    (Stencil::of_rows(vertex_count, &rows), triangles.iter().flat_map(split).collect())
}

fn is_boundary(edge: &Edge) -> bool {
    edge.triangles.len() != 2
}

/// Rows of the old vertices.
fn even_rows(vertex_count: usize, edges: &[Edge]) -> Vec<Vec<(u32, f64)>> {
    let mut ring: Vec<Vec<u32>> = vec![Vec::new(); vertex_count];
    let mut along: Vec<Vec<u32>> = vec![Vec::new(); vertex_count];
    for edge in edges {
        let [a, b] = edge.vertices;
        for (from, to) in [(a, b), (b, a)] {
            ring[from as usize].push(to);
            if is_boundary(edge) {
                along[from as usize].push(to);
            }
        }
    }
    let row = |vertex: usize| match (along[vertex].as_slice(), ring[vertex].as_slice()) {
        ([], []) => vec![(vertex as u32, 1.0)],
        ([], ring) => {
            let valence = ring.len() as f64;
            let share = (0.625 - (0.375 + 0.25 * (std::f64::consts::TAU / valence).cos()).powi(2)) / valence;
            let own = (vertex as u32, 1.0 - valence * share);
            std::iter::once(own).chain(ring.iter().map(|&other| (other, share))).collect()
        }
        (&[before, after], _) => vec![(vertex as u32, 0.75), (before, 0.125), (after, 0.125)],
        _ => vec![(vertex as u32, 1.0)],
    };
    (0..vertex_count).map(row).collect()
}

/// The row of an edge's new vertex.
fn odd_row(edge: &Edge, triangles: &[[u32; 3]]) -> Vec<(u32, f64)> {
    let [a, b] = edge.vertices;
    if is_boundary(edge) {
        return vec![(a, 0.5), (b, 0.5)];
    }
    let opposite = |triangle: &u32| {
        triangles[*triangle as usize].into_iter().find(|&corner| corner != a && corner != b).unwrap_or(a)
    };
    let ends = [(a, 0.375), (b, 0.375)];
    ends.into_iter().chain(edge.triangles.iter().map(|triangle| (opposite(triangle), 0.125))).collect()
}

fn coordinates(points: &[Point3<f64>]) -> Vec<Vector3<f64>> {
    points.iter().map(|point| point.coords).collect()
}
