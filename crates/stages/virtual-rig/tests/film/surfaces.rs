//! What hides what, and how edges look.

use crate::scene::{Thing, mocap, ruler, shot};
use camera::Camera;
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use testkit::shapes;

#[test]
fn an_edge_covers_its_share_of_a_pixel() {
    for (edge, share) in [(0.0, 0.5), (0.25, 0.75), (-0.375, 0.125), (0.5, 1.0), (-0.5, 0.0)] {
        let plate = Thing::plate([-30.0, edge], [-30.0, 30.0], 0.0);
        let exposure = shot(&ruler(), &plate, &plate.unpainted(), &[]);
        for row in [0, 15, 30] {
            let light = |column: usize| exposure.radiance[41 * row + column][1];
            let off = [light(19) - 1.0, light(20) - share, light(21)];
            assert!(off.iter().all(|x| x.abs() < 1e-6), "edge at {edge}: {off:?}");
        }
    }
}

#[test]
fn nothing_shines_through_a_closed_surface() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let ball = Thing::of(&shapes::sphere(80.0, 150));
    for _ in 0..3 {
        let camera = mocap(&mut random);
        let exposure = shot(&camera, &ball, &ball.unpainted(), &[]);
        let center = camera.project(&Point3::origin()).unwrap();
        let inner = |pixel: usize| {
            let place = Vector2::new((pixel % 656) as f64, (pixel / 656) as f64);
            (place - center).norm() < 120.0
        };
        let lights = exposure.radiance.iter().enumerate().filter(|(pixel, _)| inner(*pixel));
        assert!(lights.into_iter().all(|(_, light)| (light[0] - 1.0).abs() < 1e-4));
    }
}

#[test]
fn the_nearer_surface_hides_the_farther_whichever_comes_first() {
    let near = Thing::plate([-5.0, 5.0], [-5.0, 5.0], 100.0).colored([1.0, 0.0, 0.0]);
    let far = Thing::plate([-30.0, 30.0], [-30.0, 30.0], -50.0).colored([0.0, 1.0, 0.0]);
    let one = shot(&ruler(), &near, &near.unpainted(), &[&far]);
    let other = shot(&ruler(), &far, &far.unpainted(), &[&near]);
    assert_eq!(one, other);
    let [center, corner] = [15 * 41 + 20, 0].map(|pixel| (one.radiance[pixel], one.depth_mm[pixel]));
    assert!((center.1 - 900.0).abs() < 1e-2 && (corner.1 - 1050.0).abs() < 1e-2);
    let is = |light: [f32; 3], color: [f32; 3]| light.iter().zip(color).all(|(x, y)| (x - y).abs() < 1e-6);
    assert!(is(center.0, [1.0, 0.0, 0.0]) && is(corner.0, [0.0, 1.0, 0.0]));
    let camera = ruler();
    let sees = one.sees(&camera, 1.0);
    let asked = |x: f64, z: f64| {
        let point = Point3::new(x, 0.0, z);
        sees(&point, ruler().project(&point).unwrap())
    };
    assert!(asked(0.0, 100.0) && !asked(0.0, -50.0) && asked(15.0, -50.0));
}

#[test]
fn slanted_surfaces_have_their_depth() {
    let mut plate = Thing::plate([-60.0, 60.0], [-60.0, 60.0], 0.0);
    let tilt = Isometry3::rotation(Vector3::new(0.0, 1.0, 0.0));
    plate.open.iter_mut().for_each(|point| *point = tilt * *point);
    let exposure = shot(&ruler(), &plate, &plate.unpainted(), &[]);
    for column in [0, 10, 20, 33, 40] {
        // Where the ray of the column meets z = −x tan(1).
        let slope = (column as f64 - 20.0) / 1000.0;
        let depth = 1000.0 / (1.0 - slope * 1_f64.tan());
        let nearest = f64::from(exposure.depth_mm[15 * 41 + column]);
        // The nearest sample lies up to 7/32 px off the centre.
        let step = depth * depth / 1000.0 * 1_f64.tan() * 7.1 / 32_000.0;
        assert!(
            nearest <= depth + 0.01 && nearest >= depth - step - 0.01,
            "column {column}: {nearest} {depth}"
        );
    }
}

#[test]
fn backs_are_dark_and_nothing_is_drawn_behind_the_camera() {
    let plate = Thing::plate([-30.0, 30.0], [-30.0, 30.0], 0.0);
    let mut camera = ruler();
    let behind = Point3::new(0.0, 0.0, -1000.0);
    camera.cam_from_world = Camera::pose_looking_at(behind, Point3::origin(), Vector3::y());
    let exposure = shot(&camera, &plate, &plate.unpainted(), &[]);
    assert!(exposure.radiance.iter().all(|light| (light[0] - 0.03).abs() < 1e-5));
    camera.cam_from_world = Camera::pose_looking_at(behind, 2.0 * behind, Vector3::y());
    let exposure = shot(&camera, &plate, &plate.unpainted(), &[]);
    assert!(exposure.radiance.iter().all(|light| *light == [0.0; 3]));
    assert!(exposure.depth_mm.iter().all(|depth| *depth == f32::INFINITY));
}

#[test]
fn motion_smears_an_edge_over_its_way() {
    let plate = Thing::plate([-30.0, -2.0], [-30.0, 30.0], 0.0).moving(Vector3::x() * 4.0);
    let exposure = shot(&ruler(), &plate, &plate.unpainted(), &[]);
    let light: Vec<f32> = (17..24).map(|column| exposure.radiance[15 * 41 + column][0]).collect();
    // At the middles of the quarters, the edge stands at −1.5, −0.5, 0.5 and 1.5.
    let expected = [1.0, 1.0, 0.75, 0.5, 0.25, 0.0, 0.0];
    assert!(light.iter().zip(expected).all(|(x, y): (&f32, f32)| (x - y).abs() < 1e-6), "{light:?}");
}
