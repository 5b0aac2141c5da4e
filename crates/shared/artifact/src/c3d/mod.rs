//! C3D, the binary format of motion capture systems, in and out.
//!
//! A header (512 bytes), a section of named parameters, then per frame the points and the analog values. Read:
//! integer and real points of Intel, DEC and SGI files; analog values are passed over. Malformed files that are common are read,
//! each leniency with a warning. Written: Intel, real, mm, no analog values.
//! See the guide `docs/marker-formats.md`; the format is described by the user guide of c3d.org.

mod claims;
mod decision;
mod encoding;
mod layout;
mod parameters;
mod points;
mod write;

pub use layout::Storage;
pub use write::{write, write_frames};

use crate::markers::{ids_of_labels, rate_of, resolve_unit};
use crate::{Error, MarkerHeader, Rate, Result, Trajectories, Unit, Violation, read_bytes};
use encoding::Foreign;
use parameters::Parameters;
use std::path::Path;

/// Sections start at multiples of this many bytes.
const BLOCK: usize = 512;
/// Second byte of every C3D.
const KEY: u8 = 0x50;
/// Processor types: what wrote the numbers, plus 83.
const INTEL: u8 = 84;
const DEC: u8 = 85;
const SGI: u8 = 86;

/// What was read of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct C3d {
    /// The markers, mm; frame numbers are the file's own.
    pub trajectories: Trajectories,
    /// Unit that the file's numbers were in.
    pub unit: Unit,
    /// How its points are stored.
    pub storage: Storage,
    /// What was malformed or doubtful, and how it was read all the same.
    pub warnings: Vec<String>,
}

/// Reads the markers of a file. `unit` is what the user says it is in; it is needed where the file does not say.
///
/// # Errors
/// If it is no C3D, of an unknown processor, cut short, without points, contradicts itself or its size, holds
/// coordinates that are not finite, or its unit is unknown or not the stated one.
pub fn read(path: &Path, unit: Option<Unit>) -> Result<C3d> {
    parse(path, &read_bytes(path)?, unit)
}

/// Reads the markers from the bytes of a file; `path` is for messages.
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, bytes: &[u8], unit: Option<Unit>) -> Result<C3d> {
    let in_file = |violation: Violation| {
        violation.in_file(path).fix("the file is damaged or malformed; copy or export it again")
    };
    let (section, foreign) = parameter_section(path, bytes)?;
    let intel = foreign.map(|foreign| foreign.to_intel(bytes, section));
    let bytes = intel.as_deref().unwrap_or(bytes);
    let list = section + 4;
    let parameters = Parameters::parse(bytes, list).map_err(in_file)?;
    let mut warnings = parameters.leniencies();
    let layout = decision::decide(path, bytes, &parameters, &mut warnings)?;
    let unit_text = parameters.texts("POINT", "UNITS").map_err(in_file)?;
    let unit_text = unit_text.first().map(String::as_str);
    let unit = resolve_unit(path, "parameter POINT:UNITS", unit_text, unit, &mut warnings)?;
    let labels = labels(&parameters, layout.points as usize, &mut warnings).map_err(in_file)?;
    let ids = ids_of_labels(&labels, &mut warnings);
    let decoder = points::Decoder {
        layout,
        scale: scale(bytes, &parameters, layout.storage, &mut warnings).map_err(in_file)?,
        mm_per_unit: unit.in_mm(),
        ids: &ids,
        first_frame: first_frame(bytes, &parameters, &mut warnings).map_err(in_file)?,
    };
    let frames = decoder.frames(bytes, &mut warnings).map_err(in_file)?;
    let rate = rate(bytes, &parameters, &mut warnings).map_err(in_file)?;
    let header = MarkerHeader { unit: Unit::Mm, rate, markers: ids, take: None };
    Ok(C3d { trajectories: Trajectories { header, frames }, unit, storage: layout.storage, warnings })
}

/// Where the parameter section starts, and the encoding if it is not Intel's; refuses what is no C3D.
fn parameter_section(path: &Path, bytes: &[u8]) -> Result<(usize, Option<Foreign>)> {
    let &[block, key, ..] = bytes else {
        return Err(Error::new(path, "is empty").fix("copy or export it again"));
    };
    if key != KEY || block < 2 {
        let what = format!("is not a C3D file: it starts with {block:02x} {key:02x}, not with 02 50");
        return Err(Error::new(path, what).at("byte 0").fix("check that this is the right file"));
    }
    let section = (usize::from(block) - 1) * BLOCK;
    let Some(&processor) = bytes.get(section + 3) else {
        let what = "is cut short: it ends before its parameters and holds no frames";
        let place = format!("byte {}, its end", bytes.len());
        return Err(Error::new(path, what).at(place).fix("copy or export it again"));
    };
    match processor {
        INTEL => Ok((section, None)),
        DEC => Ok((section, Some(Foreign::Dec))),
        SGI => Ok((section, Some(Foreign::Sgi))),
        other => Err(Error::new(path, format!("is encoded for processor type {other}, which is unknown"))
            .at(format!("byte {}", section + 3))
            .fix("convert it to Intel (PC) encoding")),
    }
}

/// Labels of the points; POINT:LABELS holds at most 255, LABELS2, LABELS3, … go on.
fn labels(
    parameters: &Parameters,
    point_count: usize,
    warnings: &mut Vec<String>,
) -> std::result::Result<Vec<String>, Violation> {
    let mut labels = parameters.texts("POINT", "LABELS")?;
    for number in 2.. {
        let name = format!("LABELS{number}");
        if parameters.get("POINT", &name).is_none() {
            break;
        }
        labels.extend(parameters.texts("POINT", &name)?);
    }
    let surplus = labels.iter().skip(point_count).filter(|label| !label.is_empty()).count();
    if surplus > 0 {
        warnings.push(format!("POINT:LABELS has {surplus} more labels than there are points; left out"));
    }
    labels.resize(point_count, String::new());
    Ok(labels)
}

/// The factor of integer coordinates.
fn scale(
    bytes: &[u8],
    parameters: &Parameters,
    storage: Storage,
    warnings: &mut Vec<String>,
) -> std::result::Result<f32, Violation> {
    let header = real(bytes, 12);
    let scale = parameters.number("POINT", "SCALE")?.filter(|&scale| scale != 0.0).unwrap_or(header);
    if storage == Storage::Real {
        return Ok(1.0);
    }
    if !scale.is_finite() || scale == 0.0 {
        return Err(Violation::new("parameter POINT:SCALE", format!("{scale} is no scale")));
    }
    if (scale.abs() - header.abs()).abs() > 1e-5 * scale.abs() {
        warnings
            .push(format!("scale: the header says {header}, POINT:SCALE says {scale}; the latter is used"));
    }
    Ok(scale.abs() as f32)
}

fn first_frame(
    bytes: &[u8],
    parameters: &Parameters,
    warnings: &mut Vec<String>,
) -> std::result::Result<i64, Violation> {
    let header = u64::from(word(bytes, 6));
    let Some((trial, _)) = claims::trial_range(parameters)? else { return Ok(header as i64) };
    if header == trial.min(65535) || header == trial % 65536 {
        return Ok(trial as i64);
    }
    warnings.push(format!(
        "first frame: the header says {header}, TRIAL:ACTUAL_START_FIELD says {trial}; the header is used"
    ));
    Ok(header as i64)
}

fn rate(
    bytes: &[u8],
    parameters: &Parameters,
    warnings: &mut Vec<String>,
) -> std::result::Result<Option<Rate>, Violation> {
    let header = real(bytes, 20);
    let Some(rate) = parameters.number("POINT", "RATE")?.filter(|&rate| rate > 0.0) else {
        return Ok(rate_of("header", header, warnings));
    };
    if (rate - header).abs() > 1e-4 * rate {
        warnings.push(format!(
            "rate: the header says {header} Hz, POINT:RATE says {rate} Hz; the latter is used"
        ));
    }
    Ok(rate_of("parameter POINT:RATE", rate, warnings))
}

/// A 16-bit word; 0 past the end.
fn word(bytes: &[u8], at: usize) -> u16 {
    bytes.get(at..at + 2).map_or(0, |word| u16::from_le_bytes([word[0], word[1]]))
}

/// A 32-bit float; 0 past the end.
fn real(bytes: &[u8], at: usize) -> f64 {
    let word = bytes.get(at..at + 4).map_or([0; 4], |word| [word[0], word[1], word[2], word[3]]);
    f64::from(f32::from_le_bytes(word))
}

/// Text up to a NUL, without the blanks around it; bytes that are no UTF-8 are taken as Latin-1.
fn text_of(bytes: &[u8]) -> String {
    let bytes = bytes.split(|&byte| byte == 0).next().unwrap_or_default();
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.to_string(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    };
    text.trim().to_string()
}
