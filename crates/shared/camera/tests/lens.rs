//! The lens: OpenCV's own numbers, and there and back.

use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use proptest::prelude::*;

const LENS: Lens = Lens {
    focal_px: Vector2::new(800.0, 790.0),
    center_px: Vector2::new(327.5, 244.5),
    distortion: BrownConrady { k1: -0.21, k2: 0.09, p1: 8e-4, p2: -5e-4, k3: -0.01 },
};

proptest! {
    #[test]
    fn unprojecting_undoes_projecting(x in -0.5..0.5f64, y in -0.4..0.4f64, z in 200.0..2000.0f64) {
        let pixel = LENS.project(Vector3::new(x, y, 1.0) * z);
        let back = LENS.unproject(pixel).unwrap();
        prop_assert!((back - Vector3::new(x, y, 1.0)).norm() < 1e-12);
    }

    #[test]
    fn the_jacobian_is_the_derivative(x in -0.5..0.5f64, y in -0.4..0.4f64) {
        let (at, h) = (Vector2::new(x, y), 1e-6);
        let slopes = LENS.distortion.jacobian(at);
        for axis in 0..2 {
            let mut step = Vector2::zeros();
            step[axis] = h;
            let difference = (LENS.distortion.distort(at + step) - LENS.distortion.distort(at - step)) / (2.0 * h);
            prop_assert!((slopes.column(axis) - difference).norm() < 1e-8);
        }
    }

    #[test]
    fn a_ray_meets_the_point_that_it_came_from(x in -80.0..80.0f64, y in -80.0..80.0f64, z in -60.0..60.0f64) {
        let eye = Point3::new(300.0, 200.0, 700.0);
        let camera = Camera {
            image_size: [656, 490],
            lens: LENS,
            cam_from_world: Camera::pose_looking_at(eye, Point3::origin(), Vector3::y()),
        };
        let point = Point3::new(x, y, z);
        let ray = camera.ray_in_world(camera.project(&point).unwrap()).unwrap();
        prop_assert!((camera.eye_in_world() - eye).norm() < 1e-9);
        prop_assert!((point - eye).cross(&ray).norm() < 1e-8);
        prop_assert!((point - eye).dot(&ray) > 0.0);
    }
}

/// OpenCV 5.0, `projectPoints` of (60, −45, 500) before a camera at the origin.
#[test]
fn opencv_projects_to_the_same_pixel() {
    let pixel = LENS.project(Vector3::new(60.0, -45.0, 500.0));
    assert!((pixel - OPENCV_PIXEL).norm() < 1e-9, "{pixel}");
}

const OPENCV_PIXEL: Vector2<f64> = Vector2::new(423.016_419_065_000_04, 173.765_706_504_984_4);

#[test]
fn a_folded_lens_gives_no_ray() {
    let folded = BrownConrady { k1: -0.5, ..BrownConrady::default() };
    // x (1 − x²/2) never exceeds 0.544.
    assert_eq!(folded.undistort(Vector2::new(0.6, 0.0)), None);
    assert!(folded.undistort(Vector2::new(0.5, 0.0)).is_some());
}

#[test]
fn nothing_is_seen_behind_the_camera() {
    let camera = Camera { image_size: [4, 3], lens: LENS, cam_from_world: Isometry3::identity() };
    assert_eq!(camera.project(&Point3::new(0.0, 0.0, -1.0)), None);
}

#[test]
fn an_image_ends_half_a_pixel_beyond_its_outer_centres() {
    let camera = Camera { image_size: [4, 3], lens: LENS, cam_from_world: Isometry3::identity() };
    let inside = [(-0.5, 0.0), (3.49, 2.49)].map(|(x, y)| camera.contains(Vector2::new(x, y)));
    let outside = [(-0.51, 0.0), (3.5, 0.0), (0.0, 2.5)].map(|(x, y)| camera.contains(Vector2::new(x, y)));
    assert_eq!((inside, outside), ([true; 2], [false; 3]));
}
