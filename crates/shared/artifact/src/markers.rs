//! What the marker formats of others share: labels, units, gaps.

use crate::ids::check_marker_ids;
use crate::{Error, MarkerFrame, MarkerHeader, Rate, Result, Trajectories, Unit, Violation};
use nalgebra::Point3;
use std::borrow::Borrow;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// How many names or places a warning lists before it only counts.
const LISTED: usize = 5;

/// Units of length that exist but that no artifact uses; stating another one does not make them go away.
const FOREIGN_UNITS: [&str; 12] =
    ["in", "inch", "inches", "ft", "foot", "feet", "dm", "um", "µm", "yd", "yard", "km"];

/// The unit of a file whose text says `text` at `place`, where the user stated `stated`.
///
/// # Errors
/// If nobody states a unit that we know, or two statements disagree.
pub(crate) fn resolve_unit(
    path: &Path,
    place: &str,
    text: Option<&str>,
    stated: Option<Unit>,
    warnings: &mut Vec<String>,
) -> Result<Unit> {
    let text = text.map(str::trim).unwrap_or_default();
    if let Ok(unit) = text.parse::<Unit>() {
        return agree(path, place, unit, stated);
    }
    if FOREIGN_UNITS.contains(&text.to_ascii_lowercase().as_str()) {
        return Err(Error::new(path, format!("is in '{text}', which is not read here"))
            .at(place)
            .fix("export it in mm, cm or m"));
    }
    let what = match text {
        "" => "states no unit".to_string(),
        _ => format!("'{text}' is not a unit known here"),
    };
    let Some(unit) = stated else {
        return Err(Error::new(path, what)
            .at(place)
            .fix("say --marker-unit mm, --marker-unit cm or --marker-unit m"));
    };
    if !text.is_empty() {
        warnings.push(format!("{place}: {what}; read in {unit}, as stated"));
    }
    Ok(unit)
}

pub(crate) fn agree(path: &Path, place: &str, unit: Unit, stated: Option<Unit>) -> Result<Unit> {
    match stated.filter(|&stated| stated != unit) {
        Some(stated) => {
            Err(Error::new(path, format!("the file says {unit}, but --marker-unit says {stated}"))
                .at(place)
                .fix("find out which is right: leave --marker-unit out, or mend the file"))
        }
        None => Ok(unit),
    }
}

/// Makes ids of the labels of a file: an empty one becomes `marker_N` (N counts from 1), a doubled one `name_2`.
pub(crate) fn ids_of_labels(labels: &[String], warnings: &mut Vec<String>) -> Vec<String> {
    let mut taken: HashSet<String> = labels.iter().cloned().collect();
    let mut seen = HashSet::new();
    let mut suffixes = HashMap::new();
    let (mut generated, mut renamed) = (Vec::new(), Vec::new());
    let mut ids = Vec::with_capacity(labels.len());
    for (index, label) in labels.iter().enumerate() {
        let wanted = if label.is_empty() { format!("marker_{}", index + 1) } else { label.clone() };
        let free = if label.is_empty() { !taken.contains(&wanted) } else { seen.insert(label) };
        let id = if free { wanted } else { next_free(&wanted, &mut suffixes, &taken) };
        taken.insert(id.clone());
        if label.is_empty() {
            generated.push(id.clone());
        } else if id != *label {
            renamed.push(format!("{label} → {id}"));
        }
        ids.push(id);
    }
    if !generated.is_empty() {
        warnings.push(format!("{} markers have no label; named {}", generated.len(), listed(&generated)));
    }
    if !renamed.is_empty() {
        warnings.push(format!("{} labels stand twice; renamed {}", renamed.len(), listed(&renamed)));
    }
    ids
}

/// The first of `name_2`, `name_3`, … that no other marker has.
fn next_free(name: &str, suffixes: &mut HashMap<String, usize>, taken: &HashSet<String>) -> String {
    // Where the last search for this name ended, so that thousands of equal labels stay quick.
    let suffix = suffixes.entry(name.to_string()).or_insert(2);
    while taken.contains(&format!("{name}_{suffix}")) {
        *suffix += 1;
    }
    format!("{name}_{suffix}")
}

/// A list for a message; a long one is cut and counted.
pub(crate) fn listed(items: &[String]) -> String {
    let shown = items[..items.len().min(LISTED)].join(", ");
    match items.len().saturating_sub(LISTED) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// The rate that a file gives as a decimal number.
pub(crate) fn rate_of(place: &str, hz: f64, warnings: &mut Vec<String>) -> Option<Rate> {
    let rate = Rate::from_hz(hz);
    if rate.is_none() {
        warnings.push(format!("{place}: {hz} frames per second is no rate; read without one"));
    }
    rate
}

/// A number in a cell of a text format; `None` where the sample is missing (an empty cell, or NaN).
pub(crate) fn number_in_cell(cell: &str) -> std::result::Result<Option<f64>, String> {
    let cell = cell.trim();
    if cell.is_empty() || cell.eq_ignore_ascii_case("nan") {
        return Ok(None);
    }
    match cell.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(Some(number)),
        Ok(_) => Err(format!("'{cell}' is not a finite number")),
        Err(_) if cell.replacen(',', ".", 1).parse::<f64>().is_ok() => {
            Err(format!("'{cell}' has a decimal comma; export it with decimal points"))
        }
        Err(_) => Err(format!("'{cell}' is not a number")),
    }
}

/// Some writers store a missing sample as the origin without marking it.
pub(crate) fn warn_of_origins(ids: &[String], frames: &[MarkerFrame], warnings: &mut Vec<String>) {
    let at_origin =
        |marker: usize| frames.iter().filter(|frame| frame.points[marker] == Some(Point3::origin())).count();
    let counts = ids.iter().enumerate().map(|(marker, id)| (id, at_origin(marker)));
    let suspects: Vec<String> =
        counts.filter(|(_, count)| *count > 0).map(|(id, count)| format!("{id} in {count}")).collect();
    if !suspects.is_empty() {
        warnings.push(format!(
            "markers lie exactly at the origin without being marked as missing (frames: {}); kept as measured",
            listed(&suspects)
        ));
    }
}

/// A point in three cells; `None` where all are empty.
pub(crate) fn point_in_cells(
    cells: [&str; 3],
    scale: f64,
) -> std::result::Result<Option<Point3<f64>>, String> {
    match (number_in_cell(cells[0])?, number_in_cell(cells[1])?, number_in_cell(cells[2])?) {
        (Some(x), Some(y), Some(z)) => Ok(Some(Point3::new(x, y, z) * scale)),
        (None, None, None) => Ok(None),
        _ => Err("has only some of its three coordinates".to_string()),
    }
}

/// What every writer asks of a header; returns the rate, without which these formats cannot be.
pub(crate) fn check_writable(path: &Path, header: &MarkerHeader, frame_count: usize) -> Result<Rate> {
    let refuse = |what: &str, fix: &str| Err(Error::new(path, what).fix(fix));
    check_marker_ids(&header.markers).map_err(|violation| violation.in_file(path))?;
    if header.markers.is_empty() || frame_count == 0 {
        return refuse("there are no markers or no frames to write", "check the stage before");
    }
    match header.rate.filter(|rate| rate.hz().is_finite() && rate.hz() > 0.0) {
        Some(rate) => Ok(rate),
        None => refuse(
            "the trajectories have no frame rate, which this format needs",
            "write .jsonl, or give the source a rate",
        ),
    }
}

/// The frames as they come, each checked: numbers rise within the extent, points are as many as markers, and finite.
pub(crate) fn checked<'a, F: Borrow<MarkerFrame>>(
    path: &'a Path,
    markers: &'a [String],
    extent: &'a Extent,
    frames: impl Iterator<Item = Result<F>> + 'a,
) -> impl Iterator<Item = Result<F>> + 'a {
    let mut last = None;
    frames.map(move |frame| {
        let frame = frame?;
        check_frame(markers, extent, last, frame.borrow()).map_err(|violation| violation.in_file(path))?;
        last = Some(frame.borrow().frame);
        Ok(frame)
    })
}

fn check_frame(
    markers: &[String],
    extent: &Extent,
    last: Option<i64>,
    frame: &MarkerFrame,
) -> std::result::Result<(), Violation> {
    let refuse = |what: String| Err(Violation::new(format!("frame {}", frame.frame), what));
    if let Some(last) = last.filter(|&last| last >= frame.frame) {
        return refuse(format!("follows frame {last}"));
    }
    if !(extent.first..=extent.last).contains(&frame.frame) {
        return refuse(format!("is not in the announced range {} to {}", extent.first, extent.last));
    }
    if frame.points.len() != markers.len() {
        return refuse(format!("has {} points for {} markers", frame.points.len(), markers.len()));
    }
    for (marker, point) in markers.iter().zip(&frame.points) {
        if let Some(number) = point.iter().flat_map(|point| point.iter()).find(|x| !x.is_finite()) {
            let place = format!("frame {}, marker {marker}", frame.frame);
            return Err(Violation::new(place, format!("{number} is not a finite number")));
        }
    }
    Ok(())
}

/// Which frames a file is to hold; formats that count in their header must know before the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Extent {
    /// Number of the first frame.
    pub first: i64,
    /// Number of the last frame.
    pub last: i64,
    /// How many there are.
    pub count: usize,
}

impl Extent {
    /// Of trajectories in memory.
    #[must_use]
    pub fn of(trajectories: &Trajectories) -> Self {
        let number = |frame: Option<&MarkerFrame>| frame.map_or(0, |frame| frame.frame);
        let frames = &trajectories.frames;
        Self { first: number(frames.first()), last: number(frames.last()), count: frames.len() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ids(labels: &[&str]) -> (Vec<String>, usize) {
        let mut warnings = Vec::new();
        let labels: Vec<String> = labels.iter().map(ToString::to_string).collect();
        (ids_of_labels(&labels, &mut warnings), warnings.len())
    }

    #[test]
    fn labels_become_ids_that_differ() {
        assert_eq!(ids(&["a", "b"]), (vec!["a".into(), "b".into()], 0));
        assert_eq!(ids(&["a", "", "a", "a_2", "a"]).0, ["a", "marker_2", "a_3", "a_2", "a_4"]);
        assert_eq!(ids(&["", "marker_1", ""]).0, ["marker_1_2", "marker_1", "marker_3"]);
        assert_eq!(ids(&["a", "", "a"]).1, 2);
    }

    #[test]
    fn many_equal_labels_stay_quick_and_differ() {
        let labels = vec!["x".to_string(); 20_000];
        let ids = ids_of_labels(&labels, &mut Vec::new());
        assert_eq!(ids.iter().collect::<HashSet<_>>().len(), 20_000);
    }
}
