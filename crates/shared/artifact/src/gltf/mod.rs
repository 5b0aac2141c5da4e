//! Skinned characters as glTF 2.0 (`.gltf`, `.glb`) holds them: skeleton, skinned meshes, animations.
//!
//! Read by our own reader, since a message must name the accessor or the vertex, and a broken file must not stop the
//! program. Any number of influences per vertex (`JOINTS_0`, `JOINTS_1`, …), sparse accessors and normalised integers are
//! read; materials, textures, cameras and morph targets are passed over. Positions keep the file's unit: glTF says metres,
//! and many files do not.

mod accessor;
mod container;
mod json;
mod skin;
mod write;

pub use write::write;

use crate::{Error, Result, Unit};
use mesh::{Mesh, Polygons};
use nalgebra::{Matrix4, Point3, UnitQuaternion, Vector2, Vector3};
use std::path::Path;

/// A skinned character.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Character {
    /// All nodes of the file; a parent may stand behind its children.
    pub nodes: Vec<Node>,
    /// The skinned primitives, in the order of the file's nodes.
    pub meshes: Vec<SkinnedMesh>,
    /// The animations.
    pub animations: Vec<Animation>,
}

/// A node: a bone, or what holds a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Its name; `node 7` where the file gives none.
    pub name: String,
    /// Index of the node above; none of a root.
    pub parent: Option<usize>,
    /// Where it rests in its parent.
    pub rest: Placement,
}

/// Where a node stands in its parent: scaled, then turned, then moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// In units of the file.
    pub translation: Vector3<f64>,
    /// The turn.
    pub rotation: UnitQuaternion<f64>,
    /// Per axis.
    pub scale: Vector3<f64>,
}

impl Default for Placement {
    fn default() -> Self {
        Self {
            translation: Vector3::zeros(),
            rotation: UnitQuaternion::identity(),
            scale: Vector3::repeat(1.0),
        }
    }
}

impl Placement {
    /// The parent-from-node transform.
    #[must_use]
    pub fn matrix(&self) -> Matrix4<f64> {
        let turned = self.rotation.to_homogeneous().prepend_nonuniform_scaling(&self.scale);
        turned.append_translation(&self.translation)
    }
}

/// One primitive of a mesh, with the skin that moves it.
#[derive(Debug, Clone, PartialEq)]
pub struct SkinnedMesh {
    /// Name of its mesh, with `/` and the primitive's number (from 0) where the mesh has several.
    pub name: String,
    /// #V points, in units of the file, where they were bound.
    pub positions: Vec<Point3<f64>>,
    /// #V texture coordinates (`TEXCOORD_0`), v down; empty where the file has none.
    pub uvs: Vec<[f64; 2]>,
    /// Triangles.
    pub triangles: Vec<[u32; 3]>,
    /// The bones, as nodes.
    pub joints: Vec<usize>,
    /// Per bone the bone-from-mesh transform of the bind pose.
    pub inverse_bind: Vec<Matrix4<f64>>,
    /// Per vertex its bones (indices into `joints`, rising) and their weights, positive, of sum 1; empty where nothing moves
    /// the vertex.
    pub influences: Vec<Vec<(usize, f64)>>,
}

impl SkinnedMesh {
    /// The mesh where it was bound, in millimetres, its texture coordinates with v up.
    #[must_use]
    pub fn bound(&self, unit: Unit) -> Mesh {
        let mut polygons = Polygons::default();
        self.triangles.iter().for_each(|triangle| polygons.push(triangle));
        let corners = self.triangles.iter().flatten().copied();
        let mut mesh = Mesh {
            positions: self.positions.clone(),
            polygons,
            uvs: self.uvs.iter().map(|[u, v]| Vector2::new(*u, 1.0 - v)).collect(),
            corner_uvs: if self.uvs.is_empty() { Vec::new() } else { corners.collect() },
            ..Mesh::default()
        };
        mesh.scale(unit.in_mm());
        mesh
    }
}

/// A clip of motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Animation {
    /// Its name; `animation 0` where the file gives none.
    pub name: String,
    /// What it moves.
    pub channels: Vec<Channel>,
}

/// One part of one node's placement over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// The node.
    pub node: usize,
    /// Times of the keys, s, rising.
    pub times: Vec<f64>,
    /// What lies between keys.
    pub interpolation: Interpolation,
    /// The keys.
    pub keys: Keys,
}

/// Values of keys. With [`Interpolation::Cubic`] three per key: the tangent into it, its value, the tangent out of it.
#[derive(Debug, Clone, PartialEq)]
pub enum Keys {
    /// Translations, in units of the file.
    Translation(Vec<[f64; 3]>),
    /// Rotations: x, y, z, w.
    Rotation(Vec<[f64; 4]>),
    /// Scales.
    Scale(Vec<[f64; 3]>),
}

/// What lies between keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// The key before.
    Step,
    /// A straight line; rotations along the great circle.
    Linear,
    /// Hermite's cubic.
    Cubic,
}

/// Reads a character, and what the user should know of the file.
///
/// # Errors
/// If the file cannot be read, is no glTF 2.0, holds something that does not fit together, or has no skinned mesh.
pub fn read(path: &Path) -> Result<(Character, Vec<String>)> {
    let file = container::open(path)?;
    let nodes = skin::nodes(&file)?;
    let mut warnings = Vec::new();
    let meshes = skin::meshes(&file, &mut warnings)?;
    if meshes.is_empty() {
        return Err(Error::new(path, "has no skinned mesh: no node with both a mesh and a skin")
            .fix("export the character with its armature and its weights"));
    }
    let animations = skin::animations(&file)?;
    Ok((Character { nodes, meshes, animations }, warnings))
}
