//! Markers in CSV, in: `time_s` or `frame` (or both), then `<marker>_x,<marker>_y,<marker>_z` per marker.
//!
//! Empty cells (and `NaN`) are missing samples. CSV states no unit; the user says it. Where there is no `frame`
//! column, the rate is found from the times, and a frame's number is its time in frames: time 0 is frame 0.

use crate::markers::{ids_of_labels, number_in_cell, point_in_cells, resolve_unit, warn_of_origins};
use crate::source::text_of;
use crate::trc::frame_number;
use crate::{Error, MarkerFrame, MarkerHeader, Rate, Result, SampleStatus, Trajectories, Unit, read_bytes};
use std::path::Path;

/// How far a time may lie from a whole frame, in frames; covers times rounded to 1 ms at up to 500 Hz.
const TIME_TOLERANCE: f64 = 0.25;

/// Reads markers; positions come out in mm. Also returns warnings.
///
/// # Errors
/// Names the line and column of what is malformed; refuses a file without `unit`, without markers or frames, and
/// times that are no whole frames at any rate.
pub fn read(path: &Path, unit: Option<Unit>) -> Result<(Trajectories, Vec<String>)> {
    parse(path, &read_bytes(path)?, unit)
}

/// Reads markers from the bytes of a file; `path` is for messages.
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, bytes: &[u8], unit: Option<Unit>) -> Result<(Trajectories, Vec<String>)> {
    let mut warnings = Vec::new();
    let unit = resolve_unit(path, "CSV", None, unit, &mut warnings)?;
    let text = text_of(path, bytes.to_vec())?;
    let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
    let mut records = reader.records().map(|record| record.map_err(|error| malformed(path, &error)));
    let first = records.next().ok_or_else(|| Error::new(path, "is empty").fix("export it again"))??;
    let columns = Columns::read(path, &first)?;
    let ids = ids_of_labels(&columns.labels, &mut warnings);
    let mut rows = Vec::new();
    for record in records {
        rows.push(columns.row(path, &record?, unit.in_mm())?);
    }
    if rows.is_empty() {
        return Err(Error::new(path, "holds no frames")
            .at("line 2")
            .fix("it may be cut short; export it again"));
    }
    if bytes.last().is_some_and(|&byte| byte != b'\n' && byte != b'\r') {
        warnings.push(
            "the last line has no line end; if the file was cut there, its last number is short".into(),
        );
    }
    let (numbers, rate) = columns.number(path, &rows, &mut warnings)?;
    let status = vec![SampleStatus::Measured; ids.len()];
    let frames = numbers.into_iter().zip(rows);
    let frames = frames.map(|(frame, row)| MarkerFrame { frame, points: row.points, status: status.clone() });
    let frames: Vec<MarkerFrame> = frames.collect();
    warn_of_origins(&ids, &frames, &mut warnings);
    let header = MarkerHeader { unit: Unit::Mm, rate, markers: ids, take: None };
    Ok((Trajectories { header, frames }, warnings))
}

fn malformed(path: &Path, error: &csv::Error) -> Error {
    let place = error.position().map_or(0, csv::Position::line);
    Error::new(path, format!("is not CSV: {error}"))
        .at(format!("line {place}"))
        .fix("check that this is the right file")
}

/// What stands in which column.
struct Columns {
    frame: Option<usize>,
    time: Option<usize>,
    /// Column of the first coordinate.
    first: usize,
    labels: Vec<String>,
}

/// A line of the file.
struct Row {
    line: u64,
    frame: Option<i64>,
    time: Option<f64>,
    points: Vec<Option<nalgebra::Point3<f64>>>,
}

impl Columns {
    fn read(path: &Path, record: &csv::StringRecord) -> Result<Self> {
        let refuse = |column: usize, what: String, fix: &str| {
            Err(Error::new(path, what).at(format!("line 1, column {}", column + 1)).fix(fix))
        };
        let names: Vec<&str> = record.iter().map(|name| name.trim().trim_start_matches('\u{feff}')).collect();
        let leads = |name: &&&str| matches!(**name, "frame" | "time_s");
        let first = names.iter().take_while(leads).count();
        let find = |wanted: &str| names[..first].iter().position(|name| *name == wanted);
        let (frame, time) = (find("frame"), find("time_s"));
        if first == 0 || first > usize::from(frame.is_some()) + usize::from(time.is_some()) {
            let what = format!("'{}' where time_s or frame is expected", names.first().unwrap_or(&""));
            return refuse(0, what, "start with a column time_s or frame, and separate columns by commas");
        }
        let coordinates = &names[first..];
        let mut labels = Vec::new();
        for (marker, triple) in coordinates.chunks(3).enumerate() {
            let label = triple[0].strip_suffix("_x").unwrap_or_default();
            let wanted = [format!("{label}_x"), format!("{label}_y"), format!("{label}_z")];
            if triple != wanted.each_ref().map(String::as_str) {
                let what = format!("'{}' are not the three columns of a marker", triple.join(","));
                return refuse(first + 3 * marker, what, "name them <marker>_x,<marker>_y,<marker>_z");
            }
            labels.push(label.to_string());
        }
        if labels.is_empty() {
            return refuse(
                first,
                "there are no markers".into(),
                "add columns <marker>_x,<marker>_y,<marker>_z",
            );
        }
        Ok(Self { frame, time, first, labels })
    }

    fn row(&self, path: &Path, record: &csv::StringRecord, scale: f64) -> Result<Row> {
        let line = record.position().map_or(0, csv::Position::line);
        let width = self.first + 3 * self.labels.len();
        if record.len() != width {
            let what = format!("has {} cells, the first line has {width}", record.len());
            let fix = match record.len() > width {
                true => "export it with decimal points, and commas only between cells",
                false => "it may be cut short; export it again",
            };
            return Err(Error::new(path, what).at(format!("line {line}")).fix(fix));
        }
        let cell = |column: usize| record.get(column).unwrap_or_default();
        let refuse =
            |column: usize, what| Error::new(path, what).at(format!("line {line}, column {}", column + 1));
        let frame = self.frame.map(|column| frame_number(cell(column)).map_err(|what| refuse(column, what)));
        let time = self.time.map(|column| number_in_cell(cell(column)).map_err(|what| refuse(column, what)));
        let points = self.labels.iter().enumerate().map(|(marker, label)| {
            let column = self.first + 3 * marker;
            point_in_cells([cell(column), cell(column + 1), cell(column + 2)], scale)
                .map_err(|what| Error::new(path, what).at(format!("line {line}, marker {label}")))
        });
        let time = time.transpose()?.flatten();
        Ok(Row { line, frame: frame.transpose()?, time, points: points.collect::<Result<_>>()? })
    }

    /// Numbers of the frames, and the rate.
    fn number(
        &self,
        path: &Path,
        rows: &[Row],
        warnings: &mut Vec<String>,
    ) -> Result<(Vec<i64>, Option<Rate>)> {
        let numbers: Vec<i64> = rows.iter().filter_map(|row| row.frame).collect();
        let times: Vec<f64> = rows.iter().filter_map(|row| row.time).collect();
        if self.time.is_some() && times.len() < rows.len() {
            let line = rows.iter().find(|row| row.time.is_none()).map_or(0, |row| row.line);
            return Err(Error::new(path, "the time is missing").at(format!("line {line}")).fix("state it"));
        }
        if self.frame.is_some() {
            rising(path, rows, &numbers)?;
            let rate = if self.time.is_some() { rate_of_frames(&numbers, &times) } else { None };
            if rate.is_none() {
                warnings.push("no rate is stated and none follows from the times; read without one".into());
            }
            return Ok((numbers, rate));
        }
        if times.len() == 1 {
            warnings.push("one frame states no rate; it is read as frame 0".into());
            return Ok((vec![0], None));
        }
        if let Some(index) = (1..times.len()).find(|&index| times[index - 1] >= times[index]) {
            let what = format!("time {} follows time {}", times[index], times[index - 1]);
            return Err(Error::new(path, what)
                .at(format!("line {}", rows[index].line))
                .fix("times must rise"));
        }
        let rate = rate_of_times(&times).ok_or_else(|| {
            Error::new(path, "the times are no whole frames at any rate")
                .at("column time_s")
                .fix("resample to a fixed rate, or give a column frame")
        })?;
        let first = (times[0] * rate.hz()).round() as i64;
        let since = |time: f64| ((time - times[0]) * rate.hz()).round() as i64;
        let numbers: Vec<i64> = times.iter().map(|&time| first.saturating_add(since(time))).collect();
        rising(path, rows, &numbers)?;
        Ok((numbers, Some(rate)))
    }
}

fn rising(path: &Path, rows: &[Row], numbers: &[i64]) -> Result<()> {
    match (1..numbers.len()).find(|&index| numbers[index - 1] >= numbers[index]) {
        None => Ok(()),
        Some(index) => {
            let what = format!("frame {} follows frame {}", numbers[index], numbers[index - 1]);
            Err(Error::new(path, what).at(format!("line {}", rows[index].line)).fix("frames must rise"))
        }
    }
}

/// The rate of numbered frames.
fn rate_of_frames(numbers: &[i64], times: &[f64]) -> Option<Rate> {
    let (first, start) = (*numbers.first()?, *times.first()?);
    let frames = numbers.last()?.checked_sub(first)? as f64;
    best_rate(&[frames / (times.last()? - start)], |rate| {
        let off =
            |(number, time): (&i64, &f64)| (time - start) * rate.hz() - number.saturating_sub(first) as f64;
        numbers.iter().zip(times).map(off).map(f64::abs).fold(0.0, f64::max)
    })
}

/// The rate at which all times are whole frames after the first. The mean step says it best unless frames are
/// missing; the median step does unless times are rounded coarsely.
fn rate_of_times(times: &[f64]) -> Option<Rate> {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let (start, median) = (*times.first()?, *steps.get(steps.len() / 2)?);
    let mean = (times.last()? - start) / steps.len() as f64;
    best_rate(&[1.0 / mean, 1.0 / median], |rate| {
        let frames = times.iter().map(|time| (time - start) * rate.hz());
        frames.map(|frames| (frames - frames.round()).abs()).fold(0.0, f64::max)
    })
}

/// Of the rates near the estimates the one with the smallest error (in frames), if that is tolerable. Whole rates
/// and their 1000/1001 go first: rounded times would bend any other fraction to themselves.
fn best_rate(estimates: &[f64], error: impl Fn(Rate) -> f64) -> Option<Rate> {
    let usual = estimates.iter().flat_map(|hz| [hz.round(), hz.round() * 1000.0 / 1001.0]);
    let best = |rates: Vec<f64>| {
        let rates = rates.into_iter().filter_map(Rate::from_hz).map(|rate| (error(rate), rate));
        let tolerable = rates.filter(|(error, _)| *error <= TIME_TOLERANCE);
        tolerable.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, rate)| rate)
    };
    best(usual.collect()).or_else(|| best(estimates.to_vec()))
}
