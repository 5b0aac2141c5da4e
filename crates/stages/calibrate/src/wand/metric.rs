//! From a projective to a metric reconstruction: the plane at infinity and the focal lengths.

use super::projective::Projective;
use nalgebra::{Isometry3, Matrix3, Matrix3x4, Matrix4, Point3, Rotation3, UnitQuaternion, Vector3};

/// What is tried for focal lengths.
#[derive(Debug, Clone, Copy)]
pub(super) struct FocalRange {
    /// Shortest and longest, in the unit of the normalised images.
    pub(super) ends: [f64; 2],
    /// How many are tried between, in equal ratios.
    pub(super) steps: usize,
}

/// A metric reconstruction without scale, in normalised images.
#[derive(Debug, Clone)]
pub(super) struct Metric {
    /// Per camera its focal length and pose.
    pub(super) cameras: Vec<(f64, Isometry3<f64>)>,
    /// Per frame the point.
    pub(super) points: Vec<Option<Point3<f64>>>,
}

/// Metric reconstructions, best first: for every pair of focal lengths of two cameras the plane at infinity follows in closed
/// form, and all other cameras tell whether it is right [GherardiFusiello2010]: their pixels must be square and their
/// principal points at the origin of the normalised images.
///
/// Where all cameras look at one point, as they do around a face, the usual linear equations for the absolute quadric leave
/// a family open (every sphere around that point satisfies them); this search never leaves the quadrics of rank three.
///
/// # Errors
/// Cameras that all points lie behind, in the likeliest reconstruction, if there is no other: a mirrored image is a sound
/// projective view, but of points behind its camera.
pub(super) fn metric_candidates(
    scene: &Projective,
    range: &FocalRange,
    most: usize,
) -> Result<Vec<Metric>, Vec<usize>> {
    let mut trials: Vec<(f64, Matrix4<f64>)> = Vec::new();
    for base in base_pairs(scene) {
        let Some(trial) = Trial::of(scene, base) else { continue };
        trials.extend(trial.search(range));
    }
    trials.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut found, mut astray): (Vec<Metric>, Option<Vec<usize>>) = (Vec::new(), None);
    for (_, map) in trials {
        let Some(metric) = scene.mapped(&map).and_then(|scene| read_off(&scene)) else { continue };
        match facing(metric) {
            Ok(metric) if found.iter().all(|other| !metric.is_like(other)) => found.push(metric),
            Ok(_) => {}
            Err(behind) => astray = astray.or(Some(behind)),
        }
        if found.len() == most {
            break;
        }
    }
    match astray {
        Some(behind) if found.is_empty() => Err(behind),
        _ => Ok(found),
    }
}

/// Every camera with the next, in a ring: whatever pair is badly placed, others are not.
fn base_pairs(scene: &Projective) -> Vec<[usize; 2]> {
    let count = scene.cameras.len();
    match count {
        2 => vec![[0, 1]],
        _ => (0..count).map(|c| [c, (c + 1) % count]).collect(),
    }
}

/// The scene in a frame in which one camera is [I | 0].
struct Trial {
    /// Into that frame.
    map: Matrix4<f64>,
    second: Matrix3x4<f64>,
    cameras: Vec<Matrix3x4<f64>>,
}

impl Trial {
    fn of(scene: &Projective, base: [usize; 2]) -> Option<Self> {
        let first = scene.cameras[base[0]]?;
        let map = canonical(&first)?;
        let cameras: Vec<Matrix3x4<f64>> =
            scene.cameras.iter().map(|camera| camera.map(|camera| camera * map)).collect::<Option<_>>()?;
        Some(Self { map, second: cameras[base[1]], cameras })
    }

    /// The best maps to a metric frame: the cheapest of the grid, each refined.
    fn search(&self, range: &FocalRange) -> Vec<(f64, Matrix4<f64>)> {
        let steps = range.steps.max(1);
        let ratio = (range.ends[1] / range.ends[0]).powf(1.0 / steps.max(2) as f64);
        let focal = |step: f64| range.ends[0] * ratio.powf(step + 0.5);
        let mut grid: Vec<(f64, [f64; 2], f64)> = Vec::new();
        for (i, j) in (0..steps * steps).map(|k| (k / steps, k % steps)) {
            for sign in [1.0, -1.0] {
                let focals = if steps == 1 { [1.0, 1.0] } else { [focal(i as f64), focal(j as f64)] };
                if let Some((cost, _)) = self.upgrade(focals, sign) {
                    grid.push((cost, focals, sign));
                }
            }
        }
        grid.sort_by(|a, b| a.0.total_cmp(&b.0));
        grid.truncate(KEPT);
        let refine = |(_, focals, sign): (f64, [f64; 2], f64)| {
            let focals = if steps == 1 { focals } else { self.refined(focals, sign, ratio) };
            self.upgrade(focals, sign).map(|(cost, map)| (cost, self.map * map))
        };
        grid.into_iter().filter_map(refine).collect()
    }

    /// Halves the grid around the best focal lengths, over and over.
    fn refined(&self, mut best: [f64; 2], sign: f64, mut ratio: f64) -> [f64; 2] {
        let cost = |focals: [f64; 2]| self.upgrade(focals, sign).map_or(f64::INFINITY, |(cost, _)| cost);
        let mut least = cost(best);
        for _ in 0..REFINEMENTS {
            let middle = best;
            for k in 0..9 {
                let step = |side: usize| ratio.powi(side as i32 - 1);
                let focals = [middle[0] * step(k / 3), middle[1] * step(k % 3)];
                let next = cost(focals);
                if next < least {
                    (least, best) = (next, focals);
                }
            }
            if best == middle {
                ratio = ratio.sqrt();
            }
        }
        best
    }

    /// The map to a metric frame, given two focal lengths and the sign of the second camera's matrix, and what it costs.
    fn upgrade(&self, focals: [f64; 2], sign: f64) -> Option<(f64, Matrix4<f64>)> {
        let [first, second] = focals.map(|f| Matrix3::from_diagonal(&Vector3::new(f, f, 1.0)));
        let inverse = second.try_inverse()? * sign;
        let part: Matrix3<f64> = self.second.fixed_columns::<3>(0).into();
        let (turn, shift) = (inverse * part * first, inverse * self.second.column(3));
        let length = shift.norm();
        // The turn that brings the shift onto the first axis: below, only multiples of it are unknown.
        let axis = UnitQuaternion::rotation_between(&shift, &Vector3::x())
            .unwrap_or_else(|| UnitQuaternion::from_scaled_axis(Vector3::y() * std::f64::consts::PI));
        let rows = axis.to_rotation_matrix() * turn;
        let [w1, w2, w3] = [0, 1, 2].map(|k| Vector3::from(rows.row(k).transpose()));
        let size = w3.norm();
        let plane = (w2.cross(&w3) / size - w1) / length;
        let mut map = Matrix4::identity();
        map.fixed_view_mut::<3, 3>(0, 0).copy_from(&first);
        map.fixed_view_mut::<1, 3>(3, 0).copy_from(&plane.transpose());
        let cost = self.cameras.iter().map(|camera| flaw(&(camera * map))).sum::<f64>();
        (cost / self.cameras.len() as f64).is_finite().then_some((cost / self.cameras.len() as f64, map))
    }
}

/// Cells of the grid that are refined.
const KEPT: usize = 4;
/// Steps of the refinement; each halves the cell, or moves it.
const REFINEMENTS: usize = 24;

/// The map H with P H = [I | 0].
fn canonical(camera: &Matrix3x4<f64>) -> Option<Matrix4<f64>> {
    // The camera's own null vector, its centre, becomes the fourth axis.
    let normal = camera.transpose() * camera;
    let eigen = normal.symmetric_eigen();
    let centre = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into_owned();
    let mut full = Matrix4::zeros();
    full.fixed_rows_mut::<3>(0).copy_from(camera);
    full.fixed_rows_mut::<1>(3).copy_from(&centre.transpose());
    full.try_inverse()
}

/// How far a camera's image of the absolute conic is from that of square pixels with the principal point at the origin: skew and
/// aspect as ratios, the principal point as a share of the focal length.
fn flaw(camera: &Matrix3x4<f64>) -> f64 {
    let part: Matrix3<f64> = camera.fixed_columns::<3>(0).into();
    let conic = part * part.transpose();
    let conic = conic / conic[(2, 2)];
    let squared = 0.5 * (conic[(0, 0)] + conic[(1, 1)]);
    let skew = conic[(0, 1)] / squared;
    let aspect = 0.5 * (conic[(0, 0)] - conic[(1, 1)]) / squared;
    let centre = conic.fixed_view::<2, 1>(0, 2).norm_squared() / squared;
    skew * skew + aspect * aspect + centre
}

/// Focal lengths, poses and points of a metric frame; none where a camera is none.
fn read_off(scene: &Projective) -> Option<Metric> {
    let mut cameras = Vec::new();
    for camera in &scene.cameras {
        let camera = (*camera)?;
        let part: Matrix3<f64> = camera.fixed_columns::<3>(0).into();
        let sign = part.determinant().signum();
        let (part, shift) = (part * sign, camera.column(3) * sign);
        let conic = part * part.transpose();
        let depth = conic[(2, 2)].sqrt();
        let squared = 0.5 * (conic[(0, 0)] + conic[(1, 1)]) / conic[(2, 2)];
        let centre = conic.fixed_view::<2, 1>(0, 2).norm_squared() / conic[(2, 2)].powi(2);
        let focal = (squared - 0.5 * centre).max(1e-6).sqrt();
        let inverse = Matrix3::from_diagonal(&Vector3::new(1.0 / focal, 1.0 / focal, 1.0)) / depth;
        let svd = (inverse * part).svd_unordered(true, true);
        let turn = Rotation3::from_matrix_unchecked(svd.u? * svd.v_t?);
        let pose =
            Isometry3::from_parts((inverse * shift).into(), UnitQuaternion::from_rotation_matrix(&turn));
        cameras.push((focal, pose));
    }
    let point = |point: &nalgebra::Vector4<f64>| Point3::from(point.xyz() / point.w);
    let points: Vec<Option<Point3<f64>>> = scene.points.iter().map(|p| p.as_ref().map(point)).collect();
    Some(Metric { cameras, points })
}

/// A reconstruction is known up to a reflection through the origin: the one with the points before most cameras.
///
/// # Errors
/// The cameras that most points lie behind even so.
fn facing(mut metric: Metric) -> Result<Metric, Vec<usize>> {
    let shares: Vec<f64> =
        metric.cameras.iter().map(|(_, pose)| share_before(pose, &metric.points)).collect();
    let is_reflected = shares.iter().sum::<f64>() < 0.5 * shares.len() as f64;
    if is_reflected {
        metric.cameras.iter_mut().for_each(|(_, pose)| pose.translation.vector.neg_mut());
        metric.points.iter_mut().flatten().for_each(|point| point.coords.neg_mut());
    }
    let before = |share: f64| if is_reflected { 1.0 - share } else { share };
    let behind: Vec<usize> = (0..shares.len()).filter(|&c| before(shares[c]) < LEAST_BEFORE).collect();
    if behind.is_empty() { Ok(metric) } else { Err(behind) }
}

fn share_before(pose: &Isometry3<f64>, points: &[Option<Point3<f64>>]) -> f64 {
    let (mut before, mut all) = (0, 0);
    for point in points.iter().flatten() {
        before += usize::from((pose * point).z > 0.0);
        all += 1;
    }
    f64::from(before as u32) / f64::from(all.max(1) as u32)
}

/// Share of the points that must lie before each camera.
const LEAST_BEFORE: f64 = 0.9;

impl Metric {
    /// Whether two reconstructions have nearly the same focal lengths.
    fn is_like(&self, other: &Self) -> bool {
        self.cameras.iter().zip(&other.cameras).all(|((a, _), (b, _))| (a / b).ln().abs() < 0.05)
    }
}
