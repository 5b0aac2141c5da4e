//! Clocks by what moves: the lag at which two cameras' changes have most in common.
//!
//! A scalar such as motion energy loses which way things move; with the main components of a coarse picture and canonical
//! correlation, which finds by itself what two views have in common, the lag comes out several times finer.

use crate::breaks::{Jump, Scores};
use crate::canonical::{Likeness, Pairs};
use crate::course::{Course, Point};
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
/// Share of a camera's exposures that may be lost at one place and still be noticed.
const BREAK_SHARE: f64 = 0.05;
/// How often gaps are left and all is looked at again.
const MOST_ROUNDS: usize = 20;
/// Places where the reference lost images, as two cameras tell them, are this near to each other, exposures.
const NEAR: i64 = 15;
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
/// is looked for (mocap frames, and how far around), the first camera's included. Where images were lost without a trace, the
/// cameras' cadence gets a gap, and all is looked at again.
pub(crate) fn timelines(
    cameras: &mut [Paced],
    guess: &[(f64, f64)],
    take_rate: Rate,
    params: &Params,
    source: SyncSource,
) -> Result<Vec<Timeline>, Error> {
    let steps: Vec<f64> = cameras.iter().map(|camera| stated_step(camera.recording, take_rate)).collect();
    let reference = reference(cameras, &steps);
    for _ in 0..MOST_ROUNDS {
        let found = compare(cameras, guess, &steps, reference, params)?;
        if !mend(cameras, &found, reference)? {
            let timeline = |c: usize| match &found[c] {
                None => Timeline { start: guess[c].0, step: steps[c], source, sigma_frames: None },
                Some(Compared { line, sigma, .. }) => Timeline {
                    start: guess[reference].0 + line.at_zero,
                    step: steps[c] + line.slope,
                    source,
                    sigma_frames: Some(*sigma),
                },
            };
            return Ok((0..cameras.len()).map(timeline).collect());
        }
    }
    Err(Error::Unsteady)
}

/// A camera compared with the reference.
struct Compared {
    /// Its lag over the exposures, mocap frames, and its standard deviation.
    line: Line,
    sigma: f64,
    jumps: Vec<Jump>,
    /// Mocap frames between its exposures, and between the reference's.
    step: f64,
    reference_step: f64,
}

impl Compared {
    /// The reference's exposure at the time of one of the camera's.
    fn of_reference(&self, exposure: i64) -> i64 {
        let exposure = exposure as f64;
        ((exposure * self.step + self.line.at(exposure)) / self.reference_step).round() as i64
    }
}

/// Compares all cameras with the reference; none for itself.
fn compare(
    cameras: &[Paced],
    guess: &[(f64, f64)],
    steps: &[f64],
    reference: usize,
    params: &Params,
) -> Result<Vec<Option<Compared>>, Error> {
    let courses: Vec<Course> = cameras.par_iter().map(Course::of).collect::<Result<_, _>>()?;
    let compared = |c: usize| {
        if c == reference {
            return Ok(None);
        }
        let pair = Pair {
            camera: &courses[c],
            reference: &courses[reference],
            step: steps[c],
            reference_step: steps[reference],
            span: (2.0 / steps[c]).ceil() as i64,
        };
        let (center, radius) = (guess[c].0 - guess[reference].0, guess[c].1);
        let (line, sigma) = pair.line(center, radius, params).map_err(|found| {
            let (camera, reference) = (cameras[c].id().to_string(), cameras[reference].id().to_string());
            match found.count < LEAST_PAIRS {
                true => Error::TooShort { camera, count: found.count, least: LEAST_PAIRS },
                false => Error::NoCorrelation {
                    camera,
                    reference,
                    count: found.count,
                    correlation: found.correlation,
                },
            }
        })?;
        let jumps = pair.jumps(&line);
        Ok(Some(Compared { line, sigma, jumps, step: steps[c], reference_step: steps[reference] }))
    };
    (0..cameras.len()).into_par_iter().map(compared).collect::<Vec<_>>().into_iter().collect()
}

/// Leaves gaps where images were lost: first of the reference, which all cameras of its rate tell alike, then of the others.
/// Whether there were any.
fn mend(cameras: &mut [Paced], found: &[Option<Compared>], reference: usize) -> Result<bool, Error> {
    let refuse = |c: usize, jump: &Jump, cameras: &[Paced]| Error::Break {
        camera: cameras[c].id().to_string(),
        reference: cameras[reference].id().to_string(),
        exposure: jump.exposure,
        is_stamped: cameras[c].is_stamped,
    };
    let of_reference = |compared: &Compared, jump: &Jump| {
        let at = |exposure: i64| compared.of_reference(exposure);
        (at(jump.exposure), at(*jump.places.start())..=at(*jump.places.end()))
    };
    let alike: Vec<usize> = (0..cameras.len())
        .filter(|&c| {
            found[c].as_ref().is_some_and(|found| (found.step / found.reference_step - 1.0).abs() < 0.01)
        })
        .collect();
    let falls = |c: usize| {
        let jumps =
            found[c].iter().flat_map(|compared| compared.jumps.iter().map(move |jump| (compared, jump)));
        jumps
            .filter(|(_, jump)| jump.exposures < 0)
            .map(|(compared, jump)| (of_reference(compared, jump), jump))
    };
    let all = alike.iter().flat_map(|&c| falls(c).map(move |fall| (c, fall)));
    // The sharpest of the places that they name.
    let sharpest = all.min_by_key(|(_, ((_, places), _))| places.end() - places.start());
    if let Some((c, ((exposure, places), jump))) = sharpest {
        let is_near = |other: i64| (places.start() - NEAR..=places.end() + NEAR).contains(&other);
        let votes = alike.iter().filter(|&&c| falls(c).any(|((other, _), _)| is_near(other))).count();
        if 2 * votes <= alike.len() || cameras[reference].is_stamped {
            // Only this camera falls back: it has images that are not of its clock.
            if jump.nats > LEAST_NATS {
                return Err(refuse(c, jump, cameras));
            }
        } else {
            cameras[reference].insert_gap(exposure, places, -jump.exposures);
            return Ok(true);
        }
    }
    let mut is_mended = false;
    for c in 0..cameras.len() {
        // From the last one on: the numbers of those before stay.
        let jumps = found[c].iter().flat_map(|compared| compared.jumps.iter().rev());
        for jump in jumps.filter(|jump| jump.exposures > 0) {
            match cameras[c].is_stamped {
                true if jump.nats > LEAST_NATS => return Err(refuse(c, jump, cameras)),
                true => {}
                false => {
                    cameras[c].insert_gap(jump.exposure, jump.places.clone(), jump.exposures);
                    is_mended = true;
                }
            }
        }
    }
    Ok(is_mended)
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
    fn line(&self, center: f64, radius: f64, params: &Params) -> Result<(Line, f64), Likeness> {
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
        let line = Line::fit(&points, &weights, Some(prior)).ok_or(Likeness::default())?;
        Ok((line, weights.iter().sum::<f64>().sqrt().recip()))
    }

    /// Where the lag jumps by whole exposures beside the line.
    fn jumps(&self, line: &Line) -> Vec<Jump> {
        let length = self.camera.len();
        let mut pairs = Pairs::new();
        let pair = |exposure: i64, beside: i64| {
            let lag = |exposure: i64| line.at(exposure as f64) + beside as f64 * self.step;
            self.changes(exposure, lag(exposure))
        };
        (0..length as i64).filter_map(|n| pair(n, 0)).for_each(|(x, y)| pairs.add(&x, &y));
        let reach = ((BREAK_SHARE * length as f64) as i64).clamp(3, 30);
        Scores::new(length, reach, &pairs.variates(), pair).jumps()
    }

    /// The changes of both cameras up to an exposure, at a lag, mocap frames.
    fn changes(&self, exposure: i64, lag: f64) -> Option<(Point, Point)> {
        let at = |exposure: i64| self.reference.at((exposure as f64 * self.step + lag) / self.reference_step);
        let (x, a, b) = (self.change(exposure)?, at(exposure - self.span)?, at(exposure)?);
        Some((x, std::array::from_fn(|i| b[i] - a[i])))
    }

    /// The lag where the camera moves most, by whole frames within the radius, then finely.
    fn search(&self, center: f64, radius: f64) -> Result<WindowLag, Likeness> {
        let window = self.liveliest();
        // Further apart than both last, they have nothing in common.
        let lasts = |course: &Course, step: f64| course.len() as f64 * step;
        let both = lasts(self.camera, self.step) + lasts(self.reference, self.reference_step) + center.abs();
        let reach = (radius.min(both) / self.reference_step).ceil() as i64;
        let lag = |shift: i64| center + shift as f64 * self.reference_step;
        let found: Vec<Likeness> = (-reach..=reach)
            .into_par_iter()
            .map(|shift| self.likeness(window.clone(), &|_| lag(shift)))
            .collect();
        let usual = median(&found.iter().map(|likeness| likeness.nats).collect::<Vec<_>>());
        let best = (0..found.len()).max_by(|&a, &b| found[a].nats.total_cmp(&found[b].nats)).unwrap_or(0);
        let is_clear = found.len() < 5 || found[best].nats > usual + LEAST_NATS;
        if !is_clear || found[best].count < LEAST_PAIRS {
            return Err(found[best]);
        }
        self.window_lag(window, lag(best as i64 - reach)).ok_or(found[best])
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
        let changes = window.filter_map(|exposure| self.changes(exposure, lag(exposure)));
        changes.for_each(|(x, y)| pairs.add(&x, &y));
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
