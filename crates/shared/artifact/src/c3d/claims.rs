//! What a file says of itself, in its header and again in its parameters.

use super::layout::{Layout, Storage};
use super::parameters::Parameters;
use super::{BLOCK, word};
use crate::Violation;
use std::fmt::Display;

/// What the header and the parameters say about one thing.
struct Statements<T> {
    what: &'static str,
    said: Vec<(&'static str, T)>,
}

impl<T: Copy + PartialEq + Display> Statements<T> {
    fn new(what: &'static str, said: Vec<(&'static str, Option<T>)>) -> Self {
        Self { what, said: said.into_iter().filter_map(|(by, value)| Some((by, value?))).collect() }
    }

    fn values(&self) -> Vec<T> {
        let mut values = Vec::new();
        for &(_, value) in &self.said {
            if !values.contains(&value) {
                values.push(value);
            }
        }
        values
    }

    fn disagreement(&self) -> Option<String> {
        let said: Vec<String> = self.said.iter().map(|(by, value)| format!("{by} says {value}")).collect();
        (self.values().len() > 1).then(|| format!("{}: {}", self.what, said.join(", ")))
    }
}

/// All that decides where the data lies.
pub(super) struct Claims {
    start: Statements<u64>,
    storage: Statements<Storage>,
    points: Statements<u64>,
    analog: Statements<u64>,
    frames: Statements<u64>,
}

impl Claims {
    pub(super) fn read(bytes: &[u8], parameters: &Parameters) -> std::result::Result<Self, Violation> {
        let block = |block: u64| (block > 1).then(|| (block - 1) * BLOCK as u64);
        let scale = super::real(bytes, 12);
        let scale_parameter = parameters.number("POINT", "SCALE")?;
        let samples = u64::from(word(bytes, 18));
        let channels = parameters.count("ANALOG", "USED")?.filter(|&channels| channels == 0 || samples > 0);
        Ok(Self {
            start: Statements::new(
                "start of the data (byte)",
                vec![
                    ("the header", block(u64::from(word(bytes, 16)))),
                    ("POINT:DATA_START", parameters.count("POINT", "DATA_START")?.and_then(block)),
                ],
            ),
            storage: Statements::new(
                "storage",
                vec![
                    ("the header", (scale != 0.0 && scale.is_finite()).then(|| Storage::of_scale(scale))),
                    ("POINT:SCALE", scale_parameter.filter(|&scale| scale != 0.0).map(Storage::of_scale)),
                ],
            ),
            points: Statements::new(
                "points",
                vec![
                    ("the header", Some(u64::from(word(bytes, 2)))),
                    ("POINT:USED", parameters.count("POINT", "USED")?),
                ],
            ),
            analog: Statements::new(
                "analog values per frame",
                vec![
                    ("the header", Some(u64::from(word(bytes, 4)))),
                    ("ANALOG:USED", channels.map(|channels| channels.saturating_mul(samples))),
                ],
            ),
            frames: frame_counts(bytes, parameters)?,
        })
    }

    /// Every combination of what is said.
    pub(super) fn layouts(&self) -> Vec<Layout> {
        let mut layouts = Vec::new();
        for start in self.start.values() {
            for storage in self.storage.values() {
                for points in self.points.values() {
                    for analog in self.analog.values() {
                        for frames in self.frames.values() {
                            layouts.push(Layout { start, storage, points, analog, frames });
                        }
                    }
                }
            }
        }
        layouts
    }

    /// Which things are said differently, and how.
    pub(super) fn disagreements(&self) -> Vec<String> {
        [
            self.start.disagreement(),
            self.storage.disagreement(),
            self.points.disagreement(),
            self.analog.disagreement(),
            self.frames.disagreement(),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// The first thing that nobody says.
    pub(super) fn unsaid(&self) -> Option<&'static str> {
        let start = self.start.said.is_empty().then_some(self.start.what);
        let storage =
            self.storage.said.is_empty().then_some("POINT:SCALE, so whether it holds integers or reals");
        start.or(storage).or(self.frames.said.is_empty().then_some("frames"))
    }
}

/// First and last frame by TRIAL:ACTUAL_START_FIELD and _END_FIELD: two 16-bit words each, the low one first.
pub(super) fn trial_range(parameters: &Parameters) -> std::result::Result<Option<(u64, u64)>, Violation> {
    let field = |name| {
        let words = parameters.numbers("TRIAL", name)?;
        let word = |index: usize| words.get(index).copied().unwrap_or(0.0).rem_euclid(65536.0) as u64;
        Ok((!words.is_empty()).then(|| word(0) + 65536 * word(1)))
    };
    let range = (field("ACTUAL_START_FIELD")?, field("ACTUAL_END_FIELD")?);
    Ok(match range {
        (Some(first), Some(last)) if first <= last => Some((first, last)),
        _ => None,
    })
}

/// Counts of more than 65535 frames do not fit the words of the header and of POINT:FRAMES, which then stop at 65535
/// or start again at 0; where a wider statement explains them so, they do not count as disagreeing.
fn frame_counts(bytes: &[u8], parameters: &Parameters) -> std::result::Result<Statements<u64>, Violation> {
    let (first, last) = (u64::from(word(bytes, 6)), u64::from(word(bytes, 8)));
    let trial = trial_range(parameters)?;
    let trial_count = trial.map(|(first, last)| last - first + 1);
    let long = parameters.count("POINT", "LONG_FRAMES")?;
    let explained = |count: u64| {
        [trial_count, long]
            .into_iter()
            .flatten()
            .any(|wide| wide != count && wide > count && (count >= 65534 || count == wide % 65536))
    };
    // The header's frame numbers may also stop at 65535 when the count does not.
    let saturated = |(trial_first, trial_last): (u64, u64)| {
        let stops = |frame: u64, wide: u64| frame == wide.min(65535) || frame == wide % 65536;
        trial_last > 65535 && stops(first, trial_first) && stops(last, trial_last)
    };
    let header = (first <= last).then(|| last - first + 1);
    let header = header.filter(|&count| !explained(count) && !trial.is_some_and(saturated));
    Ok(Statements::new(
        "frames",
        vec![
            ("the header", header),
            ("POINT:FRAMES", parameters.count("POINT", "FRAMES")?.filter(|&count| !explained(count))),
            ("POINT:LONG_FRAMES", long),
            ("TRIAL", trial_count),
        ],
    ))
}
