//! Meshes of any supported format, by the file's ending.

use crate::source::ending;
use crate::{Error, Result, Staged, Unit, obj, ply};
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

fn unknown(path: &Path) -> Error {
    Error::new(path, "has an ending that is no mesh format known here").fix("use .obj or .ply")
}
