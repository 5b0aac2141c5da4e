//! The side-car that stands beside every output: `<artifact>.prov.json`.
//!
//! It holds no time, host or path: the same inputs give the same bytes.

use crate::{Document, FileRef, Kind, Result, Staged, Violation, stage_bytes};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What made an output, from what, and how well.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Stage and, where it has some, subcommand.
    pub stage: String,
    /// Version of the stage.
    pub version: String,
    /// All parameters, defaults included.
    pub parameters: serde_json::Value,
    /// Inputs by role: name and SHA-256, which is empty for standard input.
    #[schemars(with = "BTreeMap<String, FileRef>")]
    pub inputs: serde_json::Map<String, serde_json::Value>,
    /// Residuals and counts.
    pub results: serde_json::Map<String, serde_json::Value>,
}

impl Kind for Provenance {
    const NAME: &'static str = "provenance";
    const VERSION: u32 = 1;
}

impl Document for Provenance {
    fn check(&self) -> std::result::Result<(), Violation> {
        match self.inputs.iter().find(|(_, file)| serde_json::from_value::<FileRef>((*file).clone()).is_err())
        {
            Some((role, _)) => Err(Violation::new(format!("input {role}"), "is not a file's name and hash")),
            None => Ok(()),
        }
    }
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
        serde_json::to_vec_pretty(&serde_json::json!({ "schema": format!("{}/{}", Provenance::NAME, Provenance::VERSION), "data": provenance }))
            .map_err(|error| {
                crate::Error::new(artifact, format!("its side-car cannot be written: {error}"))
            })?;
    bytes.push(b'\n');
    stage_bytes(&path_beside(artifact), &bytes)
}
