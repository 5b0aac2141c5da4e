//! What a picture of a plane tells: homography, focal length, pose [Zhang2000].

use nalgebra::{
    DMatrix, Isometry3, Matrix2, Matrix3, Point2, Point3, Rotation3, UnitQuaternion, Vector2, Vector3,
};

/// The homography that carries points of a plane to their images, by the direct linear transformation on centred and scaled
/// points [HartleyZisserman2004, Alg. 4.2]; none from fewer than four points or points in a line.
pub(crate) fn homography(plane: &[Point2<f64>], image: &[Point2<f64>]) -> Option<Matrix3<f64>> {
    if plane.len() < 4 {
        return None;
    }
    let (from, to) = (normaliser(plane)?, normaliser(image)?);
    let mut rows = DMatrix::zeros(2 * plane.len(), 9);
    for (i, (p, q)) in plane.iter().zip(image).enumerate() {
        let (p, q) = (from * p.to_homogeneous(), to * q.to_homogeneous());
        for column in 0..3 {
            rows[(2 * i, column)] = p[column];
            rows[(2 * i, 6 + column)] = -q.x * p[column];
            rows[(2 * i + 1, 3 + column)] = p[column];
            rows[(2 * i + 1, 6 + column)] = -q.y * p[column];
        }
    }
    let eigen = (rows.transpose() * rows).symmetric_eigen();
    let smallest = eigen.eigenvalues.imin();
    let mut values = eigen.eigenvalues.as_slice().to_vec();
    values.sort_by(f64::total_cmp);
    if values[1] <= 1e-12 * values[8] {
        return None;
    }
    let h = Matrix3::from_row_slice(eigen.eigenvectors.column(smallest).as_slice());
    Some(to.try_inverse()? * h * from)
}

/// Moves the points' middle to the origin and makes their mean distance from it √2; none where they lie in a line.
fn normaliser(points: &[Point2<f64>]) -> Option<Matrix3<f64>> {
    let count = points.len() as f64;
    let middle = points.iter().map(|point| point.coords).sum::<Vector2<f64>>() / count;
    let spread: Matrix2<f64> =
        points.iter().map(|p| (p.coords - middle) * (p.coords - middle).transpose()).sum();
    let widths = spread.symmetric_eigenvalues();
    if widths.min() <= 1e-9 * widths.max() {
        return None;
    }
    let scale = (2.0 * count / spread.trace()).sqrt();
    Some(Matrix3::new(scale, 0.0, -scale * middle.x, 0.0, scale, -scale * middle.y, 0.0, 0.0, 1.0))
}

/// The focal length that makes the images of the plane's axes perpendicular and equally long [Zhang2000, Eq. 3–4], with square
/// pixels and a known principal point; none where the views do not tell (the plane was always parallel to the image).
pub(crate) fn focal_px(homographies: &[Matrix3<f64>], center: Vector2<f64>) -> Option<f64> {
    let centred = Matrix3::new(1.0, 0.0, -center.x, 0.0, 1.0, -center.y, 0.0, 0.0, 1.0);
    // With ω = diag(w, w, 1), w = 1 / f²: a w + b = 0 for each of both demands.
    let (mut aa, mut ab) = (0.0, 0.0);
    for homography in homographies {
        let h = centred * homography;
        let (mut u, mut v): (Vector3<f64>, Vector3<f64>) = (h.column(0).into(), h.column(1).into());
        let size = (u.xy().norm_squared() + v.xy().norm_squared()).sqrt();
        u /= size;
        v /= size;
        let demands = [
            (u.xy().dot(&v.xy()), u.z * v.z),
            (u.xy().norm_squared() - v.xy().norm_squared(), u.z * u.z - v.z * v.z),
        ];
        for (a, b) in demands {
            aa += b * b;
            ab -= a * b;
        }
    }
    // Least squares in f²: b f² = −a, so that views without perspective have no say.
    let squared = ab / aa;
    (squared.is_finite() && squared > 0.0).then(|| squared.sqrt())
}

/// The pose of a plane from its homography to the *normalised* image [Zhang2000, § 3.1]; none where the plane passes through
/// the camera.
pub(crate) fn pose(homography: &Matrix3<f64>) -> Option<Isometry3<f64>> {
    let size = (homography.column(0).norm() * homography.column(1).norm()).sqrt();
    let h = homography * (homography[(2, 2)].signum() / size);
    let (u, v, shift): (Vector3<f64>, Vector3<f64>, Vector3<f64>) =
        (h.column(0).into(), h.column(1).into(), h.column(2).into());
    let svd = Matrix3::from_columns(&[u, v, u.cross(&v)]).svd(true, true);
    let rotation = svd.u? * svd.v_t?;
    let is_sound = shift.z > 0.0 && shift.iter().all(|x| x.is_finite()) && rotation.determinant() > 0.0;
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation));
    is_sound.then(|| Isometry3::from_parts(shift.into(), rotation))
}

/// The other pose that shows nearly the same picture: without much perspective a plane that leans towards the camera looks
/// like one that leans away. The plane mirrored at the line of sight through `middle`.
pub(crate) fn reversed(cam_from_board: &Isometry3<f64>, middle: &Point3<f64>) -> Isometry3<f64> {
    let place = (cam_from_board * middle).coords;
    let sight = nalgebra::Unit::new_normalize(place);
    let half = std::f64::consts::PI;
    let rotation = UnitQuaternion::from_axis_angle(&sight, half)
        * cam_from_board.rotation
        * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), half);
    Isometry3::from_parts((place - rotation * middle.coords).into(), rotation)
}
