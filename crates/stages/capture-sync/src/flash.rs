//! Clocks by a flash that all cameras see.

use crate::line::median;
use crate::timeline::{Paced, Timeline, stated_step};
use crate::{Error, Params};
use artifact::{Rate, SyncSource};

/// A flash makes an image brighter than usual by this share, and by so many times the usual spread.
const LEAST_RISE: f64 = 0.1;
const LEAST_SPREADS: f64 = 12.0;
/// An image of less than this share of a flash's full light was taken while it flared up or died.
const WHOLE: f64 = 0.9;

/// The start of a flash, in exposures: surely within `at` ± `within`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Onset {
    at: f64,
    within: f64,
}

/// When the cameras' exposures were: the flashes of all cameras are the same ones. A flash starts between the last dark
/// image and the first bright one, or in the middle of one that is only half as bright as the next. Where the frames'
/// motion tells more (see `correlation`), this is only where it starts to look.
pub(crate) fn timelines(
    cameras: &[Paced],
    take_rate: Rate,
    _params: &Params,
) -> Result<Vec<(Timeline, f64)>, Error> {
    let onsets: Vec<Vec<Onset>> = cameras.iter().map(onsets).collect::<Result<_, _>>()?;
    let steps: Vec<f64> = cameras.iter().map(|camera| stated_step(camera.recording, take_rate)).collect();
    let fastest = (0..cameras.len()).min_by(|&a, &b| steps[a].total_cmp(&steps[b])).unwrap_or(0);
    let timeline = |c: usize| {
        if onsets[c].len() != onsets[fastest].len() {
            return Err(Error::Flashes {
                camera: cameras[c].id().to_string(),
                found: onsets[c].len(),
                reference: cameras[fastest].id().to_string(),
                expected: onsets[fastest].len(),
            });
        }
        // Each flash gives an interval that the start lies in; their common part, or what is nearest to one.
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for (own, other) in onsets[c].iter().zip(&onsets[fastest]) {
            let start = other.at * steps[fastest] - own.at * steps[c];
            let within = other.within * steps[fastest] + own.within * steps[c];
            low = low.max(start - within);
            high = high.min(start + within);
        }
        let timeline = Timeline {
            start: 0.5 * (low + high),
            step: steps[c],
            source: SyncSource::Flash,
            sigma_frames: None,
        };
        Ok((timeline, 0.5 * (high - low).abs()))
    };
    (0..cameras.len()).map(timeline).collect()
}

/// The starts of a camera's flashes.
fn onsets(camera: &Paced) -> Result<Vec<Onset>, Error> {
    let light = lights(camera).ok_or_else(|| Error::NotRead(camera.id().to_string()))?;
    let onset = |flash: &Flash| onset(&camera.cadence.exposures, &light, flash);
    let found: Vec<Onset> = flashes(&light).iter().map(onset).collect();
    if found.is_empty() { Err(Error::NoFlash(camera.id().to_string())) } else { Ok(found) }
}

fn lights(camera: &Paced) -> Option<Vec<f64>> {
    camera.recording.images.iter().map(|image| Some(image.reading.as_ref()?.light)).collect()
}

/// Images that a flash lights up, and their neighbours, which it may light a little: per image.
pub(crate) fn lit(camera: &Paced) -> Vec<bool> {
    let mut lit = vec![false; camera.recording.images.len()];
    for flash in lights(camera).map(|light| flashes(&light)).unwrap_or_default() {
        lit[flash.images.start - 1..(flash.images.end + 1).min(camera.recording.images.len())].fill(true);
    }
    lit
}

/// A flash in a camera's images.
struct Flash {
    /// The images that it lights up; the first is not the camera's first.
    images: std::ops::Range<usize>,
    /// Light without it, and how much it adds to its brightest image.
    dark: f64,
    peak: f64,
}

fn flashes(light: &[f64]) -> Vec<Flash> {
    let dark = median(light);
    let spread = 1.4826 * median(&light.iter().map(|light| (light - dark).abs()).collect::<Vec<_>>());
    let least = (LEAST_RISE * dark).max(LEAST_SPREADS * spread);
    let mut found = Vec::new();
    let mut at = 1;
    while at < light.len() {
        if light[at] - light[at - 1] < 0.5 * least || light[at] - dark < 0.5 * least {
            at += 1;
            continue;
        }
        let end = (at..light.len()).find(|&i| light[i] - dark < 0.5 * least).unwrap_or(light.len());
        let peak = light[at..end].iter().copied().fold(0.0, f64::max) - dark;
        if peak >= least {
            found.push(Flash { images: at..end, dark, peak });
        }
        at = end;
    }
    found
}

fn onset(exposures: &[i64], light: &[f64], flash: &Flash) -> Onset {
    let first = flash.images.start;
    let (before, at) = (exposures[first - 1] as f64, exposures[first] as f64);
    match light[first] - flash.dark < WHOLE * flash.peak {
        true => Onset { at, within: 0.1 },
        false => Onset { at: 0.5 * (before + at), within: 0.5 * (at - before) },
    }
}
