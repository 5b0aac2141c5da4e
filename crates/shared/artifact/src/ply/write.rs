//! PLY, out.

use crate::{Error, Result, Sink, Staged, Unit};
use mesh::{Mesh, NO_UV};
use nalgebra::Vector2;
use std::io::Write;
use std::path::Path;

/// Writes a mesh; positions are taken as millimetres and written in `unit`, as doubles. Texture coordinates go with
/// the vertices where each vertex has one, else with the corners; a face with a corner that has none loses its others.
///
/// # Errors
/// If a number is not finite or the file cannot be written.
pub fn write(path: &Path, mesh: &Mesh, unit: Unit) -> Result<Staged> {
    crate::finite::check_finite(mesh).map_err(|violation| violation.in_file(path))?;
    let textures = Textures::of(mesh);
    let mut sink = Sink::create(path)?;
    let mut write = || {
        sink.write_all(header(mesh, &textures).as_bytes())?;
        write_vertices(&mut sink, mesh, &textures, unit.in_mm())?;
        write_faces(&mut sink, mesh, &textures)
    };
    write().map_err(|cause| Error::io(path, "write", &cause))?;
    sink.finish()
}

/// Where a mesh's texture coordinates can stand.
enum Textures {
    None,
    Vertices(Vec<Vector2<f64>>),
    Corners,
}

impl Textures {
    fn of(mesh: &Mesh) -> Self {
        if mesh.corner_uvs.iter().all(|&uv| uv == NO_UV) {
            return Self::None;
        }
        let mut of_vertices: Vec<Option<Vector2<f64>>> = vec![None; mesh.positions.len()];
        for (&vertex, &uv) in mesh.polygons.corners().iter().zip(&mesh.corner_uvs) {
            let uv = if uv == NO_UV { return Self::Corners } else { mesh.uvs[uv as usize] };
            if *of_vertices[vertex as usize].get_or_insert(uv) != uv {
                return Self::Corners;
            }
        }
        Self::Vertices(of_vertices.into_iter().map(Option::unwrap_or_default).collect())
    }
}

/// The type that counts a face's corners: a byte, as all readers know it, unless a polygon is too large for it.
fn wide_counts(mesh: &Mesh, textures: &Textures) -> bool {
    let per_corner = if matches!(textures, Textures::Corners) { 2 } else { 1 };
    mesh.polygons.iter().any(|polygon| polygon.len() * per_corner > usize::from(u8::MAX))
}

fn header(mesh: &Mesh, textures: &Textures) -> String {
    let count = if wide_counts(mesh, textures) { "uint" } else { "uchar" };
    let mut lines = vec!["ply".to_string(), "format binary_little_endian 1.0".to_string()];
    let mut properties = |kind: &str, names: &[&str]| {
        lines.extend(names.iter().map(|name| format!("property {kind} {name}")));
    };
    properties("double", &["x", "y", "z"]);
    if !mesh.colors.is_empty() {
        properties("uchar", &["red", "green", "blue"]);
    }
    if matches!(textures, Textures::Vertices(_)) {
        properties("float", &["s", "t"]);
    }
    lines.insert(2, format!("element vertex {}", mesh.positions.len()));
    lines.push(format!("element face {}", mesh.polygons.len()));
    lines.push(format!("property list {count} int vertex_indices"));
    if matches!(textures, Textures::Corners) {
        lines.push(format!("property list {count} float texcoord"));
    }
    lines.push("end_header\n".to_string());
    lines.join("\n")
}

fn write_vertices(out: &mut impl Write, mesh: &Mesh, textures: &Textures, scale: f64) -> std::io::Result<()> {
    for (vertex, point) in mesh.positions.iter().enumerate() {
        for x in point.iter() {
            out.write_all(&(x / scale).to_le_bytes())?;
        }
        if let Some(color) = mesh.colors.get(vertex) {
            out.write_all(&color.map(|x| (x.clamp(0.0, 1.0) * 255.0).round() as u8))?;
        }
        if let Textures::Vertices(uvs) = textures {
            write_uv(out, uvs[vertex])?;
        }
    }
    Ok(())
}

fn write_uv(out: &mut impl Write, uv: Vector2<f64>) -> std::io::Result<()> {
    out.write_all(&(uv.x as f32).to_le_bytes())?;
    out.write_all(&(uv.y as f32).to_le_bytes())
}

fn write_faces(out: &mut impl Write, mesh: &Mesh, textures: &Textures) -> std::io::Result<()> {
    let wide = wide_counts(mesh, textures);
    let write_count = |out: &mut dyn Write, count: usize| match wide {
        true => out.write_all(&(count as u32).to_le_bytes()),
        false => out.write_all(&[count as u8]),
    };
    for (face, polygon) in mesh.polygons.iter().enumerate() {
        write_count(out, polygon.len())?;
        for vertex in polygon {
            out.write_all(&vertex.to_le_bytes())?;
        }
        if matches!(textures, Textures::Corners) {
            let uvs = &mesh.corner_uvs[mesh.polygons.corner_range(face)];
            let uvs = if uvs.contains(&NO_UV) { &[] } else { uvs };
            write_count(out, uvs.len() * 2)?;
            uvs.iter().try_for_each(|&uv| write_uv(out, mesh.uvs[uv as usize]))?;
        }
    }
    Ok(())
}
