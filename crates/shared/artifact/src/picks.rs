//! Correspondences picked in other programs: MeshLab's `.pp` and plain `.csv`.
//!
//! A `.pp` file gives points in the mesh's unit; points that are switched off are passed over. A `.csv` file has a
//! line per marker, `marker,vertex` (0-based) or `marker,x,y,z`, with a header line (columns in any order) or without;
//! commas, semicolons or tabs. Which vertex a point means is not decided here.

use crate::source::read_text;
use crate::{Error, Result, Unit, source};
use nalgebra::Point3;
use std::collections::HashMap;
use std::path::Path;

/// A marker and where somebody says that it sits.
#[derive(Debug, Clone, PartialEq)]
pub struct Pick {
    /// Marker id.
    pub marker: String,
    /// The place.
    pub place: PickPlace,
}

/// A place on a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PickPlace {
    /// Vertex index, 0-based; whether the mesh has it is not known here.
    Vertex(u32),
    /// A point on the surface, mm.
    Point(Point3<f64>),
}

/// Reads picks (`.pp`, `.csv`), in the file's order; `unit` is that of the mesh that was picked on.
///
/// # Errors
/// Names the line of: a number that is none or not finite, a marker without a name, a marker that is picked twice;
/// and refuses a file without picks or of another format.
pub fn read(path: &Path, unit: Unit) -> Result<Vec<Pick>> {
    let text = read_text(path)?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let picks = match source::ending(path).as_str() {
        "pp" => read_meshlab(path, text, unit)?,
        "csv" => read_csv(path, text, unit)?,
        _ => {
            return Err(Error::new(path, "has an ending that is no format of picks known here")
                .fix("use MeshLab's .pp, or .csv with marker,vertex or marker,x,y,z"));
        }
    };
    check_names(path, &picks)?;
    Ok(picks.into_iter().map(|(_, pick)| pick).collect())
}

/// A pick and its line.
type Line = (usize, Pick);

fn check_names(path: &Path, picks: &[Line]) -> Result<()> {
    let mut lines = HashMap::new();
    for (line, Pick { marker, .. }) in picks {
        let refuse = |what: String| Err(Error::new(path, what).at(format!("line {line}")));
        if marker.is_empty() {
            return refuse("a pick has no marker name".to_string());
        }
        if let Some(first) = lines.insert(marker, line) {
            return refuse(format!("marker {marker} is picked twice, first in line {first}"));
        }
    }
    match picks.is_empty() {
        true => {
            Err(Error::new(path, "holds no picks").fix("pick at least one point and save the file again"))
        }
        false => Ok(()),
    }
}

fn read_meshlab(path: &Path, text: &str, unit: Unit) -> Result<Vec<Line>> {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    let document = roxmltree::Document::parse_with_options(text, options).map_err(|error| {
        let said = error.to_string();
        let what = said.rsplit_once(" at ").map_or(said.as_str(), |(what, _)| what);
        Error::new(path, format!("is not XML that can be read: {what}"))
            .at(format!("line {}", error.pos().row))
            .fix("save the picked points in MeshLab again")
    })?;
    if document.root_element().tag_name().name() != "PickedPoints" {
        return Err(Error::new(path, "is XML, but not MeshLab's PickedPoints").at("line 1"));
    }
    let is_pick = |node: &roxmltree::Node| {
        node.has_tag_name("point") && !matches!(node.attribute("active"), Some("0" | "false"))
    };
    document
        .descendants()
        .filter(is_pick)
        .map(|node| {
            let line = document.text_pos_at(node.range().start).row as usize;
            let pick = meshlab_point(&node, unit);
            pick.map(|pick| (line, pick)).map_err(|what| Error::new(path, what).at(format!("line {line}")))
        })
        .collect()
}

fn meshlab_point(node: &roxmltree::Node, unit: Unit) -> std::result::Result<Pick, String> {
    let axis = |name: &str| {
        let value = node.attribute(name).ok_or_else(|| format!("a point lacks the attribute {name}"))?;
        number(value)
    };
    let place = point([axis("x")?, axis("y")?, axis("z")?], unit)?;
    Ok(Pick { marker: node.attribute("name").unwrap_or_default().trim().to_string(), place })
}

fn read_csv(path: &Path, text: &str, unit: Unit) -> Result<Vec<Line>> {
    let first_line = text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
    let delimiter = [b',', b';', b'\t'].into_iter().find(|&byte| first_line.as_bytes().contains(&byte));
    let mut records = csv::ReaderBuilder::new()
        .delimiter(delimiter.unwrap_or(b','))
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut columns = None;
    let mut picks = Vec::new();
    for record in records.records() {
        let record = record.map_err(|error| Error::new(path, format!("is not CSV: {error}")))?;
        let line = line_of(text, &record);
        let refuse = |what: String| Error::new(path, what).at(format!("line {line}"));
        if record.iter().all(str::is_empty) {
            continue;
        }
        match columns {
            None => {
                let (found, is_header) = Columns::of(&record).map_err(refuse)?;
                if !is_header {
                    picks.push((line, found.pick(&record, unit).map_err(refuse)?));
                }
                columns = Some(found);
            }
            Some(columns) => picks.push((line, columns.pick(&record, unit).map_err(refuse)?)),
        }
    }
    Ok(picks)
}

/// The line that a record stands in; the parser's own count stops before empty lines.
fn line_of(text: &str, record: &csv::StringRecord) -> usize {
    let start = record.position().map_or(0, |position| position.byte() as usize);
    let is_text = |byte: &u8| !matches!(byte, b'\r' | b'\n');
    let before =
        text.as_bytes()[start..].iter().position(is_text).map_or(text.len(), |skipped| start + skipped);
    text.as_bytes()[..before].iter().filter(|&&byte| byte == b'\n').count() + 1
}

/// Which column holds what.
#[derive(Clone, Copy)]
struct Columns {
    count: usize,
    marker: usize,
    place: PlaceColumns,
}

#[derive(Clone, Copy)]
enum PlaceColumns {
    Vertex(usize),
    Point([usize; 3]),
}

impl Columns {
    /// From the first line, and whether that line is a header.
    fn of(first: &csv::StringRecord) -> std::result::Result<(Self, bool), String> {
        let count = first.len();
        let column = |name: &str| first.iter().position(|field| field.eq_ignore_ascii_case(name));
        if let Some(marker) = column("marker") {
            let place = match (column("vertex"), column("x"), column("y"), column("z")) {
                (Some(vertex), ..) => PlaceColumns::Vertex(vertex),
                (None, Some(x), Some(y), Some(z)) => PlaceColumns::Point([x, y, z]),
                _ => return Err("the header names neither vertex nor x, y and z".to_string()),
            };
            return Ok((Self { count, marker, place }, true));
        }
        let place = match count {
            2 => PlaceColumns::Vertex(1),
            4 => PlaceColumns::Point([1, 2, 3]),
            _ => return Err(format!("{count} columns; say marker,vertex or marker,x,y,z")),
        };
        Ok((Self { count, marker: 0, place }, false))
    }

    fn pick(self, record: &csv::StringRecord, unit: Unit) -> std::result::Result<Pick, String> {
        if record.len() != self.count {
            return Err(format!("{} columns; the first line has {}", record.len(), self.count));
        }
        let field = |column: usize| record.get(column).unwrap_or_default();
        let place = match self.place {
            PlaceColumns::Vertex(column) => field(column)
                .parse()
                .map(PickPlace::Vertex)
                .map_err(|_| format!("'{}' is not a vertex index", field(column)))?,
            PlaceColumns::Point([x, y, z]) => {
                point([number(field(x))?, number(field(y))?, number(field(z))?], unit)?
            }
        };
        Ok(Pick { marker: field(self.marker).to_string(), place })
    }
}

fn number(text: &str) -> std::result::Result<f64, String> {
    text.trim().parse().map_err(|_| format!("'{text}' is not a number"))
}

fn point(coordinates: [f64; 3], unit: Unit) -> std::result::Result<PickPlace, String> {
    let point = Point3::from(coordinates) * unit.in_mm();
    match point.iter().find(|x| !x.is_finite()) {
        Some(x) => Err(format!("{x} is not a finite number")),
        None => Ok(PickPlace::Point(point)),
    }
}
