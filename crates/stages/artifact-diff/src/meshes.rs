//! Two meshes, vertex by vertex.

use crate::{Error, Part, Report, Summary};
use mesh::{LabelKind, Mesh, NO_UV};
use nalgebra::{Point3, Vector2};

/// Some vertices that are looked at on their own.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Its name.
    pub name: String,
    /// Vertex indices, 0-based.
    pub vertices: Vec<u32>,
}

impl Region {
    pub(crate) fn check(&self, vertex_count: usize) -> Result<(), Error> {
        match self.vertices.iter().find(|&&vertex| vertex as usize >= vertex_count) {
            Some(&vertex) => Err(Error::Region { region: self.name.clone(), vertex, count: vertex_count }),
            None => Ok(()),
        }
    }
}

/// Euclidean distances between the vertices of one index, mm, as a whole and per region; and where faces, texture
/// coordinates, colours, groups or materials differ.
///
/// # Errors
/// [`Error::VertexCount`] where the counts differ; [`Error::Region`] where a region does not fit.
pub fn compare_meshes(mesh: &Mesh, other: &Mesh, regions: &[Region]) -> Result<Report, Error> {
    let distances = distances(&mesh.positions, &other.positions)?;
    let vertex = |index: usize| format!("vertex {index}");
    let mut report = Report::new("mm", Summary::of(&distances, vertex));
    for region in regions {
        region.check(distances.len())?;
        let within: Vec<f64> = region.vertices.iter().map(|&vertex| distances[vertex as usize]).collect();
        let summary = Summary::of(&within, |index| vertex(region.vertices[index] as usize));
        report.regions.push(Part { name: region.name.clone(), summary });
    }
    report.structure = [faces(mesh, other), uvs(mesh, other), colors(mesh, other)]
        .into_iter()
        .flatten()
        .chain(labels(mesh, other))
        .collect();
    Ok(report)
}

/// Per vertex its distance, in the unit of the positions.
pub(crate) fn distances(points: &[Point3<f64>], other: &[Point3<f64>]) -> Result<Vec<f64>, Error> {
    match points.len() == other.len() {
        true => Ok(points.iter().zip(other).map(|(point, other)| (point - other).norm()).collect()),
        false => Err(Error::VertexCount { count: points.len(), other: other.len() }),
    }
}

fn faces(mesh: &Mesh, other: &Mesh) -> Option<String> {
    let (count, other_count) = (mesh.polygons.len(), other.polygons.len());
    if count != other_count {
        return Some(format!("{count} faces against {other_count}"));
    }
    let differs = |face: &usize| mesh.polygons.face(*face) != other.polygons.face(*face);
    let first = (0..count).find(differs)?;
    let total = (first..count).filter(differs).count();
    Some(format!("{total} of {count} faces name other vertices, the first is face {first}"))
}

fn uvs(mesh: &Mesh, other: &Mesh) -> Option<String> {
    match (mesh.corner_uvs.is_empty(), other.corner_uvs.is_empty()) {
        (true, true) => return None,
        (false, true) => return Some("only the first has texture coordinates".to_string()),
        (true, false) => return Some("only the second has texture coordinates".to_string()),
        (false, false) => {}
    }
    if mesh.corner_uvs.len() != other.corner_uvs.len() {
        // The faces differ, which is said already.
        return None;
    }
    let at = |mesh: &Mesh, corner: usize| -> Option<Vector2<f64>> {
        let uv = mesh.corner_uvs[corner];
        (uv != NO_UV).then(|| mesh.uvs[uv as usize])
    };
    let corners = 0..mesh.corner_uvs.len();
    let differing = corners.filter(|&corner| at(mesh, corner) != at(other, corner));
    let largest = |corner: usize| match (at(mesh, corner), at(other, corner)) {
        (Some(uv), Some(other)) => (uv - other).amax(),
        _ => f64::INFINITY,
    };
    let (count, most) =
        differing.fold((0usize, 0.0f64), |(count, most), corner| (count + 1, most.max(largest(corner))));
    (count > 0).then(|| match most.is_finite() {
        true => format!("texture coordinates differ at {count} corners, by up to {most}"),
        false => format!("texture coordinates differ at {count} corners, some have none"),
    })
}

fn colors(mesh: &Mesh, other: &Mesh) -> Option<String> {
    match (mesh.colors.is_empty(), other.colors.is_empty()) {
        (true, true) => None,
        (false, true) => Some("only the first has vertex colours".to_string()),
        (true, false) => Some("only the second has vertex colours".to_string()),
        (false, false) => {
            let count = mesh.colors.iter().zip(&other.colors).filter(|(color, other)| color != other).count();
            (count > 0).then(|| format!("the colours of {count} vertices differ"))
        }
    }
}

fn labels(mesh: &Mesh, other: &Mesh) -> Vec<String> {
    let kinds = [
        (LabelKind::Object, "objects"),
        (LabelKind::Group, "groups"),
        (LabelKind::Material, "materials"),
        (LabelKind::Smoothing, "smoothing groups"),
        (LabelKind::MaterialLibrary, "material libraries"),
    ];
    let of = |mesh: &Mesh, kind: LabelKind| -> Vec<(usize, String)> {
        let named = mesh.labels.iter().filter(|label| label.kind == kind);
        named.map(|label| (label.first_face, label.name.clone())).collect()
    };
    let differing = kinds.into_iter().filter(|&(kind, _)| of(mesh, kind) != of(other, kind));
    differing.map(|(_, name)| format!("the {name} differ")).collect()
}
