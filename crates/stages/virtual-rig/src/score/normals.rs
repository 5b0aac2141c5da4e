//! Normals, of a map's pixels or a mesh's vertices, against the true ones.

use super::same::check_equal;
use super::spread::Histogram;
use super::surface::check_sequence;
use super::{Metric, ScoreError};
use artifact::LargeScale;
use nalgebra::{Point3, Vector3};

/// Normals of a picture or a surface, and the true ones: one vector per pixel or vertex, of any length; zero where there is
/// none.
#[derive(Debug, Clone)]
pub struct NormalField {
    /// Where it stands, for messages: camera and frame.
    pub place: String,
    /// The true normals.
    pub truth: Vec<Vector3<f64>>,
    /// The normals to be scored; none where the result has no such picture.
    pub result: Option<Vec<Vector3<f64>>>,
}

/// Scores normals: `mean_deg`, `median_deg`, `p90_deg`, `rms_deg` of the angle between both, and `missing` (zero or not finite
/// where the truth has one).
///
/// `truth`, `result`: one vector per pixel or vertex, of any length; zero where there is none. `region`: where to compare; everywhere if
/// absent. Both must be in one space and convention: a normal map's green is not looked at. Percentiles are within 0.05 %.
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
    let mut tally = Tally::default();
    let inside = |at: &usize| region.is_none_or(|region| region[*at]);
    (0..truth.len()).filter(inside).for_each(|at| tally.add(&truth[at], &result[at]));
    Ok(tally.metrics())
}

/// Scores many pictures' normals as [`normals`] does those of one, all angles in one pool; in memory there is one at a time.
/// Every normal of a picture that the result lacks is missing.
///
/// # Errors
/// Other counts than the truth's, and whatever the fields' source refuses.
pub fn normal_fields<E: From<ScoreError>>(
    fields: impl IntoIterator<Item = Result<NormalField, E>>,
) -> Result<Vec<Metric>, E> {
    let mut tally = Tally::default();
    for field in fields {
        let NormalField { place, truth, result } = field?;
        tally.fields += 1;
        let Some(result) = result else {
            truth.iter().for_each(|truth| tally.add(truth, &Vector3::zeros()));
            tally.fields_missing += 1;
            continue;
        };
        check_equal(&format!("{place}, normals"), &truth.len(), &result.len())?;
        truth.iter().zip(&result).for_each(|(truth, result)| tally.add(truth, result));
    }
    let counts = [("fields", tally.fields), ("fields_missing", tally.fields_missing)];
    let with_counts =
        |metric: Metric| counts.iter().fold(metric, |metric, &(key, count)| metric.with(key, count));
    Ok(tally.metrics().into_iter().map(with_counts).collect())
}

/// Scores the normals of an animated surface's vertices as [`normal_fields`] does those of pictures; frames that the result
/// lacks are counted in the context.
///
/// `triangles`: those of the mesh that both were made for. `positions`: as for [`large_scale`](super::large_scale).
///
/// # Errors
/// As [`large_scale`](super::large_scale).
pub fn surface_normals<E: From<ScoreError>>(
    truth: &LargeScale,
    result: &LargeScale,
    triangles: &[[u32; 3]],
    mut positions: impl FnMut(i64) -> Result<(Vec<Point3<f64>>, Vec<Point3<f64>>), E>,
) -> Result<Vec<Metric>, E> {
    let frames = check_sequence(truth, result)?;
    let fields = frames.pairs.iter().map(|&(at, _)| -> Result<NormalField, E> {
        let frame = truth.frames[at];
        let (truth, result) = positions(frame)?;
        let place = format!("frame {frame}");
        check_equal(&format!("{place}, vertices"), &truth.len(), &result.len())?;
        let normals = |points: &[Point3<f64>]| mesh::vertex_normals(points, triangles);
        Ok(NormalField { place, truth: normals(&truth), result: Some(normals(&result)) })
    });
    let metrics: Vec<Metric> = normal_fields(fields)?;
    let context = frames.context();
    Ok(metrics.into_iter().map(|metric| metric.with_all(&context)).collect())
}

#[derive(Debug, Default)]
struct Tally {
    angles: Histogram,
    missing: usize,
    fields: usize,
    fields_missing: usize,
}

impl Tally {
    fn add(&mut self, truth: &Vector3<f64>, result: &Vector3<f64>) {
        let unit = |normal: &Vector3<f64>| {
            normal.try_normalize(0.0).filter(|normal| normal.iter().all(|x| x.is_finite()))
        };
        match (unit(truth), unit(result)) {
            (Some(truth), Some(result)) => self.angles.add(angle(&truth, &result).to_degrees()),
            (Some(_), None) => self.missing += 1,
            (None, _) => {}
        }
    }

    fn metrics(&self) -> Vec<Metric> {
        let nothing = "truth and result have no normal in the same place";
        let metrics = vec![
            Metric::error("mean_deg", "deg", self.angles.mean(nothing)),
            Metric::error("median_deg", "deg", self.angles.percentile(0.5, nothing)),
            Metric::error("p90_deg", "deg", self.angles.percentile(0.9, nothing)),
            Metric::error("rms_deg", "deg", self.angles.rms(nothing)),
            Metric::count("missing", self.missing),
        ];
        metrics.into_iter().map(|metric| metric.with("normals", self.angles.count)).collect()
    }
}

/// The angle between unit vectors: exactly zero for equal ones, and exact for small angles.
fn angle(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    2.0 * (a - b).norm().atan2((a + b).norm())
}
