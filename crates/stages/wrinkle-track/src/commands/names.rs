//! Tables in which people name wrinkles.

use anyhow::{Context, bail};
use std::path::Path;
use wrinkle_track::{NamedPlace, Place};

/// A row of a table.
pub(crate) struct Name {
    pub(crate) camera: String,
    /// Frame in which the wrinkle lies there; that of the mask if none is said.
    pub(crate) frame: Option<i64>,
    pub(crate) place: NamedPlace,
    pub(crate) line: u64,
}

/// The columns that must be there; others may stand beside them, among them `frame`.
const COLUMNS: [&str; 4] = ["camera", "x", "y", "wrinkle"];

/// Reads a table; rows without a name are left out.
pub(crate) fn read_names(path: &Path) -> anyhow::Result<Vec<Name>> {
    let bytes = artifact::read_bytes(path)?;
    let mut table = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(bytes.as_slice());
    let heads = table.headers().with_context(|| path.display().to_string())?.clone();
    let find = |name: &str| heads.iter().position(|head| head.trim_start_matches('\u{feff}') == name);
    let mut columns = [0; COLUMNS.len()];
    for (column, name) in columns.iter_mut().zip(COLUMNS) {
        *column = find(name).with_context(|| {
            format!(
                "{}: has no column {name}\n  to do: write a table with the columns camera, x, y and wrinkle, separated by commas",
                path.display()
            )
        })?;
    }
    let frame = find("frame");
    let mut names = Vec::new();
    for row in table.records() {
        let row = row.with_context(|| path.display().to_string())?;
        let line = row.position().map_or(0, csv::Position::line);
        let cell = |column: usize| row.get(column).unwrap_or("");
        let read = name(columns.map(cell), frame.map_or("", cell), line);
        names.extend(read.map_err(|what| anyhow::anyhow!("{}, line {line}: {what}", path.display()))?);
    }
    if names.is_empty() {
        bail!("{}: names no wrinkle\n  to do: write names into the column wrinkle", path.display());
    }
    Ok(names)
}

fn name([camera, x, y, wrinkle]: [&str; 4], frame: &str, line: u64) -> Result<Option<Name>, String> {
    if wrinkle.is_empty() {
        return Ok(None);
    }
    let number = |text: &str| match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("'{text}' is no place in px")),
    };
    let frame = match frame {
        "" => None,
        text => Some(text.parse().map_err(|_| format!("'{text}' is no frame"))?),
    };
    let place = NamedPlace { wrinkle: wrinkle.to_string(), at: Place::new(number(x)?, number(y)?) };
    Ok(Some(Name { camera: camera.to_string(), frame, place, line }))
}
