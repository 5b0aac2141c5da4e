//! Reads, draws, writes.

use super::arguments::{Coloring, Drawing};
use super::shots::{Reference, Rest, Shot, Source, open_sequence, select};
use anyhow::{Context, bail};
use artifact::{FrameReader, Handles};
use image::{ImageFormat, RgbImage};
use nalgebra::Point3;
use preview::sheet::{self, Cell, ColorBar, Sheet};
use preview::{CloseUp, Frame, Look, Spread, Surface, ValueRange, View};
use serde::Serialize;
use stage::Run;

/// Share of the vertices that the automatic range leaves within its ends.
const RANGE_SHARE: f64 = 0.99;

/// What stands in the side-car.
#[derive(Serialize)]
struct Parameters<'a> {
    look: &'a Look,
    color: Coloring,
    views: &'a [View],
    axes: preview::Axes,
    close_up: &'a CloseUp,
    size: [u32; 2],
    columns: usize,
    title: &'a str,
    /// As the user said; empty: any.
    frames: Vec<String>,
    count: Option<u32>,
    format: &'static str,
}

/// What was found out about the values of one shot.
#[derive(Serialize)]
struct Finding {
    shot: String,
    #[serde(flatten)]
    spread_mm: Spread,
}

pub(crate) fn draw(run: &mut Run, arguments: &Drawing) -> anyhow::Result<()> {
    let coloring = arguments.coloring()?;
    let (axes, close_up) = (arguments.axes()?, arguments.close_up()?);
    let (mesh, reference) = run.mesh("mesh", &arguments.mesh, &[("--unit", arguments.unit)])?;
    let source = open(run, arguments, Rest { path: &arguments.mesh, mesh: &mesh, reference })?;
    let shots = choose(arguments, &source)?;
    let mut surface = Surface::of(&mesh);
    surface.dots = handles(run, arguments, &source.rest)?;

    let measure = Measure { coloring, rest: &mesh.positions };
    let mut frames: Vec<Frame> =
        arguments.view.iter().map(|&view| Frame::around(view, axes, &mesh.positions)).collect();
    let survey = survey(&source, &shots, &measure, &mut frames)?;
    let range = arguments.range_mm.unwrap_or(ValueRange::up_to(survey.high));
    let look = look(arguments, range);
    look.check()?;
    let columns = columns(arguments, shots.len());
    check_size(arguments, shots.len(), columns)?;
    run.parameters(&Parameters {
        look: &look,
        color: coloring,
        views: &arguments.view,
        axes,
        close_up: &close_up,
        size: arguments.size,
        columns,
        title: &arguments.title,
        frames: arguments.frames.iter().map(ToString::to_string).collect(),
        count: arguments.count,
        format: "png",
    })?;

    let studio = Studio { frames, close_up, size: arguments.size, look, views: arguments.view.clone() };
    let cells = shoot(run, &source, &shots, &measure, &mut surface, &studio)?;
    let bar = (coloring != Coloring::Plain).then(|| ColorBar {
        map: studio.look.map,
        range,
        is_exceeded: survey.max > range.high,
        caption: caption(coloring),
    });
    let sheet = Sheet { columns, backdrop: studio.look.backdrop, title: arguments.title.clone(), bar };
    let ordered = arrange(cells, studio.views.len(), columns, shots.len());
    let picture = sheet::compose(&sheet, &ordered)?;
    write(run, arguments, &picture)
}

fn open<'a>(run: &mut Run, arguments: &Drawing, rest: Rest<'a>) -> anyhow::Result<Source<'a>> {
    let sequence = arguments.sequence.as_ref();
    let sequence = sequence.map(|path| open_sequence(run, "sequence", path, &rest)).transpose()?;
    let reference = arguments.reference.as_ref();
    let reference = reference.map(|path| Reference::open(run, path, &rest)).transpose()?;
    Ok(Source { rest, sequence, reference })
}

fn choose(arguments: &Drawing, source: &Source) -> anyhow::Result<Vec<Shot>> {
    if let Some(sequence) = &source.sequence {
        let frames = select(sequence, &arguments.frames, arguments.count)?;
        return Ok(frames.into_iter().map(Shot::Frame).collect());
    }
    match arguments.pose.is_empty() {
        true => Ok(vec![Shot::Rest]),
        false => Ok(arguments.pose.iter().cloned().map(Shot::Pose).collect()),
    }
}

fn handles(run: &mut Run, arguments: &Drawing, rest: &Rest) -> anyhow::Result<Vec<u32>> {
    let Some(path) = &arguments.handles else { return Ok(Vec::new()) };
    run.input("handles", path)?;
    let reader = FrameReader::<Handles>::open(path)?;
    let header = reader.header();
    if let Some(handle) =
        header.handles.iter().find(|handle| handle.vertex as usize >= rest.mesh.positions.len())
    {
        let (marker, vertex) = (&handle.marker, handle.vertex);
        bail!(
            "{}, marker {marker}: sits on vertex {vertex}, which {} lacks\n  to do: give the mesh that the handles were made for",
            path.display(),
            rest.path.display()
        );
    }
    if let Some(mismatch) = header.mesh.mismatch(&rest.reference) {
        run.warn(format!("{}: {mismatch}", path.display()));
    }
    Ok(header.handles.iter().map(|handle| handle.vertex).collect())
}

/// What the colours measure.
struct Measure<'a> {
    coloring: Coloring,
    rest: &'a [Point3<f64>],
}

impl Measure<'_> {
    /// Per vertex its value, mm; none for plain clay.
    fn values(
        &self,
        positions: &[Point3<f64>],
        reference: Option<&[Point3<f64>]>,
    ) -> anyhow::Result<Vec<f64>> {
        match self.coloring {
            Coloring::Plain => Ok(Vec::new()),
            Coloring::Displacement => Ok(preview::distances(positions, self.rest)?),
            Coloring::Error => Ok(preview::distances(positions, reference.unwrap_or(self.rest))?),
        }
    }
}

/// What all shots together span.
struct Survey {
    /// The highest of the shots' 99th percentiles.
    high: f64,
    max: f64,
}

/// First pass: what the pictures must show and the colours must span.
fn survey(
    source: &Source,
    shots: &[Shot],
    measure: &Measure,
    frames: &mut [Frame],
) -> anyhow::Result<Survey> {
    let mut survey = Survey { high: 0.0, max: 0.0 };
    source.visit(shots, |_, positions, reference| {
        frames.iter_mut().for_each(|frame| frame.include(&positions));
        let mut values = measure.values(&positions, reference)?;
        if !values.is_empty() {
            let rank = ((values.len() as f64 * RANGE_SHARE).ceil() as usize).clamp(1, values.len()) - 1;
            survey.high = survey.high.max(*values.select_nth_unstable_by(rank, f64::total_cmp).1);
            survey.max = values.iter().copied().fold(survey.max, f64::max);
        }
        Ok(())
    })?;
    Ok(survey)
}

fn look(arguments: &Drawing, range: ValueRange) -> Look {
    Look {
        backdrop: arguments.background.into(),
        wireframe: arguments.wireframe,
        map: arguments.map.into(),
        range,
        ..Look::default()
    }
}

/// What stays the same from shot to shot.
struct Studio {
    frames: Vec<Frame>,
    views: Vec<View>,
    close_up: CloseUp,
    size: [u32; 2],
    look: Look,
}

/// Second pass: the pictures, shot after shot and view after view.
fn shoot(
    run: &mut Run,
    source: &Source,
    shots: &[Shot],
    measure: &Measure,
    surface: &mut Surface,
    studio: &Studio,
) -> anyhow::Result<Vec<Cell>> {
    let mut cells = Vec::new();
    let mut findings = Vec::new();
    let mut progress = run.progress("drawing", Some(shots.len() as u64));
    source.visit(shots, |shot, positions, reference| {
        surface.values = measure.values(&positions, reference)?;
        surface.deform(positions);
        let name = shot.name();
        let mut note = String::new();
        if !surface.values.is_empty() {
            let spread_mm = Spread::of(&surface.values);
            let [mean, p95, max] = [spread_mm.mean, spread_mm.p95, spread_mm.max].map(sheet::short);
            note = format!("mean {mean} · 95 % {p95} · max {max} mm");
            findings.push(Finding { shot: name.clone(), spread_mm });
        }
        for frame in &studio.frames {
            let camera = frame.camera(studio.size, &studio.close_up);
            let picture = preview::render(surface, &camera, studio.size, &studio.look);
            cells.push(Cell { picture, name: name.clone(), note: note.clone() });
        }
        progress.step();
        Ok(())
    })?;
    drop(progress);
    if let Some(worst) = findings.iter().max_by(|a, b| a.spread_mm.max.total_cmp(&b.spread_mm.max)) {
        run.result("max_mm", worst.spread_mm.max);
    }
    run.result("pictures", cells.len());
    run.result("shots", findings);
    Ok(cells)
}

/// Several shots in several views: a row per view, wrapped together. One shot: its views side by side.
fn columns(arguments: &Drawing, shot_count: usize) -> usize {
    let across = if shot_count == 1 { arguments.view.len() } else { shot_count };
    let limit = match arguments.view.len() {
        1 if across > 4 => (across as f64).sqrt().ceil() as usize,
        _ => 6,
    };
    arguments.columns.map_or(limit, |columns| columns as usize).min(across)
}

/// Refuses a sheet that is too large before the work begins.
fn check_size(arguments: &Drawing, shot_count: usize, columns: usize) -> anyhow::Result<()> {
    let rows = (shot_count * arguments.view.len()).div_ceil(columns);
    let [width, height] = arguments.size.map(|side| side as usize);
    sheet::check_size(columns * width, rows * height).context("to do: choose a smaller --size or --count")
}

/// From shot after shot to rows of the sheet.
fn arrange(cells: Vec<Cell>, view_count: usize, columns: usize, shot_count: usize) -> Vec<Cell> {
    if shot_count == 1 || view_count == 1 {
        return cells;
    }
    let mut by_view: Vec<Vec<Option<Cell>>> = (0..view_count).map(|_| Vec::new()).collect();
    for (at, cell) in cells.into_iter().enumerate() {
        by_view[at % view_count].push(Some(cell));
    }
    let mut ordered = Vec::new();
    for block in (0..shot_count).step_by(columns) {
        for row in &mut by_view {
            for shot in block..block + columns {
                ordered.push(row.get_mut(shot).and_then(Option::take));
            }
        }
    }
    ordered
        .into_iter()
        .map(|cell| {
            cell.unwrap_or(Cell { picture: RgbImage::new(0, 0), name: String::new(), note: String::new() })
        })
        .collect()
}

fn caption(coloring: Coloring) -> String {
    match coloring {
        Coloring::Plain => String::new(),
        Coloring::Displacement => "moved, mm".to_string(),
        Coloring::Error => "error, mm".to_string(),
    }
}

fn write(run: &mut Run, arguments: &Drawing, picture: &RgbImage) -> anyhow::Result<()> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Png)?;
    let staged = artifact::stage_bytes(&arguments.out, bytes.get_ref())?;
    run.publish(vec![staged])
}
