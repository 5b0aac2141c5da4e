//! Reads both files, compares, reports.

use super::arguments::{Arguments, Parameters};
use super::kind::Kind;
use anyhow::{Context, bail};
use artifact::{
    FrameReader, Handles, HeadTrajectories, MeshSequence, Trajectories, Trajectories3d, Unit, VertexSet,
};
use artifact_diff::{Region, Report, Samples, SequenceDiff, compare_images, compare_meshes, compare_samples};
use image::DynamicImage;
use stage::Run;
use std::path::Path;

pub(crate) fn compare(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    let (first, second) = (arguments.first.as_path(), arguments.second.as_path());
    let (kind, other) = (Kind::of(first)?, Kind::of(second)?);
    if kind != other && !(kind.is_markers() && other.is_markers()) {
        let (one, two) = (first.display(), second.display());
        bail!("{one} is {}, but {two} is {}: they cannot be compared", kind.noun(), other.noun());
    }
    let parameters = &arguments.parameters;
    check(parameters, kind)?;
    run.parameters(parameters)?;
    let both = Both { first, second, parameters };
    let report = match kind {
        Kind::Mesh => both.meshes(run),
        Kind::Sequence => both.sequences(run),
        Kind::Markers | Kind::HeadMarkers => both.markers(run, [kind, other]),
        Kind::Handles => both.handles(),
        Kind::Image => both.images(),
    }?;
    run.input("first", first)?;
    run.input("second", second)?;
    run.result("difference", &report);
    if !run.is_json() {
        // Written, not published: the table is no artifact that a side-car could stand beside.
        drop(artifact::stage_bytes("-".as_ref(), report.table().as_bytes())?);
    }
    judge(run, &report, parameters);
    Ok(())
}

/// Refuses options that would say nothing.
fn check(parameters: &Parameters, kind: Kind) -> anyhow::Result<()> {
    let has_vertices = matches!(kind, Kind::Mesh | Kind::Sequence);
    let has_frames = !matches!(kind, Kind::Mesh | Kind::Image);
    let refuse = |option: &str| bail!("{option} means nothing for {}\n  to do: leave it away", kind.noun());
    match parameters {
        Parameters { tolerance_mm: Some(_), .. } if kind == Kind::Image => refuse("--tolerance-mm"),
        Parameters { tolerance_levels: Some(_), .. } if kind != Kind::Image => refuse("--tolerance-levels"),
        Parameters { region, .. } if !region.is_empty() && !has_vertices => refuse("--region"),
        Parameters { frames: Some(_), .. } if !has_frames => refuse("--frames"),
        _ => Ok(()),
    }
}

fn judge(run: &mut Run, report: &Report, parameters: &Parameters) {
    let tolerance = parameters.tolerance_mm.or(parameters.tolerance_levels);
    if let Some(nothing) = report.uncompared().filter(|_| tolerance.is_some() || parameters.strict) {
        run.object(format!(
            "they cannot be judged: {nothing}\n  to do: check --region, --frames and the files"
        ));
        return;
    }
    let mut objections: Vec<String> =
        tolerance.and_then(|tolerance| report.excess(tolerance)).into_iter().collect();
    if parameters.strict {
        objections.extend(report.structure.iter().cloned());
    }
    if !objections.is_empty() {
        run.object(format!("they differ: {}", objections.join("\n  and: ")));
    }
}

struct Both<'a> {
    first: &'a Path,
    second: &'a Path,
    parameters: &'a Parameters,
}

impl Both<'_> {
    fn units(&self) -> [Option<Unit>; 2] {
        [self.parameters.unit, self.parameters.second_unit.or(self.parameters.unit)]
    }

    /// Says which files could not be compared.
    fn comparable<T>(&self, outcome: Result<T, artifact_diff::Error>) -> anyhow::Result<T> {
        let names = || format!("{} and {} cannot be compared", self.first.display(), self.second.display());
        outcome.with_context(names)
    }

    fn meshes(&self, run: &mut Run) -> anyhow::Result<Report> {
        let [unit, second_unit] = self.units();
        let (mesh, reference) = run.mesh("first", self.first, &[("--unit", unit)])?;
        let (other, _) = run.mesh("second", self.second, &[("--unit", second_unit)])?;
        let regions = self.regions(run, Some(&reference))?;
        self.comparable(compare_meshes(&mesh, &other, &regions))
    }

    /// Reads the regions; one that was made for another mesh is used with a warning, since vertex order is identity.
    fn regions(&self, run: &mut Run, mesh: Option<&artifact::MeshRef>) -> anyhow::Result<Vec<Region>> {
        let mut regions = Vec::new();
        for path in &self.parameters.region {
            run.input(&format!("region {}", regions.len() + 1), path)?;
            let set: VertexSet = artifact::read_document(path)?;
            if let Some(mismatch) = mesh.and_then(|mesh| set.mesh.mismatch(mesh)) {
                run.warn(format!("{}: {mismatch}", path.display()));
            }
            regions.push(Region { name: set.name, vertices: set.vertices });
        }
        Ok(regions)
    }

    fn sequences(&self, run: &mut Run) -> anyhow::Result<Report> {
        let [unit, second_unit] = self.units();
        let (first, second) =
            (MeshSequence::open(self.first, unit)?, MeshSequence::open(self.second, second_unit)?);
        for (role, sequence) in [("first cache", &first), ("second cache", &second)] {
            sequence.cache().map_or(Ok(()), |cache| run.input(role, cache).map(drop))?;
        }
        let regions = self.regions(run, first.mesh())?;
        let mut diff = self.comparable(SequenceDiff::new(first.vertex_count(), &regions))?;
        let (mut cursor, mut other) = (first.cursor()?, second.cursor()?);
        let only = |one: &MeshSequence, two: &MeshSequence| -> Vec<i64> {
            let alone =
                |frame: &i64| self.parameters.takes(*frame) && two.frames().binary_search(frame).is_err();
            one.frames().iter().copied().filter(alone).collect()
        };
        let mut progress = run.progress("comparing", Some(first.frames().len() as u64));
        for &frame in first.frames() {
            if self.parameters.takes(frame) && second.frames().binary_search(&frame).is_ok() {
                self.comparable(diff.add(frame, &cursor.read(frame)?, &other.read(frame)?))?;
            }
            progress.step();
        }
        drop(progress);
        self.comparable(diff.finish(&only(&first, &second), &only(&second, &first)))
    }

    fn markers(&self, run: &mut Run, kinds: [Kind; 2]) -> anyhow::Result<Report> {
        let [unit, second_unit] = self.units();
        let first = read_markers(run, self.first, kinds[0], unit)?;
        let second = read_markers(run, self.second, kinds[1], second_unit)?;
        let mut report =
            self.comparable(compare_samples(&self.samples(&first), &self.samples(&second), "marker"))?;
        if kinds == [Kind::Markers, Kind::HeadMarkers] || kinds == [Kind::HeadMarkers, Kind::Markers] {
            report.structure.push("one is in head space".to_string());
        }
        if first.header.rate != second.header.rate {
            let shown =
                |rate: Option<artifact::Rate>| rate.map_or("none".to_string(), |rate| rate.to_string());
            let (rate, other) = (shown(first.header.rate), shown(second.header.rate));
            report.structure.push(format!("the rate is {rate} against {other}"));
        }
        Ok(report)
    }

    fn samples(&self, trajectories: &Trajectories) -> Samples {
        let frames = trajectories.frames.iter().filter(|frame| self.parameters.takes(frame.frame));
        let vectors = |frame: &artifact::MarkerFrame| {
            (frame.frame, frame.points.iter().map(|point| point.map(|point| point.coords)).collect())
        };
        Samples { ids: trajectories.header.markers.clone(), frames: frames.map(vectors).collect() }
    }

    fn handles(&self) -> anyhow::Result<Report> {
        let (first, vertices) = self.read_handles(self.first)?;
        let (second, other_vertices) = self.read_handles(self.second)?;
        let mut report = self.comparable(compare_samples(&first, &second, "handle"))?;
        for (id, vertex) in first.ids.iter().zip(&vertices) {
            let at = second.ids.iter().position(|other| other == id);
            if let Some(other) = at.map(|at| other_vertices[at]).filter(|other| other != vertex) {
                report.structure.push(format!("handle {id} sits on vertex {vertex} against {other}"));
            }
        }
        Ok(report)
    }

    fn read_handles(&self, path: &Path) -> anyhow::Result<(Samples, Vec<u32>)> {
        let reader = FrameReader::<Handles>::open(path)?;
        let handles = reader.header().handles.clone();
        let mut samples =
            Samples { ids: handles.iter().map(|handle| handle.marker.clone()).collect(), frames: Vec::new() };
        for frame in reader {
            let frame = frame?;
            if self.parameters.takes(frame.frame) {
                samples.frames.push((frame.frame, frame.displacements));
            }
        }
        Ok((samples, handles.iter().map(|handle| handle.vertex).collect()))
    }

    fn images(&self) -> anyhow::Result<Report> {
        self.comparable(compare_images(&read_image(self.first)?, &read_image(self.second)?))
    }
}

fn read_markers(run: &mut Run, path: &Path, kind: Kind, unit: Option<Unit>) -> anyhow::Result<Trajectories> {
    match kind {
        Kind::HeadMarkers => run.markers::<HeadTrajectories>(path, unit),
        _ => run.markers::<Trajectories3d>(path, unit),
    }
}

fn read_image(path: &Path) -> anyhow::Result<DynamicImage> {
    let bytes = artifact::read_bytes(path)?;
    image::load_from_memory(&bytes)
        .with_context(|| format!("{}: is not a PNG that can be read", path.display()))
}
