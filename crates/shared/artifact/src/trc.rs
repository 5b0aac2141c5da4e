//! TRC, the tab-separated marker format of OpenSim and Motion Analysis, in and out.
//!
//! Three lines of header (the second names the values of the third: `DataRate`, `NumFrames`, `NumMarkers`, `Units`,
//! …), a line of labels (one per three columns), a line of axis names, then a line per frame: number, time, and
//! three coordinates per marker. Empty cells are missing samples, and so is `NaN`.

use crate::markers::{
    check_writable, checked, ids_of_labels, listed, number_in_cell, point_in_cells, rate_of, resolve_unit,
    warn_of_origins,
};
use crate::source::read_text;
use crate::{
    Error, Extent, MarkerFrame, MarkerHeader, Rate, Result, SampleStatus, Sink, Staged, Trajectories, Unit,
    file_name,
};
use std::borrow::Borrow;
use std::io::Write;
use std::path::Path;

/// Columns before the first coordinate: frame number and time.
const LEADING: usize = 2;
/// Lines before the first frame: three of header, labels, axes.
const HEADER_LINES: usize = 5;

/// Reads markers; positions come out in mm. `unit` is what the user says the file is in. Also returns warnings.
///
/// # Errors
/// Names the line and column of what is malformed; refuses a file that is cut short, that contradicts its own header,
/// or whose unit is unknown or not the stated one.
pub fn read(path: &Path, unit: Option<Unit>) -> Result<(Trajectories, Vec<String>)> {
    parse(path, &read_text(path)?, unit)
}

/// Reads markers from the text of a file; `path` is for messages.
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, text: &str, unit: Option<Unit>) -> Result<(Trajectories, Vec<String>)> {
    let mut warnings = Vec::new();
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines: Vec<&str> = text.lines().collect();
    let head = Head::read(path, &lines)?;
    let unit = resolve_unit(path, "line 3, Units", head.text("Units"), unit, &mut warnings)?;
    let ids = ids_of_labels(&labels(path, &lines, &head, &mut warnings)?, &mut warnings);
    let mut rows = Rows { path, ids: &ids, scale: unit.in_mm(), tails: 0, cut_line: None, last: None };
    if !text.ends_with('\n') {
        warnings.push(
            "the last line has no line end; if the file was cut there, its last number is short".into(),
        );
        rows.cut_line = Some(lines.len());
    }
    let rate = rate_of("line 3, DataRate", head.number("DataRate").unwrap_or(0.0), &mut warnings);
    let (frames, times) = rows.read(&lines)?;
    rows.warn(&mut warnings);
    head.check_frame_count(path, frames.len(), &mut warnings)?;
    check_times(&frames, &times, rate, &mut warnings);
    warn_of_origins(&ids, &frames, &mut warnings);
    let header = MarkerHeader { unit: Unit::Mm, rate, markers: ids, take: None };
    Ok((Trajectories { header, frames }, warnings))
}

/// The names of the second line and the values of the third.
struct Head<'a> {
    entries: Vec<(&'a str, &'a str)>,
}

impl<'a> Head<'a> {
    fn read(path: &Path, lines: &[&'a str]) -> Result<Self> {
        let first = lines.first().copied().unwrap_or_default();
        if !first.starts_with("PathFileType") {
            return Err(Error::new(path, "is not a TRC file: it does not start with PathFileType")
                .at("line 1")
                .fix("check that this is the right file"));
        }
        if lines.len() < HEADER_LINES {
            return Err(Error::new(path, "is cut short: it ends within its header and holds no frames")
                .at(format!("line {}", lines.len()))
                .fix("copy or export it again"));
        }
        let entries = lines[1].split('\t').map(str::trim).zip(lines[2].split('\t').map(str::trim)).collect();
        Ok(Self { entries })
    }

    fn text(&self, name: &str) -> Option<&'a str> {
        self.entries.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, value)| *value)
    }

    fn number(&self, name: &str) -> Option<f64> {
        self.text(name)?.parse().ok()
    }

    fn marker_count(&self, path: &Path) -> Result<usize> {
        match self.text("NumMarkers").and_then(|count| count.parse().ok()) {
            Some(0) => Err(Error::new(path, "holds no markers").at("line 3, NumMarkers")),
            Some(count) => Ok(count),
            None => Err(Error::new(path, "does not say how many markers it holds")
                .at("line 3, NumMarkers")
                .fix("lines 2 and 3 must be separated by tabs and hold NumMarkers; export it again")),
        }
    }

    fn check_frame_count(&self, path: &Path, found: usize, warnings: &mut Vec<String>) -> Result<()> {
        let Some(said) = self.text("NumFrames").and_then(|count| count.parse::<usize>().ok()) else {
            warnings.push(format!("line 3: NumFrames is not stated; {found} frames were read"));
            return Ok(());
        };
        if found < said || found == 0 {
            let what = format!("is cut short, or its header lies: it holds {found} frames of {said}");
            return Err(Error::new(path, what).at("line 3, NumFrames").fix("copy or export it again"));
        }
        if found > said {
            warnings.push(format!("line 3: NumFrames says {said}, the file holds {found}; all were read"));
        }
        Ok(())
    }
}

/// Labels stand over the first of three columns; some writers leave out the two empty cells between.
fn labels(path: &Path, lines: &[&str], head: &Head, warnings: &mut Vec<String>) -> Result<Vec<String>> {
    let marker_count = head.marker_count(path)?;
    let cells: Vec<&str> = lines[3].split('\t').map(str::trim).skip(LEADING).collect();
    let filled: Vec<usize> = (0..cells.len()).filter(|&column| !cells[column].is_empty()).collect();
    let in_range = |&column: &usize| column % 3 == 0 && column / 3 < marker_count;
    if filled.iter().all(in_range) && cells.len() + 2 >= marker_count.saturating_mul(3) {
        let cell = |marker: usize| cells.get(3 * marker).copied().unwrap_or_default().to_string();
        return Ok((0..marker_count).map(cell).collect());
    }
    if filled.len() == marker_count {
        warnings.push("line 4: the labels do not stand three columns apart; read in their order".into());
        return Ok(filled.iter().map(|&column| cells[column].to_string()).collect());
    }
    let what = format!("has {} labels, but NumMarkers says {marker_count}", filled.len());
    Err(Error::new(path, what)
        .at("line 4")
        .fix("cells must be separated by tabs, one label per three columns; export it again"))
}

/// The lines of the frames.
struct Rows<'a> {
    path: &'a Path,
    ids: &'a [String],
    scale: f64,
    /// Lines whose last empty cells were left out.
    tails: usize,
    /// The last line, where it has no line end.
    cut_line: Option<usize>,
    last: Option<i64>,
}

impl Rows<'_> {
    /// Frames and their times.
    fn read(&mut self, lines: &[&str]) -> Result<(Vec<MarkerFrame>, Vec<f64>)> {
        let axes = lines[HEADER_LINES - 1].split('\t').map(str::trim).find(|cell| !cell.is_empty());
        if !axes.is_some_and(|axis| axis.starts_with(['X', 'x'])) {
            return Err(Error::new(self.path, "does not name the axes X1, Y1, Z1, …")
                .at("line 5")
                .fix("the fifth line must name the axes; export it again"));
        }
        let (mut frames, mut times) = (Vec::new(), Vec::new());
        for (index, line) in lines.iter().enumerate().skip(HEADER_LINES) {
            if line.trim().is_empty() {
                continue;
            }
            let (frame, time) = self.row(line, index + 1)?;
            frames.push(frame);
            times.push(time);
        }
        Ok((frames, times))
    }

    fn row(&mut self, line: &str, number: usize) -> Result<(MarkerFrame, f64)> {
        let cells: Vec<&str> = line.split('\t').collect();
        let refuse = |place: String, what: String| Error::new(self.path, what).at(place);
        let width = LEADING + 3 * self.ids.len();
        if cells.len() < width && self.cut_line == Some(number) {
            return Err(refuse(format!("line {number}"), "is cut short within its last line".into())
                .fix("copy or export it again"));
        }
        if let Some(extra) = cells.iter().skip(width).position(|cell| !cell.trim().is_empty()) {
            let what = format!("a cell beyond the {} markers", self.ids.len());
            return Err(refuse(format!("line {number}, column {}", width + extra + 1), what)
                .fix("NumMarkers or the line is wrong; export it again"));
        }
        let cell = |column: usize| cells.get(column).copied().unwrap_or_default();
        let frame = frame_number(cell(0)).map_err(|what| refuse(format!("line {number}, column 1"), what))?;
        if let Some(last) = self.last.filter(|&last| last >= frame) {
            return Err(refuse(format!("line {number}"), format!("frame {frame} follows frame {last}"))
                .fix("frame numbers must rise"));
        }
        let time =
            number_in_cell(cell(1)).map_err(|what| refuse(format!("line {number}, column 2"), what))?;
        let points = self.ids.iter().enumerate().map(|(marker, id)| {
            let column = LEADING + 3 * marker;
            point_in_cells([cell(column), cell(column + 1), cell(column + 2)], self.scale)
                .map_err(|what| refuse(format!("line {number}, frame {frame}, marker {id}"), what))
        });
        let points = points.collect::<Result<_>>()?;
        self.last = Some(frame);
        self.tails += usize::from(cells.len() < width);
        let status = vec![SampleStatus::Measured; self.ids.len()];
        Ok((MarkerFrame { frame, points, status }, time.unwrap_or(f64::NAN)))
    }

    fn warn(&self, warnings: &mut Vec<String>) {
        if self.tails > 0 {
            warnings
                .push(format!("{} lines end before their last cells; those samples are missing", self.tails));
        }
    }
}

/// A frame number; some writers put `1.0`.
pub(crate) fn frame_number(cell: &str) -> std::result::Result<i64, String> {
    let cell = cell.trim();
    let whole = cell.parse::<i64>().ok().or_else(|| {
        let number: f64 = cell.parse().ok()?;
        (number.fract() == 0.0 && number.abs() < 1e15).then_some(number as i64)
    });
    whole.ok_or_else(|| format!("'{cell}' is not a frame number"))
}

/// Frame numbers rule; times that tell another story are worth a word.
fn check_times(frames: &[MarkerFrame], times: &[f64], rate: Option<Rate>, warnings: &mut Vec<String>) {
    let (Some(rate), Some(first), Some(start)) = (rate, frames.first(), times.first()) else { return };
    let off = |frame: &MarkerFrame, time: f64| {
        let counted = frame.frame.saturating_sub(first.frame) as f64;
        ((time - start) * rate.hz() - counted).abs() > 0.5
    };
    let frames = frames.iter().zip(times).filter(|(frame, time)| off(frame, **time));
    let strays: Vec<String> = frames.map(|(frame, _)| frame.frame.to_string()).collect();
    if !strays.is_empty() {
        let strays = listed(&strays);
        warnings
            .push(format!("the times do not follow the frame numbers at {rate} (frames {strays}); not used"));
    }
}

/// Writes markers in mm; a missing sample is three empty cells, and gaps in the frame numbers stay gaps. Numbers are
/// the shortest that read back to the same value; the time of the first frame is 0. Sample status and take are not
/// kept.
///
/// # Errors
/// If there is no rate, marker or frame, an id holds a tab or line end or has blanks around it, a coordinate is not
/// finite, or the file cannot be written.
pub fn write(path: &Path, trajectories: &Trajectories) -> Result<Staged> {
    write_frames(path, &trajectories.header, Extent::of(trajectories), trajectories.frames.iter().map(Ok))
}

/// The same, frame by frame: nothing is kept in memory.
///
/// # Errors
/// As [`write`]; also the errors of `frames`, and if these do not keep to the extent.
pub fn write_frames<F: Borrow<MarkerFrame>>(
    path: &Path,
    header: &MarkerHeader,
    extent: Extent,
    frames: impl Iterator<Item = Result<F>>,
) -> Result<Staged> {
    let rate = check_writable(path, header, extent.count)?;
    let plain = |id: &&String| !id.contains(['\t', '\n', '\r']) && id.trim() == id.as_str();
    if let Some(id) = header.markers.iter().find(|id| !plain(id)) {
        return Err(Error::new(path, "the id does not fit a TRC file")
            .at(format!("marker '{}'", id.escape_debug()))
            .fix("use no tabs or line ends, and no blanks around it"));
    }
    let mut sink = Sink::create(path)?;
    let fail = |cause: std::io::Error| Error::io(path, "write", &cause);
    write_head(&mut sink, &file_name(path), header, extent, rate).map_err(fail)?;
    for frame in checked(path, &header.markers, &extent, frames) {
        write_row(&mut sink, frame?.borrow(), extent.first, rate.hz()).map_err(fail)?;
    }
    sink.finish()
}

fn write_head(
    out: &mut impl Write,
    name: &str,
    header: &MarkerHeader,
    extent: Extent,
    rate: Rate,
) -> std::io::Result<()> {
    let markers = &header.markers;
    let Extent { first, count: frame_count, .. } = extent;
    let hz = rate.hz();
    writeln!(out, "PathFileType\t4\t(X/Y/Z)\t{name}")?;
    writeln!(
        out,
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames"
    )?;
    writeln!(out, "{hz}\t{hz}\t{frame_count}\t{}\tmm\t{hz}\t{first}\t{frame_count}", markers.len())?;
    writeln!(out, "Frame#\tTime\t{}\t\t", markers.join("\t\t\t"))?;
    let axes: Vec<String> =
        (1..=markers.len()).map(|number| format!("X{number}\tY{number}\tZ{number}")).collect();
    writeln!(out, "\t\t{}\n", axes.join("\t"))
}

fn write_row(out: &mut impl Write, frame: &MarkerFrame, first: i64, hz: f64) -> std::io::Result<()> {
    write!(out, "{}\t{:.6}", frame.frame, frame.frame.saturating_sub(first) as f64 / hz)?;
    for point in &frame.points {
        match point {
            Some(point) => write!(out, "\t{}\t{}\t{}", point.x, point.y, point.z)?,
            None => out.write_all(b"\t\t\t")?,
        }
    }
    writeln!(out)
}
