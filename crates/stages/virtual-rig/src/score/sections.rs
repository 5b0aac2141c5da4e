//! `sections` against the true cross-sections.

use super::polyline::{self, Foot};
use super::same::{CommonFrames, check_take};
use super::spread::Pool;
use super::wrinkles_2d::{CREASE_RATIO, TrueSections, check_rates, check_strings};
use super::{Metric, ScoreError};
use artifact::{Section, SectionState, SectionsFrame};
use nalgebra::Vector2;
use serde_json::{Map, Value};

/// Errors are pooled over true sections at least so wide, px …
pub const MIN_WIDTH_PX: f64 = 3.5;
/// … and of such depths over widths.
pub const RATIOS: std::ops::RangeInclusive<f64> = 0.15..=0.8;
/// A wrinkle is shallow where the median d/w of its sections is in this range: about 0.1.
pub const SHALLOW: std::ops::RangeInclusive<f64> = 0.075..=0.125;

/// Scores cross-sections.
///
/// Every true section with w ≥ 3.5 px and 0.15 ≤ d/w ≤ 0.8 is compared with what the result has beside it, interpolated along its
/// creases: `ratio_rel`, `width_rel`, `depth_rel` are medians of the relative errors of d/w, w and d, `…_p90` their 90 %.
/// `rim_depth_rel` compares depths from the bottom to the rim at the *true* ±w, since a profile's zero crossing hangs on a
/// baseline that shading does not see. `crease_px`, `crease_p90_px`: distance of true places with d/w ≥ 0.3 to the result's
/// creases. `coverage`: share of these sections that have a result beside them (failed ones are none).
///
/// `flat_rejected`: share of the flat wrinkle images (all true d = 0) in which every section of the result has d = 0
/// exactly. `shallow_kept`: share of those with a median d/w of about 0.1 in which at least half of the sections have d > 0. A wrinkle
/// image is one wrinkle in one camera and frame; one that the result lacks counts against both.
///
/// # Errors
/// A result of another take, with unknown cameras or wrinkles, or without a common frame.
pub fn sections(truth: TrueSections, result: TrueSections) -> Result<Vec<Metric>, ScoreError> {
    check_take(truth.0.take.as_ref(), result.0.take.as_ref())?;
    check_rates(truth.0.rate, result.0.rate)?;
    check_strings("camera", &truth.0.cameras, result.0.cameras.iter())?;
    let wrinkles: Vec<String> = truth.0.wrinkles.iter().map(|wrinkle| wrinkle.id.clone()).collect();
    check_strings("wrinkle", &wrinkles, result.0.wrinkles.iter().map(|wrinkle| &wrinkle.id))?;
    let numbers = |frames: &[SectionsFrame]| frames.iter().map(|frame| frame.frame).collect::<Vec<_>>();
    let frames = CommonFrames::of(&numbers(truth.1), &numbers(result.1))?;
    let mut tally = Tally::default();
    let mut places: Vec<(usize, Option<usize>)> =
        frames.pairs.iter().map(|&(at, other)| (at, Some(other))).collect();
    places.extend(frames.missing.iter().map(|&at| (at, None)));
    for (at, other) in places {
        tally.add_frame(&truth.1[at], other.map(|other| &result.1[other]));
    }
    Ok(tally.metrics(&frames.context()))
}

#[derive(Debug, Default)]
struct Tally {
    ratio: Pool,
    width: Pool,
    depth: Pool,
    rim_depth: Pool,
    crease: Pool,
    /// Sections that count, and those that have a result beside them.
    wanted: usize,
    beside: usize,
    flat: [usize; 2],
    shallow: [usize; 2],
    missing: usize,
    extra: usize,
}

impl Tally {
    fn add_frame(&mut self, truth: &SectionsFrame, result: Option<&SectionsFrame>) {
        for (camera, wrinkles) in &truth.sections {
            for (id, sections) in wrinkles.iter().filter(|(_, sections)| !sections.is_empty()) {
                let found = result.and_then(|result| result.sections.get(camera)?.get(id));
                self.missing += usize::from(found.is_none());
                self.add_wrinkle(sections, found.map_or(&[], Vec::as_slice));
            }
        }
        for (camera, wrinkles) in result.iter().flat_map(|result| &result.sections) {
            let known = |id: &String| truth.sections.get(camera).is_some_and(|truth| truth.contains_key(id));
            self.extra += wrinkles.keys().filter(|id| !known(id)).count();
        }
    }

    fn add_wrinkle(&mut self, truth: &[Section], result: &[Section]) {
        self.add_gate(truth, result);
        let result: Vec<Section> =
            result.iter().filter(|section| section.state != SectionState::Failed).copied().collect();
        let creases: Vec<Vector2<f64>> = result.iter().map(|section| section.at.into()).collect();
        for section in truth.iter().filter(|section| section.d_px > 0.0 && section.w_px > 0.0) {
            let foot = polyline::nearest(&creases, &section.at.into()).filter(|foot| !foot.beyond);
            let ratio = section.d_px / section.w_px;
            if let Some(foot) = foot.filter(|_| ratio >= CREASE_RATIO) {
                self.crease.add(foot.distance);
            }
            if section.w_px >= MIN_WIDTH_PX && RATIOS.contains(&ratio) {
                self.wanted += 1;
                if let Some(foot) = foot {
                    self.beside += 1;
                    self.add_section(section, &between(&result, &foot));
                }
            }
        }
    }

    fn add_section(&mut self, truth: &Section, result: &Section) {
        let relative = |truth: f64, result: f64| ((result - truth) / truth).abs();
        let ratio = |section: &Section| if section.w_px > 0.0 { section.d_px / section.w_px } else { 0.0 };
        self.ratio.add(relative(ratio(truth), ratio(result)));
        self.depth.add(relative(truth.d_px, result.d_px));
        self.rim_depth.add(relative(rim_depth(truth, truth.w_px), rim_depth(result, truth.w_px)));
        // A flat section says nothing of its width.
        if result.d_px > 0.0 {
            self.width.add(relative(truth.w_px, result.w_px));
        }
    }

    fn add_gate(&mut self, truth: &[Section], result: &[Section]) {
        let deep = |section: &&Section| section.d_px > 0.0;
        let mut ratios = Pool::default();
        // Wrinkles run out flat at their ends: the median over all of the length says how deep they are.
        let ratio = |section: &Section| if section.d_px > 0.0 { section.d_px / section.w_px } else { 0.0 };
        truth.iter().for_each(|section| ratios.add(ratio(section)));
        if truth.iter().all(|section| section.d_px == 0.0) {
            let rejected = !result.is_empty() && result.iter().all(|section| section.d_px == 0.0);
            self.flat[0] += usize::from(rejected);
            self.flat[1] += 1;
        } else if ratios.median("").is_ok_and(|median| SHALLOW.contains(&median)) {
            let kept = !result.is_empty() && 2 * result.iter().filter(deep).count() >= result.len();
            self.shallow[0] += usize::from(kept);
            self.shallow[1] += 1;
        }
    }

    fn metrics(&self, context: &Map<String, Value>) -> Vec<Metric> {
        use super::metric::share_of;
        let nothing =
            "no section of the result lies beside a true one with w of 3.5 px or more and d/w of 0.15 to 0.8";
        let no_crease = "no section of the result lies beside a true one with d/w of 0.3 or more";
        let relative =
            |name, errors: &Pool, share| Metric::error(name, "ratio", errors.percentile(share, nothing));
        let metrics = vec![
            relative("ratio_rel", &self.ratio, 0.5),
            relative("ratio_p90", &self.ratio, 0.9),
            relative("width_rel", &self.width, 0.5),
            relative("width_p90", &self.width, 0.9),
            relative("depth_rel", &self.depth, 0.5),
            relative("depth_p90", &self.depth, 0.9),
            relative("rim_depth_rel", &self.rim_depth, 0.5),
            relative("rim_depth_p90", &self.rim_depth, 0.9),
            Metric::error("crease_px", "px", self.crease.median(no_crease)),
            Metric::error("crease_p90_px", "px", self.crease.percentile(0.9, no_crease)),
            Metric::share("coverage", share_of(self.beside, self.wanted, "the truth has no such section")),
            Metric::share(
                "flat_rejected",
                share_of(self.flat[0], self.flat[1], "the truth has no flat wrinkle"),
            ),
            Metric::share(
                "shallow_kept",
                share_of(
                    self.shallow[0],
                    self.shallow[1],
                    "the truth has no wrinkle with a d/w of about 0.1",
                ),
            ),
            Metric::count("missing", self.missing),
        ];
        let counts = [
            ("sections", self.wanted),
            ("compared", self.beside),
            ("flat_wrinkles", self.flat[1]),
            ("shallow_wrinkles", self.shallow[1]),
            ("without_truth", self.extra),
        ];
        let with_counts =
            |metric: Metric| counts.iter().fold(metric, |metric, &(key, count)| metric.with(key, count));
        metrics.into_iter().map(|metric| with_counts(metric.with_all(context))).collect()
    }
}

/// The section between two of the result's, at the foot of a true one.
fn between(sections: &[Section], foot: &Foot) -> Section {
    let value = |field: fn(&Section) -> f64| foot.value(|at| field(&sections[at]));
    Section {
        w_px: value(|section| section.w_px),
        d_px: value(|section| section.d_px),
        epsilon: value(|section| section.epsilon),
        kappa: value(|section| section.kappa),
        ..sections[foot.segment]
    }
}

/// How far the bottom lies below the mean of the profile's heights at ±`rim`.
fn rim_depth(section: &Section, rim: f64) -> f64 {
    let height = |p: f64| section.shape().at(p).0;
    0.5 * (height(rim) + height(-rim)) - height(0.0)
}
