//! All cameras together, up to a projective map of space: camera after camera, then all at once by factorisation.

use super::Track;
use super::pair::{Pair, normaliser, null_vector};
use super::ransac::consensus;
use nalgebra::{DMatrix, Matrix3x4, Matrix4, SMatrix, Vector2, Vector4};
use rand_chacha::ChaCha8Rng;

/// Cameras and points up to a projective map of space, in normalised images.
#[derive(Debug, Clone)]
pub(super) struct Projective {
    /// Per camera its matrix; none until it is placed.
    pub(super) cameras: Vec<Option<Matrix3x4<f64>>>,
    /// Per frame the point.
    pub(super) points: Vec<Option<Vector4<f64>>>,
}

/// Points that a camera is placed by, at least: six, and some to agree.
const LEAST_POINTS: usize = 10;
const TRIES: usize = 300;
/// Times a camera is placed again by all points that agree.
const POLISH: usize = 4;

impl Projective {
    /// Starts from a pair, and adds the camera that sees the most of the known points until none can be added.
    pub(super) fn grow(tracks: &[Track], start: &Pair, limit: f64, rng: &mut ChaCha8Rng) -> Option<Self> {
        let frames = tracks.first()?.len();
        let mut scene = Self { cameras: vec![None; tracks.len()], points: vec![None; frames] };
        let [first, second] = start.cameras_from_geometry()?;
        scene.cameras[start.cameras[0]] = Some(first);
        scene.cameras[start.cameras[1]] = Some(second);
        scene.triangulate(tracks, limit);
        let mut failed = vec![false; tracks.len()];
        while let Some(next) = scene.next(tracks, &failed) {
            match scene.resect(&tracks[next], limit, rng) {
                Some(camera) => {
                    scene.cameras[next] = Some(camera);
                    scene.triangulate(tracks, limit);
                    // What failed before may go with more points.
                    failed.fill(false);
                }
                None => failed[next] = true,
            }
        }
        Some(scene)
    }

    fn next(&self, tracks: &[Track], failed: &[bool]) -> Option<usize> {
        let known = |camera: &usize| {
            tracks[*camera]
                .iter()
                .zip(&self.points)
                .filter(|(seen, point)| seen.is_some() && point.is_some())
                .count()
        };
        let open = (0..tracks.len()).filter(|&c| self.cameras[c].is_none() && !failed[c]);
        // The first of equals.
        open.map(|c| (known(&c), std::cmp::Reverse(c))).max().map(|(_, std::cmp::Reverse(c))| c)
    }

    /// The camera with the least algebraic error over the known points that it sees [HartleyZisserman2004, § 7.1].
    fn resect(&self, track: &Track, limit: f64, rng: &mut ChaCha8Rng) -> Option<Matrix3x4<f64>> {
        let pairs: Vec<(Vector4<f64>, Vector2<f64>)> =
            self.points.iter().zip(track).filter_map(|(point, seen)| Some(((*point)?, (*seen)?))).collect();
        if pairs.len() < LEAST_POINTS {
            return None;
        }
        let fit = |chosen: &[usize]| direct_camera(chosen.iter().map(|&i| pairs[i]));
        let error = |camera: &Matrix3x4<f64>, i: usize| distance(camera, &pairs[i].0, &pairs[i].1);
        let mut found = consensus(rng, [pairs.len(), 6, TRIES], limit, fit, error)?;
        for _ in 0..POLISH {
            let chosen: Vec<usize> = (0..pairs.len()).filter(|&i| found.inliers[i]).collect();
            found.model = fit(&chosen)?;
            found.inliers = (0..pairs.len()).map(|i| error(&found.model, i) < limit).collect();
        }
        let agree = found.inliers.iter().filter(|agrees| **agrees).count();
        (agree >= LEAST_POINTS && 2 * agree > pairs.len()).then_some(found.model)
    }

    /// Places every point from the cameras that stand and agree on it.
    pub(super) fn triangulate(&mut self, tracks: &[Track], limit: f64) {
        for frame in 0..self.points.len() {
            let views: Vec<(&Matrix3x4<f64>, Vector2<f64>)> = self
                .cameras
                .iter()
                .zip(tracks)
                .filter_map(|(camera, track)| Some((camera.as_ref()?, track[frame]?)))
                .collect();
            self.points[frame] = direct_point(&views)
                .filter(|point| views.iter().all(|(camera, seen)| distance(camera, point, seen) < limit));
        }
    }

    /// Distances between projected and seen points, (camera, frame, distance).
    pub(super) fn errors(&self, tracks: &[Track]) -> Vec<(usize, usize, f64)> {
        let mut errors = Vec::new();
        for (c, (camera, track)) in self.cameras.iter().zip(tracks).enumerate() {
            let Some(camera) = camera else { continue };
            for (frame, (seen, point)) in track.iter().zip(&self.points).enumerate() {
                if let (Some(seen), Some(point)) = (seen, point) {
                    errors.push((c, frame, distance(camera, point, seen)));
                }
            }
        }
        errors
    }

    fn rms(&self, tracks: &[Track]) -> f64 {
        let errors = self.errors(tracks);
        (errors.iter().map(|(_, _, e)| e * e).sum::<f64>() / errors.len().max(1) as f64).sqrt()
    }

    /// Factorises the matrix of all image points, scaled by their projective depths, into cameras and points of rank four
    /// [SturmTriggs1996, Svoboda2005], over and over; what a camera does not see is taken from its own projection. The best of
    /// the rounds is kept. Needs all cameras placed.
    pub(super) fn factorise(&mut self, tracks: &[Track], rounds: usize) {
        let mut current = self.clone();
        let mut least = self.rms(tracks);
        for _ in 0..rounds {
            let Some(next) = current.factorised(tracks) else { break };
            let error = next.rms(tracks);
            let gain = least - error;
            current = next;
            if error < least {
                least = error;
                *self = current.clone();
            }
            if gain.abs() < 1e-7 * least {
                break;
            }
        }
    }

    fn factorised(&self, tracks: &[Track]) -> Option<Self> {
        let cameras: Vec<Matrix3x4<f64>> = self.cameras.iter().copied().collect::<Option<_>>()?;
        let frames: Vec<usize> = (0..self.points.len()).filter(|&f| self.points[f].is_some()).collect();
        let mut matrix = DMatrix::zeros(3 * cameras.len(), frames.len());
        for (column, &frame) in frames.iter().enumerate() {
            let point = self.points[frame]?;
            for (c, camera) in cameras.iter().enumerate() {
                let projected = camera * point;
                let scaled = tracks[c][frame].map_or(projected, |seen| projected.z * seen.push(1.0));
                matrix.fixed_view_mut::<3, 1>(3 * c, column).copy_from(&scaled);
            }
        }
        let row_scales = balance(&mut matrix);
        let eigen = (&matrix * matrix.transpose()).symmetric_eigen();
        let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let basis = DMatrix::from_columns(
            &order.iter().take(4).map(|&k| eigen.eigenvectors.column(k)).collect::<Vec<_>>(),
        );
        let places = basis.transpose() * &matrix;
        let mut next = Self { cameras: vec![None; cameras.len()], points: vec![None; self.points.len()] };
        for (c, scale) in row_scales.iter().enumerate() {
            next.cameras[c] = Some(basis.fixed_view::<3, 4>(3 * c, 0) / *scale);
        }
        for (column, &frame) in frames.iter().enumerate() {
            next.points[frame] = Some(places.fixed_view::<4, 1>(0, column).into());
        }
        Some(next)
    }

    /// The same scene in another projective frame: cameras P H, points H⁻¹ X.
    pub(super) fn mapped(&self, map: &Matrix4<f64>) -> Option<Self> {
        let inverse = map.try_inverse()?;
        Some(Self {
            cameras: self.cameras.iter().map(|camera| camera.map(|camera| camera * map)).collect(),
            points: self.points.iter().map(|point| point.map(|point| inverse * point)).collect(),
        })
    }
}

/// Rounds of the balancing: after a few, rows and columns are alike.
const BALANCE: usize = 5;

/// Scales columns to unit length, then cameras' rows to equal ones, in turn; depths are known up to these scales only. Returns
/// the cameras' scales.
fn balance(matrix: &mut DMatrix<f64>) -> Vec<f64> {
    let cameras = matrix.nrows() / 3;
    let mut scales = vec![1.0; cameras];
    for _ in 0..BALANCE {
        for mut column in matrix.column_iter_mut() {
            let length = column.norm();
            column /= length;
        }
        for (c, scale) in scales.iter_mut().enumerate() {
            let mut rows = matrix.rows_mut(3 * c, 3);
            let factor = 1.0 / rows.norm();
            rows *= factor;
            *scale *= factor;
        }
    }
    scales
}

/// How far a projected point lies from where it is seen.
pub(super) fn distance(camera: &Matrix3x4<f64>, point: &Vector4<f64>, seen: &Vector2<f64>) -> f64 {
    let projected = camera * point;
    (projected.xy() / projected.z - seen).norm()
}

/// The camera with the least algebraic error, from six points or more.
fn direct_camera(
    pairs: impl Iterator<Item = (Vector4<f64>, Vector2<f64>)> + Clone,
) -> Option<Matrix3x4<f64>> {
    let count = pairs.clone().count();
    if count < 6 {
        return None;
    }
    let image = normaliser(pairs.clone().map(|(_, seen)| seen))?;
    let mut rows = DMatrix::zeros(2 * count, 12);
    for (row, (point, seen)) in pairs.enumerate() {
        let point = point.normalize();
        let at = image * seen.push(1.0);
        for k in 0..4 {
            rows[(2 * row, k)] = point[k];
            rows[(2 * row, 8 + k)] = -at.x * point[k];
            rows[(2 * row + 1, 4 + k)] = point[k];
            rows[(2 * row + 1, 8 + k)] = -at.y * point[k];
        }
    }
    let null = null_vector(rows)?;
    let camera = image.try_inverse()? * Matrix3x4::from_row_slice(null.as_slice());
    Some(camera / camera.norm())
}

/// The point with the least algebraic error, from two views or more [HartleyZisserman2004, § 12.2].
fn direct_point(views: &[(&Matrix3x4<f64>, Vector2<f64>)]) -> Option<Vector4<f64>> {
    if views.len() < 2 {
        return None;
    }
    let mut normal = SMatrix::<f64, 4, 4>::zeros();
    for (camera, seen) in views {
        for axis in 0..2 {
            let row = camera.row(2) * seen[axis] - camera.row(axis);
            let row = row / camera.norm();
            normal += row.transpose() * row;
        }
    }
    let eigen = normal.symmetric_eigen();
    let point: Vector4<f64> = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into();
    point.iter().all(|x| x.is_finite()).then_some(point)
}
