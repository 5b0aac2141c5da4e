//! Read, clip, write the mesh and its map.

use super::Arguments;
use anyhow::{Context, bail};
use artifact::{Document, MeshRef, VertexMapping, VertexPath, VertexSet, file_name, sha256};
use mesh_clip::{Clipped, Mask, Params, Picks, clip};
use serde::Serialize;
use stage::Run;
use std::path::{Path, PathBuf};

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    let params = parameters(&arguments);
    let cut = arguments.cut.iter().map(|cut| cut.0.clone()).collect();
    run.parameters(&Recorded { params: &params, cut })?;
    let (mesh, old) = arguments.scan.read(run)?;
    let keep = sets(run, "keep", &arguments.keep, &old)?;
    let remove = sets(run, "remove", &arguments.remove, &old)?;
    let cuts = cuts(run, &arguments, &old)?;
    let mask = arguments.uv_mask.as_deref().map(|path| mask(run, path)).transpose()?;
    let picks = Picks { keep: slices(&keep), remove: slices(&remove), cuts: slices(&cuts), mask };
    let clipped = clip(&mesh, &picks, &params).with_context(|| arguments.scan.mesh.display().to_string())?;
    report(run, &mesh, &clipped, !cuts.is_empty());
    publish(run, &arguments, old, clipped)
}

/// What the side-car says of the parameters.
#[derive(Serialize)]
struct Recorded<'a> {
    #[serde(flatten)]
    params: &'a Params,
    /// Cuts that were given by vertex on the command line.
    cut: Vec<Vec<u32>>,
}

fn parameters(arguments: &Arguments) -> Params {
    Params {
        keep_regions: [&arguments.keep_sphere, &arguments.keep_above, &arguments.keep_below]
            .into_iter()
            .flatten()
            .cloned()
            .collect(),
        remove_regions: arguments.remove_box.clone(),
        touching: arguments.touching,
        slit_width_mm: arguments.slit_width_mm,
        mask_level: arguments.mask_level,
        drop_non_manifold: arguments.drop_non_manifold,
        keep_largest_component: arguments.keep_largest_component,
    }
}

fn slices(lists: &[Vec<u32>]) -> Vec<&[u32]> {
    lists.iter().map(Vec::as_slice).collect()
}

fn sets(run: &mut Run, role: &str, paths: &[PathBuf], mesh: &MeshRef) -> anyhow::Result<Vec<Vec<u32>>> {
    let read = |(i, path): (usize, &PathBuf)| {
        let set: VertexSet =
            picked(run, &format!("{role} {}", i + 1), path, mesh, |set: &VertexSet| &set.mesh)?;
        Ok(set.vertices)
    };
    paths.iter().enumerate().map(read).collect()
}

fn cuts(run: &mut Run, arguments: &Arguments, mesh: &MeshRef) -> anyhow::Result<Vec<Vec<u32>>> {
    let mut cuts: Vec<Vec<u32>> = Vec::new();
    for (i, path) in arguments.cut_along.iter().enumerate() {
        let role = format!("cut {}", i + 1);
        let line: VertexPath = picked(run, &role, path, mesh, |line: &VertexPath| &line.mesh)?;
        cuts.push(line.vertices);
    }
    cuts.extend(arguments.cut.iter().map(|cut| cut.0.clone()));
    Ok(cuts)
}

/// Reads what was picked on a mesh, and refuses it if that was another one.
fn picked<T: Document>(
    run: &mut Run,
    role: &str,
    path: &Path,
    mesh: &MeshRef,
    of: impl Fn(&T) -> &MeshRef,
) -> anyhow::Result<T> {
    let document: T = artifact::read_document(path)?;
    if let Some(why) = of(&document).mismatch(mesh) {
        bail!(
            "{}: {why}\n  to do: pick again on this mesh, or give the mesh it was made for",
            path.display()
        );
    }
    run.input(role, path)?;
    Ok(document)
}

fn mask(run: &mut Run, path: &Path) -> anyhow::Result<Mask> {
    let picture = artifact::picture::read_gray(path)?;
    run.input("uv mask", path)?;
    Ok(Mask { width: picture.width, height: picture.height, texels: picture.pixels })
}

fn report(run: &mut Run, mesh: &mesh::Mesh, clipped: &Clipped, has_cuts: bool) {
    run.result("vertices", clipped.mesh.positions.len());
    run.result("faces", clipped.mesh.polygons.len());
    run.result("faces_removed", mesh.polygons.len() - clipped.mesh.polygons.len());
    run.result("slit_vertices", clipped.slit_vertices);
    run.result("non_manifold_edges_mended", clipped.dropped.non_manifold_edges);
    run.result("bow_ties_mended", clipped.dropped.bow_ties);
    run.result("faces_dropped_to_mend", clipped.dropped.faces);
    run.result("components_dropped", clipped.dropped_components);
    let triangles = clipped.mesh.triangles();
    let around = mesh::Connectivity::of(clipped.mesh.positions.len(), &triangles);
    run.result("components", around.components().1);
    run.result("boundary_loops", around.boundary_loops().len());
    if has_cuts && clipped.slit_vertices == 0 {
        run.warn("the cuts double no vertex: a cut must reach the boundary, be closed, or have a vertex between its ends");
    }
    let faults = around.non_manifold_edges().len() + around.bow_ties().len();
    if faults > 0 {
        run.warn(format!(
            "{faults} non-manifold edges and bow-tie vertices are left; --drop-non-manifold takes them out"
        ));
    }
}

fn publish(run: &mut Run, arguments: &Arguments, old: MeshRef, clipped: Clipped) -> anyhow::Result<()> {
    let out = artifact::write_mesh(&arguments.out, &clipped.mesh, old.unit)?;
    // The map refers to the mesh by the hash of its bytes, which stand under a temporary name until all is written.
    let Some(written) = out.temporary() else {
        bail!("--out cannot be standard output: the map refers to a file")
    };
    let file = artifact::FileRef { name: file_name(&arguments.out), sha256: sha256(written)? };
    let new = MeshRef { file, unit: old.unit, vertex_count: clipped.mesh.positions.len() };
    let mapping =
        VertexMapping { old, new, new_from_old: clipped.new_from_old, old_from_new: clipped.old_from_new };
    let map = artifact::write_document(&arguments.map, &mapping)?;
    run.publish(vec![out, map])
}
