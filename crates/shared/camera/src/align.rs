//! Absolute orientation: the transform that carries one set of points onto another.

use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Similarity3, UnitQuaternion, Vector3};

/// Why no transform could be found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AlignError {
    /// Fewer than three points with positive weight.
    TooFew(usize),
    /// The points lie on a line or in one place: the rotation about it is free.
    Collinear,
}

impl std::fmt::Display for AlignError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::TooFew(count) => write!(f, "{count} points; three are needed"),
            Self::Collinear => f.write_str("the points lie on a line, so their rotation about it is unknown"),
        }
    }
}

impl std::error::Error for AlignError {}

/// Spread of the second principal axis over the first below which points count as a line.
const LINE_RATIO: f64 = 1e-9;

/// The rigid transform `target_from_source` that minimises Σ wᵢ ‖targetᵢ − T sourceᵢ‖² [Horn1987], by the singular
/// value decomposition of the cross-covariance (the same minimiser as the quaternion form).
///
/// `weights`: one non-negative number per point; all 1 if absent.
///
/// # Errors
/// [`AlignError`] where the points do not determine a rotation.
///
/// # Panics
/// If the lengths differ.
pub fn fit_rigid(
    source: &[Point3<f64>],
    target: &[Point3<f64>],
    weights: Option<&[f64]>,
) -> Result<Isometry3<f64>, AlignError> {
    let moments = Moments::of(source, target, weights)?;
    let rotation = moments.rotation()?.0;
    let shift = moments.target_mean - rotation * moments.source_mean;
    Ok(Isometry3::from_parts(shift.into(), rotation))
}

/// The similarity (rotation, translation, one scale) that minimises Σ wᵢ ‖targetᵢ − T sourceᵢ‖² [Horn1987].
///
/// # Errors
/// [`AlignError`] where the points do not determine a rotation.
///
/// # Panics
/// If the lengths differ.
pub fn fit_similarity(
    source: &[Point3<f64>],
    target: &[Point3<f64>],
    weights: Option<&[f64]>,
) -> Result<Similarity3<f64>, AlignError> {
    let moments = Moments::of(source, target, weights)?;
    let (rotation, trace) = moments.rotation()?;
    let scale = trace / moments.source_spread;
    let shift = moments.target_mean - scale * (rotation * moments.source_mean);
    Ok(Similarity3::from_parts(shift.into(), rotation, scale))
}

struct Moments {
    source_mean: Vector3<f64>,
    target_mean: Vector3<f64>,
    /// Σ w (target − mean)(source − mean)ᵀ
    cross: Matrix3<f64>,
    /// Σ w ‖source − mean‖²
    source_spread: f64,
}

impl Moments {
    fn of(
        source: &[Point3<f64>],
        target: &[Point3<f64>],
        weights: Option<&[f64]>,
    ) -> Result<Self, AlignError> {
        assert_eq!(source.len(), target.len(), "points come in pairs");
        let weight = |i: usize| weights.map_or(1.0, |weights| weights[i]);
        let used = (0..source.len()).filter(|&i| weight(i) > 0.0).count();
        if used < 3 {
            return Err(AlignError::TooFew(used));
        }
        let total: f64 = (0..source.len()).map(weight).sum();
        let mean = |points: &[Point3<f64>]| {
            points.iter().enumerate().map(|(i, point)| point.coords * weight(i)).sum::<Vector3<f64>>() / total
        };
        let (source_mean, target_mean) = (mean(source), mean(target));
        let mut cross = Matrix3::zeros();
        let mut source_spread = 0.0;
        for i in 0..source.len() {
            let (from, to) = (source[i].coords - source_mean, target[i].coords - target_mean);
            cross += weight(i) * to * from.transpose();
            source_spread += weight(i) * from.norm_squared();
        }
        Ok(Self { source_mean, target_mean, cross, source_spread })
    }

    /// The rotation, and the trace of its product with the cross-covariance (which sets the best scale).
    fn rotation(&self) -> Result<(UnitQuaternion<f64>, f64), AlignError> {
        let svd = self.cross.svd(true, true);
        let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else { return Err(AlignError::Collinear) };
        let s = svd.singular_values;
        if s[1] <= LINE_RATIO * s[0] {
            return Err(AlignError::Collinear);
        }
        let sign = (u.determinant() * v_t.determinant()).signum();
        let flip = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign));
        let rotation = Rotation3::from_matrix_unchecked(u * flip * v_t);
        Ok((UnitQuaternion::from_rotation_matrix(&rotation), s[0] + s[1] + sign * s[2]))
    }
}
