//! `wrinkles-2d` against the projected true valleys.

use super::polyline;
use super::same::{CommonFrames, check_equal, check_ids, check_take};
use super::spread::Pool;
use super::{Metric, ScoreError};
use artifact::{
    Curve2d, CurveState, Section, SectionsFrame, SectionsHeader, Wrinkles2dFrame, Wrinkles2dHeader,
};
use nalgebra::Vector2;
use serde_json::{Map, Value};

/// True cross-sections in the images: header and frames. They stand densely along every visible valley, `at` where its
/// bottom is seen.
pub type TrueSections<'a> = (&'a SectionsHeader, &'a [SectionsFrame]);

/// Wrinkle curves: header and frames.
pub type Curves<'a> = (&'a Wrinkles2dHeader, &'a [Wrinkles2dFrame]);

/// A curve carries a wrong id where it lies nearer to another valley than to its own by more than this, px.
pub const ID_GATE_PX: f64 = 1.0;

/// Valleys shallower than this (d/w) do not count for `curve_px`: their bottom cannot be told from the middle of the paint.
pub const CREASE_RATIO: f64 = 0.3;

/// Scores valley curves: `curve_px` (median), `curve_p90_px`: distance from places of the true valley with d/w ≥ 0.3 to the
/// curve of the same id; `coverage`: share of the true valleys' places that have a curve beside them; `id_errors`;
/// `missing` curves; `false_curves` where the camera sees no such wrinkle.
///
/// Curves that are only held from frames before count as missing.
///
/// # Errors
/// A result of another take, with unknown cameras or wrinkles, or without a common frame.
pub fn wrinkles_2d(truth: TrueSections, result: Curves) -> Result<Vec<Metric>, ScoreError> {
    check_take(truth.0.take.as_ref(), result.0.take.as_ref())?;
    check_rates(truth.0.rate, result.0.rate)?;
    check_strings("camera", &truth.0.cameras, result.0.cameras.iter())?;
    let wrinkles: Vec<String> = truth.0.wrinkles.iter().map(|wrinkle| wrinkle.id.clone()).collect();
    check_strings("wrinkle", &wrinkles, result.0.wrinkles.iter().map(|wrinkle| &wrinkle.id))?;
    let true_numbers: Vec<i64> = truth.1.iter().map(|frame| frame.frame).collect();
    let numbers: Vec<i64> = result.1.iter().map(|frame| frame.frame).collect();
    let frames = CommonFrames::of(&true_numbers, &numbers)?;
    let mut tally = Tally::default();
    for &(at, other) in &frames.pairs {
        tally.add_frame(&truth.1[at], &result.1[other]);
    }
    for &at in &frames.missing {
        let empty = Wrinkles2dFrame { frame: truth.1[at].frame, curves: artifact::PerCamera::new() };
        tally.add_frame(&truth.1[at], &empty);
    }
    Ok(tally.metrics(&frames.context()))
}

pub(super) fn check_rates(
    truth: Option<artifact::Rate>,
    result: Option<artifact::Rate>,
) -> Result<(), ScoreError> {
    match (truth, result) {
        (Some(truth), Some(result)) => check_equal("rate", &truth, &result),
        _ => Ok(()),
    }
}

pub(super) fn check_strings<'a>(
    thing: &'static str,
    truth: &'a [String],
    result: impl Iterator<Item = &'a String>,
) -> Result<(), ScoreError> {
    let known: Vec<&str> = truth.iter().map(String::as_str).collect();
    check_ids(thing, &known, result.map(String::as_str))
}

#[derive(Debug, Default)]
struct Tally {
    distances: Pool,
    places: usize,
    beside: usize,
    curves: usize,
    id_errors: usize,
    missing: usize,
    held: usize,
    false_curves: usize,
}

impl Tally {
    fn add_frame(&mut self, truth: &SectionsFrame, result: &Wrinkles2dFrame) {
        for (camera, valleys) in &truth.sections {
            let curves = result.curves.get(camera);
            for (id, sections) in valleys.iter().filter(|(_, sections)| !sections.is_empty()) {
                self.places += sections.len();
                match curves.and_then(|curves| curves.get(id)) {
                    None => self.missing += 1,
                    Some(curve) if curve.state == CurveState::Held => {
                        self.missing += 1;
                        self.held += 1;
                    }
                    Some(curve) => self.add_curve(id, curve, sections, valleys),
                }
            }
        }
        for (camera, curves) in &result.curves {
            let seen = |id: &String| {
                truth
                    .sections
                    .get(camera)
                    .and_then(|valleys| valleys.get(id))
                    .is_some_and(|valley| !valley.is_empty())
            };
            let found = curves.iter().filter(|(_, curve)| curve.state != CurveState::Held);
            self.false_curves += found.filter(|(id, _)| !seen(id)).count();
        }
    }

    fn add_curve(
        &mut self,
        id: &String,
        curve: &Curve2d,
        sections: &[Section],
        valleys: &std::collections::BTreeMap<String, Vec<Section>>,
    ) {
        self.curves += 1;
        let samples = sampled(curve);
        for section in sections {
            let Some(foot) = polyline::nearest(&samples, &Vector2::from(section.at)) else { continue };
            if foot.beyond {
                continue;
            }
            self.beside += 1;
            if section.d_px >= CREASE_RATIO * section.w_px && section.d_px > 0.0 {
                self.distances.add(distance(curve, &samples, &foot, section));
            }
        }
        let apart = |sections: &[Section]| {
            let valley: Vec<Vector2<f64>> = sections.iter().map(|section| section.at.into()).collect();
            let mut pool = Pool::default();
            let feet =
                samples.iter().step_by(SAMPLES / 4).filter_map(|sample| polyline::nearest(&valley, sample));
            feet.for_each(|foot| pool.add(foot.distance));
            pool.median("").unwrap_or(f64::INFINITY)
        };
        let others = valleys.iter().filter(|(other, sections)| *other != id && !sections.is_empty());
        let nearest = others.map(|(_, sections)| apart(sections)).fold(f64::INFINITY, f64::min);
        self.id_errors += usize::from(apart(sections) - nearest > ID_GATE_PX);
    }

    fn metrics(&self, context: &Map<String, Value>) -> Vec<Metric> {
        let nothing = "no curve lies beside a true valley with d/w of 0.3 or more";
        let counts = [
            ("curves", self.curves),
            ("held", self.held),
            ("places", self.places),
            ("crease_places", self.distances.len()),
        ];
        let metrics = vec![
            Metric::error("curve_px", "px", self.distances.median(nothing)),
            Metric::error("curve_p90_px", "px", self.distances.percentile(0.9, nothing)),
            Metric::share(
                "coverage",
                super::metric::share_of(self.beside, self.places, "the truth has no visible valley"),
            ),
            Metric::count("id_errors", self.id_errors),
            Metric::count("missing", self.missing),
            Metric::count("false_curves", self.false_curves),
        ];
        let with_counts =
            |metric: Metric| counts.iter().fold(metric, |metric, &(key, count)| metric.with(key, count));
        metrics.into_iter().map(|metric| with_counts(metric.with_all(context))).collect()
    }
}

/// Samples per span of a curve.
const SAMPLES: usize = 32;

fn sampled(curve: &Curve2d) -> Vec<Vector2<f64>> {
    let spans = curve.controls.len().saturating_sub(3);
    (0..=spans * SAMPLES).map(|i| point(curve, i as f64 / SAMPLES as f64)).collect()
}

/// The point of a uniform cubic B-spline at its parameter (the form of [`Curve2d`]).
fn point(curve: &Curve2d, u: f64) -> Vector2<f64> {
    let spans = curve.controls.len() - 3;
    let span = (u.max(0.0) as usize).min(spans - 1);
    let v = u - span as f64;
    let shares = [
        (1.0 - v).powi(3),
        3.0 * v.powi(3) - 6.0 * v * v + 4.0,
        -3.0 * v.powi(3) + 3.0 * v * v + 3.0 * v + 1.0,
        v.powi(3),
    ];
    let sum = |axis: usize| (0..4).map(|i| shares[i] * curve.controls[span + i][axis]).sum::<f64>() / 6.0;
    Vector2::new(sum(0), sum(1))
}

/// Halvings of the bracket around the nearest sample: 2⁻⁵⁰ of a span is below rounding.
const HALVINGS: usize = 50;

/// The distance from a true place to the curve itself: a chord of its samples cuts corners. Ternary search on the spline around the
/// nearest sample; a sample that lies on the place counts as it is.
fn distance(curve: &Curve2d, samples: &[Vector2<f64>], foot: &polyline::Foot, section: &Section) -> f64 {
    let place = Vector2::from(section.at);
    let to = |u: f64| (point(curve, u) - place).norm();
    let last = (samples.len() - 1) as f64;
    let middle = foot.segment as f64 + foot.share;
    let (mut low, mut high) =
        ((middle - 1.0).max(0.0) / SAMPLES as f64, (middle + 1.0).min(last) / SAMPLES as f64);
    for _ in 0..HALVINGS {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if to(a) < to(b) { high = b } else { low = a }
    }
    let on_sample = samples[foot.segment..].iter().take(2).map(|sample| (sample - place).norm());
    on_sample.fold(to(0.5 * (low + high)), f64::min)
}
