//! Meshes of any supported format, by the file's ending.

use crate::{Error, Result, Staged, Unit, Violation, obj, ply};
use mesh::Mesh;
use std::path::Path;

/// Reads a mesh (`.obj`, `.ply`); positions come out in millimetres.
///
/// # Errors
/// If the ending is unknown or the file cannot be read.
pub fn read_mesh(path: &Path, unit: Unit) -> Result<Mesh> {
    match ending(path).as_str() {
        "obj" => obj::read(path, unit),
        "ply" => ply::read(path, unit),
        _ => Err(unknown(path)),
    }
}

/// Writes a mesh (`.obj`, `.ply`), given in millimetres, in `unit`.
///
/// # Errors
/// If the ending is unknown or the file cannot be written.
pub fn write_mesh(path: &Path, mesh: &Mesh, unit: Unit) -> Result<Staged> {
    match ending(path).as_str() {
        "obj" => obj::write(path, mesh, unit),
        "ply" => ply::write(path, mesh, unit),
        _ => Err(unknown(path)),
    }
}

/// Refuses a mesh with a number that is not finite: every writer asks.
pub(crate) fn check_finite(mesh: &Mesh) -> std::result::Result<(), Violation> {
    let refuse = |place: String, what: &str| Err(Violation::new(place, format!("the {what} is not finite")));
    if let Some(vertex) = mesh.positions.iter().position(|point| point.iter().any(|x| !x.is_finite())) {
        return refuse(format!("vertex {vertex}"), "position");
    }
    if let Some(vertex) = mesh.colors.iter().position(|color| color.iter().any(|x| !x.is_finite())) {
        return refuse(format!("vertex {vertex}"), "colour");
    }
    match mesh.uvs.iter().position(|uv| uv.iter().any(|x| !x.is_finite())) {
        Some(uv) => refuse(format!("texture coordinate {uv}"), "value"),
        None => Ok(()),
    }
}

pub(crate) fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

fn unknown(path: &Path) -> Error {
    Error::new(path, "has an ending that is no mesh format known here").fix("use .obj or .ply")
}
