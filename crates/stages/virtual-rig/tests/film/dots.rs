//! Dots stand where the truth says.

use crate::scene::{Thing, mocap, ruler, shot};
use camera::{BrownConrady, Camera};
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use testkit::shapes;
use virtual_rig::film::Exposure;
use virtual_rig::paint::{Dot, Layers, Outline};

/// A ball as large as a head with dots of 2 to 4 mm on its front, out of round, none over another.
pub(crate) fn dotted_ball(random: &mut ChaCha8Rng) -> (Thing, Layers) {
    let ball = Thing::of(&shapes::sphere(80.0, 90));
    let front: Vec<u32> = (0..ball.triangles.len() as u32)
        .filter(|&index| ball.normals[ball.triangles[index as usize][0] as usize].z > 0.25)
        .collect();
    let mut dots: Vec<Dot> = Vec::new();
    while dots.len() < 60 {
        let triangle = front[random.random_range(0..front.len())];
        let [second, third] = [0, 1].map(|_| random.random_range(0.0..0.5));
        let outline = Outline::out_of_round(random.random_range(1.0..2.0), 0.15, dots.len() as u64);
        let dot = ball.dot((triangle, [1.0 - second - third, second, third]), outline);
        if dots.iter().all(|other| (other.center - dot.center).norm() > 5.0) {
            dots.push(dot);
        }
    }
    let layers = ball.paint(dots, vec![]);
    (ball, layers)
}

/// Centroid and area of a layer's paint in an image.
pub(crate) fn paint_in(exposure: &Exposure, layer: u32) -> (Vector2<f64>, f64) {
    let mut area = 0.0;
    let mut moment = Vector2::zeros();
    let width = exposure.size[0];
    for cover in exposure.covers.iter().filter(|cover| cover.layer == layer) {
        let share = f64::from(cover.share);
        area += share;
        let pixel = [cover.pixel % width, cover.pixel / width];
        let place = [0, 1].map(|axis| f64::from(pixel[axis]) + f64::from(cover.offset_px[axis]));
        moment += share * Vector2::from(place);
    }
    (moment / area, area)
}

/// Errors of the dots that a camera sees well: distances in px; and the painted area over the true one.
fn errors(camera: &Camera, thing: &Thing, layers: &Layers) -> (Vec<f64>, [f64; 2]) {
    let exposure = shot(camera, thing, layers, &[]);
    let middle = thing.solid().moment.mean();
    let (mut off, mut areas) = (Vec::new(), [0.0; 2]);
    for (dot, samples) in layers.dot_samples().iter().enumerate() {
        let view = samples.view(&middle, camera, |_, _| true);
        if view.angle_rad < 70_f64.to_radians() && view.share_seen == 1.0 {
            let (center, area) = paint_in(&exposure, layers.layer_of_dot(dot));
            off.push((center - view.centroid_px.unwrap()).norm());
            areas = [areas[0] + area, areas[1] + view.area_px];
        }
    }
    (off, areas)
}

fn assert_close_to_truth(name: &str, off: &[f64], areas: [f64; 2]) {
    let rms = (off.iter().map(|x| x * x).sum::<f64>() / off.len() as f64).sqrt();
    let worst = off.iter().copied().fold(0.0, f64::max);
    let area = areas[0] / areas[1];
    println!("{name}: {} dots, off {rms:.4} px RMS, {worst:.4} at most, area × {area:.5}", off.len());
    assert!(worst <= 0.02, "{name}: {worst} px");
    assert!((area - 1.0).abs() < 0.005, "{name}: area × {area}");
}

#[test]
fn dots_are_where_the_truth_says() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let (mut off, mut areas) = (Vec::new(), [0.0; 2]);
    for _ in 0..6 {
        let (ball, layers) = dotted_ball(&mut random);
        let (new, [seen, true_one]) = errors(&mocap(&mut random), &ball, &layers);
        off.extend(new);
        areas = [areas[0] + seen, areas[1] + true_one];
    }
    assert!(off.len() >= 200);
    assert_close_to_truth("still", &off, areas);
}

#[test]
fn motion_puts_dots_where_they_are_at_mid_exposure() {
    let mut random = ChaCha8Rng::seed_from_u64(12);
    let (ball, layers) = dotted_ball(&mut random);
    let ball = ball.moving(Vector3::new(0.5, -0.3, 0.2));
    let (off, areas) = errors(&mocap(&mut random), &ball, &layers);
    assert!(off.len() >= 30);
    assert_close_to_truth("moving by 1.3 px", &off, areas);
}

#[test]
fn perspective_bends_no_paint_on_a_large_triangle() {
    let mut plate = Thing::plate([-60.0, 60.0], [-60.0, 60.0], 0.0);
    let layers = plate.paint(vec![plate.dot((0, [0.3, 0.5, 0.2]), Outline::round(2.0))], vec![]);
    let tilt = Isometry3::rotation(Vector3::new(0.9, 0.5, 0.0));
    plate.open.iter_mut().for_each(|point| *point = tilt * *point);
    let mut camera = mocap(&mut ChaCha8Rng::seed_from_u64(3));
    camera.lens.distortion = BrownConrady::default();
    let near = Point3::new(0.0, 0.0, 160.0);
    camera.cam_from_world = Camera::pose_looking_at(near, Point3::origin(), Vector3::y());
    camera.lens.focal_px = Vector2::repeat(400.0);
    let (off, areas) = errors(&camera, &plate, &layers);
    assert_eq!(off.len(), 1);
    assert_close_to_truth("on a large triangle", &off, areas);
}

#[test]
fn the_truth_of_a_dot_on_a_plane_is_the_projection_of_its_outline() {
    let grid = Thing::of(&shapes::grid(20, 1.0));
    let outline = Outline::out_of_round(2.0, 0.15, 4);
    let layers = grid.paint(vec![grid.dot_near(Point3::new(10.0, 10.0, 0.0), outline)], vec![]);
    let dot = &layers.dots()[0];
    let mut camera = ruler();
    camera.lens.focal_px = Vector2::repeat(4000.0);
    camera.lens.center_px = Vector2::zeros();
    camera.image_size = [200, 200];
    camera.cam_from_world.translation.vector.y += 20.0;
    let view = layers.dot_samples()[0].view(&grid.open, &camera, |_, _| true);
    // Green's theorem on the outline in space; the plane is parallel to the image, so one scale serves all.
    let steps = 20_000;
    let point = |step: i32| {
        let angle = std::f64::consts::TAU * f64::from(step) / f64::from(steps);
        outline.radius(angle) * Vector2::new(angle.cos(), angle.sin())
    };
    let (mut area, mut moment) = (0.0, Vector2::zeros());
    for step in 0..steps {
        let (p, q) = (point(step), point(step + 1));
        area += 0.5 * p.perp(&q);
        moment += 0.5 * p.perp(&q) * (p + q) / 3.0;
    }
    let center = dot.center + Vector3::new(moment.x / area, moment.y / area, 0.0);
    assert!((view.center_in_world - center).norm() < 2e-3, "{}", (view.center_in_world - center).norm());
    assert!((view.area_mm2 / area - 1.0).abs() < 2e-3 && (view.area_px / (16.0 * area) - 1.0).abs() < 2e-3);
    assert!((view.centroid_px.unwrap() - camera.project(&center).unwrap()).norm() < 8e-3);
    let toward = camera.eye_in_world() - center;
    assert!((view.angle_rad - toward.angle(&Vector3::z())).abs() < 1e-5 && view.share_seen == 1.0);
}

#[test]
fn hidden_halves_are_left_out_of_the_truth() {
    let grid = Thing::of(&shapes::grid(20, 1.0));
    let layers = grid.paint(vec![grid.dot_near(Point3::new(10.0, 10.0, 0.0), Outline::round(2.0))], vec![]);
    let center = layers.dots()[0].center;
    let camera = Camera { image_size: [200, 200], ..ruler() };
    let left_half = |point: &Point3<f64>, _: Vector2<f64>| point.x < center.x;
    let view = layers.dot_samples()[0].view(&grid.open, &camera, left_half);
    assert!((view.share_seen - 0.5).abs() < 0.02);
    // The centroid of half a disc lies 4 r / 3 π from its middle.
    let expected = camera.project(&(center - Vector3::x() * 8.0 / (3.0 * std::f64::consts::PI))).unwrap();
    assert!((view.centroid_px.unwrap() - expected).norm() < 0.03);
    let nothing = layers.dot_samples()[0].view(&grid.open, &camera, |_, _| false);
    assert!(nothing.centroid_px.is_none() && nothing.share_seen == 0.0);
    let back = Camera {
        cam_from_world: Camera::pose_looking_at(
            Point3::new(10.0, 10.0, -900.0),
            Point3::new(10.0, 10.0, 0.0),
            Vector3::y(),
        ),
        ..camera
    };
    assert_eq!(layers.dot_samples()[0].view(&grid.open, &back, |_, _| true).share_seen, 0.0);
}
