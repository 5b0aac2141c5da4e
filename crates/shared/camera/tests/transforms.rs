//! Fits find what was planted; projections land where geometry says.

use camera::{AlignError, Pinhole, fit_rigid, fit_similarity};
use nalgebra::{Isometry3, Point3, Similarity3, Translation3, UnitQuaternion, Vector2, Vector3};
use proptest::prelude::*;

fn points() -> impl Strategy<Value = Vec<Point3<f64>>> {
    prop::collection::vec(prop::array::uniform3(-100.0..100.0f64).prop_map(Point3::from), 4..20)
}

fn motion() -> impl Strategy<Value = Isometry3<f64>> {
    (prop::array::uniform3(-3.0..3.0f64), prop::array::uniform3(-500.0..500.0f64)).prop_map(
        |(turn, shift)| {
            Isometry3::from_parts(
                Translation3::from(Vector3::from(shift)),
                UnitQuaternion::new(Vector3::from(turn)),
            )
        },
    )
}

proptest! {
    #[test]
    fn rigid_motions_are_recovered(source in points(), planted in motion()) {
        let target: Vec<Point3<f64>> = source.iter().map(|point| planted * point).collect();
        let found = fit_rigid(&source, &target, None).unwrap();
        prop_assert!(source.iter().zip(&target).all(|(from, to)| (found * from - to).norm() < 1e-8));
        prop_assert!((found.rotation.to_rotation_matrix().matrix().determinant() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn similarities_are_recovered(source in points(), planted in motion(), scale in 0.01..100.0f64) {
        let planted = Similarity3::from_isometry(planted, scale);
        let target: Vec<Point3<f64>> = source.iter().map(|point| planted * point).collect();
        let found = fit_similarity(&source, &target, None).unwrap();
        prop_assert!((found.scaling() / scale - 1.0).abs() < 1e-9);
        prop_assert!(source.iter().zip(&target).all(|(from, to)| (found * from - to).norm() < 1e-6 * scale.max(1.0)));
    }

    /// No other motion fits noisy points better.
    #[test]
    fn the_fit_is_a_minimum(source in points(), planted in motion(), noise in prop::collection::vec(-1.0..1.0f64, 60), nudge in motion()) {
        let noisy = |(i, point): (usize, &Point3<f64>)| planted * point + Vector3::new(noise[i % 20], noise[i % 20 + 20], noise[i % 20 + 40]);
        let target: Vec<Point3<f64>> = source.iter().enumerate().map(noisy).collect();
        let found = fit_rigid(&source, &target, None).unwrap();
        let cost = |motion: &Isometry3<f64>| -> f64 { source.iter().zip(&target).map(|(from, to)| (motion * from - to).norm_squared()).sum() };
        let other = Isometry3::identity().lerp_slerp(&nudge, 0.01) * found;
        prop_assert!(cost(&found) <= cost(&other) + 1e-9);
    }

    /// A point without weight has no say.
    #[test]
    fn weights_leave_points_out(source in points(), planted in motion()) {
        let mut target: Vec<Point3<f64>> = source.iter().map(|point| planted * point).collect();
        target[0] += Vector3::new(900.0, 0.0, 0.0);
        let mut weights = vec![1.0; source.len()];
        weights[0] = 0.0;
        if let Ok(found) = fit_rigid(&source, &target, Some(&weights)) {
            prop_assert!(source[1..].iter().zip(&target[1..]).all(|(from, to)| (found * from - to).norm() < 1e-6));
        }
    }
}

#[test]
fn too_little_is_refused() {
    let line = [[0., 0., 0.], [1., 1., 1.], [2., 2., 2.], [5., 5., 5.]].map(Point3::from);
    assert_eq!(fit_rigid(&line, &line, None), Err(AlignError::Collinear));
    assert_eq!(fit_rigid(&line[..2], &line[..2], None), Err(AlignError::TooFew(2)));
}

/// A mirrored target has no rigid fit that meets it; the best rotation is still a rotation.
#[test]
fn mirrors_are_not_taken_for_rotations() {
    let source = [[1., 0., 0.], [0., 2., 0.], [0., 0., 3.], [0., 0., 0.]].map(Point3::from);
    let target = source.map(|point| Point3::new(-point.x, point.y, point.z));
    let found = fit_rigid(&source, &target, None).unwrap();
    assert!((found.rotation.to_rotation_matrix().matrix().determinant() - 1.0).abs() < 1e-12);
}

/// Camera axes: x right, y down, z forward; the target lands on the principal point.
#[test]
fn pinholes_look_where_they_are_told() {
    let camera = Pinhole::looking_at(
        Point3::new(0.0, 0.0, 500.0),
        Point3::origin(),
        Vector3::y(),
        1000.0,
        Vector2::new(320.0, 240.0),
    );
    let close = |(pixel, depth): (Vector2<f64>, f64), x: f64, y: f64, z: f64| {
        assert!((pixel - Vector2::new(x, y)).norm() < 1e-9 && (depth - z).abs() < 1e-9, "{pixel} {depth}");
    };
    close(camera.project(&Point3::origin()), 320.0, 240.0, 500.0);
    close(camera.project(&Point3::new(50.0, 0.0, 0.0)), 420.0, 240.0, 500.0);
    close(camera.project(&Point3::new(0.0, 50.0, 100.0)), 320.0, 115.0, 400.0);
    assert!(camera.project(&Point3::new(0.0, 0.0, 600.0)).1 < 0.0, "behind");
}
