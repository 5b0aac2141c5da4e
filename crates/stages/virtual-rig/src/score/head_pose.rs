//! `head-pose` against the true motion of the head.

use super::same::{CommonFrames, check_take};
use super::spread::Pool;
use super::{Metric, ScoreError};
use artifact::{HeadPoseFrame, HeadPoseHeader};
use nalgebra::{Isometry3, Point3, UnitQuaternion};

/// A head's poses: header and frames.
pub type Poses<'a> = (&'a HeadPoseHeader, &'a [HeadPoseFrame]);

/// Scores the head's motion since the first frame that both have a pose for: `rotation_rms_deg`, `rotation_max_deg`,
/// `translation_rms_mm`, `translation_max_mm`, `missing` frames.
///
/// Where head space lies on the head is up to whoever defines it, so poses are compared as motions of the world,
/// `M(t) = T(t) T(t₀)⁻¹`. The translation error is that of the true head's origin, which rests under the face's
/// middle: at the world's origin, metres away, a small turn would count as a large shift.
///
/// # Errors
/// A result of another take, or without a common frame.
pub fn head_pose(truth: Poses, result: Poses) -> Result<Vec<Metric>, ScoreError> {
    check_take(truth.0.take.as_ref(), result.0.take.as_ref())?;
    if let (Some(truth), Some(result)) = (truth.0.rate, result.0.rate) {
        super::same::check_equal("rate", &truth, &result)?;
    }
    let numbers = |frames: &[HeadPoseFrame]| frames.iter().map(|frame| frame.frame).collect::<Vec<_>>();
    let frames = CommonFrames::of(&numbers(truth.1), &numbers(result.1))?;
    let pair = |&(at, other): &(usize, usize)| {
        Some((truth.1[at].world_from_head?, result.1[other].world_from_head?))
    };
    let pairs: Vec<(Isometry3<f64>, Isometry3<f64>)> = frames.pairs.iter().filter_map(pair).collect();
    let held = truth.1.iter().filter(|frame| frame.world_from_head.is_some()).count();
    let (rotation, translation) = errors(&pairs);
    let nothing = "no frame has a pose in truth and result beside the first";
    let metrics = vec![
        Metric::error("rotation_rms_deg", "deg", rotation.rms(nothing)),
        Metric::error("rotation_max_deg", "deg", rotation.max(nothing)),
        Metric::error("translation_rms_mm", "mm", translation.rms(nothing)),
        Metric::error("translation_max_mm", "mm", translation.max(nothing)),
        Metric::count("missing", held - pairs.len()),
    ];
    let context = frames.context();
    Ok(metrics.into_iter().map(|metric| metric.with_all(&context).with("poses", pairs.len())).collect())
}

/// Rotation (degrees) and translation (mm) errors of all poses after the first.
fn errors(pairs: &[(Isometry3<f64>, Isometry3<f64>)]) -> (Pool, Pool) {
    let (mut rotation, mut translation) = (Pool::default(), Pool::default());
    let Some((first_truth, first_result)) = pairs.first() else { return (rotation, translation) };
    let head = first_truth * Point3::origin();
    for (truth, result) in &pairs[1..] {
        let (moved, found) = (truth * first_truth.inverse(), result * first_result.inverse());
        rotation.add(angle(&moved.rotation, &found.rotation).to_degrees());
        translation.add((moved * head - found * head).norm());
    }
    (rotation, translation)
}

/// The angle between two rotations: exactly zero for equal ones, and exact for small angles, where the arc cosine of a
/// trace is not.
pub(super) fn angle(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> f64 {
    let (a, b) = (a.coords, b.coords);
    let chord = (a - b).norm().min((a + b).norm());
    4.0 * (0.5 * chord).min(1.0).asin()
}
