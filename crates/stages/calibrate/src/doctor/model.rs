//! A camera fitted to points that others placed.

use camera::Camera;
use nalgebra::{
    DMatrix, Isometry3, Matrix3, Matrix3x4, Point3, SMatrix, SVector, UnitQuaternion, Vector2, Vector3,
};

/// A point that others placed, and where the camera sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Datum<'a> {
    pub(super) name: &'a str,
    pub(super) frame: i64,
    pub(super) point: Point3<f64>,
    pub(super) pixel: Vector2<f64>,
}

/// Turn and shift in the camera's axes, and the logarithm of the focal length.
pub(super) const PARAMETERS: usize = 7;
pub(super) const TURN: &[usize] = &[0, 1, 2];
pub(super) const FOCAL: &[usize] = &[6];
pub(super) const POSE: &[usize] = &[0, 1, 2, 3, 4, 5];
pub(super) const ALL: &[usize] = &[0, 1, 2, 3, 4, 5, 6];

type Step = SVector<f64, PARAMETERS>;

/// A fitted camera.
#[derive(Debug, Clone)]
pub(super) struct Fit {
    pub(super) camera: Camera,
    pub(super) rms_px: f64,
    /// Standard deviation of the logarithm of the focal length; 0 where it is held.
    pub(super) focal_deviation: f64,
}

/// Share of the residuals that are looked at: the worst tenth may be mistakes of a tracker.
const KEPT: f64 = 0.9;

/// Root mean square without the worst tenth; none of fewer than five.
pub(super) fn trimmed_rms(residuals: impl Iterator<Item = f64>) -> Option<f64> {
    let mut squares: Vec<f64> = residuals.map(|r| r * r).collect();
    squares.sort_by(f64::total_cmp);
    squares.truncate((KEPT * squares.len() as f64).ceil() as usize);
    (squares.len() >= 5).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// How far the camera's pixels are from its projections; points behind it count as far.
pub(super) fn residual(camera: &Camera, datum: &Datum) -> Option<Vector2<f64>> {
    Some(datum.pixel - camera.project(&datum.point)?)
}

/// Of a point behind the camera, px.
const BEHIND_PX: f64 = 1e4;

pub(super) fn rms(camera: &Camera, data: &[Datum]) -> f64 {
    let lengths = data.iter().map(|datum| residual(camera, datum).map_or(BEHIND_PX, |r| r.norm()));
    trimmed_rms(lengths).unwrap_or(0.0)
}

fn moved(camera: &Camera, step: &Step) -> Camera {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(step[0], step[1], step[2]));
    let motion = Isometry3::from_parts(Vector3::new(step[3], step[4], step[5]).into(), turn);
    let mut moved = camera.clone();
    moved.cam_from_world = motion * camera.cam_from_world;
    moved.cam_from_world.rotation.renormalize();
    moved.lens.focal_px *= step[6].exp();
    moved
}

/// Steps of the fit at most.
const STEPS: usize = 25;
/// Steps for the difference quotients: rad, mm, share.
const TINY: [f64; PARAMETERS] = [1e-6, 1e-6, 1e-6, 1e-3, 1e-3, 1e-3, 1e-6];

/// The camera with some of its parameters fitted, by Gauss–Newton with Cauchy weights at the residuals' own scale, so that what a
/// tracker confused does not pull.
pub(super) fn fit(camera: &Camera, data: &[Datum], free: &[usize]) -> Option<Fit> {
    let mut now = camera.clone();
    let mut least = rms(&now, data);
    let mut focal_deviation = 0.0;
    for _ in 0..STEPS {
        let (normal, right, variance) = equations(&now, data, free)?;
        let scale = normal.diagonal().map(|d| 1.0 / d.sqrt());
        let scaled = DMatrix::from_fn(free.len(), free.len(), |i, j| normal[(i, j)] * scale[i] * scale[j]);
        let inverse = scaled.cholesky()?.inverse();
        let solution = (&inverse * right.component_mul(&scale)).component_mul(&scale);
        let mut step = Step::zeros();
        free.iter().zip(solution.iter()).for_each(|(&k, value)| step[k] = *value);
        if let Some(place) = free.iter().position(|&k| k == PARAMETERS - 1) {
            focal_deviation = (inverse[(place, place)] * variance).sqrt() * scale[place];
        }
        let next = shortened(&now, &step, data, least)?;
        let Some((camera, error)) = next else { break };
        let gain = least - error;
        (now, least) = (camera, error);
        if gain < 1e-6 * least {
            break;
        }
    }
    Some(Fit { camera: now, rms_px: least, focal_deviation })
}

/// The camera after a step, halved until it helps; no camera where none does.
fn shortened(camera: &Camera, step: &Step, data: &[Datum], least: f64) -> Option<Option<(Camera, f64)>> {
    if !step.iter().all(|x| x.is_finite()) {
        return None;
    }
    let tries = (0..6).map(|halvings| moved(camera, &(step * 0.5_f64.powi(halvings))));
    let better = tries.map(|camera| (rms(&camera, data), camera)).find(|(error, _)| *error < least);
    Some(better.map(|(error, camera)| (camera, error)))
}

fn equations(
    camera: &Camera,
    data: &[Datum],
    free: &[usize],
) -> Option<(DMatrix<f64>, nalgebra::DVector<f64>, f64)> {
    let residuals: Vec<Option<Vector2<f64>>> = data.iter().map(|datum| residual(camera, datum)).collect();
    let mut lengths: Vec<f64> = residuals.iter().flatten().map(|r| r.norm()).collect();
    if 2 * lengths.len() <= free.len() + 3 {
        return None;
    }
    lengths.sort_by(f64::total_cmp);
    let scale = 2.0 * lengths[lengths.len() / 2].max(1e-6);
    let sides: Vec<[Camera; 2]> = free
        .iter()
        .map(|&k| {
            let mut step = Step::zeros();
            step[k] = TINY[k];
            [moved(camera, &step), moved(camera, &-step)]
        })
        .collect();
    let mut normal = DMatrix::zeros(free.len(), free.len());
    let mut right = nalgebra::DVector::zeros(free.len());
    let (mut squares, mut weights) = (0.0, 0.0);
    for (datum, r) in data.iter().zip(&residuals) {
        let Some(r) = r else { continue };
        let weight = 1.0 / (1.0 + r.norm_squared() / (scale * scale));
        let slopes: Option<Vec<Vector2<f64>>> = sides
            .iter()
            .zip(free)
            .map(|([up, down], &k)| {
                Some((up.project(&datum.point)? - down.project(&datum.point)?) / (2.0 * TINY[k]))
            })
            .collect();
        let Some(slopes) = slopes else { continue };
        for (i, a) in slopes.iter().enumerate() {
            right[i] += weight * a.dot(r);
            for (j, b) in slopes.iter().enumerate() {
                normal[(i, j)] += weight * a.dot(b);
            }
        }
        squares += weight * r.norm_squared();
        weights += 2.0 * weight;
    }
    Some((normal, right, squares / weights))
}

/// Share of the largest eigenvalue under which the second least one says that the points are flat.
const FLAT: f64 = 1e-9;

/// The pose that a camera of this lens must have, found without any start: the direct linear transform over undistorted
/// points [HartleyZisserman2004, § 7.1]. None from fewer than six points, or flat ones.
pub(super) fn direct_pose(camera: &Camera, data: &[Datum]) -> Option<Camera> {
    let mean = data.iter().map(|datum| datum.point.coords).sum::<Vector3<f64>>() / data.len() as f64;
    let size = data.iter().map(|datum| (datum.point.coords - mean).norm()).sum::<f64>() / data.len() as f64;
    let mut normal = SMatrix::<f64, 12, 12>::zeros();
    for datum in data {
        let at = camera.lens.unproject(datum.pixel)?;
        let point = ((datum.point.coords - mean) / size).push(1.0);
        for axis in 0..2 {
            let mut row = SMatrix::<f64, 1, 12>::zeros();
            for k in 0..4 {
                row[4 * axis + k] = point[k];
                row[8 + k] = -at[axis] * point[k];
            }
            normal += row.transpose() * row;
        }
    }
    let eigen = normal.symmetric_eigen();
    let mut values: Vec<f64> = eigen.eigenvalues.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    if data.len() < 6 || values[1] <= FLAT * values[11] {
        return None;
    }
    let null = eigen.eigenvectors.column(eigen.eigenvalues.imin());
    let matrix = Matrix3x4::from_row_slice(null.as_slice());
    let part: Matrix3<f64> = matrix.fixed_columns::<3>(0).into();
    let sign = part.determinant().signum();
    let svd = (part * sign).svd_unordered(true, true);
    let turn = nalgebra::Rotation3::from_matrix_unchecked(svd.u? * svd.v_t?);
    let shift = matrix.column(3) * (sign * size * 3.0 / svd.singular_values.sum());
    let turn = UnitQuaternion::from_rotation_matrix(&turn);
    let mut placed = camera.clone();
    placed.cam_from_world = Isometry3::from_parts((shift - turn * mean).into(), turn);
    Some(placed)
}
