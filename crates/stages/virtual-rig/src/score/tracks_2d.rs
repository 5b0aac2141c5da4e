//! `tracks-2d` against the true centroids of the dots.

use super::metric::share_of;
use super::same::{CommonFrames, check_equal, check_ids, check_take};
use super::spread::Pool;
use super::{Metric, ScoreError};
use artifact::{Sample2d, TrackState, Tracks2dFrame, Tracks2dHeader};
use nalgebra::Point2;
use serde_json::{Map, Value, json};

/// Tracks: header and frames.
pub type Tracks<'a> = (&'a Tracks2dHeader, &'a [Tracks2dFrame]);

/// A sample is recalled within this distance; a swap is nearer to another marker by more than it. px
pub const GATE_PX: f64 = 1.0;

/// Scores tracks: `swaps`, `recall`, `rms_px`, `outliers`, `false_positives`; each with its numbers per camera.
///
/// In the truth, a sample is *seen* where it counts as visible, and its confidence is the visible share of the dot. In the
/// result, samples seen or edited count; predictions do not. A sample is, in this order,
/// - a *swap* if it lies nearer to another marker's true place than to its own by more than [`GATE_PX`];
/// - *recalled* within [`GATE_PX`] of its own visible dot (`rms_px`, radial, is over these), an *outlier* beyond;
/// - *partial* within [`GATE_PX`] of its own dot that shows, but does not count as visible: neither good nor bad;
/// - else a *false positive*.
///
/// `recall` is over all visible samples of the truth, those of missing frames, cameras and markers included.
///
/// # Errors
/// A result of another take, with unknown cameras or markers, or without a common frame.
pub fn tracks_2d(truth: Tracks, result: Tracks) -> Result<Vec<Metric>, ScoreError> {
    let places = Places::of(truth.0, result.0)?;
    let numbers = |frames: &[Tracks2dFrame]| frames.iter().map(|frame| frame.frame).collect::<Vec<_>>();
    let frames = CommonFrames::of(&numbers(truth.1), &numbers(result.1))?;
    let mut cameras = vec![Tally::default(); truth.0.cameras.len()];
    for &(at, other) in &frames.pairs {
        for (camera, tally) in cameras.iter_mut().enumerate() {
            let found = places.cameras[camera]
                .and_then(|other_camera| result.1[other].cameras[other_camera].as_deref());
            tally.add_image(truth.1[at].cameras[camera].as_deref(), found, &places.markers);
        }
    }
    for &at in &frames.missing {
        for (camera, tally) in cameras.iter_mut().enumerate() {
            tally.add_image(truth.1[at].cameras[camera].as_deref(), None, &places.markers);
        }
    }
    let mut context = frames.context();
    let missing = |places: &[Option<usize>]| places.iter().filter(|place| place.is_none()).count();
    context.insert("cameras_missing".into(), missing(&places.cameras).into());
    context.insert("markers_missing".into(), missing(&places.markers).into());
    Ok(metrics(&truth.0.cameras, &cameras, &context))
}

/// Per camera and marker of the truth its place in the result.
struct Places {
    cameras: Vec<Option<usize>>,
    markers: Vec<Option<usize>>,
}

impl Places {
    fn of(truth: &Tracks2dHeader, result: &Tracks2dHeader) -> Result<Self, ScoreError> {
        check_take(truth.take.as_ref(), result.take.as_ref())?;
        if let (Some(truth), Some(result)) = (truth.rate, result.rate) {
            check_equal("rate", &truth, &result)?;
        }
        let places = |thing, truth: &[String], result: &[String]| {
            let known: Vec<&str> = truth.iter().map(String::as_str).collect();
            check_ids(thing, &known, result.iter().map(String::as_str))?;
            Ok(truth.iter().map(|id| result.iter().position(|other| other == id)).collect())
        };
        Ok(Self {
            cameras: places("camera", &truth.cameras, &result.cameras)?,
            markers: places("marker", &truth.markers, &result.markers)?,
        })
    }
}

/// What became of the samples of a camera.
#[derive(Debug, Clone, Default)]
struct Tally {
    visible: usize,
    recalled: Pool,
    swaps: usize,
    outliers: usize,
    false_positives: usize,
    partial: usize,
    predicted: usize,
}

impl Tally {
    fn add_image(
        &mut self,
        truth: Option<&[Option<Sample2d>]>,
        result: Option<&[Option<Sample2d>]>,
        markers: &[Option<usize>],
    ) {
        let visible =
            |sample: &&Option<Sample2d>| sample.is_some_and(|sample| sample.state == TrackState::Seen);
        self.visible += truth.iter().flat_map(|truth| truth.iter()).filter(visible).count();
        let Some(result) = result else { return };
        for (marker, place) in markers.iter().enumerate() {
            match place.and_then(|place| result[place]) {
                None => {}
                Some(sample) if sample.state == TrackState::Predicted => self.predicted += 1,
                Some(sample) => self.add_sample(sample.at, marker, truth.unwrap_or_default()),
            }
        }
    }

    fn add_sample(&mut self, at: Point2<f64>, marker: usize, truth: &[Option<Sample2d>]) {
        let distance = |sample: &Sample2d| (sample.at - at).norm();
        let own = truth.get(marker).copied().flatten();
        let others = truth.iter().enumerate().filter(|(other, _)| *other != marker);
        let nearest =
            others.filter_map(|(_, sample)| sample.as_ref().map(distance)).fold(f64::INFINITY, f64::min);
        let off = own.as_ref().map(distance);
        let is_swap = match off {
            Some(off) => off - nearest > GATE_PX,
            // The camera cannot have its own dot in the image at all.
            None => nearest <= GATE_PX,
        };
        match (own, off) {
            _ if is_swap => self.swaps += 1,
            (Some(own), Some(off)) if own.state == TrackState::Seen => match off <= GATE_PX {
                true => self.recalled.add(off),
                false => self.outliers += 1,
            },
            (Some(own), Some(off)) if own.confidence > 0.0 && off <= GATE_PX => self.partial += 1,
            _ => self.false_positives += 1,
        }
    }

    fn join(tallies: &[Self]) -> Self {
        let mut whole = Self::default();
        for tally in tallies {
            whole.visible += tally.visible;
            whole.recalled.join(&tally.recalled);
            whole.swaps += tally.swaps;
            whole.outliers += tally.outliers;
            whole.false_positives += tally.false_positives;
            whole.partial += tally.partial;
            whole.predicted += tally.predicted;
        }
        whole
    }

    fn recall(&self) -> Result<f64, String> {
        share_of(self.recalled.len(), self.visible, "no marker is visible in the truth")
    }

    fn rms_px(&self) -> Result<f64, String> {
        self.recalled.rms("no sample was recalled")
    }
}

fn metrics(names: &[String], cameras: &[Tally], context: &Map<String, Value>) -> Vec<Metric> {
    let whole = Tally::join(cameras);
    let per_camera = |value: &dyn Fn(&Tally) -> Value| {
        let values = names.iter().zip(cameras).map(|(name, tally)| (name.clone(), value(tally)));
        Value::Object(values.collect())
    };
    let counts = [
        ("visible", whole.visible),
        ("recalled", whole.recalled.len()),
        ("partial", whole.partial),
        ("predicted", whole.predicted),
    ];
    let with_counts = |metric: Metric, value: &dyn Fn(&Tally) -> Value| {
        let metric = metric.with_all(context);
        let metric = counts.iter().fold(metric, |metric, &(key, count)| metric.with(key, count));
        metric.with("cameras", per_camera(value))
    };
    vec![
        with_counts(Metric::count("swaps", whole.swaps), &|tally| tally.swaps.into()),
        with_counts(Metric::share("recall", whole.recall()), &|tally| json!(tally.recall().ok())),
        with_counts(Metric::error("rms_px", "px", whole.rms_px()), &|tally| json!(tally.rms_px().ok())),
        with_counts(Metric::count("outliers", whole.outliers), &|tally| tally.outliers.into()),
        with_counts(Metric::count("false_positives", whole.false_positives), &|tally| {
            tally.false_positives.into()
        }),
    ]
}
