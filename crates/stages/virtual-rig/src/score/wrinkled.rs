//! `wrinkled` against the true surface with its wrinkles.

use super::bulge;
use super::high_pass::HighPass;
use super::region::{distance_in_widths, foot};
use super::same::{check_equal, check_take};
use super::spread::{Histogram, Pool};
use super::surface::{add_distances, check_mesh, check_sequence, distance_metrics};
use super::valleys::ValleyCurves;
use super::{Metric, ScoreError};
use artifact::{LargeScale, ValleyPoint, ValleysFrame};
use nalgebra::{Point3, Vector3};

/// What holds for all frames of a comparison.
#[derive(Debug, Clone, Copy)]
pub struct WrinkledScene<'a> {
    /// Index of the true sequence.
    pub truth: &'a LargeScale,
    /// Index of the result.
    pub result: &'a LargeScale,
    /// The true valleys.
    pub valleys: ValleyCurves<'a>,
    /// The scan at rest, mm.
    pub rest: &'a [Point3<f64>],
    /// Its triangles, in the order that the valleys count them.
    pub triangles: &'a [[u32; 3]],
}

/// The surfaces of a frame, #V positions each, mm, in the scan's space.
#[derive(Debug, Clone)]
pub struct WrinkledFrame {
    /// The true surface with wrinkles.
    pub truth: Vec<Point3<f64>>,
    /// The true surface without.
    pub truth_large_scale: Vec<Point3<f64>>,
    /// The result.
    pub result: Vec<Point3<f64>>,
    /// The surface that the result was made from, where it is known.
    pub result_large_scale: Option<Vec<Point3<f64>>>,
}

/// Cut-off of the high-pass, mm.
pub const CUTOFF_MM: f64 = 10.0;
/// A wrinkle's region reaches so many widths w from its valley: at 3 w the profile has fallen to a tenth of its depth.
pub const REGION_WIDTHS: f64 = 3.0;
/// Beyond so many widths from every valley no wrinkle may move anything: there the profile is 1 % of its depth.
pub const OUTSIDE_WIDTHS: f64 = 7.0;

/// Scores wrinkles on a surface.
///
/// - `mean_mm`, `rms_mm`, `p95_mm`, `max_mm`: distance of all vertices.
/// - `region_rms_mm`: in the wrinkles' regions, the error along the normal of the true large-scale surface after a high-pass
///   (a Gaussian filter with a cut-off at waves of 10 mm), so that errors of the large-scale motion do not drown those of the wrinkles.
///   `region_error_ratio`: over the same error of the surface without wrinkles that the result was made from (of the true
///   one where that is not known). `region_raw_rms_mm`, `region_raw_ratio`: the same without projection and filter.
/// - `valley_depth_rel` (median), `valley_depth_p90`: the deepest vertex within w / 2 of a true valley point, below the true
///   large-scale surface along its normal, result against truth, over points with 0.15 ≤ d/w ≤ 0.8.
/// - `bulge_height_rel`: between neighbouring valleys (no farther apart than four times the sum of their widths), the highest
///   vertex beside the straight way from one to the other, above the true large-scale surface: relative error of the mean over all
///   ways whose bulge is above it in the truth.
/// - `outside_moved`: how far a vertex moved, mm, that is more than 7 w from every valley of the frame and that the truth leaves where it is.
/// - `missing` frames.
///
/// The region of a frame reaches 3 w from each valley that is open in it.
///
/// # Errors
/// A result of another take, mesh or rate, without a common frame, or of another vertex count; and whatever `frame` refuses.
pub fn wrinkled<E: From<ScoreError>>(
    scene: &WrinkledScene,
    mut frame: impl FnMut(i64) -> Result<WrinkledFrame, E>,
) -> Result<Vec<Metric>, E> {
    let frames = check_sequence(scene.truth, scene.result)?;
    check_take(scene.truth.take.as_ref(), scene.valleys.0.take.as_ref())?;
    check_mesh(&scene.truth.mesh, &scene.valleys.0.mesh)?;
    check_equal("vertices of the rest mesh", &scene.truth.mesh.vertex_count, &scene.rest.len())?;
    let filter = HighPass::of(scene.rest, scene.triangles, CUTOFF_MM);
    let mut tally = Tally::default();
    for &(at, _) in &frames.pairs {
        let number = scene.truth.frames[at];
        let surfaces = frame(number)?;
        surfaces.check(number)?;
        add_distances(&mut tally.distances, number, &surfaces.truth, &surfaces.result)?;
        let place = scene.valleys.1.binary_search_by_key(&number, |frame| frame.frame);
        match place {
            Ok(place) => tally.add(scene, &filter, &surfaces, &scene.valleys.1[place]),
            Err(_) => tally.without_valleys += 1,
        }
    }
    let context = frames.context();
    let metrics = tally.metrics().into_iter().chain([Metric::count("missing", frames.missing.len())]);
    Ok(metrics.map(|metric| metric.with_all(&context)).collect())
}

impl WrinkledFrame {
    fn check(&self, number: i64) -> Result<(), ScoreError> {
        let place = |what: &str| format!("frame {number}, vertices{what}");
        check_equal(
            &place(" of the true large-scale surface"),
            &self.truth.len(),
            &self.truth_large_scale.len(),
        )?;
        if let Some(surface) = &self.result_large_scale {
            check_equal(&place(" of the result's large-scale surface"), &self.truth.len(), &surface.len())?;
        }
        check_equal(&place(""), &self.truth.len(), &self.result.len())
    }
}

#[derive(Debug, Default)]
struct Tally {
    distances: Histogram,
    region: Histogram,
    region_flat: Histogram,
    raw: Histogram,
    raw_flat: Histogram,
    depth: Pool,
    /// Heights of bulges in truth and result, summed, and how many.
    bulges: [f64; 2],
    bulge_count: usize,
    outside: Histogram,
    without_valleys: usize,
    own_large_scale: usize,
}

impl Tally {
    fn add(
        &mut self,
        scene: &WrinkledScene,
        filter: &HighPass,
        frame: &WrinkledFrame,
        valleys: &ValleysFrame,
    ) {
        let large = &frame.truth_large_scale;
        let widths = distance_in_widths(large, scene.triangles, valleys, OUTSIDE_WIDTHS);
        let region: Vec<usize> =
            (0..widths.len()).filter(|&vertex| widths[vertex] <= REGION_WIDTHS).collect();
        let normals = mesh::vertex_normals(large, scene.triangles);
        let flat = frame.result_large_scale.as_ref().unwrap_or(large);
        for (surface, filtered, raw) in [
            (&frame.result, &mut self.region, &mut self.raw),
            (flat, &mut self.region_flat, &mut self.raw_flat),
        ] {
            let along: Vec<f64> = heights(&frame.truth, surface, &normals);
            filter.apply(&along, &region).iter().for_each(|error| filtered.add(error.abs()));
            region.iter().for_each(|&vertex| raw.add((surface[vertex] - frame.truth[vertex]).norm()));
        }
        let (truth, result) =
            (heights(large, &frame.truth, &normals), heights(large, &frame.result, &normals));
        self.add_depths(scene, large, [&truth, &result], valleys);
        let crossings = bulge::crossings(large, scene.triangles, valleys);
        for [truth, result] in bulge::heights(large, &crossings, [&truth, &result]) {
            if truth > 0.0 {
                self.bulges = [self.bulges[0] + truth, self.bulges[1] + result];
                self.bulge_count += 1;
            }
        }
        if let Some(own) = &frame.result_large_scale {
            self.own_large_scale += 1;
            for vertex in (0..widths.len()).filter(|&vertex| widths[vertex].is_infinite()) {
                if frame.truth[vertex] == large[vertex] {
                    self.outside.add((frame.result[vertex] - own[vertex]).norm());
                }
            }
        }
    }

    fn add_depths(
        &mut self,
        scene: &WrinkledScene,
        large: &[Point3<f64>],
        [truth, result]: [&[f64]; 2],
        valleys: &ValleysFrame,
    ) {
        let counts = |point: &&ValleyPoint| {
            point.d_mm > 0.0 && super::sections::RATIOS.contains(&(point.d_mm / point.w_mm))
        };
        let points: Vec<&ValleyPoint> = valleys.valleys.values().flatten().filter(counts).collect();
        let Some(widest) = points.iter().map(|point| point.w_mm).reduce(f64::max) else { return };
        let grid = super::grid::Grid::of(large, 0.5 * widest);
        for point in points {
            let Some(center) = foot(large, scene.triangles, point) else { continue };
            let (mut true_depth, mut depth) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
            grid.near(&center, 0.5 * point.w_mm, |vertex| {
                if (large[vertex] - center).norm() <= 0.5 * point.w_mm {
                    true_depth = true_depth.max(-truth[vertex]);
                    depth = depth.max(-result[vertex]);
                }
            });
            if true_depth > 0.0 {
                self.depth.add((depth / true_depth - 1.0).abs());
            }
        }
    }

    fn metrics(&self) -> Vec<Metric> {
        let no_region = "no frame has an open valley in the truth";
        let no_depth = "no true valley with d/w of 0.15 to 0.8 has vertices near it";
        let ratio = |error: &Histogram, flat: &Histogram| {
            let (error, flat) = (error.rms(no_region)?, flat.rms(no_region)?);
            match flat > 0.0 {
                true => Ok(error / flat),
                false => {
                    Err("the surface without wrinkles has no error in the wrinkles' regions".to_string())
                }
            }
        };
        let mut metrics = distance_metrics(&self.distances);
        metrics.extend([
            Metric::error("region_error_ratio", "ratio", ratio(&self.region, &self.region_flat)),
            Metric::error("region_rms_mm", "mm", self.region.rms(no_region)),
            Metric::error("region_raw_ratio", "ratio", ratio(&self.raw, &self.raw_flat)),
            Metric::error("region_raw_rms_mm", "mm", self.raw.rms(no_region)),
            Metric::error("valley_depth_rel", "ratio", self.depth.median(no_depth)),
            Metric::error("valley_depth_p90", "ratio", self.depth.percentile(0.9, no_depth)),
            Metric::error("bulge_height_rel", "ratio", self.bulge_error()),
            Metric::error("outside_moved", "mm", self.outside_moved())
                .with("outside_samples", self.outside.count),
        ]);
        let counts = [
            ("samples", self.distances.count),
            ("region_samples", self.region.count),
            ("depth_points", self.depth.len()),
            ("bulges", self.bulge_count),
            ("frames_without_valleys", self.without_valleys),
        ];
        let with_counts =
            |metric: Metric| counts.iter().fold(metric, |metric, &(key, count)| metric.with(key, count));
        metrics.into_iter().map(with_counts).collect()
    }

    fn bulge_error(&self) -> Result<f64, String> {
        match self.bulge_count {
            0 => Err("no two open valleys of the truth are neighbours with a bulge between them".to_string()),
            _ => Ok((self.bulges[1] / self.bulges[0] - 1.0).abs()),
        }
    }

    fn outside_moved(&self) -> Result<f64, String> {
        match self.own_large_scale {
            0 => Err("the large-scale sequence that the result was made from was not given".to_string()),
            _ => self.outside.max("every vertex lies near a valley"),
        }
    }
}

/// Per vertex how far `surface` lies above `base`, along the normals.
fn heights(base: &[Point3<f64>], surface: &[Point3<f64>], normals: &[Vector3<f64>]) -> Vec<f64> {
    (0..base.len()).map(|vertex| (surface[vertex] - base[vertex]).dot(&normals[vertex])).collect()
}
