//! Read, remove, write.

use super::Arguments;
use super::region::region;
use anyhow::Context;
use artifact::{Staged, picture};
use mesh::Mesh;
use serde::Serialize;
use stage::Run;
use wrinkle_removal::{Detection, Params, Report, Smoothed, draw, remove};

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    let params = parameters(&arguments);
    params.check()?;
    let detection = detection(&arguments);
    let (reach, detect) = (arguments.reach, arguments.detect.then_some(&detection));
    run.parameters(&Recorded { removal: &params, reach, frame: arguments.frame, detect })?;
    let (mesh, reference) = arguments.scan.read(run)?;
    let outputs: Vec<_> =
        [Some(arguments.out.as_path()), arguments.show.as_deref()].into_iter().flatten().collect();
    let weights = region(run, &arguments, &mesh, &reference, &detection)?;
    run.check_outputs(&outputs)?;
    run.check_folders(&outputs)?;
    let smoothed = run.timed("removal", || remove(&mesh, &weights, &params));
    let smoothed = smoothed.with_context(|| arguments.scan.mesh.display().to_string())?;
    tell(run, &smoothed.report, &params);
    let mut staged = show(&arguments, &mesh, &smoothed, &weights)?;
    staged.insert(
        0,
        artifact::write_mesh(&arguments.out, &mesh.with_positions(smoothed.positions), reference.unit)?,
    );
    run.publish(staged)
}

/// What the side-car says of the parameters.
#[derive(Serialize)]
struct Recorded<'a> {
    #[serde(flatten)]
    removal: &'a Params,
    reach: f64,
    frame: Option<i64>,
    detect: Option<&'a Detection>,
}

fn parameters(arguments: &Arguments) -> Params {
    let Arguments { detail_mm, detail_limit, shape_mm, strength, feather_mm, .. } = *arguments;
    match arguments.paper {
        true => Params { detail_mm, strength, feather_mm, ..Params::paper() },
        false => Params { detail_mm, detail_limit, shape_mm, strength, feather_mm, ..Params::default() },
    }
}

fn detection(arguments: &Arguments) -> Detection {
    let Arguments { width_mm, curvature_per_mm, reach, .. } = *arguments;
    Detection { width_mm, curvature_per_mm, reach, ..Detection::default() }
}

fn tell(run: &mut Run, report: &Report, params: &Params) {
    run.result("region_vertices", report.region_vertices);
    run.result("held_on_boundary", report.held_on_boundary);
    run.result("moved_rms_mm", report.moved_rms_mm);
    run.result("moved_max_mm", report.moved_max_mm);
    run.result("detail_rms_mm", report.detail_rms_mm);
    run.result("edge_mm", report.edge_mm);
    run.result("tempered_triangles", report.tempered_triangles);
    if report.held_on_boundary > 0 {
        run.warn(format!(
            "{} vertices of the region lie on the mesh's boundary and stay; wrinkles that run into it fade towards it",
            report.held_on_boundary
        ));
    }
    if 2.0 * report.edge_mm > params.detail_mm {
        run.warn(format!(
            "edges of {:.2} mm in the region cannot show detail of {} mm, so there is none to keep; subdivide the scan, or raise \
             --detail-mm above {:.1}",
            report.edge_mm,
            params.detail_mm,
            2.0 * report.edge_mm
        ));
    }
}

fn show(
    arguments: &Arguments,
    mesh: &Mesh,
    smoothed: &Smoothed,
    weights: &[f64],
) -> anyhow::Result<Vec<Staged>> {
    let Some(path) = &arguments.show else { return Ok(Vec::new()) };
    let drawn = draw(mesh, &smoothed.positions, weights);
    Ok(vec![picture::write_rgb8(path, drawn.width, drawn.height, &drawn.rgb)?])
}
