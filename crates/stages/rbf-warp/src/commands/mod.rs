//! The subcommands, and how they read markers.

pub(crate) mod apply;
pub(crate) mod correspond;
pub(crate) mod fit;
pub(crate) mod handles;

use artifact::{
    FrameReader, HeadTrajectories, MarkerFrame, MarkerHeader, TakeRef, Trajectories, Unit, is_standard_stream,
};
use stage::Run;
use std::path::Path;
use std::vec::IntoIter;

/// A number above 0, for an option.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        _ => Err(format!("'{text}' is not a number above 0")),
    }
}

/// A number from 0 on, for an option.
fn from_zero(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number >= 0.0 => Ok(number),
        _ => Err(format!("'{text}' is not a number from 0 on")),
    }
}

fn is_stream(path: &Path) -> bool {
    is_standard_stream(path) || path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("jsonl"))
}

/// Frames of markers: read one by one where the format allows it.
enum MarkerStream {
    Lines(FrameReader<HeadTrajectories>),
    Whole(MarkerHeader, IntoIter<MarkerFrame>),
}

impl MarkerStream {
    fn open(run: &mut Run, path: &Path, unit: Option<Unit>) -> anyhow::Result<Self> {
        if is_stream(path) {
            let reader = FrameReader::open(path)?;
            artifact::check_marker_unit(path, reader.header(), unit)?;
            return Ok(Self::Lines(reader));
        }
        let Trajectories { header, frames } = run.markers::<HeadTrajectories>(path, unit)?;
        Ok(Self::Whole(header, frames.into_iter()))
    }

    fn header(&self) -> &MarkerHeader {
        match self {
            Self::Lines(reader) => reader.header(),
            Self::Whole(header, _) => header,
        }
    }
}

impl Iterator for MarkerStream {
    type Item = artifact::Result<MarkerFrame>;

    fn next(&mut self) -> Option<Self::Item> {
        match self {
            Self::Lines(reader) => reader.next(),
            Self::Whole(_, frames) => frames.next().map(Ok),
        }
    }
}

/// The take that markers belong to: what they say themselves, or what `--take` says.
fn agreed_take(
    markers: &Path,
    said: Option<&TakeRef>,
    given: Option<TakeRef>,
) -> anyhow::Result<Option<TakeRef>> {
    match (said, given) {
        (Some(said), Some(given)) if said.sha256 != given.sha256 => anyhow::bail!(
            "{}: belongs to {said}, but --take says {given}\n  to do: give the manifest of the take that the markers \
             were recorded in",
            markers.display()
        ),
        (said, given) => Ok(given.or_else(|| said.cloned())),
    }
}
