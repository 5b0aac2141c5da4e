//! Meshes of any supported format, by the file's ending.

use crate::{Error, Result, Staged, Unit, obj};
use mesh::Mesh;
use std::path::Path;

/// Reads a mesh (`.obj`); positions come out in millimetres.
///
/// # Errors
/// If the ending is unknown or the file cannot be read.
pub fn read_mesh(path: &Path, unit: Unit) -> Result<Mesh> {
    match ending(path).as_str() {
        "obj" => obj::read(path, unit),
        _ => Err(unknown(path)),
    }
}

/// Writes a mesh (`.obj`), given in millimetres, in `unit`.
///
/// # Errors
/// If the ending is unknown or the file cannot be written.
pub fn write_mesh(path: &Path, mesh: &Mesh, unit: Unit) -> Result<Staged> {
    match ending(path).as_str() {
        "obj" => obj::write(path, mesh, unit),
        _ => Err(unknown(path)),
    }
}

pub(crate) fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

fn unknown(path: &Path) -> Error {
    Error::new(path, "has an ending that is no mesh format known here").fix("use .obj or .ply")
}
