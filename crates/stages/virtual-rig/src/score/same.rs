//! Whether truth and result speak of the same things.

use super::ScoreError;
use artifact::TakeRef;

/// Refuses a result of another take; one that names no take is believed.
pub(super) fn check_take(truth: Option<&TakeRef>, result: Option<&TakeRef>) -> Result<(), ScoreError> {
    match (truth, result) {
        (Some(truth), Some(result)) if truth.sha256 != result.sha256 => {
            Err(ScoreError::OtherTake { truth: truth.to_string(), result: result.to_string() })
        }
        _ => Ok(()),
    }
}

/// Ids that a message lists at most.
const LISTED: usize = 6;

/// Refuses ids of the result that the truth does not have.
pub(super) fn check_ids<'a>(
    thing: &'static str,
    truth: &[&'a str],
    result: impl IntoIterator<Item = &'a str>,
) -> Result<(), ScoreError> {
    match result.into_iter().find(|id| !truth.contains(id)) {
        None => Ok(()),
        Some(id) => {
            let more = if truth.len() > LISTED { ", …" } else { "" };
            let known = truth.iter().take(LISTED).copied().collect::<Vec<_>>().join(", ");
            let known = if known.is_empty() { "none".to_string() } else { format!("{known}{more}") };
            Err(ScoreError::UnknownId { thing, id: id.to_string(), known })
        }
    }
}

/// Refuses two values that should be one.
pub(super) fn check_equal<T: PartialEq + std::fmt::Display>(
    place: &str,
    truth: &T,
    result: &T,
) -> Result<(), ScoreError> {
    if truth == result {
        return Ok(());
    }
    Err(ScoreError::Differs {
        place: place.to_string(),
        truth: truth.to_string(),
        result: result.to_string(),
    })
}

/// Which frames truth and result share.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct CommonFrames {
    /// Per common frame its places in the truth and in the result.
    pub(super) pairs: Vec<(usize, usize)>,
    /// Frames of the truth that the result lacks, as places in the truth.
    pub(super) missing: Vec<usize>,
    /// Frames of the result that the truth does not have: they are not scored, but counted.
    pub(super) extra: usize,
}

impl CommonFrames {
    /// Pairs frame numbers (rising).
    pub(super) fn of(truth: &[i64], result: &[i64]) -> Result<Self, ScoreError> {
        let mut pairs = Vec::new();
        let mut missing = Vec::new();
        for (place, frame) in truth.iter().enumerate() {
            match result.binary_search(frame) {
                Ok(other) => pairs.push((place, other)),
                Err(_) => missing.push(place),
            }
        }
        if pairs.is_empty() && !truth.is_empty() {
            return Err(ScoreError::NoCommonFrame { truth: range(truth), result: range(result) });
        }
        let extra = result.len() - pairs.len();
        Ok(Self { pairs, missing, extra })
    }

    /// The counts, for a metric's context.
    pub(super) fn context(&self) -> serde_json::Map<String, serde_json::Value> {
        let counts = [
            ("frames", self.pairs.len()),
            ("frames_missing", self.missing.len()),
            ("frames_extra", self.extra),
        ];
        counts.into_iter().map(|(key, count)| (key.to_string(), count.into())).collect()
    }
}

fn range(frames: &[i64]) -> String {
    match (frames.first(), frames.last()) {
        (Some(first), Some(last)) => format!("{first}–{last}"),
        _ => "none".to_string(),
    }
}
