//! `large-scale` against the true surface without wrinkles.

use super::same::{CommonFrames, check_equal, check_take};
use super::spread::Histogram;
use super::{Metric, ScoreError};
use artifact::{LargeScale, MeshRef};
use nalgebra::Point3;

/// Scores an animated surface vertex by vertex: `mean_mm`, `rms_mm`, `p95_mm`, `max_mm` of the distances, `missing` frames.
///
/// `positions` gives, for a frame that both have, the vertices of truth and result, mm; frames are asked for in rising order.
/// Percentiles are within 0.05 %.
///
/// # Errors
/// A result of another take, mesh or rate, without a common frame, or of another vertex count; and whatever `positions` refuses.
pub fn large_scale<E: From<ScoreError>>(
    truth: &LargeScale,
    result: &LargeScale,
    mut positions: impl FnMut(i64) -> Result<(Vec<Point3<f64>>, Vec<Point3<f64>>), E>,
) -> Result<Vec<Metric>, E> {
    let frames = check_sequence(truth, result)?;
    let mut distances = Histogram::default();
    for &(at, _) in &frames.pairs {
        let (from, to) = positions(truth.frames[at])?;
        add_distances(&mut distances, truth.frames[at], &from, &to)?;
    }
    let metrics = distance_metrics(&distances);
    let context = frames.context();
    Ok(metrics
        .into_iter()
        .chain([Metric::count("missing", frames.missing.len())])
        .map(|metric| metric.with_all(&context).with("vertices", truth.mesh.vertex_count))
        .collect())
}

pub(super) fn distance_metrics(distances: &Histogram) -> Vec<Metric> {
    let nothing = "truth and result share no vertex";
    vec![
        Metric::error("mean_mm", "mm", distances.mean(nothing)),
        Metric::error("rms_mm", "mm", distances.rms(nothing)),
        Metric::error("p95_mm", "mm", distances.percentile(0.95, nothing)),
        Metric::error("max_mm", "mm", distances.max(nothing)),
    ]
}

pub(super) fn add_distances(
    distances: &mut Histogram,
    frame: i64,
    truth: &[Point3<f64>],
    result: &[Point3<f64>],
) -> Result<(), ScoreError> {
    check_equal(&format!("frame {frame}, vertices"), &truth.len(), &result.len())?;
    truth.iter().zip(result).for_each(|(truth, result)| distances.add((result - truth).norm()));
    Ok(())
}

/// Refuses sequences that cannot be compared; pairs the frames of the others.
pub(super) fn check_sequence(truth: &LargeScale, result: &LargeScale) -> Result<CommonFrames, ScoreError> {
    check_take(truth.take.as_ref(), result.take.as_ref())?;
    check_mesh(&truth.mesh, &result.mesh)?;
    super::wrinkles_2d::check_rates(truth.rate, result.rate)?;
    CommonFrames::of(&truth.frames, &result.frames)
}

/// Refuses a result that was made for another mesh, or took the mesh to be in another unit.
pub(super) fn check_mesh(truth: &MeshRef, result: &MeshRef) -> Result<(), ScoreError> {
    check_equal("mesh", &truth.file.to_string(), &result.file.to_string())?;
    check_equal(&format!("unit of {}", truth.file.name), &truth.unit, &result.unit)?;
    check_equal(&format!("vertices of {}", truth.file.name), &truth.vertex_count, &result.vertex_count)
}
