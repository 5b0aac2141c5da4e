//! Normals and tangents of a mesh, as renderers share them [Mikkelsen2008].

use artifact::gltf::SkinnedMesh;
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// A mesh whose vertices have one tangent each: those that lie between mirrored halves of a texture stand there twice.
pub(crate) struct Surface {
    /// Per vertex the one of the mesh that it is.
    pub(crate) source: Vec<usize>,
    pub(crate) normals: Vec<Vector3<f64>>,
    /// x, y, z, and on which side the bitangent is: `bitangent = w · normal × tangent`.
    pub(crate) tangents: Vec<[f32; 4]>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Surface {
    pub(crate) fn of(mesh: &SkinnedMesh) -> Self {
        let normals = normals(mesh);
        let mut corners =
            Corners { mesh, normals: &normals, tangents: vec![[PLAIN; 3]; mesh.triangles.len()] };
        if !mesh.uvs.is_empty() {
            // Without a tangent space there is no detail to draw; the plain tangent stays.
            let _ = generate_tangents(&mut corners);
        }
        let tangents = corners.tangents;
        let mut surface = Self { source: vec![], normals: vec![], tangents: vec![], triangles: vec![] };
        let mut known = BTreeMap::new();
        for (triangle, tangents) in mesh.triangles.iter().zip(&tangents) {
            surface.triangles.push(std::array::from_fn(|corner| {
                let (vertex, tangent) = (triangle[corner], tangents[corner]);
                *known.entry((vertex, tangent.map(f32::to_bits))).or_insert_with(|| {
                    surface.source.push(vertex as usize);
                    surface.normals.push(normals[vertex as usize]);
                    surface.tangents.push(tangent);
                    surface.source.len() as u32 - 1
                })
            }));
        }
        surface
    }
}

const PLAIN: [f32; 4] = [1.0, 0.0, 0.0, 1.0];

/// Normals of vertices; those at one place, which the seams of a texture keep apart, have the same.
fn normals(mesh: &SkinnedMesh) -> Vec<Vector3<f64>> {
    let mut places = BTreeMap::new();
    let mut points = Vec::new();
    let welded: Vec<u32> = mesh
        .positions
        .iter()
        .map(|point| {
            *places.entry([point.x, point.y, point.z].map(f64::to_bits)).or_insert_with(|| {
                points.push(*point);
                points.len() as u32 - 1
            })
        })
        .collect();
    let triangles: Vec<[u32; 3]> =
        mesh.triangles.iter().map(|triangle| triangle.map(|corner| welded[corner as usize])).collect();
    let normals = mesh::vertex_normals(&points, &triangles);
    welded.into_iter().map(|vertex| normals[vertex as usize]).collect()
}

struct Corners<'a> {
    mesh: &'a SkinnedMesh,
    normals: &'a [Vector3<f64>],
    tangents: Vec<[[f32; 4]; 3]>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].coords.map(|x| x as f32).into()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.normals[self.vertex(face, corner)].map(|x| x as f32).into()
    }

    /// MikkTSpace has v up, glTF down: green that points up in the picture is what `bake` writes.
    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let [u, v] = self.mesh.uvs[self.vertex(face, corner)];
        [u as f32, 1.0 - v as f32]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        if let Some(space) = space {
            let [x, y, z] = space.tangent();
            let sign = if space.is_orientation_preserving() { 1.0 } else { -1.0 };
            self.tangents[face][corner] = [x, y, z, sign];
        }
    }
}
