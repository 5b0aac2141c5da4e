//! Read, refine, write.

use super::Arguments;
use anyhow::{Context, bail};
use artifact::{GreenAxis, npy, picture};
use mesh::Mesh;
use nalgebra::Vector3;
use scan_refine::{Measured, NormalMap, Params, Report, Space, crossover_of_lambda, refine};
use stage::Run;
use std::path::Path;

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    let params = parameters(&arguments);
    params.check()?;
    run.parameters(&params)?;
    let (mesh, reference) = arguments.scan.read(run)?;
    let measured = measured(run, &arguments, &mesh)?;
    run.check_outputs(&[&arguments.out])?;
    run.check_folders(&[&arguments.out])?;
    let refined = run.timed("refinement", || refine(&mesh, &measured, &params));
    let refined = refined.with_context(|| arguments.scan.mesh.display().to_string())?;
    tell(run, &refined.report);
    let out = artifact::write_mesh(&arguments.out, &mesh.with_positions(refined.positions), reference.unit)?;
    run.publish(vec![out])
}

fn parameters(arguments: &Arguments) -> Params {
    Params {
        crossover_mm: arguments.lambda.map_or(arguments.crossover_mm, crossover_of_lambda),
        bias_mm: arguments.bias_mm,
        iterations: arguments.iterations,
    }
}

/// The normals from whichever file was named, with the trust that another gives them.
fn measured(run: &mut Run, arguments: &Arguments, mesh: &Mesh) -> anyhow::Result<Measured> {
    let green = if arguments.directx { GreenAxis::Directx } else { GreenAxis::Opengl };
    let mut measured = match (&arguments.object_map, &arguments.tangent_map, &arguments.vertex_normals) {
        (Some(path), _, _) => mapped(run, path, mesh, Space::Object, green)?,
        (_, Some(path), _) => mapped(run, path, mesh, Space::Tangent, green)?,
        (_, _, Some(path)) => per_vertex(run, path, mesh)?,
        _ => bail!("no normals are given"),
    };
    if let Some(path) = &arguments.confidence {
        let ([_, columns], values) = npy::read_f32(path)?;
        if columns != 1 {
            bail!(
                "{}: has {columns} columns, not 1\n  to do: give one confidence per vertex",
                path.display()
            );
        }
        run.input("confidence", path)?;
        let values: Vec<f64> = values.into_iter().map(f64::from).collect();
        measured.weigh(&values).with_context(|| path.display().to_string())?;
    }
    Ok(measured)
}

fn mapped(
    run: &mut Run,
    path: &Path,
    mesh: &Mesh,
    space: Space,
    green: GreenAxis,
) -> anyhow::Result<Measured> {
    let picture = picture::read_rgb(path)?;
    run.input("normal map", path)?;
    let (width, height) = (picture.width, picture.height);
    let shares = (0..width * height).map(|texel| picture.at(texel % width, texel / width));
    let named = || path.display().to_string();
    let map = NormalMap::new(width, height, shares).with_context(named)?;
    run.timed("map", || map.measure(mesh, space, green)).with_context(named)
}

fn per_vertex(run: &mut Run, path: &Path, mesh: &Mesh) -> anyhow::Result<Measured> {
    let ([rows, columns], values) = npy::read_f32(path)?;
    if columns != 3 || rows != mesh.positions.len() {
        bail!(
            "{}: is {rows} × {columns}, but the mesh has {} vertices\n  to do: give the normals of this mesh, one row of 3 each",
            path.display(),
            mesh.positions.len()
        );
    }
    run.input("vertex normals", path)?;
    let normals = values.chunks_exact(3).map(|row| Vector3::new(row[0], row[1], row[2]).cast::<f64>());
    Measured::per_vertex(normals.collect()).with_context(|| path.display().to_string())
}

/// Less than this share of vertices with a normal is worth a warning.
const LITTLE: f64 = 0.5;

fn tell(run: &mut Run, report: &Report) {
    run.result("coverage", report.coverage);
    run.result("bias_degrees", report.bias_degrees);
    run.result("before_degrees", report.before_degrees);
    run.result("after_degrees", report.after_degrees);
    run.result("moved_rms_mm", report.moved_rms_mm);
    run.result("moved_max_mm", report.moved_max_mm);
    run.result("folded_triangles", report.folded_triangles);
    if report.folded_triangles > 0 {
        run.warn(format!(
            "{} triangles face away from their normals: the scan's noise along the surface is as large as its edges there; smooth \
             or thin it out first",
            report.folded_triangles
        ));
    }
    if report.coverage < LITTLE {
        run.warn(format!(
            "only {:.0} % of the vertices have a normal; the others stay",
            100.0 * report.coverage
        ));
    }
    if report.after_degrees > report.before_degrees {
        run.warn(
            "the refined surface agrees less with the normals than the scan did: they may have green the other way round, \
             or belong to another pose",
        );
    }
}
