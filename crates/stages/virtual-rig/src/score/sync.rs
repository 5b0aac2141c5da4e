//! `sync` against the true clocks.

use super::same::{CommonFrames, check_equal, check_ids, check_take};
use super::{Metric, ScoreError};
use artifact::{Shown, SyncCamera, SyncFrame, SyncHeader};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// A time base: header and frames.
pub type TimeBase<'a> = (&'a SyncHeader, &'a [SyncFrame]);

/// Scores a time base: `offset_frames`, `drift_ppm` (the worst camera; each in the context), `drops_missed`,
/// `drops_invented`, `wrong_images`, `missing`, `cameras_missing`.
///
/// - The offset error of a camera is the mean, over the images that truth and result both show, of the difference of the
///   mocap times that they give the same image, in mocap frames. A difference that all clocks share says nothing about
///   how they stand to each other: the (lower) median over the cameras is taken off, of offsets and of drifts; it stands
///   in the context as `common`.
/// - A drop is an image that is due but not there, or one that only repeats the one before it: so marked in the truth, or
///   one between two images that the truth shows but that stands in none of its frames. *Missed*: the result shows an image
///   for a dropped one, or takes a repeated one for a new one. *Invented*: the other way round.
/// - A *wrong* image is one with another index than the truth's; a *missing* one stands in a frame or camera that the
///   result does not have.
///
/// # Errors
/// A result of another take, with unknown cameras, other rates, or without a common frame.
pub fn sync(truth: TimeBase, result: TimeBase) -> Result<Vec<Metric>, ScoreError> {
    check_headers(truth.0, result.0)?;
    let numbers = |frames: &[SyncFrame]| frames.iter().map(|frame| frame.frame).collect::<Vec<_>>();
    let frames = CommonFrames::of(&numbers(truth.1), &numbers(result.1))?;
    let repeats = Repeats::of(truth.1);
    let mut drops = Drops { true_drops: repeats.count(), ..Drops::default() };
    for &(at, other) in &frames.pairs {
        drops.add_frame(&truth.1[at], &result.1[other], &repeats);
    }
    drops.missing +=
        frames.missing.iter().map(|&at| truth.1[at].shows.values().flatten().count()).sum::<usize>();
    let common = |(id, camera): (&String, &SyncCamera)| {
        Some((id.clone(), camera.clone(), result.0.cameras.get(id)?.clone()))
    };
    let cameras: Vec<(String, SyncCamera, SyncCamera)> = truth.0.cameras.iter().filter_map(common).collect();
    let drift =
        cameras.iter().map(|(id, truth, result)| (id.clone(), result.drift_ppm - truth.drift_ppm)).collect();
    let offsets = cameras
        .iter()
        .filter_map(|(id, at, found)| {
            Some((id.clone(), mean_difference(id, (at, truth.1), (found, result.1))?))
        })
        .collect();
    let context = frames.context();
    let metrics = vec![
        worst("offset_frames", "frames", offsets),
        worst("drift_ppm", "ppm", drift),
        Metric::count("drops_missed", drops.missed),
        Metric::count("drops_invented", drops.invented),
        Metric::count("wrong_images", drops.wrong),
        Metric::count("missing", drops.missing),
        Metric::count("cameras_missing", truth.0.cameras.len() - cameras.len()),
    ];
    let known = [("images", drops.images), ("drops", drops.true_drops)];
    let metrics = metrics.into_iter().map(|metric| metric.with_all(&context));
    Ok(metrics
        .map(|metric| known.iter().fold(metric, |metric, &(key, count)| metric.with(key, count)))
        .collect())
}

fn check_headers(truth: &SyncHeader, result: &SyncHeader) -> Result<(), ScoreError> {
    check_take(truth.take.as_ref(), result.take.as_ref())?;
    check_equal("rate", &truth.rate, &result.rate)?;
    let known: Vec<&str> = truth.cameras.keys().map(String::as_str).collect();
    check_ids("camera", &known, result.cameras.keys().map(String::as_str))?;
    for (id, camera) in &result.cameras {
        check_equal(&format!("camera {id}, every"), &truth.cameras[id].every, &camera.every)?;
    }
    Ok(())
}

/// Which images only repeat the one before them, so that no frame of the truth shows them. Footage holds nothing but images
/// of frames and their repetitions: what lies between two that are shown is a repetition. Per camera those that are shown.
struct Repeats<'a>(BTreeMap<&'a str, BTreeSet<i64>>);

impl<'a> Repeats<'a> {
    fn of(truth: &'a [SyncFrame]) -> Self {
        let mut shown: BTreeMap<&str, BTreeSet<i64>> = BTreeMap::new();
        let shows = truth.iter().flat_map(|frame| &frame.shows);
        for (camera, image) in shows.filter_map(|(camera, image)| Some((camera, image.as_ref()?))) {
            shown.entry(camera).or_default().insert(image.index);
        }
        Self(shown)
    }

    fn count(&self) -> usize {
        let between = |shown: &BTreeSet<i64>| {
            let span = shown.last()?.abs_diff(*shown.first()?) as usize;
            Some(span - (shown.len() - 1))
        };
        self.0.values().filter_map(between).sum()
    }

    fn contains(&self, camera: &str, image: i64) -> bool {
        let lies_between = |shown: &BTreeSet<i64>| {
            shown.first() < Some(&image) && Some(&image) < shown.last() && !shown.contains(&image)
        };
        self.0.get(camera).is_some_and(lies_between)
    }
}

/// Images by what the result says of them.
#[derive(Debug, Default)]
struct Drops {
    images: usize,
    true_drops: usize,
    missed: usize,
    invented: usize,
    wrong: usize,
    missing: usize,
}

impl Drops {
    fn add_frame(&mut self, truth: &SyncFrame, result: &SyncFrame, repeats: &Repeats) {
        for (camera, shown) in &truth.shows {
            self.images += usize::from(shown.is_some());
            self.true_drops += usize::from(shown.is_none_or(|shown| shown.doubled));
            match result.shows.get(camera) {
                None => self.missing += usize::from(shown.is_some()),
                Some(found) => {
                    let repeats = |image: &Shown| repeats.contains(camera, image.index);
                    self.add_image(shown.as_ref(), found.as_ref(), repeats);
                }
            }
        }
    }

    /// `repeats`: whether an image that the truth does not show only repeats another one.
    fn add_image(&mut self, truth: Option<&Shown>, result: Option<&Shown>, repeats: impl Fn(&Shown) -> bool) {
        match (truth, result) {
            (None, None) => {}
            // An image known to be a repetition is no image of this frame.
            (None, Some(result)) => self.missed += usize::from(!result.doubled),
            (Some(truth), None) => self.invented += usize::from(!truth.doubled),
            (Some(truth), Some(result)) => {
                self.missed += usize::from(!result.doubled && (truth.doubled || repeats(result)));
                self.invented += usize::from(!truth.doubled && result.doubled);
                self.wrong += usize::from(truth.index != result.index);
            }
        }
    }
}

/// The mocap time of a camera's image that shows a frame, in frames after the frame of the same number.
fn lag(camera: &SyncCamera, frame: i64) -> f64 {
    camera.offset_frames + camera.drift_ppm * 1e-6 * (frame - camera.phase) as f64
}

/// How much later the result takes a camera's images to be than the truth, in the mean; none where they share no image.
fn mean_difference(
    camera: &str,
    truth: (&SyncCamera, &[SyncFrame]),
    result: (&SyncCamera, &[SyncFrame]),
) -> Option<f64> {
    let images = |frames: &[SyncFrame]| {
        let image = |frame: &SyncFrame| Some(((*frame.shows.get(camera)?)?.index, frame.frame));
        frames.iter().filter_map(image).collect::<BTreeMap<i64, i64>>()
    };
    let (at, found) = (images(truth.1), images(result.1));
    let differences: Vec<f64> = at
        .iter()
        .filter_map(|(index, frame)| {
            let other = *found.get(index)?;
            Some((other - frame) as f64 + (lag(result.0, other) - lag(truth.0, *frame)))
        })
        .collect();
    (!differences.is_empty()).then(|| differences.iter().sum::<f64>() / differences.len() as f64)
}

/// The worst camera after what all have in common.
fn worst(name: &'static str, unit: &'static str, mut differences: Vec<(String, f64)>) -> Metric {
    let mut sorted: Vec<f64> = differences.iter().map(|(_, difference)| *difference).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let value = match sorted.len() {
        0 => Err("truth and result share no image of any camera".to_string()),
        1 => Err("one camera has nothing that its clock could be compared with".to_string()),
        _ => {
            let common = sorted[(sorted.len() - 1) / 2];
            differences.iter_mut().for_each(|(_, difference)| *difference -= common);
            Ok(differences.iter().map(|(_, difference)| difference.abs()).fold(0.0, f64::max))
        }
    };
    let common = (sorted.len() > 1).then(|| sorted[(sorted.len() - 1) / 2]);
    let each: Map<String, Value> =
        differences.into_iter().map(|(id, difference)| (id, json!(difference))).collect();
    Metric::error(name, unit, value).with("common", json!(common)).with("per_camera", each)
}
