//! The scan as a page draws it.

use super::Bench;
use anyhow::Context;
use loopback::Response;
use workbench::{SCAN, buffers};

/// So many vertices are drawn while the scan turns.
const COARSE: usize = 40_000;

/// `scan` or `scan-coarse`.
pub(crate) fn mesh(bench: &Bench, name: &str) -> anyhow::Result<Response> {
    let path = bench.find(SCAN).context("the take has no scan.obj or scan.ply")?;
    let unit = bench.manifest.as_ref().map(|take| take.mesh_unit);
    let unit = stage::resolve_unit(&path, &[("the take manifest", unit)])?;
    let mesh = artifact::read_mesh(&path, unit)?;
    let triangles = mesh.triangles();
    let bytes = match name {
        "scan" => buffers::encode(&mesh.positions, &triangles)?,
        "scan-coarse" => {
            let area = mesh::triangle_areas(&mesh.positions, &triangles).iter().sum();
            let (points, triangles) =
                buffers::coarse(&mesh.positions, &triangles, buffers::cell_for(area, COARSE));
            buffers::encode(&points, &triangles)?
        }
        _ => return Ok(Response::missing()),
    };
    Ok(Response::bytes("application/octet-stream", bytes))
}
