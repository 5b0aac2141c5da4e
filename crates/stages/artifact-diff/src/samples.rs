//! Points or displacements with ids, frame by frame: markers and handles.

use crate::sequences::one_sided_frames;
use crate::{Error, Part, Report, Summary};
use nalgebra::Vector3;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Vectors with ids over frames.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Samples {
    /// The ids; the order of the vectors.
    pub ids: Vec<String>,
    /// Frame numbers, rising, each with one vector per id, mm; `None` where it is missing.
    pub frames: Vec<(i64, Vec<Option<Vector3<f64>>>)>,
}

/// Distances between the vectors of one id in one frame, mm, as a whole and per id; and ids, frames and samples that
/// stand on one side only. `noun` says what an id is: `marker`.
///
/// # Errors
/// [`Error::NothingShared`] if no id or no frame stands on both sides.
pub fn compare_samples(samples: &Samples, other: &Samples, noun: &'static str) -> Result<Report, Error> {
    let place: BTreeMap<&str, usize> = other.ids.iter().enumerate().map(|(i, id)| (id.as_str(), i)).collect();
    let pairs: Vec<(usize, usize)> =
        samples.ids.iter().enumerate().filter_map(|(i, id)| Some((i, *place.get(id.as_str())?))).collect();
    if pairs.is_empty() {
        return Err(Error::NothingShared(noun));
    }
    let frames = FramePairs::of(samples, other);
    if frames.both.is_empty() {
        return Err(Error::NothingShared("frame"));
    }
    let table = Table::of(samples, other, &pairs, &frames.both);
    let name = |pair: usize| &samples.ids[pairs[pair].0];
    let whole = Summary::of(&table.distances, |at| {
        let (frame, pair) = table.places[at];
        format!("frame {frame}, {noun} {}", name(pair))
    });
    let mut report = Report::new("mm", whole);
    report.details = (0..pairs.len()).map(|pair| table.part(pair, name(pair))).collect();
    report.structure = one_sided_ids(&samples.ids, &other.ids, noun);
    report.structure.extend(one_sided_frames(&frames.only_first, &frames.only_second));
    report.structure.extend(table.one_sided(noun));
    Ok(report)
}

/// Which frames stand on both sides (as positions), and which on one (as numbers).
#[derive(Default)]
struct FramePairs {
    both: Vec<(usize, usize)>,
    only_first: Vec<i64>,
    only_second: Vec<i64>,
}

impl FramePairs {
    fn of(samples: &Samples, other: &Samples) -> Self {
        let mut pairs = Self::default();
        let (mut i, mut j) = (0, 0);
        while i < samples.frames.len() || j < other.frames.len() {
            let (first, second) = (samples.frames.get(i).map(|f| f.0), other.frames.get(j).map(|f| f.0));
            let order = match (first, second) {
                (Some(first), Some(second)) => first.cmp(&second),
                (Some(_), None) => Ordering::Less,
                _ => Ordering::Greater,
            };
            match order {
                Ordering::Less => pairs.only_first.extend(first),
                Ordering::Greater => pairs.only_second.extend(second),
                Ordering::Equal => pairs.both.push((i, j)),
            }
            i += usize::from(order != Ordering::Greater);
            j += usize::from(order != Ordering::Less);
        }
        pairs
    }
}

/// All distances, frame after frame.
#[derive(Default)]
struct Table {
    distances: Vec<f64>,
    /// Frame number and pair of ids of every distance.
    places: Vec<(i64, usize)>,
    /// Samples that are missing in the second only, in the first only.
    missing: [usize; 2],
}

impl Table {
    fn of(samples: &Samples, other: &Samples, ids: &[(usize, usize)], frames: &[(usize, usize)]) -> Self {
        let mut table = Self::default();
        for &(i, j) in frames {
            let ((frame, vectors), (_, others)) = (&samples.frames[i], &other.frames[j]);
            for (pair, &(id, other_id)) in ids.iter().enumerate() {
                match (vectors[id], others[other_id]) {
                    (Some(vector), Some(other)) => {
                        table.distances.push((vector - other).norm());
                        table.places.push((*frame, pair));
                    }
                    (Some(_), None) => table.missing[0] += 1,
                    (None, Some(_)) => table.missing[1] += 1,
                    (None, None) => {}
                }
            }
        }
        table
    }

    fn part(&self, pair: usize, name: &str) -> Part {
        let own: Vec<usize> = (0..self.places.len()).filter(|&at| self.places[at].1 == pair).collect();
        let distances: Vec<f64> = own.iter().map(|&at| self.distances[at]).collect();
        let summary = Summary::of(&distances, |at| format!("frame {}", self.places[own[at]].0));
        Part { name: name.to_string(), summary }
    }

    fn one_sided(&self, noun: &str) -> Vec<String> {
        let sentence = |(count, side): (usize, &str)| {
            (count > 0)
                .then(|| format!("{count} {noun} samples are only in the {side}, missing in the other"))
        };
        [(self.missing[0], "first"), (self.missing[1], "second")].into_iter().filter_map(sentence).collect()
    }
}

fn one_sided_ids(ids: &[String], others: &[String], noun: &str) -> Vec<String> {
    let only = |ids: &[String], others: &[String], side: &str| {
        let own: Vec<&str> = ids.iter().filter(|id| !others.contains(id)).map(String::as_str).collect();
        (!own.is_empty()).then(|| format!("only the {side} has the {noun}s {}", own.join(", ")))
    };
    [only(ids, others, "first"), only(others, ids, "second")].into_iter().flatten().collect()
}
