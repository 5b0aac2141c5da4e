//! Two cameras: the fundamental matrix of their common points.

use super::Track;
use super::ransac::consensus;
use nalgebra::{DMatrix, Matrix3, Matrix3x4, Vector2, Vector3};
use rand_chacha::ChaCha8Rng;

/// Points that a fundamental matrix is fitted to, at least: eight, and some to agree.
pub(super) const LEAST_COMMON: usize = 12;
/// Samples of eight; with a third of the points wrong, one of 26 is all right.
const TRIES: usize = 600;
/// Times the matrix is fitted again to all who agree with it.
const POLISH: usize = 4;

/// The epipolar geometry of two cameras, in normalised images.
pub(super) struct Pair {
    /// Places of the cameras.
    pub(super) cameras: [usize; 2],
    /// second · F · first = 0
    pub(super) fundamental: Matrix3<f64>,
    /// Frames in which both see the point and agree, and those in which they do not.
    pub(super) agree: Vec<usize>,
    pub(super) differ: Vec<usize>,
}

/// The epipolar geometry of two cameras' tracks: eight-point algorithm in samples, then over all who agree
/// [HartleyZisserman2004, § 11]. None where they have too few points in common, or too few agree.
///
/// `limit`: Sampson distance from which a point disagrees, in the images' unit.
pub(super) fn pair(tracks: &[Track], cameras: [usize; 2], limit: f64, rng: &mut ChaCha8Rng) -> Option<Pair> {
    let [first, second] = cameras.map(|c| &tracks[c]);
    let frames: Vec<usize> =
        (0..first.len()).filter(|&f| first[f].is_some() && second[f].is_some()).collect();
    let points: Vec<[Vector2<f64>; 2]> =
        frames.iter().filter_map(|&f| Some([first[f]?, second[f]?])).collect();
    if points.len() < LEAST_COMMON {
        return None;
    }
    let fit = |chosen: &[usize]| fundamental(chosen.iter().map(|&i| points[i]));
    let error = |f: &Matrix3<f64>, i: usize| sampson(f, &points[i]);
    let mut found = consensus(rng, [points.len(), 8, TRIES], limit, fit, error)?;
    for _ in 0..POLISH {
        let chosen: Vec<usize> = (0..points.len()).filter(|&i| found.inliers[i]).collect();
        found.model = fit(&chosen)?;
        found.inliers = (0..points.len()).map(|i| error(&found.model, i) < limit).collect();
    }
    let chosen = |wanted: bool| -> Vec<usize> {
        frames.iter().zip(&found.inliers).filter(|(_, agrees)| **agrees == wanted).map(|(f, _)| *f).collect()
    };
    let (agree, differ) = (chosen(true), chosen(false));
    (agree.len() >= LEAST_COMMON && agree.len() > differ.len()).then_some(Pair {
        cameras,
        fundamental: found.model,
        agree,
        differ,
    })
}

/// The fundamental matrix with the least algebraic error over normalised points; none from fewer than eight, or from points
/// that leave it open.
fn fundamental(points: impl Iterator<Item = [Vector2<f64>; 2]> + Clone) -> Option<Matrix3<f64>> {
    let count = points.clone().count();
    if count < 8 {
        return None;
    }
    let scales = [0, 1].map(|side| normaliser(points.clone().map(|pair| pair[side])));
    let [Some(first), Some(second)] = scales else { return None };
    let mut rows = DMatrix::zeros(count.max(9), 9);
    for (row, pair) in points.enumerate() {
        let (a, b) = (first * pair[0].push(1.0), second * pair[1].push(1.0));
        for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
            rows[(row, 3 * i + j)] = b[i] * a[j];
        }
    }
    let null = null_vector(rows)?;
    let svd = Matrix3::from_row_slice(null.as_slice()).svd_unordered(true, true);
    let (u, v_t, mut s) = (svd.u?, svd.v_t?, svd.singular_values);
    let least = s.imin();
    s[least] = 0.0;
    let flat = u * Matrix3::from_diagonal(&s) * v_t;
    let matrix = second.transpose() * flat * first;
    Some(matrix / matrix.norm())
}

/// The similarity that brings points to mean zero and mean distance √2; none if they are all in one place.
pub(super) fn normaliser(points: impl Iterator<Item = Vector2<f64>> + Clone) -> Option<Matrix3<f64>> {
    let count = points.clone().count() as f64;
    let mean = points.clone().sum::<Vector2<f64>>() / count;
    let spread = points.map(|point| (point - mean).norm()).sum::<f64>() / count;
    let scale = std::f64::consts::SQRT_2 / spread;
    scale
        .is_finite()
        .then(|| Matrix3::new(scale, 0.0, -scale * mean.x, 0.0, scale, -scale * mean.y, 0.0, 0.0, 1.0))
}

/// The unit vector that a matrix brings nearest to zero.
pub(super) fn null_vector(matrix: DMatrix<f64>) -> Option<nalgebra::DVector<f64>> {
    // The normal matrix is small, and its eigenvectors cost the same for any number of rows.
    let eigen = (matrix.transpose() * matrix).symmetric_eigen();
    let vector = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
    vector.iter().all(|x| x.is_finite()).then_some(vector)
}

/// First-order distance of a pair of points to the epipolar constraint [HartleyZisserman2004, Eq. 11.9].
fn sampson(fundamental: &Matrix3<f64>, points: &[Vector2<f64>; 2]) -> f64 {
    let (a, b) = (points[0].push(1.0), points[1].push(1.0));
    let (line, back) = (fundamental * a, fundamental.transpose() * b);
    let slope = line.xy().norm_squared() + back.xy().norm_squared();
    (b.dot(&line)).abs() / slope.sqrt()
}

impl Pair {
    /// Projective cameras with this geometry: [I | 0] and [[e′]ₓF | e′] [HartleyZisserman2004, Result 9.14].
    pub(super) fn cameras_from_geometry(&self) -> Option<[Matrix3x4<f64>; 2]> {
        let svd = self.fundamental.transpose().svd_unordered(false, true);
        let epipole: Vector3<f64> = svd.v_t?.row(svd.singular_values.imin()).transpose();
        let mut second = Matrix3x4::zeros();
        second.fixed_columns_mut::<3>(0).copy_from(&(epipole.cross_matrix() * self.fundamental));
        second.set_column(3, &epipole);
        Some([Matrix3x4::identity(), second])
    }
}
