//! `--refine`: the scan with more vertices where valleys need them.

use super::Arguments;
use anyhow::Context;
use artifact::{FileRef, MeshRef, Staged, ValleysFrame};
use mesh::Mesh;
use nalgebra::Point3;
use shell_synth::{Params, Refinement};
use stage::Run;
use std::fmt::Write;

/// The mesh that wrinkles are put on.
pub(crate) struct Ground {
    pub(crate) mesh: Mesh,
    pub(crate) mesh_ref: MeshRef,
    pub(crate) valleys: Vec<ValleysFrame>,
    refinement: Option<Refinement>,
    /// The finer scan and its map, written but not shown yet.
    pub(crate) staged: Vec<Staged>,
}

impl Ground {
    /// The scan itself, or a finer one if that is asked for.
    pub(crate) fn new(
        run: &mut Run,
        arguments: &Arguments,
        (mesh, mesh_ref): (Mesh, MeshRef),
        ids: &[String],
        valleys: Vec<ValleysFrame>,
        params: &Params,
    ) -> anyhow::Result<Self> {
        let Some(path) = &arguments.refine else {
            return Ok(Self { mesh, mesh_ref, valleys, refinement: None, staged: Vec::new() });
        };
        let refinement = run
            .timed("refine", || Refinement::new(&mesh, ids, &valleys, arguments.refine_edges, params))
            .with_context(|| format!("{} with {}", arguments.mesh.display(), arguments.valleys.display()))?;
        run.result("added_vertices", refinement.parents.len());
        let scan = artifact::write_mesh(path, &refinement.mesh, mesh_ref.unit)?;
        let sha256 = artifact::sha256(scan.temporary().unwrap_or(path))?;
        let file = FileRef { name: artifact::file_name(path), sha256 };
        let vertex_count = refinement.mesh.positions.len();
        let map = artifact::stage_bytes(&path.with_extension("csv"), map(&mesh, &refinement).as_bytes())?;
        Ok(Self {
            mesh: refinement.mesh.clone(),
            mesh_ref: MeshRef { file, unit: mesh_ref.unit, vertex_count },
            valleys: refinement.valleys(&mesh, &valleys),
            refinement: Some(refinement),
            staged: vec![scan, map],
        })
    }

    /// A frame of the scan as one of this mesh.
    pub(crate) fn carry(&self, positions: Vec<Point3<f64>>) -> Vec<Point3<f64>> {
        match &self.refinement {
            Some(refinement) => refinement.carry(&positions),
            None => positions,
        }
    }
}

/// Per vertex that was added the two that it is the middle of.
fn map(scan: &Mesh, refinement: &Refinement) -> String {
    let mut table = "vertex,first,second\n".to_string();
    for (number, [first, second]) in refinement.parents.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(table, "{},{first},{second}", scan.positions.len() + number);
    }
    table
}
