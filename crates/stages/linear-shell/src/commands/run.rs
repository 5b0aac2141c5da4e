//! The run: read, survey, factor, frame after frame, write.

use super::Arguments;
use super::cache::Cache;
use super::output::Output;
use super::solver::Solver;
use super::take::HandleTake;
use anyhow::{Context, bail};
use artifact::{FrameRange, HandleFrame, LargeScale, MeshRef, VertexSet};
use linear_shell::{Constraints, LeaveOneOut, Surface, Survey, TearWatch};
use mesh::Mesh;
use nalgebra::Vector3;
use serde_json::json;
use stage::Run;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Frames that are combined in one pass over the response basis.
const BATCH: usize = 16;

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    arguments.check()?;
    let mut take = HandleTake::open(&arguments.handles, arguments.frames.unwrap_or(FrameRange::ALL))?;
    let (mesh, mesh_ref) = read_mesh(run, &arguments, &take)?;
    let handles_file = run.input("handles", &arguments.handles)?;
    let constraints = Constraints {
        handles: take.header.handles.iter().map(|handle| handle.vertex).collect(),
        held: read_held(run, &arguments, &mesh_ref)?,
    };
    run.check_outputs(&arguments.outputs().iter().map(PathBuf::as_path).collect::<Vec<_>>())?;
    let params = arguments.params();
    run.parameters(&json!({
        "shell": params, "reference": arguments.reference, "mode": arguments.mode, "soft": arguments.soft
    }))?;
    let survey = || Surface::survey(&mesh, &constraints, &params);
    let surface = run
        .timed("assembly", survey)
        .with_context(|| format!("{}: cannot become a shell", arguments.mesh.display()))?;
    report_survey(run, surface.report());
    report_take(run, &take);

    let cache = Cache::new(&arguments, &mesh_ref, &take.header.handles, &constraints, &params)?;
    let mut solver = Solver::prepare(run, &arguments, &cache, &surface, &constraints)?;
    if let (Some(path), Some((basis, completion))) = (&arguments.basis, solver.basis()) {
        let staged = cache.write_basis(path, basis, completion)?;
        run.publish(staged)?;
    }
    // The modes agree to rounding only, so a cache is not begun in one and continued in the other.
    let way = (arguments.mode, arguments.frames, arguments.soft);
    let key = format!("{} {} {way:?}", cache.key(), handles_file.sha256);
    let mut output = Output::start(&arguments, &mesh, mesh_ref.unit, &take, &key)?;
    let findings = animate(run, &arguments, &mesh, &surface, &mut take, &mut solver, &mut output)?;
    findings.report(run, &take, &surface, &constraints);
    let index = LargeScale {
        mesh: mesh_ref,
        cache: output.name().to_string(),
        form: arguments.format.form(),
        rate: take.header.rate,
        frames: take.frames.clone(),
        take: take.header.take.clone(),
    };
    run.result("frames", take.frames.len());
    let mut staged = run.timed("write", || output.finish())?;
    staged.push(artifact::write_document(&arguments.out, &index)?);
    run.publish(staged)
}

fn read_mesh(run: &mut Run, arguments: &Arguments, take: &HandleTake) -> anyhow::Result<(Mesh, MeshRef)> {
    let stated = [("--unit", arguments.unit), ("the handles file", Some(take.header.mesh.unit))];
    let (mesh, mesh_ref) = run.mesh("mesh", &arguments.mesh, &stated)?;
    match take.header.mesh.mismatch(&mesh_ref) {
        Some(why) => {
            bail!("{}: {why}\n  to do: give the mesh that the handles were made for", take.path.display())
        }
        None => Ok((mesh, mesh_ref)),
    }
}

fn read_held(run: &mut Run, arguments: &Arguments, mesh: &MeshRef) -> anyhow::Result<Vec<u32>> {
    let Some(path) = &arguments.held else { return Ok(Vec::new()) };
    let set: VertexSet = artifact::read_document(path)?;
    run.input("held", path)?;
    match set.mesh.mismatch(mesh) {
        Some(why) => bail!("{}: {why}", path.display()),
        None => Ok(set.vertices),
    }
}

/// What the frames showed.
struct Findings {
    leave_one_out: LeaveOneOut,
    tears: TearWatch,
}

/// Makes every frame that is not there yet.
fn animate(
    run: &mut Run,
    arguments: &Arguments,
    mesh: &Mesh,
    surface: &Surface,
    take: &mut HandleTake,
    solver: &mut Solver,
    output: &mut Output,
) -> anyhow::Result<Findings> {
    let vertices: Vec<u32> = take.header.handles.iter().map(|handle| handle.vertex).collect();
    let mut findings = Findings {
        leave_one_out: LeaveOneOut::new(vertices.len()),
        tears: TearWatch::new(surface, &vertices),
    };
    let rest: Vec<f32> =
        mesh.positions.iter().flat_map(|point| [point.x as f32, point.y as f32, point.z as f32]).collect();
    let mut done = output.already();
    if done > 0 {
        run.say(&format!("{done} frames are there already"));
    }
    let mut frames = take.frames()?;
    let mut deformed = Vec::new();
    let mut progress = run.progress("frames", Some(take.frames.len() as u64));
    loop {
        let batch: Vec<HandleFrame> = frames.by_ref().take(BATCH).collect::<artifact::Result<_>>()?;
        if batch.is_empty() {
            return Ok(findings);
        }
        let completed: Vec<Vec<Vector3<f64>>> =
            batch.iter().map(|frame| complete(frame, arguments, solver)).collect::<anyhow::Result<_>>()?;
        findings.add(&batch, &completed, solver);
        // What an earlier run left is not made again, but looked at all the same: findings are of the whole take.
        let there = done.min(batch.len());
        done -= there;
        if there < batch.len() {
            write_batch(run, &rest, &batch[there..], &completed[there..], solver, output, &mut deformed)?;
        }
        batch.iter().for_each(|_| progress.step());
    }
}

fn write_batch(
    run: &mut Run,
    rest: &[f32],
    batch: &[HandleFrame],
    completed: &[Vec<Vector3<f64>>],
    solver: &Solver,
    output: &mut Output,
    deformed: &mut Vec<Vec<f32>>,
) -> anyhow::Result<()> {
    if output.wants_fields() {
        let fields = run.timed("frames", || solver.fields(completed));
        let mut pairs = batch.iter().zip(&fields);
        return Ok(pairs.try_for_each(|(frame, field)| output.write_field(frame.frame, field))?);
    }
    let scale = 1.0 / output.unit().in_mm();
    run.timed("frames", || solver.deform(rest, completed, scale, deformed));
    let mut pairs = batch.iter().zip(&*deformed);
    Ok(run.timed("write", || {
        pairs.try_for_each(|(frame, coordinates)| output.write(frame.frame, coordinates))
    })?)
}

/// Where all handles go in a frame: as told, or, missing or soft, as the shell's energy has it.
fn complete(
    frame: &HandleFrame,
    arguments: &Arguments,
    solver: &mut Solver,
) -> anyhow::Result<Vec<Vector3<f64>>> {
    let weights: Vec<Option<f64>> = frame.weights.iter().map(|weight| weight.or(arguments.soft)).collect();
    let told: Option<Vec<Vector3<f64>>> = frame.displacements.iter().copied().collect();
    match told {
        Some(told) if weights.iter().all(Option::is_none) => Ok(told),
        _ => solver
            .completion()
            .complete(&frame.displacements, &weights)
            .with_context(|| format!("frame {}", frame.frame)),
    }
}

impl Findings {
    fn add(&mut self, batch: &[HandleFrame], completed: &[Vec<Vector3<f64>>], solver: &Solver) {
        for (frame, handles) in batch.iter().zip(completed) {
            self.tears.add(handles);
            if let Some(completion) = solver.known_completion() {
                self.leave_one_out.add(completion, &frame.displacements);
            }
        }
    }

    fn report(&self, run: &mut Run, take: &HandleTake, surface: &Surface, constraints: &Constraints) {
        let name = |handle: usize| take.header.handles[handle].marker.clone();
        let errors = self.leave_one_out.errors();
        let known = || errors.iter().enumerate().filter_map(|(i, error)| error.map(|error| (i, error)));
        let per_marker: BTreeMap<String, serde_json::Value> = known()
            .map(|(i, error)| {
                (name(i), json!({ "rms_mm": rounded(error.rms_mm), "worst_mm": rounded(error.worst_mm) }))
            })
            .collect();
        run.result("leave_one_out", per_marker);
        if let Some((i, error)) = known().max_by(|a, b| a.1.rms_mm.total_cmp(&b.1.rms_mm)) {
            run.result("leave_one_out_worst", format!("{} ({:.2} mm rms)", name(i), error.rms_mm));
        }
        let tears = self.tears.tears(surface, &constraints.handles);
        for tear in tears.iter().take(3) {
            run.warn(format!(
                "markers {} and {} move from {:.0} to {:.0} mm apart over a closed surface; is the mouth (or an eye) cut \
                 open in the scan? `mesh-clip` opens it",
                name(tear.handles[0]), name(tear.handles[1]), tear.rest_mm, tear.largest_mm
            ));
        }
        run.result("tears", tears.len());
    }
}

/// Micrometres are enough for a side-car.
fn rounded(mm: f64) -> f64 {
    (mm * 1e3).round() / 1e3
}

fn report_survey(run: &mut Run, survey: &Survey) {
    run.result("surface", survey);
    run.result("vertices", survey.vertices);
    let notes = [
        (survey.unreferenced_vertices, "vertices belong to no face; they stay still"),
        (survey.bow_ties, "bow-tie vertices hinge their fans of triangles"),
        (survey.held_components, "parts of the mesh have no handle; they stay still"),
        (survey.tempered_triangles, "needle triangles were tempered"),
        (survey.collapsed_triangles, "triangles are points; they were left out"),
    ];
    for (count, what) in notes.into_iter().filter(|note| note.0 > 0) {
        run.warn(format!("{count} {what}"));
    }
    match survey.openings_mm.len() {
        0 => run.warn(
            "the scan has no opening: mouth and eyes are closed surfaces, so lips and lids cannot part; \
             `mesh-clip` opens them",
        ),
        _ if survey.mouth_is_missing => run.warn(format!(
            "the scan has two openings of {:.0} and {:.0} mm around, which look like the eyes: is the mouth cut open? Fused \
             lips cost millimetres; `mesh-clip --cut-along` opens them",
            survey.openings_mm[0], survey.openings_mm[1]
        )),
        _ => {}
    }
}

fn report_take(run: &mut Run, take: &HandleTake) {
    let missing: BTreeMap<&str, usize> = (0..take.missing.len())
        .filter(|&handle| take.missing[handle] > 0)
        .map(|handle| (take.header.handles[handle].marker.as_str(), take.missing[handle]))
        .collect();
    run.result("missing_frames", &missing);
    let never: Vec<&str> =
        missing.iter().filter(|(_, count)| **count == take.frames.len()).map(|(marker, _)| *marker).collect();
    if !never.is_empty() {
        run.warn(format!("never seen: {}; the shell decides where they go", never.join(", ")));
    }
    if let (Some(first), Some(last)) = (take.gaps.first(), take.gaps.last()) {
        let which = match take.gaps.len() {
            1 => format!("frame {first} has"),
            count => format!("{count} frames between {first} and {last} have"),
        };
        run.warn(format!("{which} no marker at all and stay out of the sequence"));
        run.result("gap_frames", &take.gaps);
    }
}
