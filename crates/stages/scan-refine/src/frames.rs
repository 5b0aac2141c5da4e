//! Tangent frames of a mesh.

use crate::sampling::Corners;
use artifact::GreenAxis;
use mesh::Mesh;
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;

/// Per corner of each triangle its frame: columns tangent, bitangent, normal.
pub(crate) struct Frames(Vec<[Matrix3<f64>; 3]>);

impl Frames {
    /// The normals are the vertices'; a tangent is the mean of ∂x/∂u over the triangles around a vertex that share its texture
    /// coordinate and their orientation there, weighted by angle and made perpendicular to the normal. The bitangent completes the
    /// frame along growing v, or against it where green points down.
    pub(crate) fn of(mesh: &Mesh, corners: &Corners, normals: &[Vector3<f64>], green: GreenAxis) -> Self {
        let mut tangents: BTreeMap<Key, Vector3<f64>> = BTreeMap::new();
        let mut keys = Vec::with_capacity(corners.vertices.len());
        for triangle in 0..corners.vertices.len() {
            let (tangent, mirrored) = tangent(mesh, corners, triangle);
            let key = [0, 1, 2].map(|corner| key(corners, triangle, corner, mirrored));
            for (corner, key) in key.into_iter().enumerate() {
                let share = angle(mesh, corners.vertices[triangle], corner);
                *tangents.entry(key).or_insert_with(Vector3::zeros) += share * tangent;
            }
            keys.push(key);
        }
        let up = green.sign();
        let frame = |key: Key| {
            let normal = normals[key.0 as usize];
            let sum = tangents.get(&key).copied().unwrap_or_else(Vector3::x);
            let across = (sum - normal.dot(&sum) * normal).try_normalize(1e-12);
            let tangent = across.unwrap_or_else(|| normal.cross(&Vector3::ith(normal.iamin(), 1.0)));
            let handed = if key.2 { -1.0 } else { 1.0 };
            Matrix3::from_columns(&[tangent, up * handed * normal.cross(&tangent), normal])
        };
        Self(keys.into_iter().map(|keys| keys.map(frame)).collect())
    }

    /// A vector of the map at a place in a triangle, in the axes of the mesh's coordinates.
    pub(crate) fn turn(&self, triangle: usize, at: [f64; 3], vector: Vector3<f64>) -> Vector3<f64> {
        let frames = &self.0[triangle];
        let turned = (at[0] * frames[0] + at[1] * frames[1] + at[2] * frames[2]) * vector;
        turned.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
    }
}

/// Vertex, texture coordinate (bits), and whether the map is mirrored there.
type Key = (u32, [u64; 2], bool);

fn key(corners: &Corners, triangle: usize, corner: usize, mirrored: bool) -> Key {
    let uv = corners.uvs[triangle][corner];
    (corners.vertices[triangle][corner], [uv.x.to_bits(), uv.y.to_bits()], mirrored)
}

/// ∂x/∂u of a triangle as a unit vector, and whether its texture is mirrored; zero where it has no texture area.
fn tangent(mesh: &Mesh, corners: &Corners, triangle: usize) -> (Vector3<f64>, bool) {
    let [a, b, c] = corners.vertices[triangle].map(|vertex| mesh.positions[vertex as usize]);
    let [ua, ub, uc] = corners.uvs[triangle];
    let (first, second) = (ub - ua, uc - ua);
    let area = first.perp(&second);
    let along = ((b - a) * second.y - (c - a) * first.y) * area.signum();
    (along.try_normalize(0.0).filter(|_| area != 0.0).unwrap_or_else(Vector3::zeros), area < 0.0)
}

fn angle(mesh: &Mesh, triangle: [u32; 3], corner: usize) -> f64 {
    let at = |i: usize| mesh.positions[triangle[(corner + i) % 3] as usize];
    (at(1) - at(0)).angle(&(at(2) - at(0)))
}
