//! The two surfaces, in one pose.

use super::Arguments;
use anyhow::{Context, bail};
use artifact::{MeshRef, MeshSequence, Unit, gltf};
use bake::{High, Low, follow};
use mesh::Mesh;
use nalgebra::Point3;
use stage::Run;
use std::path::Path;

/// What is baked, and onto what.
pub(crate) struct Surfaces {
    pub(crate) low: Low,
    pub(crate) low_ref: MeshRef,
    pub(crate) high: High,
}

pub(crate) fn read(run: &mut Run, arguments: &Arguments) -> anyhow::Result<Surfaces> {
    let (path, mesh, unit, points) = wrinkled(run, arguments)?;
    let (mut low, low_ref) = low_mesh(run, arguments, unit)?;
    if let (Some(large), Some(frame)) = (&arguments.large_scale, arguments.frame) {
        let moved = positions(run, "large-scale", large, unit, frame, &mesh)?;
        let moved = follow(&low.positions, &mesh, &moved).with_context(|| large.display().to_string())?;
        low = low.with_positions(moved);
    }
    let high = run.timed("tree", || High::of(&mesh, &points)).with_context(|| path.display().to_string())?;
    let low = Low::of(&low).with_context(|| arguments.low.display().to_string())?;
    Ok(Surfaces { low, low_ref, high })
}

/// The low-resolution mesh in its neutral pose; `unit` is that of the wrinkled one.
fn low_mesh(run: &mut Run, arguments: &Arguments, unit: Unit) -> anyhow::Result<(Mesh, MeshRef)> {
    let path = &arguments.low;
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    if !ending.is_some_and(|ending| ending == "glb" || ending == "gltf") {
        if arguments.low_mesh.is_some() {
            bail!(
                "--low-mesh: {} holds one mesh only\n  to do: leave it out, or give a .glb or .gltf",
                path.display()
            );
        }
        return run.mesh("low", path, &[("--low-unit", arguments.low_unit.or(Some(unit)))]);
    }
    let (character, warnings) = gltf::read(path)?;
    warnings.into_iter().for_each(|warning| run.warn(warning));
    let file = run.input("low", path)?;
    let unit = arguments.low_unit.unwrap_or(Unit::M);
    let named = |name: &String| character.meshes.iter().find(|mesh| mesh.name == *name);
    let largest = || character.meshes.iter().rev().max_by_key(|mesh| mesh.positions.len());
    let Some(chosen) = arguments.low_mesh.as_ref().map_or_else(largest, named) else {
        let known: Vec<&str> = character.meshes.iter().map(|mesh| mesh.name.as_str()).collect();
        bail!("{}: has no such mesh\n  to do: --low-mesh knows {}", path.display(), known.join(", "));
    };
    run.detail(&format!("  low: {} of {} meshes", chosen.name, character.meshes.len()));
    let mesh = chosen.bound(unit);
    let reference = MeshRef { file, unit, vertex_count: mesh.positions.len() };
    Ok((mesh, reference))
}

/// The wrinkled mesh: its file, at rest, its unit, and where its vertices are, mm.
fn wrinkled<'a>(
    run: &mut Run,
    arguments: &'a Arguments,
) -> anyhow::Result<(&'a Path, Mesh, Unit, Vec<Point3<f64>>)> {
    match (&arguments.high, &arguments.mesh, &arguments.wrinkled, arguments.frame) {
        (Some(path), ..) => {
            let (mesh, reference) = run.mesh("high", path, &[("--unit", arguments.unit)])?;
            let points = mesh.positions.clone();
            Ok((path, mesh, reference.unit, points))
        }
        (None, Some(path), Some(sequence), Some(frame)) => {
            let by_index = MeshSequence::open(sequence, arguments.unit)?.mesh().map(|mesh| mesh.unit);
            let stated = [("--unit", arguments.unit), ("the sequence", by_index)];
            let (mesh, reference) = run.mesh("mesh", path, &stated)?;
            if let Some(why) = MeshSequence::open(sequence, arguments.unit)?
                .mesh()
                .and_then(|mesh| mesh.mismatch(&reference))
            {
                bail!("{}: {why}\n  to do: give the mesh that the sequence was made for", sequence.display());
            }
            let points = positions(run, "wrinkled", sequence, reference.unit, frame, &mesh)?;
            Ok((path, mesh, reference.unit, points))
        }
        _ => bail!("no wrinkled mesh is given\n  to do: give --high, or --mesh, --wrinkled and --frame"),
    }
}

/// A frame of a sequence.
fn positions(
    run: &mut Run,
    role: &str,
    path: &Path,
    unit: Unit,
    frame: i64,
    mesh: &Mesh,
) -> anyhow::Result<Vec<Point3<f64>>> {
    let sequence = MeshSequence::open(path, Some(unit))?;
    if sequence.vertex_count() != mesh.positions.len() {
        bail!(
            "{}: has {} vertices, but the mesh has {}\n  to do: give sequences of the same mesh",
            path.display(),
            sequence.vertex_count(),
            mesh.positions.len()
        );
    }
    run.input(role, path)?;
    if let Some(cache) = sequence.cache() {
        run.input(&format!("{role} cache"), cache)?;
    }
    Ok(sequence.cursor()?.read(frame)?)
}
