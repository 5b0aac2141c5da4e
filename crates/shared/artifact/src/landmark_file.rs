//! Landmarks from other programs: WebMorph and Psychomorph (`.tem`), ibug and menpo (`.pts`), and spreadsheets (`.csv`).

use crate::source::{ending, read_text};
use crate::{Document, Error, Landmark, Landmarks, Result, read_document};
use std::path::Path;

/// Landmarks and what their numbers are.
#[derive(Debug, Clone, PartialEq)]
pub struct LandmarkFile {
    /// The landmarks.
    pub landmarks: Landmarks,
    /// Whether places are texture coordinates (u right, v up, in tiles) and no pixels.
    pub is_uv: bool,
}

/// Reads landmarks by the file's ending: `.json` (ours), `.tem`, `.pts`, `.csv`.
///
/// - `.tem`: a count, then x and y of each point; ids are `0`, `1`, …
/// - `.pts`: points between braces, counted from 1, and so are their pixels: 1 is taken off.
/// - `.csv`: columns x, y (or `x_px`, `y_px`; or u, v), optionally id and z (or `z_rel`, `depth_px`); without an id column rows are `0`, `1`, …
///
/// # Errors
/// Names the line of what is no number or missing.
pub fn read_landmarks(path: &Path) -> Result<LandmarkFile> {
    let (points, is_uv) = match ending(path).as_str() {
        "json" => return Ok(LandmarkFile { landmarks: read_document(path)?, is_uv: false }),
        "tem" => (template(path, &read_text(path)?)?, false),
        "pts" => (braces(path, &read_text(path)?)?, false),
        "csv" => table(path, &read_text(path)?)?,
        _ => {
            return Err(Error::new(path, "has an ending that is no format of landmarks known here")
                .fix("give .json, .tem (WebMorph), .pts (ibug) or .csv with id,x,y"));
        }
    };
    let mut landmarks = Landmarks::default();
    for (line, id, point) in points {
        if landmarks.points.insert(id.clone(), point).is_some() {
            return Err(Error::new(path, format!("landmark {id} stands here again"))
                .at(format!("line {line}"))
                .fix("give each landmark an id of its own"));
        }
    }
    match landmarks.points.is_empty() {
        true => {
            Err(Error::new(path, "holds no landmarks").fix("mark at least 4 places and save the file again"))
        }
        false => landmarks
            .check()
            .map_err(|violation| violation.in_file(path))
            .map(|()| LandmarkFile { landmarks, is_uv }),
    }
}

/// Line, id and place.
type Row = (usize, String, Landmark);

fn number(path: &Path, line: usize, text: &str) -> Result<f64> {
    let parsed = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    parsed.ok_or_else(|| {
        Error::new(path, format!("'{}' is no number", text.trim()))
            .at(format!("line {line}"))
            .fix("mend the line, with a point as decimal mark")
    })
}

fn place(path: &Path, line: usize, text: &str) -> Result<Landmark> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let [x, y] = words[..] else {
        return Err(Error::new(path, format!("'{}' is not x and y of a point", text.trim()))
            .at(format!("line {line}"))
            .fix("give two numbers with a space between"));
    };
    Ok(Landmark { at: [number(path, line, x)?, number(path, line, y)?], depth_px: None })
}

fn template(path: &Path, text: &str) -> Result<Vec<Row>> {
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line))
        .filter(|(_, line)| !line.trim().is_empty());
    let count = lines.next().and_then(|(_, line)| line.trim().parse::<usize>().ok()).ok_or_else(|| {
        Error::new(path, "does not begin with the number of its points")
            .at("line 1")
            .fix("save the template from WebMorph again")
    })?;
    (0..count)
        .map(|index| {
            let (line, text) = lines.next().ok_or_else(|| {
                Error::new(path, format!("has {index} points, not {count} as it says"))
                    .fix("save the template from WebMorph again")
            })?;
            Ok((line, index.to_string(), place(path, line, text)?))
        })
        .collect()
}

fn braces(path: &Path, text: &str) -> Result<Vec<Row>> {
    let body = text.lines().enumerate().skip_while(|(_, line)| line.trim() != "{").skip(1);
    let rows: Vec<Row> = body
        .take_while(|(_, line)| line.trim() != "}")
        .filter(|(_, line)| !line.trim().is_empty())
        .enumerate()
        .map(|(index, (line, text))| {
            let point = place(path, line + 1, text)?;
            Ok((line + 1, (index + 1).to_string(), Landmark { at: point.at.map(|x| x - 1.0), ..point }))
        })
        .collect::<Result<_>>()?;
    match rows.is_empty() {
        true => Err(Error::new(path, "has no points between { and }").fix("give a .pts file of ibug's form")),
        false => Ok(rows),
    }
}

fn table(path: &Path, text: &str) -> Result<(Vec<Row>, bool)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line))
        .filter(|(_, line)| !line.trim().is_empty());
    let header: Vec<String> = lines
        .next()
        .map(|(_, line)| line.split([',', ';', '\t']).map(|name| name.trim().to_ascii_lowercase()).collect())
        .unwrap_or_default();
    let column = |names: &[&str]| header.iter().position(|name| names.contains(&name.as_str()));
    let is_uv = column(&["u"]).is_some() && column(&["v"]).is_some();
    let (x, y) = (column(&["x", "x_px", "u"]), column(&["y", "y_px", "v"]));
    let (Some(x), Some(y)) = (x, y) else {
        return Err(Error::new(path, "its first line names no columns x and y, nor u and v")
            .at("line 1")
            .fix("begin the file with a line like id,x,y"));
    };
    let (id, depth) = (column(&["id", "name", "landmark"]), column(&["z", "z_rel", "depth_px"]));
    let row = |(index, (line, text)): (usize, (usize, &str))| {
        let cells: Vec<&str> = text.split([',', ';', '\t']).collect();
        let cell = |column: usize| {
            cells.get(column).copied().ok_or_else(|| {
                Error::new(path, format!("has {} columns, not {}", cells.len(), header.len()))
                    .at(format!("line {line}"))
                    .fix("give each line what the first one names")
            })
        };
        let at = [number(path, line, cell(x)?)?, number(path, line, cell(y)?)?];
        let depth_px = depth.map(|column| number(path, line, cell(column)?)).transpose()?;
        let id = id.map_or(Ok(index.to_string()), |column| cell(column).map(|id| id.trim().to_string()))?;
        Ok((line, id, Landmark { at, depth_px }))
    };
    Ok((lines.enumerate().map(row).collect::<Result<_>>()?, is_uv))
}
