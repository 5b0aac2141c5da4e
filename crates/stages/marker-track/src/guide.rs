//! What 3D markers of a first pass say about a camera's second one: where each marker is, and whether it can be seen.

use crate::tracker::Hint;
use artifact::{MeasuredFrame, SampleStatus};
use camera::Camera;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::{Matrix3, Point3, Vector3};
use std::num::NonZero;

/// Markers that a patch of skin is taken from, the marker itself included.
const PATCH: NonZero<usize> = NonZero::new(9).unwrap();
/// Skin turned further than this from the view is not looked for, cosine of the angle; dots are seen up to 70°, and a
/// patch of markers is flatter than the skin.
const LEAST_COSINE: f64 = 0.2;
/// So many other cameras place a marker without this one's help.
const OTHERS: usize = 2;
/// … if its place is known so well: as many standard deviations along its worst axis fit into the gate.
const DEVIATIONS: f64 = 2.0;

/// Per marker whether a guide says of a camera more than that camera said itself: it is measured, from two other cameras at
/// least, and to half of `gate_px` (standard deviation along its worst axis, seen from this camera). A guide that says nothing of
/// its accuracy is believed.
///
/// A marker that was placed on the ray of this one camera is where that saw it, right or wrong; one that a wrong view was measured from
/// has a large covariance, as its views disagree.
#[must_use]
pub fn bears_out(frame: &MeasuredFrame, id: &str, camera: &Camera, gate_px: f64) -> Vec<bool> {
    let is_borne_out = |marker: usize| {
        let Some(point) = frame.markers.points[marker] else { return false };
        let is_measured = frame.markers.status[marker] == SampleStatus::Measured;
        let Some(accuracy) = &frame.accuracy[marker] else { return is_measured };
        let [xx, xy, xz, yy, yz, zz] = accuracy.covariance_mm2;
        let variances = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz).symmetric_eigenvalues();
        let px_per_mm = camera.lens.focal_px.max() / (camera.cam_from_world * point).z.abs();
        let others = accuracy.views.iter().filter(|view| *view != id).count();
        is_measured
            && (accuracy.views.is_empty() || others >= OTHERS)
            && DEVIATIONS * variances.max().max(0.0).sqrt() * px_per_mm <= gate_px
    };
    (0..frame.markers.points.len()).map(is_borne_out).collect()
}

/// Per marker its place in a camera's image, and whether its skin faces the camera; none for one that is missing, behind the
/// camera or outside the image. `points`: world, mm.
///
/// The skin's direction at a marker is that of the plane through the markers nearest to it, outwards from the middle of all of
/// them; fewer than five markers are taken to face every camera.
#[must_use]
pub fn hints(points: &[Option<Point3<f64>>], camera: &Camera) -> Vec<Option<Hint>> {
    let there: Vec<[f64; 3]> = points.iter().flatten().map(|point| (*point).into()).collect();
    let tree = if there.len() < 5 { None } else { ImmutableKdTree::new_from_slice(&there).ok() };
    let sum: Vector3<f64> = points.iter().flatten().map(|point| point.coords).sum();
    let middle = Point3::from(sum / there.len().max(1) as f64);
    let hint = |point: &Point3<f64>| {
        let pixel = camera.project(point).filter(|pixel| camera.contains(*pixel))?;
        let normal = tree.as_ref().and_then(|tree| patch_normal(tree, &there, point, &middle));
        let view = (camera.eye_in_world() - point).normalize();
        let facing = normal.is_none_or(|normal| normal.dot(&view) > LEAST_COSINE);
        Some(Hint { at: pixel.into(), facing })
    };
    points.iter().map(|point| point.as_ref().and_then(hint)).collect()
}

fn patch_normal(
    tree: &ImmutableKdTree<f64, 3>,
    points: &[[f64; 3]],
    at: &Point3<f64>,
    middle: &Point3<f64>,
) -> Option<Vector3<f64>> {
    let near = tree.query(&(*at).into()).nearest_n::<SquaredEuclidean<f64>>(PATCH).execute();
    let near: Vec<Vector3<f64>> = near.iter().map(|hit| points[hit.item as usize].into()).collect();
    let mean = near.iter().sum::<Vector3<f64>>() / near.len() as f64;
    let spread: Matrix3<f64> = near.iter().map(|p| (p - mean) * (p - mean).transpose()).sum();
    let eigen = spread.symmetric_eigen();
    let normal: Vector3<f64> = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into();
    let outwards = normal.dot(&(at - middle));
    // A patch seen edge-on from the middle has no outside.
    (outwards.abs() > 1e-9).then(|| normal * outwards.signum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use camera::{BrownConrady, Lens};
    use nalgebra::Vector2;

    #[test]
    fn the_near_side_of_a_ball_faces_the_camera_and_the_far_side_does_not() {
        let ball: Vec<Option<Point3<f64>>> = (0..60)
            .map(|i| {
                let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / 60.0;
                let turn = f64::from(i) * 2.399_963;
                let r = (1.0 - z * z).sqrt();
                Some(Point3::new(80.0 * r * turn.cos(), 80.0 * r * turn.sin(), 80.0 * z))
            })
            .collect();
        let lens = Lens {
            focal_px: Vector2::repeat(800.0),
            center_px: Vector2::new(327.5, 244.5),
            distortion: BrownConrady::default(),
        };
        let eye = Point3::new(0.0, 0.0, 600.0);
        let pose = Camera::pose_looking_at(eye, Point3::origin(), Vector3::y());
        let camera = Camera { image_size: [656, 490], lens, cam_from_world: pose };
        for (hint, point) in hints(&ball, &camera).iter().zip(&ball) {
            let (hint, point) = (hint.unwrap(), point.unwrap());
            let cosine = point.coords.normalize().dot(&(eye - point).normalize());
            if cosine.abs() > 0.35 {
                assert_eq!(hint.facing, cosine > 0.0, "{point} {cosine}");
            }
            assert!((Vector2::from(hint.at) - camera.project(&point).unwrap()).norm() < 1e-9);
        }
    }
}
