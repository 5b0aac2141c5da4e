//! Points from their images.

use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Point3, Vector2, Vector3};
use proptest::prelude::*;

fn camera(eye: [f64; 3]) -> Camera {
    Camera {
        image_size: [656, 490],
        lens: Lens {
            focal_px: Vector2::new(1100.0, 1105.0),
            center_px: Vector2::new(330.0, 240.0),
            distortion: BrownConrady { k1: -0.2, k2: 0.1, p1: 1e-3, p2: -5e-4, k3: 0.0 },
        },
        cam_from_world: Camera::pose_looking_at(eye.into(), Point3::origin(), Vector3::y()),
    }
}

proptest! {
    #[test]
    fn a_projected_point_comes_back(x in -80.0..80.0, y in -80.0..80.0, z in -60.0..60.0) {
        let point = Point3::new(x, y, z);
        let cameras = [[400.0, 0.0, 500.0], [0.0, 100.0, 600.0], [-400.0, 50.0, 480.0]].map(camera);
        let views = cameras.iter().map(|camera| (camera, camera.project(&point).unwrap()));
        let found = Camera::nearest_to_rays(views).unwrap();
        prop_assert!((found - point).norm() < 1e-6);
    }
}

#[test]
fn one_ray_parallel_rays_and_points_behind_give_none() {
    let left = camera([-200.0, 0.0, 500.0]);
    let center = left.lens.center_px;
    assert_eq!(Camera::nearest_to_rays([(&left, center)]), None);
    let mut shifted = left.clone();
    shifted.cam_from_world.translation.vector.x += 100.0;
    assert_eq!(Camera::nearest_to_rays([(&left, center), (&shifted, center)]), None);
    // The shifted camera looks past the left one's axis on the far side: the rays meet behind both.
    let crossing = [(&left, center), (&shifted, center - Vector2::new(50.0, 0.0))];
    let ahead = [(&left, center), (&shifted, center + Vector2::new(50.0, 0.0))];
    assert_ne!(Camera::nearest_to_rays(crossing).is_some(), Camera::nearest_to_rays(ahead).is_some());
}
