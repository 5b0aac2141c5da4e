//! `valleys` against the true valley curves on the mesh.

use super::polyline;
use super::same::{CommonFrames, check_equal, check_take};
use super::spread::Pool;
use super::wrinkles_2d::{check_rates, check_strings};
use super::{Metric, ScoreError};
use artifact::{ValleyPoint, ValleysFrame, ValleysHeader};
use nalgebra::Vector3;
use serde_json::{Map, Value};

/// Valleys: header and frames.
pub type ValleyCurves<'a> = (&'a ValleysHeader, &'a [ValleysFrame]);

/// Scores valley curves in 3D: `position_mm` (median), `position_p90_mm`: distance of the true bottoms to the curve of the same
/// id; `depth_rel`, `width_rel` (medians over true points with 0.15 ≤ d/w ≤ 0.8) and their `_p90`; `coverage`: share of the
/// true points with d > 0 that have a curve beside them; `missing` valleys; `false_valleys` where there is none.
///
/// # Errors
/// A result of another take or mesh, with unknown wrinkles, or without a common frame.
pub fn valleys(truth: ValleyCurves, result: ValleyCurves) -> Result<Vec<Metric>, ScoreError> {
    check_take(truth.0.take.as_ref(), result.0.take.as_ref())?;
    check_rates(truth.0.rate, result.0.rate)?;
    super::surface::check_mesh(&truth.0.mesh, &result.0.mesh)?;
    check_equal("space", &format!("{:?}", truth.0.space), &format!("{:?}", result.0.space))?;
    let wrinkles: Vec<String> = truth.0.wrinkles.iter().map(|wrinkle| wrinkle.id.clone()).collect();
    check_strings("wrinkle", &wrinkles, result.0.wrinkles.iter().map(|wrinkle| &wrinkle.id))?;
    let numbers = |frames: &[ValleysFrame]| frames.iter().map(|frame| frame.frame).collect::<Vec<_>>();
    let frames = CommonFrames::of(&numbers(truth.1), &numbers(result.1))?;
    let mut tally = Tally::default();
    for &(at, other) in &frames.pairs {
        tally.add_frame(&truth.1[at], Some(&result.1[other]));
    }
    for &at in &frames.missing {
        tally.add_frame(&truth.1[at], None);
    }
    Ok(tally.metrics(&frames.context()))
}

#[derive(Debug, Default)]
struct Tally {
    position: Pool,
    depth: Pool,
    width: Pool,
    points: usize,
    beside: usize,
    missing: usize,
    false_valleys: usize,
}

impl Tally {
    fn add_frame(&mut self, truth: &ValleysFrame, result: Option<&ValleysFrame>) {
        let open = |points: &Vec<ValleyPoint>| points.iter().any(|point| point.d_mm > 0.0);
        for (id, points) in truth.valleys.iter().filter(|(_, points)| open(points)) {
            let found = result.and_then(|result| result.valleys.get(id));
            self.missing += usize::from(found.is_none());
            self.add_valley(points, found.map_or(&[], Vec::as_slice));
        }
        let found = result.iter().flat_map(|result| &result.valleys).filter(|(_, points)| open(points));
        self.false_valleys += found.filter(|(id, _)| !truth.valleys.get(*id).is_some_and(open)).count();
    }

    fn add_valley(&mut self, truth: &[ValleyPoint], result: &[ValleyPoint]) {
        let line: Vec<Vector3<f64>> = result.iter().map(|point| point.at_mm.into()).collect();
        for point in truth.iter().filter(|point| point.d_mm > 0.0) {
            self.points += 1;
            let foot = polyline::nearest(&line, &point.at_mm.into()).filter(|foot| !foot.beyond);
            let Some(foot) = foot else { continue };
            self.beside += 1;
            self.position.add(foot.distance);
            if super::sections::RATIOS.contains(&(point.d_mm / point.w_mm)) {
                self.depth.add((foot.value(|at| result[at].d_mm) / point.d_mm - 1.0).abs());
                self.width.add((foot.value(|at| result[at].w_mm) / point.w_mm - 1.0).abs());
            }
        }
    }

    fn metrics(&self, context: &Map<String, Value>) -> Vec<Metric> {
        let nothing = "no valley of the result lies beside a true one";
        let relative =
            |name, errors: &Pool, share| Metric::error(name, "ratio", errors.percentile(share, nothing));
        let metrics = vec![
            Metric::error("position_mm", "mm", self.position.median(nothing)),
            Metric::error("position_p90_mm", "mm", self.position.percentile(0.9, nothing)),
            relative("depth_rel", &self.depth, 0.5),
            relative("depth_p90", &self.depth, 0.9),
            relative("width_rel", &self.width, 0.5),
            relative("width_p90", &self.width, 0.9),
            Metric::share(
                "coverage",
                super::metric::share_of(self.beside, self.points, "the truth has no valley"),
            ),
            Metric::count("missing", self.missing),
            Metric::count("false_valleys", self.false_valleys),
        ];
        let with_counts = |metric: Metric| metric.with("points", self.points).with("compared", self.beside);
        metrics.into_iter().map(|metric| with_counts(metric.with_all(context))).collect()
    }
}
