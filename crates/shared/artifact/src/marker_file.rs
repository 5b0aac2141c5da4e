//! Markers of any supported format, by the file's ending.

use crate::markers::agree;
use crate::source::ending;
use crate::{
    Error, MarkerFrame, MarkerHeader, Result, Staged, Stream, Trajectories, Unit, c3d, is_standard_stream,
    marker_csv, trc,
};
use std::path::Path;

/// Reads markers of any supported format, by the file's ending: `.jsonl` or `-` (kind `S`), `.c3d`, `.trc`, `.csv`.
///
/// Positions come out in mm. `unit` is what the user says the file is in, for formats that do not say it themselves.
/// Also returns warnings: what was malformed, and how it was read all the same.
///
/// # Errors
/// If the ending is unknown, the file cannot be read, states no unit and none is given, or states another one.
pub fn read_trajectories<S>(path: &Path, unit: Option<Unit>) -> Result<(Trajectories, Vec<String>)>
where
    S: Stream<Header = MarkerHeader, Frame = MarkerFrame>,
{
    let (trajectories, warnings) = match ending(path).as_str() {
        _ if is_standard_stream(path) => (read_artifact::<S>(path, unit)?, Vec::new()),
        "jsonl" => (read_artifact::<S>(path, unit)?, Vec::new()),
        "c3d" => {
            let c3d = c3d::read(path, unit)?;
            (c3d.trajectories, c3d.warnings)
        }
        "trc" => trc::read(path, unit)?,
        "csv" => marker_csv::read(path, unit)?,
        _ => return Err(unknown(path, ".jsonl, .c3d, .trc or .csv")),
    };
    let warnings = warnings.into_iter().map(|warning| format!("{}: {warning}", path.display()));
    Ok((trajectories, warnings.collect()))
}

/// Writes markers in any supported format, by the file's ending: `.jsonl` or `-` (kind `S`), `.c3d`, `.trc`.
///
/// # Errors
/// If the ending is unknown, the format cannot hold the markers, or the file cannot be written.
pub fn write_trajectories<S>(path: &Path, trajectories: &Trajectories) -> Result<Staged>
where
    S: Stream<Header = MarkerHeader, Frame = MarkerFrame>,
{
    match ending(path).as_str() {
        _ if is_standard_stream(path) => trajectories.write::<S>(path),
        "jsonl" => trajectories.write::<S>(path),
        "c3d" => c3d::write(path, trajectories),
        "trc" => trc::write(path, trajectories),
        _ => Err(unknown(path, ".jsonl, .c3d or .trc")),
    }
}

fn read_artifact<S>(path: &Path, unit: Option<Unit>) -> Result<Trajectories>
where
    S: Stream<Header = MarkerHeader, Frame = MarkerFrame>,
{
    let trajectories = Trajectories::read::<S>(path)?;
    check_marker_unit(path, &trajectories.header, unit)?;
    Ok(trajectories)
}

/// Refuses a unit that a user states for markers whose artifact says another one.
///
/// # Errors
/// If the two disagree.
pub fn check_marker_unit(path: &Path, header: &MarkerHeader, stated: Option<Unit>) -> Result<()> {
    agree(path, "unit", header.unit, stated).map(drop)
}

fn unknown(path: &Path, known: &str) -> Error {
    Error::new(path, "has an ending that is no marker format known here").fix(format!("use {known}"))
}
