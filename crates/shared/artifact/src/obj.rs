//! Wavefront OBJ, in and out.
//!
//! Kept: vertex order, polygons, texture coordinates per corner (UDIM tiles are coordinates beyond 1), vertex
//! colours, objects, groups, materials, smoothing groups. Not kept: normals (a deformed mesh needs new ones), free-form
//! curves, points and lines. OBJ states no unit; the caller says it.

use crate::source::read_text;
use crate::{Error, Result, Sink, Staged, Unit};
use mesh::{Label, LabelKind, Mesh, NO_UV};
use nalgebra::{Point3, Vector2};
use std::io::Write;
use std::path::Path;

/// Reads a mesh; positions come out in millimetres.
///
/// # Errors
/// Names the line of: binary data, a number that is none or not finite, a face with fewer than three corners or
/// with an index out of range; and a file without vertices or faces.
pub fn read(path: &Path, unit: Unit) -> Result<Mesh> {
    parse(path, &read_text(path)?, unit)
}

/// Reads a mesh from the text of its file; `path` is for messages.
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, text: &str, unit: Unit) -> Result<Mesh> {
    let mut reader = Reader { mesh: Mesh::default(), scale: unit.in_mm(), face_lines: Vec::new() };
    // A byte-order mark in front is what some exporters leave. ZBrush ends its files with one zero byte; more of them
    // are a damaged file.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let text = text.strip_suffix("\0\n").or(text.strip_suffix('\0')).unwrap_or(text);
    for (number, line) in logical_lines(text) {
        reader.statement(&line, number).map_err(|what| {
            let error = Error::new(path, what).at(format!("line {number}"));
            match number >= text.lines().count() {
                true => error
                    .fix("this is the last line: the file may have been cut short; copy or export it again"),
                false => error.fix("mend the line, or export the mesh again"),
            }
        })?;
    }
    reader.check_indices(path)?;
    match reader.mesh {
        mesh if mesh.positions.is_empty() => {
            Err(Error::new(path, "holds no vertices").fix("is this an OBJ file?"))
        }
        mesh if mesh.polygons.is_empty() => Err(Error::new(path, "holds vertices but no faces")
            .fix("export the mesh with faces; point clouds cannot be used")),
        mesh => Ok(mesh),
    }
}

/// Lines with their numbers; a backslash at the end joins the next one, except after a comment (`# made in C:\`).
fn logical_lines(text: &str) -> impl Iterator<Item = (usize, std::borrow::Cow<'_, str>)> {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (index, first) = lines.next()?;
        if !first.ends_with('\\') || first.trim_start().starts_with('#') {
            return Some((index + 1, first.into()));
        }
        let mut joined = first.to_string();
        while joined.ends_with('\\') {
            joined.pop();
            joined.push(' ');
            joined.push_str(lines.next().map_or("", |(_, line)| line));
        }
        Some((index + 1, joined.into()))
    })
}

struct Reader {
    mesh: Mesh,
    scale: f64,
    /// The line of every face, to name it when its indices turn out wrong.
    face_lines: Vec<u32>,
}

impl Reader {
    fn statement(&mut self, line: &str, number: usize) -> std::result::Result<(), String> {
        let mut words = line.split_ascii_whitespace();
        let Some(keyword) = words.next() else { return Ok(()) };
        match keyword {
            "v" => self.vertex(words),
            "vt" => {
                let numbers = numbers(words)?;
                let u = numbers.first().ok_or("a texture coordinate without numbers")?;
                self.mesh.uvs.push(Vector2::new(*u, numbers.get(1).copied().unwrap_or(0.0)));
                Ok(())
            }
            "f" => {
                self.face_lines.push(number as u32);
                self.face(words)
            }
            "o" => self.label(LabelKind::Object, line),
            "g" => self.label(LabelKind::Group, line),
            "usemtl" => self.label(LabelKind::Material, line),
            "s" => self.label(LabelKind::Smoothing, line),
            "mtllib" => self.label(LabelKind::MaterialLibrary, line),
            _ if keyword.chars().all(|c| c.is_ascii_graphic()) => Ok(()),
            _ => Err("is not text (binary data)".to_string()),
        }
    }

    fn vertex<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> std::result::Result<(), String> {
        let numbers = numbers(words)?;
        let color = match numbers.len() {
            3 | 4 => None,
            6 | 7 => Some(&numbers[numbers.len() - 3..]),
            count => return Err(format!("a vertex with {count} numbers; it has 3, or 6 with a colour")),
        };
        if let Some(color) = color {
            self.mesh.colors.resize(self.mesh.positions.len(), [0.0; 3]);
            self.mesh.colors.push([color[0] as f32, color[1] as f32, color[2] as f32]);
        } else if !self.mesh.colors.is_empty() {
            self.mesh.colors.push([0.0; 3]);
        }
        let point = Point3::new(numbers[0], numbers[1], numbers[2]) * self.scale;
        let color = self.mesh.colors.last().into_iter().flatten().map(|&x| f64::from(x));
        if point.iter().copied().chain(color).any(|x| !x.is_finite()) {
            return Err("a number is too large".to_string());
        }
        self.mesh.positions.push(point);
        Ok(())
    }

    fn face<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> std::result::Result<(), String> {
        let mut corners = Vec::with_capacity(4);
        let mut uvs = Vec::with_capacity(4);
        for word in words {
            let mut parts = word.split('/');
            corners.push(index(parts.next().unwrap_or(""), self.mesh.positions.len())?);
            uvs.push(match parts.next() {
                None | Some("") => NO_UV,
                Some(part) => index(part, self.mesh.uvs.len())?,
            });
        }
        if corners.len() < 3 {
            return Err(format!("a face with {} corners; it needs three", corners.len()));
        }
        let corner_count = self.mesh.polygons.corners().len();
        self.mesh.polygons.push(&corners);
        if uvs.iter().any(|&uv| uv != NO_UV) || !self.mesh.corner_uvs.is_empty() {
            self.mesh.corner_uvs.resize(corner_count, NO_UV);
            self.mesh.corner_uvs.extend(uvs);
        }
        Ok(())
    }

    fn label(&mut self, kind: LabelKind, line: &str) -> std::result::Result<(), String> {
        let name = line.split_once(char::is_whitespace).map_or("", |(_, name)| name).trim().to_string();
        self.mesh.labels.push(Label { first_face: self.mesh.polygons.len(), kind, name });
        Ok(())
    }

    /// Indices may point forward in the file, so they are checked at its end.
    fn check_indices(&self, path: &Path) -> Result<()> {
        let (vertex_count, uv_count) = (self.mesh.positions.len(), self.mesh.uvs.len());
        let refuse = |face: usize, what: String| {
            Error::new(path, what)
                .at(format!("line {}", self.face_lines[face]))
                .fix("the file may have been cut or mixed up with another one; export it again")
        };
        for (face, polygon) in self.mesh.polygons.iter().enumerate() {
            if let Some(vertex) = polygon.iter().find(|&&vertex| vertex as usize >= vertex_count) {
                let what = format!("the face names vertex {}; the file has {vertex_count}", vertex + 1);
                return Err(refuse(face, what));
            }
            let uvs = self.mesh.corner_uvs.get(self.mesh.polygons.corner_range(face)).unwrap_or(&[]);
            if let Some(uv) = uvs.iter().find(|&&uv| uv != NO_UV && uv as usize >= uv_count) {
                let what = format!("the face names texture coordinate {}; the file has {uv_count}", uv + 1);
                return Err(refuse(face, what));
            }
        }
        Ok(())
    }
}

fn numbers<'a>(words: impl Iterator<Item = &'a str>) -> std::result::Result<Vec<f64>, String> {
    words
        .map(|word| match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            Ok(_) => Err(format!("'{word}' is not a finite number")),
            Err(_) => Err(format!("'{word}' is not a number")),
        })
        .collect()
}

/// A 1-based index, or a negative one that counts back from the last element so far.
fn index(word: &str, count: usize) -> std::result::Result<u32, String> {
    let index: i64 = word.parse().map_err(|_| format!("'{word}' is not an index"))?;
    match index {
        1.. => u32::try_from(index - 1)
            .ok()
            .filter(|&index| index != NO_UV)
            .ok_or(format!("the index {index} is too large")),
        0 => Err("the index 0; indices start at 1".to_string()),
        _ => u32::try_from(count as i64 + index)
            .map_err(|_| format!("the index {index} counts back past the first element")),
    }
}

/// Writes a mesh; positions are taken as millimetres and written in `unit`. Numbers are the shortest that read back
/// to the same value.
///
/// # Errors
/// If a number is not finite or the file cannot be written.
pub fn write(path: &Path, mesh: &Mesh, unit: Unit) -> Result<Staged> {
    crate::finite::check_finite(mesh).map_err(|violation| violation.in_file(path))?;
    let mut sink = Sink::create(path)?;
    write_text(&mut sink, mesh, unit).map_err(|cause| Error::io(path, "write", &cause))?;
    sink.finish()
}

fn write_text(out: &mut impl Write, mesh: &Mesh, unit: Unit) -> std::io::Result<()> {
    let scale = unit.in_mm();
    for (vertex, point) in mesh.positions.iter().enumerate() {
        let point = point.map(|x| in_unit(x, scale));
        write!(out, "v {} {} {}", point.x, point.y, point.z)?;
        match mesh.colors.get(vertex) {
            Some([r, g, b]) => writeln!(out, " {r} {g} {b}")?,
            None => writeln!(out)?,
        }
    }
    for uv in &mesh.uvs {
        writeln!(out, "vt {} {}", uv.x, uv.y)?;
    }
    let mut labels = mesh.labels.iter().peekable();
    for (face, polygon) in mesh.polygons.iter().enumerate() {
        while let Some(label) = labels.next_if(|label| label.first_face <= face) {
            writeln!(out, "{} {}", keyword(label.kind), label.name)?;
        }
        let uvs = mesh.corner_uvs.get(mesh.polygons.corner_range(face)).unwrap_or(&[]);
        write!(out, "f")?;
        for (corner, vertex) in polygon.iter().enumerate() {
            match uvs.get(corner) {
                Some(&uv) if uv != NO_UV => write!(out, " {}/{}", vertex + 1, uv + 1)?,
                _ => write!(out, " {}", vertex + 1)?,
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

/// The number in the file's unit that reads back as `mm`, the shortest of several: a mesh that was read and is written
/// in the same unit keeps its numbers.
fn in_unit(mm: f64, scale: f64) -> f64 {
    let quotient = mm / scale;
    if scale == 1.0 {
        return quotient;
    }
    let candidates = [quotient, quotient.next_up(), quotient.next_down()];
    let reads_back = candidates.into_iter().filter(|candidate| candidate * scale == mm);
    reads_back.min_by_key(|candidate| candidate.to_string().len()).unwrap_or(quotient)
}

fn keyword(kind: LabelKind) -> &'static str {
    match kind {
        LabelKind::Object => "o",
        LabelKind::Group => "g",
        LabelKind::Material => "usemtl",
        LabelKind::Smoothing => "s",
        LabelKind::MaterialLibrary => "mtllib",
    }
}
