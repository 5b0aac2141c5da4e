//! `response-basis/1`: how every vertex answers to a unit displacement of each handle, as a NumPy array beside a
//! JSON header.

use crate::{Document, FileRef, Handle, Kind, MeshRef, Violation, finite};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Header of a response basis; the array (#V × n, float32) stands in a `.npy` file beside it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ResponseBasis {
    /// The mesh.
    pub mesh: MeshRef,
    /// The handles: the array's columns.
    pub handles: Vec<Handle>,
    /// Parameters of the shell, as in the side-car of the stage that solved it.
    pub parameters: serde_json::Value,
    /// The array's file, in the same folder.
    pub array: FileRef,
    /// The handles' Schur complement, n × n: the energy's Hessian in the handles' displacements alone. Missing and
    /// soft handles are solved with it.
    pub schur: Vec<Vec<f64>>,
}

impl Kind for ResponseBasis {
    const NAME: &'static str = "response-basis";
    const VERSION: u32 = 1;
}

impl Document for ResponseBasis {
    fn check(&self) -> Result<(), Violation> {
        let count = self.handles.len();
        if self.schur.len() != count || self.schur.iter().any(|row| row.len() != count) {
            return Err(Violation::new("schur", format!("is not {count} × {count}")));
        }
        finite("schur", self.schur.iter().flatten())
    }
}
