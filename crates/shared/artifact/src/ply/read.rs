//! PLY, in.

use crate::source::open;
use crate::{Error, Result, Unit};
use mesh::{Mesh, NO_UV};
use nalgebra::{Point3, Vector2};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Property, PropertyAccess, PropertyAccessResult};
use std::collections::HashMap;
use std::io::{BufRead, ErrorKind};
use std::path::Path;

const EXPORT_AGAIN: &str = "the file may have been cut or mixed up with another one; export it again";

/// Reads a mesh; positions come out in millimetres.
///
/// # Errors
/// Names the vertex or face (in ascii files also the line) of: a number that is not finite, an index out of range, a
/// face with fewer than three corners, an end that comes too early; and refuses a file without vertices or faces.
pub fn read(path: &Path, unit: Unit) -> Result<Mesh> {
    let mut reader = Reader::new(open(path)?);
    let header =
        Parser::<Skipped>::new().read_header(&mut reader).map_err(|error| bad_header(path, &error))?;
    let mut source = Source {
        path,
        encoding: header.encoding,
        // The parser has counted the line that the data starts in.
        line: reader.line().saturating_sub(1),
        bytes: reader.into_inner(),
        text: String::new(),
    };
    let mut builder = Builder { scale: unit.in_mm(), ..Builder::default() };
    for element in header.elements.values() {
        match element.name.as_str() {
            "vertex" => builder.vertices(&mut source, element)?,
            "face" => builder.faces(&mut source, element)?,
            "tristrips" => {
                return Err(Error::new(path, "holds triangle strips").fix("export the mesh with plain faces"));
            }
            _ => source.each::<Skipped>(element, |_| Ok(()))?,
        }
    }
    builder.finish(path)
}

fn bad_header(path: &Path, error: &ParseError) -> Error {
    let said = error.to_string();
    let what = said.lines().next().unwrap_or_default().trim_end_matches('.');
    Error::new(path, format!("is not a PLY file that can be read: {what}"))
        .at(error.line().map_or("header".to_string(), |line| format!("header, line {line}")))
        .fix("check that this is the right file, and export it again")
}

/// Where elements come from, one after the other.
struct Source<'a> {
    path: &'a Path,
    encoding: Encoding,
    bytes: Box<dyn BufRead>,
    /// Lines read so far; of use for ascii only.
    line: usize,
    text: String,
}

impl Source<'_> {
    /// Reads all elements of a kind; an error names the element.
    fn each<E: PropertyAccess>(
        &mut self,
        kind: &ElementDef,
        mut take: impl FnMut(E) -> std::result::Result<(), String>,
    ) -> Result<()> {
        let parser = Parser::<E>::new();
        for index in 0..kind.count {
            let element = self.next(&parser, kind).map_err(|error| match error.kind() {
                ErrorKind::UnexpectedEof => {
                    let what =
                        format!("the file ends here; its header says {} of kind {}", kind.count, kind.name);
                    self.refuse(kind, index, what).fix("the file was cut short; copy or export it again")
                }
                _ => self.refuse(kind, index, last_line(&error)).fix(EXPORT_AGAIN),
            })?;
            take(element).map_err(|what| self.refuse(kind, index, what).fix(EXPORT_AGAIN))?;
        }
        Ok(())
    }

    fn next<E: PropertyAccess>(
        &mut self,
        parser: &Parser<E>,
        kind: &ElementDef,
    ) -> std::result::Result<E, ParseError> {
        match self.encoding {
            Encoding::BinaryLittleEndian => parser.read_little_endian_element(&mut self.bytes, kind),
            Encoding::BinaryBigEndian => parser.read_big_endian_element(&mut self.bytes, kind),
            Encoding::Ascii => {
                self.text.clear();
                self.line += 1;
                if self.bytes.read_line(&mut self.text)? == 0 {
                    return Err(std::io::Error::from(ErrorKind::UnexpectedEof).into());
                }
                parser.read_ascii_element(&self.text, kind)
            }
        }
    }

    fn refuse(&self, kind: &ElementDef, index: usize, what: impl Into<String>) -> Error {
        let place = match self.encoding {
            Encoding::Ascii => format!("line {}, {} {index}", self.line, kind.name),
            _ => format!("{} {index}", kind.name),
        };
        Error::new(self.path, what).at(place)
    }
}

/// The parser nests its reasons; the innermost comes last.
fn last_line(error: &ParseError) -> String {
    let said = error.to_string();
    said.lines()
        .rev()
        .map(|line| line.trim().trim_start_matches("Error: ").trim_end_matches([',', ' ']))
        .find(|line| !line.is_empty())
        .unwrap_or("cannot be read")
        .to_string()
}

/// An element whose properties nobody needs.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

/// x, y, z, red, green, blue, s, t of a vertex.
struct Vertex([f64; 8]);

/// Which number of a [`Vertex`] a property is.
fn slot(property: &str) -> Option<usize> {
    Some(match property {
        "x" => 0,
        "y" => 1,
        "z" => 2,
        "red" => 3,
        "green" => 4,
        "blue" => 5,
        "s" | "u" | "texture_u" => 6,
        "t" | "v" | "texture_v" => 7,
        _ => return None,
    })
}

const COLORS: std::ops::Range<usize> = 3..6;

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self([0.0; 8])
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some(slot) = slot(name) else { return PropertyAccessResult::Ignored };
        // Colours of a whole-number type fill its range; those of a real type run from 0 to 1.
        let (number, full) = match property {
            Property::UChar(x) => (f64::from(x), f64::from(u8::MAX)),
            Property::UShort(x) => (f64::from(x), f64::from(u16::MAX)),
            Property::Float(x) => (f64::from(x), 1.0),
            Property::Double(x) => (x, 1.0),
            Property::Char(x) => (f64::from(x), f64::from(i8::MAX)),
            Property::Short(x) => (f64::from(x), f64::from(i16::MAX)),
            Property::Int(x) => (f64::from(x), f64::from(i32::MAX)),
            Property::UInt(x) => (f64::from(x), f64::from(u32::MAX)),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        self.0[slot] = if COLORS.contains(&slot) { number / full } else { number };
        PropertyAccessResult::Set
    }
}

/// The corners of a face, and their texture coordinates: u, v, u, v, …
#[derive(Default)]
struct Face {
    corners: Vec<u32>,
    texture: Vec<f64>,
    /// Why the corners are no indices.
    wrong: Option<&'static str>,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match (name, property) {
            ("vertex_indices" | "vertex_index", list) => match list.to_u32_list() {
                Some(corners) => self.corners = corners,
                None => self.wrong = Some("a vertex index is negative or not a whole number"),
            },
            ("texcoord", Property::ListFloat(list)) => {
                self.texture = list.into_iter().map(f64::from).collect();
            }
            ("texcoord", Property::ListDouble(list)) => self.texture = list,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

#[derive(Default)]
struct Builder {
    mesh: Mesh,
    scale: f64,
    /// Texture coordinates per vertex, where the file has them so.
    vertex_uvs: Vec<Vector2<f64>>,
    /// Where each texture coordinate of a corner stands in the pool, by its bits.
    pool: HashMap<[u64; 2], u32>,
}

impl Builder {
    fn vertices(&mut self, source: &mut Source, kind: &ElementDef) -> Result<()> {
        let mut has = [false; 8];
        kind.properties.keys().filter_map(|name| slot(name)).for_each(|slot| has[slot] = true);
        if !has[..3].iter().all(|&has| has) {
            return Err(Error::new(source.path, "its vertices lack x, y or z").at("header"));
        }
        let (colored, textured) = (has[COLORS].iter().all(|&has| has), has[6] && has[7]);
        source.each::<Vertex>(kind, |Vertex(numbers)| {
            let point = Point3::new(numbers[0], numbers[1], numbers[2]) * self.scale;
            if let Some(x) = point.iter().chain(&numbers[3..]).find(|x| !x.is_finite()) {
                return Err(format!("{x} is not a finite number"));
            }
            self.mesh.positions.push(point);
            if colored {
                self.mesh.colors.push([numbers[3] as f32, numbers[4] as f32, numbers[5] as f32]);
            }
            if textured {
                self.vertex_uvs.push(Vector2::new(numbers[6], numbers[7]));
            }
            Ok(())
        })
    }

    fn faces(&mut self, source: &mut Source, kind: &ElementDef) -> Result<()> {
        source.each::<Face>(kind, |face| {
            if let Some(wrong) = face.wrong {
                return Err(wrong.to_string());
            }
            let (corner_count, before) = (face.corners.len(), self.mesh.polygons.corners().len());
            if corner_count < 3 {
                return Err(format!("has {corner_count} corners; it needs three"));
            }
            self.mesh.polygons.push(&face.corners);
            if face.texture.is_empty() && self.mesh.corner_uvs.is_empty() {
                return Ok(());
            }
            self.mesh.corner_uvs.resize(before, NO_UV);
            self.texture(corner_count, &face.texture)
        })
    }

    /// Texture coordinates of a face's corners; equal ones share their place in the pool.
    fn texture(&mut self, corner_count: usize, texture: &[f64]) -> std::result::Result<(), String> {
        if texture.is_empty() {
            self.mesh.corner_uvs.extend(std::iter::repeat_n(NO_UV, corner_count));
            return Ok(());
        }
        if texture.len() != corner_count * 2 {
            return Err(format!("has {} texture numbers for {corner_count} corners", texture.len()));
        }
        for uv in texture.chunks_exact(2) {
            if uv.iter().any(|x| !x.is_finite()) {
                return Err("a texture coordinate is not finite".to_string());
            }
            let uvs = &mut self.mesh.uvs;
            let at = *self.pool.entry([uv[0].to_bits(), uv[1].to_bits()]).or_insert_with(|| {
                uvs.push(Vector2::new(uv[0], uv[1]));
                uvs.len() as u32 - 1
            });
            self.mesh.corner_uvs.push(at);
        }
        Ok(())
    }

    fn finish(mut self, path: &Path) -> Result<Mesh> {
        let vertex_count = self.mesh.positions.len();
        if vertex_count == 0 {
            return Err(Error::new(path, "holds no vertices").fix("export the mesh again"));
        }
        if self.mesh.polygons.is_empty() {
            return Err(Error::new(path, "holds vertices but no faces")
                .fix("export the mesh with faces; point clouds cannot be used"));
        }
        for (face, polygon) in self.mesh.polygons.iter().enumerate() {
            if let Some(vertex) = polygon.iter().find(|&&vertex| vertex as usize >= vertex_count) {
                let what = format!("names vertex {vertex}; the file has {vertex_count} (counted from 0)");
                return Err(Error::new(path, what).at(format!("face {face}")).fix(EXPORT_AGAIN));
            }
        }
        if self.mesh.corner_uvs.is_empty() && !self.vertex_uvs.is_empty() {
            self.mesh.uvs = self.vertex_uvs;
            self.mesh.corner_uvs = self.mesh.polygons.corners().to_vec();
        }
        Ok(self.mesh)
    }
}
