//! Which exposure of its camera each image is: drops leave numbers out, doubles repeat one.

use crate::line::median;
use crate::recording::{Image, Recording};

/// Which exposures a camera's images are.
#[derive(Debug, Clone, PartialEq)]
pub struct Cadence {
    /// Per image the number of its exposure, from 0 at the first image, never falling. Numbers left out are dropped images.
    pub exposures: Vec<i64>,
    /// Per image whether it only repeats the one before it: a second copy where it has the same exposure, else one that
    /// stands in the place of a lost image.
    pub repeats: Vec<bool>,
}

/// Gain of the tracker that follows the stamps: slow enough to smooth their jitter, fast enough for a clock that warms up.
const PHASE_GAIN: f64 = 0.1;
/// How far back a late stamp may have opened a gap that is none.
const MEND_REACH: usize = 8;
/// A longer gap is refused later; so many steps can be counted.
const MOST_STEPS: i64 = 1 << 40;
/// Stamps closer than this share of the period are one stamp.
const SAME_STAMP: f64 = 1e-3;
/// An image that differs from the one before it by less than this share of the usual difference repeats it, though a lossy
/// codec changed some pixels.
const REPEAT_SHARE: f64 = 0.1;
/// Where more images than this seem to repeat the one before them, nothing moves and nothing can be told.
const MOST_REPEATS: f64 = 0.3;

impl Cadence {
    /// From the stamps if all images have one and `use_stamps`, else from the images and their numbers.
    #[must_use]
    pub fn of(recording: &Recording, use_stamps: bool) -> Self {
        match use_stamps && recording.is_stamped() {
            true => Self::from_stamps(recording),
            false => Self::from_images(recording),
        }
    }

    /// A phase-locked tracker predicts the next stamp from the ones before, and the nearest whole number of periods to it
    /// is taken. An image with the stamp of the one before repeats it.
    fn from_stamps(recording: &Recording) -> Self {
        let times: Vec<f64> = recording.images.iter().filter_map(|image| image.time_s).collect();
        let period = period(&times, 1.0 / recording.rate.hz());
        let (mut exposures, mut repeats) = (vec![0_i64], vec![false]);
        let mut expected = times.first().copied().unwrap_or_default();
        for i in 1..times.len() {
            let last = exposures[i - 1];
            let repeat = times[i] - times[i - 1] < SAME_STAMP * period;
            repeats.push(repeat);
            if repeat {
                exposures.push(last);
                continue;
            }
            let steps = ((times[i] - expected) / period).round() as i64;
            if steps < 1 && close_gap(&mut exposures) {
                expected -= period;
            }
            let last = exposures[i - 1];
            let steps = (((times[i] - expected) / period).round() as i64).clamp(1, MOST_STEPS);
            exposures.push(last + steps);
            let due = expected + steps as f64 * period;
            expected = due + PHASE_GAIN * (times[i] - due);
        }
        let first = exposures[0];
        exposures.iter_mut().for_each(|exposure| *exposure -= first);
        // The same pixels at another time: the image stands for one that was lost.
        let stale = repeated(&recording.images);
        repeats.iter_mut().zip(stale).for_each(|(repeat, stale)| *repeat |= stale);
        Self { exposures, repeats }
    }

    /// Numbers left out of an image sequence are drops. An image that repeats the one before it is a second copy, or stands
    /// for one that was lost; which of the two is for the clocks to say, and here taken to be a copy.
    fn from_images(recording: &Recording) -> Self {
        let repeats = repeated(&recording.images);
        let (mut exposures, mut last) = (Vec::with_capacity(repeats.len()), 0);
        for (i, repeat) in repeats.iter().enumerate() {
            if i > 0 {
                let step =
                    recording.images[i].index.saturating_sub(recording.images[i - 1].index).min(MOST_STEPS);
                last += step - i64::from(*repeat);
            }
            exposures.push(last);
        }
        Self { exposures, repeats }
    }

    /// Exposures that no image shows, between the first image and the last.
    #[must_use]
    pub fn dropped(&self) -> i64 {
        self.exposures.windows(2).map(|pair| (pair[1] - pair[0] - 1).max(0)).sum()
    }

    /// Images that repeat the one before them.
    #[must_use]
    pub fn doubled(&self) -> usize {
        self.repeats.iter().filter(|repeat| **repeat).count()
    }
}

/// Takes back the last gap, if it is near: the stamp before came late and only seemed to be the next one's.
fn close_gap(exposures: &mut [i64]) -> bool {
    let from = exposures.len().saturating_sub(MEND_REACH);
    let gap = (from.max(1)..exposures.len()).rev().find(|&i| exposures[i] > exposures[i - 1] + 1);
    let Some(gap) = gap else { return false };
    exposures[gap..].iter_mut().for_each(|exposure| *exposure -= 1);
    true
}

/// The median time between stamps, of those near the stated one.
fn period(times: &[f64], stated: f64) -> f64 {
    let steps: Vec<f64> = times
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| (0.5 * stated..1.5 * stated).contains(step))
        .collect();
    let usual = if steps.is_empty() { stated } else { median(&steps) };
    // Rounded stamps (1 ms) and jitter make the median coarse; the mean of those around it is fine.
    let near: Vec<f64> = steps.into_iter().filter(|step| (step / usual - 1.0).abs() < 0.4).collect();
    if near.is_empty() { usual } else { near.iter().sum::<f64>() / near.len() as f64 }
}

/// Per image whether it repeats the one before it.
fn repeated(images: &[Image]) -> Vec<bool> {
    let difference = |pair: &[Image]| match (&pair[0].reading, &pair[1].reading) {
        (Some(a), Some(b)) if a.fingerprint == b.fingerprint => Some(0.0),
        (Some(a), Some(b)) => Some(a.distance(b)),
        _ => None,
    };
    let differences: Vec<Option<f64>> = images.windows(2).map(difference).collect();
    let mut sorted: Vec<f64> = differences.iter().flatten().copied().filter(|d| *d > 0.0).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let limit = REPEAT_SHARE * sorted.get(sorted.len() / 20).copied().unwrap_or(0.0);
    let mut repeats = vec![false];
    repeats.extend(differences.iter().map(|d| d.is_some_and(|d| d <= limit)));
    repeats.truncate(images.len());
    let share = repeats.iter().filter(|repeat| **repeat).count() as f64 / images.len().max(1) as f64;
    if share > MOST_REPEATS { vec![false; images.len()] } else { repeats }
}
