//! Clocks by what moves: the lag at which two cameras' changes have most in common.
//!
//! A scalar such as motion energy loses which way things move; with the main components of a coarse picture and canonical
//! correlation, which finds by itself what two views have in common, the lag comes out several times finer.

use crate::canonical::{Likeness, Pairs};
use crate::course::{COMPONENTS, Course, Point};
use crate::line::{Line, lower_median, median};
use crate::timeline::{Paced, Timeline, stated_step};
use crate::{Error, Params};
use artifact::{Rate, SyncSource};
use rayon::prelude::*;

/// Exposures that the first search uses: those around the most motion.
const SEARCH_EXPOSURES: usize = 1500;
/// Exposures of a window, about; a window's lag is one number.
const WINDOW_EXPOSURES: usize = 400;
/// Fewer pairs of changes tell nothing.
const LEAST_PAIRS: usize = 60;
/// By how much the best lag must be likelier than the usual one, nats. Unrelated noise of 12 × 12 components scatters by
/// √(144 / 2), by √2 more for changes that overlap: six times that.
const LEAST_NATS: f64 = 72.0;
/// Exposures of the windows that are looked at for breaks in short takes.
const BREAK_EXPOSURES: usize = 100;
/// Share of a camera's exposures that may be lost without a trace and still be noticed.
const BREAK_SHARE: f64 = 0.05;
/// Steps of the fine search, mocap frames.
const FINE: f64 = 0.25;
/// How far from where it is expected a window's lag is looked for, mocap frames.
const REACH: f64 = 2.0;
/// Changes of neighbouring exposures overlap and share their noise, and components are no perfect Gaussians: curvature says
/// more than is known by about this factor (from the scatter of windows on virtual takes).
const CURVATURE_SHARE: f64 = 0.1;

/// A camera compared with the reference.
struct Pair<'a> {
    camera: &'a Course,
    reference: &'a Course,
    /// Stated mocap frames between exposures of either.
    step: f64,
    reference_step: f64,
    /// Changes are over so many exposures.
    span: i64,
}

/// The lag in a window of exposures.
#[derive(Debug, Clone, Copy)]
struct WindowLag {
    /// Middle of the window, exposures.
    middle: f64,
    /// Mocap frames.
    lag: f64,
    /// 1 / variance.
    weight: f64,
}

/// When the cameras' exposures were, against the middle one of the mocap cameras; `guess`: where exposure 0 of each camera
/// is looked for (mocap frames, and how far around), the first camera's included.
pub(crate) fn timelines(
    cameras: &[Paced],
    guess: &[(f64, f64)],
    take_rate: Rate,
    params: &Params,
    source: SyncSource,
) -> Result<Vec<Timeline>, Error> {
    let courses: Vec<Course> = cameras.par_iter().map(Course::of).collect::<Result<_, _>>()?;
    let steps: Vec<f64> = cameras.iter().map(|camera| stated_step(camera.recording, take_rate)).collect();
    let reference = reference(cameras, &steps);
    let timeline = |c: usize| {
        if c == reference {
            return Ok(Timeline { start: guess[c].0, step: steps[c], source, sigma_frames: None });
        }
        let pair = Pair {
            camera: &courses[c],
            reference: &courses[reference],
            step: steps[c],
            reference_step: steps[reference],
            span: (2.0 / steps[c]).ceil() as i64,
        };
        let (center, radius) = (guess[c].0 - guess[reference].0, guess[c].1);
        let (line, sigma) =
            pair.line(center, radius, params).map_err(|correlation| Error::NoCorrelation {
                camera: cameras[c].id().to_string(),
                reference: cameras[reference].id().to_string(),
                correlation,
            })?;
        if let Some(exposure) = pair.find_break(&line) {
            let (camera, reference) = (cameras[c].id().to_string(), cameras[reference].id().to_string());
            return Err(Error::Break { camera, reference, exposure });
        }
        let (start, step) = (guess[reference].0 + line.at_zero, steps[c] + line.slope);
        Ok(Timeline { start, step, source, sigma_frames: Some(sigma) })
    };
    (0..cameras.len()).into_par_iter().map(timeline).collect()
}

/// The camera that the others are compared with: of the fastest ones that with the most exposures seen.
fn reference(cameras: &[Paced], steps: &[f64]) -> usize {
    let fastest = steps.iter().copied().fold(f64::INFINITY, f64::min);
    let seen = |c: usize| cameras[c].recording.images.len() - cameras[c].cadence.doubled();
    let fast = (0..cameras.len()).filter(|&c| steps[c] < 1.01 * fastest);
    fast.max_by(|&a, &b| seen(a).cmp(&seen(b)).then(b.cmp(&a))).unwrap_or(0)
}

/// Moves all clocks alike, so that the middle one of the mocap cameras is in step with what the take says.
pub(crate) fn settle(timelines: &mut [Timeline], cameras: &[Paced], take_rate: Rate) {
    let stated: Vec<Timeline> =
        cameras.iter().map(|camera| Timeline::stated(camera.recording, take_rate)).collect();
    let fastest = stated.iter().map(|line| line.step).fold(f64::INFINITY, f64::min);
    let fast: Vec<usize> = (0..cameras.len()).filter(|&c| stated[c].step < 1.01 * fastest).collect();
    let middle =
        |value: &dyn Fn(usize) -> f64| lower_median(&fast.iter().map(|&c| value(c)).collect::<Vec<_>>());
    let slowness = middle(&|c| timelines[c].step / stated[c].step);
    timelines.iter_mut().for_each(|line| {
        line.step /= slowness;
        line.start /= slowness;
    });
    let late = middle(&|c| timelines[c].start - stated[c].start);
    timelines.iter_mut().for_each(|line| line.start -= late);
}

impl Pair<'_> {
    /// Lag of the camera's exposures over stated time, a line over the exposures (mocap frames), and its standard
    /// deviation; or the best correlation, where it is not enough.
    fn line(&self, center: f64, radius: f64, params: &Params) -> Result<(Line, f64), f64> {
        let first = self.search(center, radius)?;
        let count = (self.camera.len() / WINDOW_EXPOSURES).max(1);
        let window =
            |w: usize| (w * self.camera.len() / count) as i64..((w + 1) * self.camera.len() / count) as i64;
        let start = (0..count).find(|&w| window(w).contains(&(first.middle as i64))).unwrap_or(0);
        let mut lags: Vec<Option<WindowLag>> = vec![None; count];
        // Outwards from where the lag is known, each window near its neighbour's lag.
        let mut known = first.lag;
        for w in start..count {
            lags[w] = self.window_lag(window(w), known);
            known = lags[w].map_or(known, |lag| lag.lag);
        }
        known = lags[start].map_or(first.lag, |lag| lag.lag);
        for w in (0..start).rev() {
            lags[w] = self.window_lag(window(w), known);
            known = lags[w].map_or(known, |lag| lag.lag);
        }
        let mut lags: Vec<WindowLag> = lags.into_iter().flatten().collect();
        if lags.is_empty() {
            lags.push(first);
        }
        let points: Vec<(f64, f64)> = lags.iter().map(|lag| (lag.middle, lag.lag)).collect();
        let weights: Vec<f64> = lags.iter().map(|lag| lag.weight).collect();
        let prior = (0.0, params.drift_prior_ppm * 1e-6 * self.step);
        let line = Line::fit(&points, &weights, Some(prior)).ok_or(0.0)?;
        Ok((line, weights.iter().sum::<f64>().sqrt().recip()))
    }

    /// An exposure near which images were lost that the cadence does not know of: a window whose changes are much likelier
    /// whole frames beside the line than on it.
    fn find_break(&self, line: &Line) -> Option<i64> {
        let length = self.camera.len();
        let count = (length / WINDOW_EXPOSURES).max((length / BREAK_EXPOSURES).min(6)).max(1);
        let reach = ((BREAK_SHARE * length as f64) as i64).clamp(3, 30);
        (0..count).into_par_iter().find_map_first(|w| {
            let window = (w * length / count) as i64..((w + 1) * length / count) as i64;
            let nats = |beside: i64| {
                self.likeness(window.clone(), &|n| line.at(n as f64) + beside as f64 * self.step).nats
            };
            let on_line = nats(0);
            let beside = (-reach..=reach).map(nats).fold(0.0, f64::max);
            (beside > on_line + LEAST_NATS).then_some(window.start)
        })
    }

    /// The lag where the camera moves most, by whole frames within the radius, then finely.
    fn search(&self, center: f64, radius: f64) -> Result<WindowLag, f64> {
        let window = self.liveliest();
        let reach = (radius / self.reference_step).ceil() as i64;
        let lag = |shift: i64| center + shift as f64 * self.reference_step;
        let found: Vec<Likeness> = (-reach..=reach)
            .into_par_iter()
            .map(|shift| self.likeness(window.clone(), &|_| lag(shift)))
            .collect();
        let usual = median(&found.iter().map(|likeness| likeness.nats).collect::<Vec<_>>());
        let best = (0..found.len()).max_by(|&a, &b| found[a].nats.total_cmp(&found[b].nats)).unwrap_or(0);
        let is_clear = found.len() < 5 || found[best].nats > usual + LEAST_NATS;
        if !is_clear || found[best].count < LEAST_PAIRS {
            return Err(found[best].correlation);
        }
        self.window_lag(window, lag(best as i64 - reach)).ok_or(found[best].correlation)
    }

    /// The exposures around the most motion.
    fn liveliest(&self) -> std::ops::Range<i64> {
        let length = SEARCH_EXPOSURES.min(self.camera.len());
        let energy: Vec<f64> = (0..self.camera.len() as i64)
            .map(|n| self.change(n).map_or(0.0, |change| change.iter().map(|x| x * x).sum()))
            .collect();
        let total = |from: usize| energy[from..from + length].iter().sum::<f64>();
        let starts = (0..=self.camera.len() - length).step_by((length / 2).max(1));
        let from = starts.max_by(|&a, &b| total(a).total_cmp(&total(b))).unwrap_or(0) as i64;
        from..from + length as i64
    }

    /// The camera's change up to an exposure.
    fn change(&self, exposure: i64) -> Option<Point> {
        let (a, b) = (self.camera.point(exposure - self.span)?, self.camera.point(exposure)?);
        Some(std::array::from_fn(|i| b[i] - a[i]))
    }

    /// How much the camera's changes have in common with the reference's at a lag (mocap frames, by exposure).
    fn likeness(&self, window: std::ops::Range<i64>, lag: &dyn Fn(i64) -> f64) -> Likeness {
        let mut pairs = Pairs::new();
        for exposure in window {
            let at = |exposure: i64| {
                self.reference.at((exposure as f64 * self.step + lag(exposure)) / self.reference_step)
            };
            if let (Some(x), Some(a), Some(b)) =
                (self.change(exposure), at(exposure - self.span), at(exposure))
            {
                let y: [f64; COMPONENTS] = std::array::from_fn(|i| b[i] - a[i]);
                pairs.add(&x, &y);
            }
        }
        pairs.likeness()
    }

    /// The lag of a window near an expected one: the vertex of the parabola through the likeliest of a grid and its
    /// neighbours. None where the window tells nothing, or the likeliest is at the grid's end.
    fn window_lag(&self, window: std::ops::Range<i64>, expected: f64) -> Option<WindowLag> {
        let steps = (REACH.max(self.reference_step) / FINE).round() as i64;
        let lag = |step: i64| expected + step as f64 * FINE;
        let found: Vec<Likeness> =
            (-steps..=steps).map(|step| self.likeness(window.clone(), &|_| lag(step))).collect();
        let best = (0..found.len()).max_by(|&a, &b| found[a].nats.total_cmp(&found[b].nats))?;
        if found[best].count < LEAST_PAIRS || best == 0 || best + 1 == found.len() {
            return None;
        }
        let [before, at, after] = [best - 1, best, best + 1].map(|i| found[i].nats);
        let bend = 2.0 * at - before - after;
        if bend.is_nan() || bend <= 0.0 {
            return None;
        }
        let vertex = 0.5 * (after - before) / bend;
        Some(WindowLag {
            middle: 0.5 * (window.start + window.end - 1) as f64,
            lag: lag(best as i64 - steps) + vertex * FINE,
            weight: CURVATURE_SHARE * bend / FINE.powi(2),
        })
    }
}
