//! The side-car that stands beside every output: `<artifact>.prov.json`.
//!
//! It holds no time, host or path: the same inputs give the same bytes.

use crate::{FileRef, Result, Staged, stage_bytes};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What made an output, from what, and how well.
#[derive(Debug, Clone, Serialize)]
pub struct Provenance {
    /// Stage and, where it has some, subcommand.
    pub stage: String,
    /// Version of the stage.
    pub version: String,
    /// All parameters, defaults included.
    pub parameters: serde_json::Value,
    /// Inputs by role.
    pub inputs: serde_json::Map<String, serde_json::Value>,
    /// Residuals and counts.
    pub results: serde_json::Map<String, serde_json::Value>,
}

impl Provenance {
    /// Records an input.
    pub fn add_input(&mut self, role: &str, file: &FileRef) {
        self.inputs.insert(role.to_string(), serde_json::json!({ "name": file.name, "sha256": file.sha256 }));
    }
}

/// Where the side-car of an artifact stands.
#[must_use]
pub fn path_beside(artifact: &Path) -> PathBuf {
    let mut name = artifact.as_os_str().to_os_string();
    name.push(".prov.json");
    name.into()
}

/// Writes the side-car of an artifact.
///
/// # Errors
/// If it cannot be written.
pub fn write(artifact: &Path, provenance: &Provenance) -> Result<Staged> {
    let mut bytes =
        serde_json::to_vec_pretty(&serde_json::json!({ "schema": "provenance/1", "data": provenance }))
            .map_err(|error| {
                crate::Error::new(artifact, format!("its side-car cannot be written: {error}"))
            })?;
    bytes.push(b'\n');
    stage_bytes(&path_beside(artifact), &bytes)
}
