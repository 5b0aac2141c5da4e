//! `trajectories-3d` and `head-trajectories` against the true markers.

use super::same::{CommonFrames, check_ids, check_take};
use super::spread::Pool;
use super::tracks_2d::Tracks;
use super::{Metric, ScoreError};
use artifact::{MarkerFrame, MarkerHeader, Sample2d, SampleStatus, TrackState, Trajectories};
use nalgebra::{Isometry3, Point3};
use serde_json::{Map, Value, json};

/// Scores markers in the world: `rms_mm`, `median_mm`, `p95_mm` and `coverage` of measured samples, `filled_rms_mm` of
/// filled ones (seen by one camera, filled from neighbours, interpolated), `missing` samples (no position at all, missing frames and markers
/// included).
///
/// `coverage` is the share of the truth's samples that were measured. Where the truth should only hold what two cameras
/// saw, give it as [`seen_by_two`] leaves it.
///
/// # Errors
/// A result of another take, with unknown markers, or without a common frame.
pub fn trajectories_3d(truth: &Trajectories, result: &Trajectories) -> Result<Vec<Metric>, ScoreError> {
    let samples = Samples::pair(truth, result)?;
    Ok(samples.metrics(&Isometry3::identity(), &samples.context))
}

/// Scores markers in head space as [`trajectories_3d`] does in the world, after one rigid motion for the whole take:
/// where head space has its origin is up to whoever defines it. The errors without that motion stand in the context.
///
/// # Errors
/// As [`trajectories_3d`].
pub fn head_trajectories(truth: &Trajectories, result: &Trajectories) -> Result<Vec<Metric>, ScoreError> {
    let samples = Samples::pair(truth, result)?;
    let (from, to): (Vec<_>, Vec<_>) =
        samples.measured.iter().map(|sample| (sample.result, sample.truth)).unzip();
    let fitted = super::align::rigid(&from, &to).unwrap_or_else(Isometry3::identity);
    let raw = samples.errors(&samples.measured, &Isometry3::identity()).rms("").ok();
    let mut context = samples.context.clone();
    context.insert("raw_rms_mm".to_string(), json!(raw));
    Ok(samples.metrics(&fitted, &context))
}

/// The truth without samples that fewer than two cameras see in the true tracks: nobody can triangulate those.
#[must_use]
pub fn seen_by_two(truth: &Trajectories, tracks: Tracks) -> Trajectories {
    let (header, frames) = tracks;
    let places: Vec<Option<usize>> =
        truth.header.markers.iter().map(|id| header.markers.iter().position(|other| other == id)).collect();
    let is_seen = |samples: &[Option<Sample2d>], place: usize| {
        samples[place].is_some_and(|sample| sample.state == TrackState::Seen)
    };
    let mut seen = truth.clone();
    for frame in &mut seen.frames {
        let images = frames
            .binary_search_by_key(&frame.frame, |frame| frame.frame)
            .map_or(&[][..], |at| &frames[at].cameras);
        for (place, point) in places.iter().zip(&mut frame.points) {
            let sees = |place| images.iter().flatten().filter(|samples| is_seen(samples, place)).count();
            if place.map_or(0, sees) < 2 {
                *point = None;
            }
        }
    }
    seen
}

struct Sample {
    truth: Point3<f64>,
    result: Point3<f64>,
}

/// The samples that truth and result share, by where the result has them from.
struct Samples {
    measured: Vec<Sample>,
    filled: Vec<Sample>,
    /// Samples of the truth without any position in the result.
    missing: usize,
    context: Map<String, Value>,
}

impl Samples {
    fn pair(truth: &Trajectories, result: &Trajectories) -> Result<Self, ScoreError> {
        let markers = check_headers(&truth.header, &result.header)?;
        let numbers = |frames: &[MarkerFrame]| frames.iter().map(|frame| frame.frame).collect::<Vec<_>>();
        let frames = CommonFrames::of(&numbers(&truth.frames), &numbers(&result.frames))?;
        let mut samples =
            Self { measured: Vec::new(), filled: Vec::new(), missing: 0, context: frames.context() };
        let mut invented = 0;
        for &(at, other) in &frames.pairs {
            invented += samples.add_frame(&truth.frames[at], &result.frames[other], &markers);
        }
        let held = |frame: &MarkerFrame| frame.points.iter().flatten().count();
        samples.missing += frames.missing.iter().map(|&at| held(&truth.frames[at])).sum::<usize>();
        let markers_missing = markers.iter().filter(|marker| marker.is_none()).count();
        let counts = [
            ("measured", samples.measured.len()),
            ("filled", samples.filled.len()),
            ("missing", samples.missing),
            ("without_truth", invented),
            ("markers_missing", markers_missing),
        ];
        samples.context.extend(counts.map(|(key, count)| (key.to_string(), count.into())));
        Ok(samples)
    }

    /// Sorts the samples of a frame; returns how many the truth does not have.
    fn add_frame(&mut self, truth: &MarkerFrame, result: &MarkerFrame, markers: &[Option<usize>]) -> usize {
        let mut invented = 0;
        for (marker, point) in truth.points.iter().enumerate() {
            let found = markers[marker].and_then(|other| Some((result.points[other]?, result.status[other])));
            match (*point, found) {
                (Some(truth), Some((result, SampleStatus::Measured))) => {
                    self.measured.push(Sample { truth, result });
                }
                (Some(truth), Some((result, _))) => self.filled.push(Sample { truth, result }),
                (Some(_), None) => self.missing += 1,
                (None, Some(_)) => invented += 1,
                (None, None) => {}
            }
        }
        invented
    }

    fn errors(&self, samples: &[Sample], truth_from_result: &Isometry3<f64>) -> Pool {
        let mut pool = Pool::default();
        samples.iter().for_each(|sample| pool.add((truth_from_result * sample.result - sample.truth).norm()));
        pool
    }

    fn metrics(&self, truth_from_result: &Isometry3<f64>, context: &Map<String, Value>) -> Vec<Metric> {
        let errors = self.errors(&self.measured, truth_from_result);
        let filled = self.errors(&self.filled, truth_from_result);
        let nothing = "the result has no measured sample that the truth has too";
        let whole = self.measured.len() + self.filled.len() + self.missing;
        vec![
            Metric::error("rms_mm", "mm", errors.rms(nothing)),
            Metric::error("median_mm", "mm", errors.median(nothing)),
            Metric::error("p95_mm", "mm", errors.percentile(0.95, nothing)),
            Metric::share(
                "coverage",
                super::metric::share_of(self.measured.len(), whole, "the truth has no sample"),
            ),
            Metric::error("filled_rms_mm", "mm", filled.rms("the result fills no sample")),
            Metric::count("missing", self.missing),
        ]
        .into_iter()
        .map(|metric| metric.with_all(context))
        .collect()
    }
}

/// Refuses other takes and unknown markers; returns per marker of the truth its place in the result.
fn check_headers(truth: &MarkerHeader, result: &MarkerHeader) -> Result<Vec<Option<usize>>, ScoreError> {
    check_take(truth.take.as_ref(), result.take.as_ref())?;
    super::same::check_equal("unit", &truth.unit, &result.unit)?;
    if let (Some(truth), Some(result)) = (truth.rate, result.rate) {
        super::same::check_equal("rate", &truth, &result)?;
    }
    let known: Vec<&str> = truth.markers.iter().map(String::as_str).collect();
    check_ids("marker", &known, result.markers.iter().map(String::as_str))?;
    Ok(truth.markers.iter().map(|id| result.markers.iter().position(|other| other == id)).collect())
}
