//! Time stamps of a camera's images, in: CSV with the columns `index,time_s`, or `index,timecode`.
//!
//! `index` counts as the footage does: the number in the file's name, or the index in the video. An image that has no line
//! was not stamped. Equal stamps may follow each other (an image that was stored twice); none may run backwards.

use crate::source::text_of;
use crate::{Error, Rate, Result, Timecode, read_bytes};
use std::path::Path;

/// When an image was taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeStamp {
    /// Number of the image in its footage.
    pub index: i64,
    /// The time by the camera's clock, s; of time codes, the time since midnight.
    pub time_s: f64,
}

/// Reads the time stamps of a camera's images, rising. `rate` is the camera's, for time codes.
///
/// # Errors
/// Names the line of what is malformed; refuses a file without stamps, an index that stands twice, indices or times that
/// run backwards.
pub fn read(path: &Path, rate: Rate) -> Result<Vec<TimeStamp>> {
    parse(path, &read_bytes(path)?, rate)
}

/// Reads time stamps from the bytes of a file; `path` is for messages.
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, bytes: &[u8], rate: Rate) -> Result<Vec<TimeStamp>> {
    let text = text_of(path, bytes.to_vec())?;
    let mut column = None;
    let mut stamps: Vec<TimeStamp> = Vec::new();
    for (line, text) in (1..).zip(text.trim_start_matches('\u{feff}').lines()) {
        if text.trim().is_empty() || text.starts_with('#') {
            continue;
        }
        let cells: Vec<&str> = text.split(',').map(str::trim).collect();
        let refuse = |what: String, fix: &str| Error::new(path, what).at(format!("line {line}")).fix(fix);
        let Some(column) = column else {
            column =
                Some(Column::read(&cells).map_err(|what| refuse(what, "name the columns index,time_s"))?);
            continue;
        };
        let stamp = column.stamp(&cells, rate).map_err(|what| refuse(what, "export the stamps again"))?;
        if let Some(before) = stamps.last() {
            follows(before, &stamp).map_err(|what| {
                refuse(what, "sort the file by index; if the camera's clock was set back, cut the take there")
            })?;
        }
        stamps.push(stamp);
    }
    match stamps.is_empty() {
        true => {
            Err(Error::new(path, "holds no time stamps")
                .fix("export it again, or take it out of the manifest"))
        }
        false => Ok(stamps),
    }
}

/// What the second column holds.
#[derive(Debug, Clone, Copy)]
enum Column {
    Seconds,
    Timecode,
}

impl Column {
    fn read(cells: &[&str]) -> std::result::Result<Self, String> {
        match cells {
            ["index", "time_s"] => Ok(Self::Seconds),
            ["index", "timecode"] => Ok(Self::Timecode),
            _ => Err(format!("'{}' where index,time_s or index,timecode is expected", cells.join(","))),
        }
    }

    fn stamp(self, cells: &[&str], rate: Rate) -> std::result::Result<TimeStamp, String> {
        let &[index, time] = cells else {
            return Err(format!("has {} cells, not two", cells.len()));
        };
        let index = index.parse().map_err(|_| format!("'{index}' is not the number of an image"))?;
        let time_s = match self {
            Self::Seconds => time.parse::<f64>().ok().filter(|time| time.is_finite()),
            Self::Timecode => Some(Timecode::parse(time, rate)?.frame as f64 / rate.hz()),
        };
        let time_s = time_s.ok_or_else(|| format!("'{time}' is not a time in seconds"))?;
        Ok(TimeStamp { index, time_s })
    }
}

fn follows(before: &TimeStamp, stamp: &TimeStamp) -> std::result::Result<(), String> {
    if stamp.index == before.index {
        return Err(format!("image {} has two stamps", stamp.index));
    }
    if stamp.index < before.index {
        return Err(format!("image {} stands after image {}", stamp.index, before.index));
    }
    match stamp.time_s < before.time_s {
        true => Err(format!(
            "the time runs backwards: image {} was taken at {} s, image {} before it at {} s",
            stamp.index, stamp.time_s, before.index, before.time_s
        )),
        false => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::{TimeStamp, parse};
    use crate::Rate;
    use std::path::Path;

    fn read(text: &str) -> Result<Vec<TimeStamp>, String> {
        parse(Path::new("m1.csv"), text.as_bytes(), Rate::per_second(25)).map_err(|error| error.to_string())
    }

    #[test]
    fn stamps_and_time_codes_are_read() {
        let stamps = read("index,time_s\n3,0.5\n4,0.5\n7,0.75\n").unwrap();
        let stamp = |index, time_s| TimeStamp { index, time_s };
        assert_eq!(stamps, [stamp(3, 0.5), stamp(4, 0.5), stamp(7, 0.75)]);
        assert_eq!(read("index,timecode\n0,00:00:02:05\n").unwrap(), [stamp(0, 2.2)]);
    }

    #[test]
    fn what_cannot_be_is_refused_by_line() {
        for (text, line, what) in [
            ("index,time_s\n0,1.0\n1,0.9\n", "line 3", "runs backwards"),
            ("index,time_s\n0,1.0\n\n0,1.1\n", "line 4", "two stamps"),
            ("index,time_s\n1,1.0\n0,1.1\n", "line 3", "stands after image 1"),
            ("index,time_s\n0,soon\n", "line 2", "'soon'"),
            ("index,time_s\n0,NaN\n", "line 2", "'NaN'"),
            ("index,time_s\n0,1,5\n", "line 2", "3 cells"),
            ("frame,time_s\n0,1\n", "line 1", "index,time_s"),
            ("index,timecode\n0,00:00:00:25\n", "line 2", "out of range"),
        ] {
            let message = read(text).unwrap_err();
            assert!(message.contains(line) && message.contains(what), "{message}");
        }
        assert!(read("index,time_s\n").unwrap_err().contains("no time stamps"));
    }
}
