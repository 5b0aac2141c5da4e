//! USD as text (`.usda`): a mesh with a point cache, for delivery to Houdini, Maya, Blender, Omniverse.
//!
//! One `Mesh` prim holds the rest pose, polygons and texture coordinates once, and the points of every frame as time
//! samples; the time code is the frame number. Everything is in the unit that the stage states as `metersPerUnit`.
//! The file is written front to back: only six numbers per frame, its extent, wait for the end.

use crate::{Axis, Consent, Error, Rate, Result, Sink, Staged, Unit, Violation, finite};
use mesh::{Mesh, NO_UV};
use std::fmt::{Display, Write as _};
use std::io::Write;
use std::path::Path;

/// Writes a mesh sequence frame by frame.
pub struct Writer {
    sink: Sink,
    vertex_count: usize,
    /// Where the first and last frame are told; they are known only at the end.
    range_offset: u64,
    /// Frames so far, each with the lowest and highest corner of its box.
    extents: Vec<(i64, Box3)>,
}

type Box3 = [[f32; 3]; 2];

impl Writer {
    /// Starts a sequence of `mesh` (mm; its positions are the rest pose) in a file whose lengths are in `unit`, with
    /// the axis `up`. Without a `rate` the file states none, and USD takes 24 frames a second.
    ///
    /// # Errors
    /// If the mesh holds a number that is not finite, or the file cannot be written.
    pub fn create(path: &Path, mesh: &Mesh, unit: Unit, up: Axis, rate: Option<Rate>) -> Result<Self> {
        Self::start(path, mesh, &head(unit, up, rate, None), unit, rate)
    }

    /// The same, with the consent of the take in the layer's data: it travels with the recording.
    ///
    /// # Errors
    /// As [`Writer::create`].
    pub fn create_with_consent(
        path: &Path,
        mesh: &Mesh,
        unit: Unit,
        up: Axis,
        rate: Option<Rate>,
        consent: &Consent,
    ) -> Result<Self> {
        Self::start(path, mesh, &head(unit, up, rate, Some(consent)), unit, rate)
    }

    fn start(path: &Path, mesh: &Mesh, head: &str, unit: Unit, rate: Option<Rate>) -> Result<Self> {
        finite::check_finite(mesh).map_err(|violation| violation.in_file(path))?;
        if let Some(rate) = rate {
            rate.check("rate").map_err(|violation| violation.in_file(path))?;
        }
        let mut sink = Sink::create_seekable(path)?;
        let mut write = || {
            sink.write_all(head.as_bytes())?;
            sink.write_all(range(0, 0).as_bytes())?;
            write_mesh(&mut sink, mesh, unit.in_mm())?;
            sink.write_all(b"    point3f[] points.timeSamples = {\n")
        };
        write().map_err(|cause| Error::io(path, "write", &cause))?;
        let (vertex_count, range_offset) = (mesh.positions.len(), head.len() as u64);
        Ok(Self { sink, vertex_count, range_offset, extents: Vec::new() })
    }

    /// Appends a frame: #V × 3 coordinates, in the unit of the file.
    ///
    /// # Errors
    /// If the frame does not follow the last one, a coordinate is not finite, or writing fails.
    ///
    /// # Panics
    /// If the count is not three per vertex: that is a bug of the caller.
    pub fn write(&mut self, frame: i64, coordinates: &[f32]) -> Result<()> {
        assert_eq!(coordinates.len(), self.vertex_count * 3, "a frame has three coordinates per vertex");
        let refuse = |violation: Violation| violation.in_file(self.sink.path());
        if let Some((last, _)) = self.extents.last().filter(|(last, _)| *last >= frame) {
            let what = format!("would follow frame {last}");
            return Err(refuse(Violation::new(format!("frame {frame}"), what)));
        }
        if let Some(at) = coordinates.iter().position(|x| !x.is_finite()) {
            let place = format!("frame {frame}, vertex {}", at / 3);
            return Err(refuse(Violation::new(place, "the position is not finite")));
        }
        let triple = |x: &[f32]| Tuple([Number(x[0]), Number(x[1]), Number(x[2])]);
        let sink = &mut self.sink;
        let mut write = || {
            write!(sink, "        {frame}: ")?;
            write_list(sink, coordinates.chunks_exact(3).map(triple))?;
            sink.write_all(b",\n")
        };
        write().map_err(|cause| self.sink.failed(&cause))?;
        self.extents.push((frame, box_around(coordinates)));
        Ok(())
    }

    /// Completes the sequence.
    ///
    /// # Errors
    /// If there is no frame, or the rest cannot be written.
    pub fn finish(mut self) -> Result<Staged> {
        let (Some((first, _)), Some((last, _))) = (self.extents.first(), self.extents.last()) else {
            return Err(Error::new(self.sink.path(), "would hold no frames"));
        };
        let range = range(*first, *last);
        let mut tail = "    }\n    float3[] extent.timeSamples = {\n".to_string();
        for (frame, [low, high]) in &self.extents {
            let [low, high] = [low, high].map(|corner| Tuple(corner.map(Number)));
            let _ = writeln!(tail, "        {frame}: [{low}, {high}],");
        }
        tail.push_str("    }\n}\n");
        self.sink.write_all(tail.as_bytes()).map_err(|cause| self.sink.failed(&cause))?;
        self.sink.patch(self.range_offset, range.as_bytes())?;
        self.sink.finish()
    }
}

/// Metadata of the stage, up to where the range of frames stands.
fn head(unit: Unit, up: Axis, rate: Option<Rate>, consent: Option<&Consent>) -> String {
    let meters = unit.in_mm() / 1000.0;
    let up = match up {
        Axis::Y => "Y",
        Axis::Z => "Z",
    };
    let rate = rate
        .map(|rate| format!("    framesPerSecond = {0}\n    timeCodesPerSecond = {0}\n", rate.hz()))
        .unwrap_or_default();
    let consent = consent.map(custom_data).unwrap_or_default();
    format!(
        "#usda 1.0\n(\n{consent}    defaultPrim = \"face\"\n    metersPerUnit = {meters}\n    upAxis = \"{up}\"\n{rate}"
    )
}

fn custom_data(consent: &Consent) -> String {
    let said = [("licence", Some(&consent.licence)), ("credit", consent.credit.as_ref())];
    let mut data = "    customLayerData = {\n".to_string();
    for (name, text) in said.into_iter().chain([("notes", consent.notes.as_ref())]) {
        if let Some(text) = text {
            let _ = writeln!(data, "        string {name} = \"{}\"", escaped(text));
        }
    }
    data + "    }\n"
}

/// Text between quotation marks, on one line.
fn escaped(text: &str) -> String {
    let escape = |c: char| match c {
        '"' => "\\\"".to_string(),
        '\\' => "\\\\".to_string(),
        '\n' => "\\n".to_string(),
        c if c.is_control() => " ".to_string(),
        c => c.to_string(),
    };
    text.chars().map(escape).collect()
}

/// The range of frames, always of the same length.
fn range(first: i64, last: i64) -> String {
    format!("    startTimeCode = {first:<20}\n    endTimeCode = {last:<20}\n")
}

fn write_mesh(out: &mut impl Write, mesh: &Mesh, unit_mm: f64) -> std::io::Result<()> {
    let rest: Vec<f32> =
        mesh.positions.iter().flat_map(|point| point.iter().map(|x| (x / unit_mm) as f32)).collect();
    let triple = |x: &[f32]| Tuple([Number(x[0]), Number(x[1]), Number(x[2])]);
    out.write_all(b")\n\ndef Mesh \"face\"\n{\n    uniform token subdivisionScheme = \"none\"\n")?;
    write_attribute(out, "int[] faceVertexCounts", mesh.polygons.iter().map(<[u32]>::len), "")?;
    write_attribute(out, "int[] faceVertexIndices", mesh.polygons.corners().iter(), "")?;
    let [low, high] = box_around(&rest).map(|corner| Tuple(corner.map(Number)));
    write_attribute(out, "float3[] extent", [low, high].into_iter(), "")?;
    write_uvs(out, mesh)?;
    write_attribute(out, "point3f[] points", rest.chunks_exact(3).map(triple), "")
}

/// Texture coordinates per corner. A corner without one, which USD cannot say, gets (0, 0).
fn write_uvs(out: &mut impl Write, mesh: &Mesh) -> std::io::Result<()> {
    if mesh.corner_uvs.iter().all(|&uv| uv == NO_UV) {
        return Ok(());
    }
    let none = mesh.corner_uvs.contains(&NO_UV).then_some([0.0, 0.0]);
    let pool = mesh.uvs.iter().map(|uv| [uv.x as f32, uv.y as f32]).chain(none);
    let index = |&uv: &u32| if uv == NO_UV { mesh.uvs.len() } else { uv as usize };
    write_attribute(
        out,
        "texCoord2f[] primvars:st",
        pool.map(|uv| Tuple(uv.map(Number))),
        " (\n        interpolation = \"faceVarying\"\n    )",
    )?;
    write_attribute(out, "int[] primvars:st:indices", mesh.corner_uvs.iter().map(index), "")
}

fn write_attribute(
    out: &mut impl Write,
    name: &str,
    values: impl Iterator<Item = impl Display>,
    metadata: &str,
) -> std::io::Result<()> {
    write!(out, "    {name} = ")?;
    write_list(out, values)?;
    writeln!(out, "{metadata}")
}

fn write_list(out: &mut impl Write, values: impl Iterator<Item = impl Display>) -> std::io::Result<()> {
    out.write_all(b"[")?;
    for (i, value) in values.enumerate() {
        write!(out, "{}{value}", if i > 0 { ", " } else { "" })?;
    }
    out.write_all(b"]")
}

struct Tuple<const N: usize>([Number; N]);

impl<const N: usize> Display for Tuple<N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (i, number) in self.0.iter().enumerate() {
            write!(f, "{}{number}", if i > 0 { ", " } else { "(" })?;
        }
        f.write_str(")")
    }
}

/// The shortest text that reads back to the same float.
#[derive(Clone, Copy)]
struct Number(f32);

impl Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0.abs() {
            0.0 | 1e-4..1e9 => write!(f, "{}", self.0),
            _ => write!(f, "{:e}", self.0),
        }
    }
}

fn box_around(coordinates: &[f32]) -> Box3 {
    let Some(first) = coordinates.first_chunk::<3>() else { return [[0.0; 3]; 2] };
    coordinates.chunks_exact(3).fold([*first; 2], |[low, high], point| {
        [
            std::array::from_fn(|axis| low[axis].min(point[axis])),
            std::array::from_fn(|axis| high[axis].max(point[axis])),
        ]
    })
}
