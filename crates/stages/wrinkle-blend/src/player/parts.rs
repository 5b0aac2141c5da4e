//! The meshes of a character, as the page draws them.

use super::block::{Block, Span};
use super::surface::Surface;
use artifact::gltf::{Node, SkinnedMesh};
use serde::Serialize;

/// What a mesh is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PartKind {
    /// Wears the wrinkles.
    Skin,
    /// Hangs on bones that are called eyes.
    Eye,
    /// Anything else: teeth, a tongue, lashes.
    Other,
}

/// A mesh: per vertex a line of each list.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: PartKind,
    /// Three numbers each, in units of the file, where they were bound.
    pub positions: Span,
    /// Three numbers each.
    pub normals: Span,
    /// Four numbers each: `bitangent = w · normal × tangent`.
    pub tangents: Span,
    /// Two numbers each, v down; all 0 where the mesh has none.
    pub uvs: Span,
    /// Three whole numbers per triangle.
    pub triangles: Span,
    /// Two whole numbers each: the first of its influences, and how many.
    pub ranges: Span,
    /// Four whole numbers per influence: the joint; the bits of its weight; the watched bone, or 2³² − 1; the poses that the bone is
    /// of, a bit each.
    pub influences: Span,
    /// The bones, as nodes.
    pub joints: Vec<usize>,
    /// Per bone 16 numbers, column after column: bone from mesh, as it was bound.
    pub inverse_bind: Span,
}

/// Marks a joint that is not watched.
pub(crate) const NOBODY: u32 = u32::MAX;

/// Per node the watched bone and the poses that it is of.
pub(crate) type Watched = Vec<Option<(u32, u32)>>;

pub(crate) fn part(
    mesh: &SkinnedMesh,
    nodes: &[Node],
    watched: &Watched,
    is_skin: bool,
    block: &mut Block,
) -> Part {
    let surface = Surface::of(mesh);
    let of = |vertex: &usize| *vertex;
    let source = || surface.source.iter().map(of);
    let mut first = 0;
    let ranges = source().flat_map(|vertex| {
        let count = mesh.influences[vertex].len() as u32;
        first += count;
        [first - count, count]
    });
    let ranges: Vec<u32> = ranges.collect();
    let influence = |&(joint, weight): &(usize, f64)| {
        let (bone, poses) = watched[mesh.joints[joint]].unwrap_or((NOBODY, 0));
        [joint as u32, (weight as f32).to_bits(), bone, poses]
    };
    Part {
        name: mesh.name.clone(),
        kind: kind(mesh, nodes, is_skin),
        positions: block.floats(source().flat_map(|vertex| <[f64; 3]>::from(mesh.positions[vertex].coords))),
        normals: block.floats(surface.normals.iter().flat_map(|normal| <[f64; 3]>::from(*normal))),
        tangents: block.floats(surface.tangents.iter().flat_map(|tangent| tangent.map(f64::from))),
        uvs: block.floats(source().flat_map(|vertex| mesh.uvs.get(vertex).copied().unwrap_or_default())),
        triangles: block.words(surface.triangles.iter().flatten().copied()),
        ranges: block.words(ranges),
        influences: block
            .words(source().flat_map(|vertex| mesh.influences[vertex].iter().flat_map(influence))),
        joints: mesh.joints.clone(),
        inverse_bind: block
            .floats(mesh.inverse_bind.iter().flat_map(|bind| bind.iter().copied().collect::<Vec<_>>())),
    }
}

/// Eyes are what hangs on bones that are called so, lids are not.
fn kind(mesh: &SkinnedMesh, nodes: &[Node], is_skin: bool) -> PartKind {
    let is_eye = |joint: usize| {
        let name = nodes[mesh.joints[joint]].name.to_lowercase();
        name.contains("eye") && !["lid", "brow", "lash"].iter().any(|other| name.contains(other))
    };
    let mut heaviest = mesh.influences.iter().filter_map(|of| of.iter().max_by(|a, b| a.1.total_cmp(&b.1)));
    match is_skin {
        true => PartKind::Skin,
        false if !mesh.influences.is_empty() && heaviest.all(|(joint, _)| is_eye(*joint)) => PartKind::Eye,
        false => PartKind::Other,
    }
}
