//! The writer: Intel, real points, mm, no analog values.

use super::{BLOCK, INTEL, KEY};
use crate::markers::{check_writable, checked};
use crate::{Error, Extent, MarkerFrame, MarkerHeader, Result, Sink, Staged, Trajectories};
use std::borrow::Borrow;
use std::io::Write;
use std::path::Path;

/// Labels in one parameter; its dimensions are bytes.
const LABELS_AT_ONCE: usize = 255;
/// Bytes of a label: 255 of them must stay under 32768, the reach of a parameter's offset.
const LONGEST_LABEL: usize = 127;
/// The most frames that POINT:LONG_FRAMES, a float, counts exactly.
const MOST_FRAMES: i64 = 1 << 24;
/// The most blocks that the parameter section's own header can count.
const MOST_BLOCKS: usize = 255;

/// Writes markers as Intel reals in mm; a missing sample is (0, 0, 0) with residual −1.
///
/// C3D has no gaps in its frame numbers: frames that are not there are written with all samples missing. Positions
/// are rounded to 32-bit floats; sample status and take are not kept.
///
/// # Errors
/// If there is no rate, marker or frame, a frame number is negative, a label does not fit (more than 127 bytes,
/// blanks around it), a coordinate is not finite as a 32-bit float, or the file cannot be written.
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
    check(path, header, extent)?;
    let outline =
        Outline { markers: &header.markers, first: extent.first, last: extent.last, rate: rate.hz() as f32 };
    let section = outline.parameters(path)?;
    let mut sink = Sink::create(path)?;
    let fail = |cause: std::io::Error| Error::io(path, "write", &cause);
    sink.write_all(&outline.header(&section)).and_then(|()| sink.write_all(&section)).map_err(fail)?;
    let mut next = extent.first;
    for frame in checked(path, &header.markers, &extent, frames) {
        let frame = frame?;
        let frame = frame.borrow();
        check_size(path, header, frame)?;
        outline.write_missing(&mut sink, next..frame.frame).map_err(fail)?;
        frame.points.iter().try_for_each(|at| sink.write_all(&point(*at))).map_err(fail)?;
        next = frame.frame + 1;
    }
    outline.write_missing(&mut sink, next..extent.last + 1).map_err(fail)?;
    let used = outline.frame_count() as usize * outline.markers.len() * 16;
    sink.write_all(&vec![0; used.next_multiple_of(BLOCK) - used]).map_err(fail)?;
    sink.finish()
}

fn check(path: &Path, header: &MarkerHeader, extent: Extent) -> Result<()> {
    let Extent { first, last, .. } = extent;
    if first < 0 || last > i64::from(u32::MAX) || last - first >= MOST_FRAMES {
        let what = format!("frames {first} to {last} do not fit a C3D");
        return Err(Error::new(path, what)
            .fix("a C3D holds up to 16777216 frames, gaps included, with numbers from 0 on; choose fewer"));
    }
    let markers = &header.markers;
    if markers.len() > usize::from(u16::MAX) {
        return Err(Error::new(path, format!("{} markers do not fit a C3D", markers.len()))
            .fix("a C3D holds up to 65535"));
    }
    let fits = |id: &&String| id.len() <= LONGEST_LABEL && id.trim() == id.as_str() && !id.contains('\0');
    if let Some(id) = markers.iter().find(|id| !fits(id)) {
        return Err(Error::new(path, "the id does not fit a C3D")
            .at(format!("marker '{id}'"))
            .fix("use at most 127 bytes and no blanks around it"));
    }
    Ok(())
}

fn check_size(path: &Path, header: &MarkerHeader, frame: &MarkerFrame) -> Result<()> {
    let too_large = |point: &Option<nalgebra::Point3<f64>>| {
        point.is_some_and(|point| point.iter().any(|&x| !(x as f32).is_finite()))
    };
    match frame.points.iter().position(too_large) {
        Some(marker) => Err(Error::new(path, "the position is too large for a 32-bit float")
            .at(format!("frame {}, marker {}", frame.frame, header.markers[marker]))),
        None => Ok(()),
    }
}

/// What the header and the parameters say.
struct Outline<'a> {
    markers: &'a [String],
    first: i64,
    last: i64,
    rate: f32,
}

impl Outline<'_> {
    fn frame_count(&self) -> i64 {
        self.last - self.first + 1
    }

    /// Frames that are not there, with all samples missing.
    fn write_missing(&self, out: &mut impl Write, frames: std::ops::Range<i64>) -> std::io::Result<()> {
        frames.flat_map(|_| self.markers).try_for_each(|_| out.write_all(&point(None)))
    }

    fn header(&self, section: &[u8]) -> Vec<u8> {
        let mut header = vec![2, KEY];
        let words = [self.markers.len() as u16, 0, saturated(self.first), saturated(self.last), 0];
        words.iter().for_each(|word| header.extend(word.to_le_bytes()));
        header.extend((-1f32).to_le_bytes());
        header.extend(data_start(section).to_le_bytes());
        header.extend(0u16.to_le_bytes());
        header.extend(self.rate.to_le_bytes());
        header.resize(BLOCK, 0);
        header
    }

    /// The parameter section, padded to whole blocks. Its size does not depend on where the data starts, so it is
    /// made twice to say that.
    fn parameters(&self, path: &Path) -> Result<Vec<u8>> {
        let section = self.section(data_start(&self.section(0)));
        if section.len() / BLOCK > MOST_BLOCKS {
            return Err(Error::new(path, "the marker ids together do not fit a C3D")
                .fix("use fewer markers or shorter ids"));
        }
        Ok(section)
    }

    fn section(&self, data_start: u16) -> Vec<u8> {
        let mut section = Section { bytes: vec![1, KEY, 0, INTEL] };
        self.point_group(&mut section, data_start);
        section.group(2, "ANALOG", "no analog data");
        section.integers(2, "USED", &[0]);
        if self.last > i64::from(u16::MAX) {
            section.group(3, "TRIAL", "frame range beyond 16 bits");
            section.integers(3, "ACTUAL_START_FIELD", &low_and_high(self.first));
            section.integers(3, "ACTUAL_END_FIELD", &low_and_high(self.last));
        }
        section.finish()
    }

    fn point_group(&self, section: &mut Section, data_start: u16) {
        section.group(1, "POINT", "3D points");
        section.integers(1, "USED", &[self.markers.len() as u16]);
        section.integers(1, "FRAMES", &[saturated(self.frame_count())]);
        section.integers(1, "DATA_START", &[data_start]);
        section.reals(1, "SCALE", -1.0);
        section.reals(1, "RATE", self.rate);
        section.texts(1, "UNITS", &["mm".to_string()]);
        for (index, labels) in self.markers.chunks(LABELS_AT_ONCE).enumerate() {
            let suffix = if index == 0 { String::new() } else { (index + 1).to_string() };
            section.texts(1, &format!("LABELS{suffix}"), labels);
            section.texts(1, &format!("DESCRIPTIONS{suffix}"), &vec![String::new(); labels.len()]);
        }
        if self.frame_count() > i64::from(u16::MAX) {
            section.reals(1, "LONG_FRAMES", self.frame_count() as f32);
        }
    }
}

/// Block of the first frame, counted from 1: after the header's block and the parameters'.
fn data_start(section: &[u8]) -> u16 {
    (section.len() / BLOCK) as u16 + 2
}

fn saturated(count: i64) -> u16 {
    u16::try_from(count).unwrap_or(u16::MAX)
}

fn low_and_high(frame: i64) -> [u16; 2] {
    [frame as u16, (frame >> 16) as u16]
}

fn point(point: Option<nalgebra::Point3<f64>>) -> [u8; 16] {
    let words =
        point.map_or([0.0, 0.0, 0.0, -1.0], |point| [point.x as f32, point.y as f32, point.z as f32, 0.0]);
    let mut bytes = [0; 16];
    bytes.chunks_exact_mut(4).zip(words).for_each(|(chunk, word)| chunk.copy_from_slice(&word.to_le_bytes()));
    bytes
}

/// The parameter section in the making.
struct Section {
    bytes: Vec<u8>,
}

impl Section {
    fn group(&mut self, id: i8, name: &str, description: &str) {
        self.name(-id, name);
        self.bytes.extend((description.len() as u16 + 3).to_le_bytes());
        self.bytes.push(description.len() as u8);
        self.bytes.extend(description.as_bytes());
    }

    fn integers(&mut self, group: i8, name: &str, values: &[u16]) {
        let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let dimensions = [values.len() as u8];
        self.parameter(group, name, 2, if values.len() > 1 { &dimensions } else { &[] }, &data);
    }

    fn reals(&mut self, group: i8, name: &str, value: f32) {
        self.parameter(group, name, 4, &[], &value.to_le_bytes());
    }

    fn texts(&mut self, group: i8, name: &str, texts: &[String]) {
        let length = texts.iter().map(String::len).max().unwrap_or(0).max(1);
        let mut data = vec![b' '; length * texts.len()];
        for (cell, text) in data.chunks_exact_mut(length).zip(texts) {
            cell[..text.len()].copy_from_slice(text.as_bytes());
        }
        self.parameter(group, name, -1, &[length as u8, texts.len() as u8], &data);
    }

    fn parameter(&mut self, group: i8, name: &str, kind: i8, dimensions: &[u8], data: &[u8]) {
        self.name(group, name);
        let distance = 2 + 1 + 1 + dimensions.len() + data.len() + 1;
        self.bytes.extend((distance as u16).to_le_bytes());
        self.bytes.extend([kind as u8, dimensions.len() as u8]);
        self.bytes.extend(dimensions);
        self.bytes.extend(data);
        self.bytes.push(0);
    }

    fn name(&mut self, id: i8, name: &str) {
        self.bytes.extend([name.len() as u8, id as u8]);
        self.bytes.extend(name.as_bytes());
    }

    /// Ends the list, pads it to whole blocks, and says how many there are.
    fn finish(mut self) -> Vec<u8> {
        self.bytes.extend([0, 0]);
        self.bytes.resize(self.bytes.len().next_multiple_of(BLOCK), 0);
        self.bytes[2] = (self.bytes.len() / BLOCK) as u8;
        self.bytes
    }
}
