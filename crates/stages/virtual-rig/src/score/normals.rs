//! Normals, of a map's pixels or a mesh's vertices, against the true ones.

use super::same::check_equal;
use super::spread::Pool;
use super::{Metric, ScoreError};
use nalgebra::Vector3;

/// Scores normals: `mean_deg`, `median_deg`, `p90_deg`, `rms_deg` of the angle between both, and `missing` (zero or not finite
/// where the truth has one).
///
/// `truth`, `result`: one vector per pixel or vertex, of any length; zero where there is none. `region`: where to compare; everywhere if
/// absent. Both must be in one space and convention: a normal map's green is not looked at.
///
/// # Errors
/// Other counts than the truth's.
pub fn normals(
    truth: &[Vector3<f64>],
    result: &[Vector3<f64>],
    region: Option<&[bool]>,
) -> Result<Vec<Metric>, ScoreError> {
    check_equal("normals", &truth.len(), &result.len())?;
    if let Some(region) = region {
        check_equal("region", &truth.len(), &region.len())?;
    }
    let unit = |normal: &Vector3<f64>| {
        normal.try_normalize(0.0).filter(|normal| normal.iter().all(|x| x.is_finite()))
    };
    let (mut errors, mut missing) = (Pool::default(), 0);
    for at in 0..truth.len() {
        if region.is_some_and(|region| !region[at]) {
            continue;
        }
        match (unit(&truth[at]), unit(&result[at])) {
            (Some(truth), Some(result)) => errors.add(angle(&truth, &result).to_degrees()),
            (Some(_), None) => missing += 1,
            (None, _) => {}
        }
    }
    let nothing = "truth and result have no normal in the same place";
    let metrics = vec![
        Metric::error("mean_deg", "deg", errors.mean(nothing)),
        Metric::error("median_deg", "deg", errors.median(nothing)),
        Metric::error("p90_deg", "deg", errors.percentile(0.9, nothing)),
        Metric::error("rms_deg", "deg", errors.rms(nothing)),
        Metric::count("missing", missing),
    ];
    Ok(metrics.into_iter().map(|metric| metric.with("normals", errors.len())).collect())
}

/// The angle between unit vectors: exactly zero for equal ones, and exact for small angles.
fn angle(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    2.0 * (a - b).norm().atan2((a + b).norm())
}
