//! Slitting a mesh along its edges: what hung together only across them comes apart.

use mesh::{Mesh, Polygons};
use std::collections::{BTreeMap, BTreeSet};

/// A mesh that was slit.
pub(crate) struct Slit {
    pub(crate) mesh: Mesh,
    /// Per vertex the vertex of the whole mesh that it is (a copy of).
    pub(crate) whole_from_slit: Vec<u32>,
}

/// Slits `mesh` along `lines` (vertices joined by edges). Around each vertex of a line the faces fall into fans that
/// hang together across edges that are not cut; the fan on the left of the line keeps the vertex, every other gets a
/// copy, appended at the end. An end inside the surface has one fan and is not doubled.
pub(crate) fn slit(mesh: &Mesh, lines: &[Vec<u32>]) -> Slit {
    let cut: BTreeSet<[u32; 2]> =
        lines.iter().flat_map(|line| line.windows(2).map(|pair| edge(pair[0], pair[1]))).collect();
    let directed: BTreeSet<[u32; 2]> =
        lines.iter().flat_map(|line| line.windows(2).map(|pair| [pair[0], pair[1]])).collect();
    let on_line: BTreeSet<u32> = cut.iter().flatten().copied().collect();
    let mut corners = mesh.polygons.corners().to_vec();
    let mut whole_from_slit: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    let corners_at = corners_around(mesh, &on_line);
    for (&vertex, around) in &corners_at {
        for fan in fans(mesh, around, &cut, &directed).into_iter().skip(1) {
            let copy = whole_from_slit.len() as u32;
            whole_from_slit.push(vertex);
            fan.into_iter().for_each(|corner| corners[corner] = copy);
        }
    }
    let mut polygons = Polygons::default();
    for face in 0..mesh.polygons.len() {
        polygons.push(&corners[mesh.polygons.corner_range(face)]);
    }
    let mut slit = Mesh { polygons, ..mesh.clone() };
    for &whole in &whole_from_slit[mesh.positions.len()..] {
        slit.positions.push(mesh.positions[whole as usize]);
        slit.colors.extend(mesh.colors.get(whole as usize).copied());
    }
    Slit { mesh: slit, whole_from_slit }
}

fn edge(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// A corner of a face, with the vertices before and after it.
struct Corner {
    index: usize,
    before: u32,
    after: u32,
}

fn corners_around(mesh: &Mesh, vertices: &BTreeSet<u32>) -> BTreeMap<u32, Vec<Corner>> {
    let mut around: BTreeMap<u32, Vec<Corner>> = BTreeMap::new();
    for face in 0..mesh.polygons.len() {
        let polygon = mesh.polygons.face(face);
        let start = mesh.polygons.corner_range(face).start;
        for (i, vertex) in polygon.iter().enumerate().filter(|(_, vertex)| vertices.contains(vertex)) {
            let before = polygon[(i + polygon.len() - 1) % polygon.len()];
            let after = polygon[(i + 1) % polygon.len()];
            around.entry(*vertex).or_default().push(Corner { index: start + i, before, after });
        }
    }
    around
}

/// The corners around one vertex, by fan; the one on the left of a line first.
fn fans(
    mesh: &Mesh,
    around: &[Corner],
    cut: &BTreeSet<[u32; 2]>,
    directed: &BTreeSet<[u32; 2]>,
) -> Vec<Vec<usize>> {
    let vertex = around.first().map_or(0, |corner| mesh.polygons.corners()[corner.index]);
    let mut fan_of: Vec<usize> = (0..around.len()).collect();
    let sides = |corner: &Corner| [corner.before, corner.after].map(|other| edge(vertex, other));
    loop {
        let mut changed = false;
        for i in 0..around.len() {
            for j in 0..i {
                let joined = sides(&around[i])
                    .iter()
                    .any(|side| !cut.contains(side) && sides(&around[j]).contains(side));
                if joined && fan_of[i] != fan_of[j] {
                    let low = fan_of[i].min(fan_of[j]);
                    (fan_of[i], fan_of[j]) = (low, low);
                    changed = true;
                }
            }
        }
        if !changed {
            break;
        }
    }
    // A face is on the left of a line that runs along it in the direction of its corners.
    let is_left = |corner: &Corner| {
        directed.contains(&[vertex, corner.after]) || directed.contains(&[corner.before, vertex])
    };
    let left = around.iter().position(is_left).map(|corner| fan_of[corner]);
    let mut fans: BTreeMap<(bool, usize), Vec<usize>> = BTreeMap::new();
    for (corner, &fan) in around.iter().zip(&fan_of) {
        fans.entry((Some(fan) != left, fan)).or_default().push(corner.index);
    }
    fans.into_values().collect()
}
