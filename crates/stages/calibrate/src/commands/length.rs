//! Known lengths, as they are written on the command line.

use calibrate::wand::{Ends, Length};

/// What may stand after `--scale`.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Word {
    Unknown,
    Distance(f64),
    Length(Length),
}

/// Reads `A:B=MM`, `MM` or `unknown`.
pub(super) fn word(text: &str) -> Result<Word, String> {
    match text {
        "unknown" => Ok(Word::Unknown),
        _ if text.contains('=') => length(text).map(Word::Length),
        _ => millimetres(text).map(Word::Distance),
    }
}

/// Reads `A:B=MM`; A and B are numbers or names.
pub(super) fn length(text: &str) -> Result<Length, String> {
    let parts = text.split_once('=').and_then(|(ends, mm)| Some((ends.split_once(':')?, mm)));
    let ((a, b), mm) = parts.ok_or_else(|| format!("'{text}' is not A:B=MM"))?;
    let ends = match (a.parse(), b.parse()) {
        (Ok(a), Ok(b)) => Ends::Frames(a, b),
        _ => Ends::Cameras(a.to_string(), b.to_string()),
    };
    Ok(Length { ends, mm: millimetres(mm)? })
}

fn millimetres(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(mm) if mm.is_finite() && mm > 0.0 => Ok(mm),
        _ => Err(format!("'{text}' is not a positive number of mm")),
    }
}
