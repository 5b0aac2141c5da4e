//! Real weight curves: recordings of ARKit face tracking (Live Link Face).

use super::arkit::columns_of;
use super::cubic::Cubic;
use super::timeline::ease;
use super::{Performance, Source, refuse};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A recording: one curve per column.
#[derive(Debug, Clone, PartialEq)]
pub struct Clip {
    /// Time of each row since the first, s; rising.
    pub times_s: Vec<f64>,
    /// Names of the curves.
    pub names: Vec<String>,
    /// Per curve its value in each row.
    pub curves: Vec<Vec<f64>>,
}

/// Which part of a recording to take, and how fast.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ClipParams {
    /// Where in the recording the take begins, s.
    pub start_s: f64,
    /// Seconds of the recording per second of the take.
    pub speed: f64,
    /// The face is neutral at first and joins the recording within so many seconds.
    pub join_s: f64,
}

impl Default for ClipParams {
    fn default() -> Self {
        Self { start_s: 0.0, speed: 1.0, join_s: 0.3 }
    }
}

impl ClipParams {
    /// Refuses times and speeds that make no sense.
    ///
    /// # Errors
    /// Names the parameter below `place`.
    pub fn check(&self, place: &str) -> Result<(), crate::Error> {
        let rule = |name: &str, holds: bool, what: String| match holds {
            true => Ok(()),
            false => Err(refuse(format!("{place}.{name}"), what)),
        };
        rule(
            "start_s",
            self.start_s.is_finite() && self.start_s >= 0.0,
            format!("{} is no time", self.start_s),
        )?;
        let speed = format!("{} is not from 0.01 to 100", self.speed);
        rule("speed", (0.01..=100.0).contains(&self.speed), speed)?;
        let join = format!("{} s is no duration; say 0.01 or more", self.join_s);
        rule("join_s", self.join_s >= 0.01 && self.join_s.is_finite(), join)
    }
}

/// Why a text is no recording of weights.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}{}: {what}", match .column { Some(column) => format!(", column {column}"), None => String::new() })]
pub struct ClipError {
    /// Line, counted from 1.
    pub line: usize,
    /// Name of the column, if it is about one.
    pub column: Option<String>,
    /// What is wrong there.
    pub what: String,
}

/// Columns that hold no weights.
const TIME: &str = "Timecode";
const COUNT: &str = "BlendShapeCount";
/// Frames that a second of the time code has, whatever the rate of the rows.
const CODE_FRAMES: f64 = 60.0;
/// Seconds after which a time code begins anew.
const DAY_S: f64 = 86_400.0;

/// Where its parameters stand in a scenario.
const PLACE: &str = "performance.recording";

impl Clip {
    /// Reads the text of a Live Link Face CSV: a header with `Timecode` (`HH:MM:SS:FF.mmm`, FF in sixtieths of a second)
    /// and one column per curve, in any order.
    ///
    /// # Errors
    /// Names line and column of: a header without time code or curves, a row with other columns, a time code that
    /// cannot be read or does not rise, a number that is none.
    pub fn parse(text: &str) -> Result<Self, ClipError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut rows =
            text.lines().enumerate().map(|(i, row)| (i + 1, row)).filter(|(_, row)| !row.trim().is_empty());
        let (line, header) = rows.next().ok_or_else(|| fault(1, None, "the file is empty"))?;
        let header: Vec<&str> = header.split(',').map(str::trim).collect();
        let time = header.iter().position(|name| *name == TIME);
        let time = time.ok_or_else(|| fault(line, None, format!("the header has no column {TIME}")))?;
        let kept: Vec<usize> =
            (0..header.len()).filter(|&i| i != time && header[i] != COUNT && !header[i].is_empty()).collect();
        if kept.is_empty() {
            return Err(fault(line, None, "the header names no curves"));
        }
        let names = kept.iter().map(|&i| header[i].to_string()).collect();
        let mut clip = Self { times_s: Vec::new(), names, curves: vec![Vec::new(); kept.len()] };
        let mut clock = TimeCode::default();
        for (line, row) in rows {
            let fields: Vec<&str> = row.split(',').map(str::trim).collect();
            if fields.len() != header.len() {
                return Err(fault(
                    line,
                    None,
                    format!("{} columns; the header has {}", fields.len(), header.len()),
                ));
            }
            clip.times_s.push(clock.next(fields[time]).map_err(|what| fault(line, Some(TIME), what))?);
            for (curve, &column) in clip.curves.iter_mut().zip(&kept) {
                let value = number(fields[column]).map_err(|what| fault(line, Some(header[column]), what))?;
                curve.push(value);
            }
        }
        match clip.times_s.is_empty() {
            true => Err(fault(line, None, "no rows follow the header")),
            false => Ok(clip),
        }
    }

    /// Length of the recording, s.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        self.times_s.last().copied().unwrap_or(0.0)
    }

    /// Binds the curves to the shapes of a body. Shapes that no curve drives stay at 0: see [`Clip::undriven`].
    ///
    /// # Errors
    /// Parameters that make no sense, a start after the end of the recording, or no shape at all that a curve drives.
    pub fn bind(&self, params: &ClipParams, shapes: &[String]) -> Result<Performance, crate::Error> {
        params.check(PLACE)?;
        if params.start_s >= self.length_s() {
            let what =
                format!("{} s is past the end of the recording ({:.2} s)", params.start_s, self.length_s());
            return Err(refuse(format!("{PLACE}.start_s"), what));
        }
        if self.undriven(shapes).len() == shapes.len() {
            return Err(refuse(
                PLACE,
                format!("no curve drives any shape of this body ({})", shapes.join(", ")),
            ));
        }
        let curve = |shape: &String| {
            let columns = columns_of(shape, &self.names)?;
            let sum = |row: usize| {
                columns.iter().map(|&(column, weight)| weight * self.curves[column][row]).sum::<f64>()
            };
            let values = (0..self.times_s.len()).map(|row| sum(row).clamp(0.0, 1.0)).collect();
            Some(Cubic::through(self.times_s.clone(), values))
        };
        let bound = BoundClip { params: *params, curves: shapes.iter().map(curve).collect() };
        Ok(Performance { shape_count: shapes.len(), source: Source::Clip(bound) })
    }

    /// Shapes that no curve of the recording drives.
    #[must_use]
    pub fn undriven<'a>(&self, shapes: &'a [String]) -> Vec<&'a str> {
        shapes.iter().map(String::as_str).filter(|shape| columns_of(shape, &self.names).is_none()).collect()
    }
}

/// A part of a recording on the shapes of a body.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BoundClip {
    params: ClipParams,
    curves: Vec<Option<Cubic>>,
}

impl BoundClip {
    pub(super) fn weights(&self, time_s: f64) -> Vec<f64> {
        let joined = ease(time_s / self.params.join_s);
        let time = self.params.start_s + self.params.speed * time_s;
        self.curves.iter().map(|curve| curve.as_ref().map_or(0.0, |curve| joined * curve.at(time))).collect()
    }
}

/// Time codes as seconds since the first one.
#[derive(Default)]
struct TimeCode {
    first: Option<f64>,
    last: f64,
}

impl TimeCode {
    fn next(&mut self, code: &str) -> Result<f64, String> {
        let seconds = seconds(code).ok_or_else(|| format!("'{code}' is not HH:MM:SS:FF.mmm"))?;
        let Some(first) = self.first else {
            self.first = Some(seconds);
            return Ok(0.0);
        };
        let mut since = seconds - first;
        // Over midnight the code falls by nearly a day.
        if since < self.last - 0.5 * DAY_S {
            since += DAY_S;
        }
        if since <= self.last {
            return Err(format!("'{code}' is not later than the row before"));
        }
        self.last = since;
        Ok(since)
    }
}

fn seconds(code: &str) -> Option<f64> {
    let mut parts = code.split(':');
    let mut whole =
        |limit: u32| parts.next()?.parse::<u32>().ok().filter(|&part| part < limit).map(f64::from);
    let (hours, minutes, seconds) = (whole(24)?, whole(60)?, whole(60)?);
    let frames = parts.next()?.parse::<f64>().ok().filter(|frames| (0.0..CODE_FRAMES).contains(frames))?;
    parts.next().is_none().then_some(3600.0 * hours + 60.0 * minutes + seconds + frames / CODE_FRAMES)
}

fn number(field: &str) -> Result<f64, String> {
    match field.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("'{field}' is not a finite number")),
        Err(_) => Err(format!("'{field}' is not a number")),
    }
}

fn fault(line: usize, column: Option<&str>, what: impl Into<String>) -> ClipError {
    ClipError { line, column: column.map(str::to_string), what: what.into() }
}
