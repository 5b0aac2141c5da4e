//! Laws of the bundle adjustment.
#![allow(clippy::unwrap_used, reason = "a scene that cannot be made is a broken test")]

use calibrate::bundle::{Element, Focal, Free, Loss, Observation, Params, Scene, adjust};
use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

const LENS: Lens = Lens {
    focal_px: Vector2::new(1450.0, 1440.0),
    center_px: Vector2::new(330.0, 240.0),
    distortion: BrownConrady { k1: -0.12, k2: 0.08, p1: 3e-4, p2: -2e-4, k3: 0.0 },
};
const MODEL: Free =
    Free { pose: true, focal: Focal::Free, center: true, distortion: [true, true, true, true, false] };

fn ring(count: usize) -> Vec<Camera> {
    let camera = |i: usize| {
        let angle = -0.6 + 1.2 * i as f64 / (count - 1) as f64;
        let eye = Point3::new(1500.0 * angle.sin(), 150.0 * (i as f64).sin(), 1500.0 * angle.cos());
        let cam_from_world = Camera::pose_looking_at(eye, Point3::origin(), Vector3::y());
        Camera { image_size: [656, 490], lens: LENS, cam_from_world }
    };
    (0..count).map(camera).collect()
}

fn noise(rng: &mut ChaCha8Rng) -> Vector2<f64> {
    // Twelve uniform numbers make a good normal one.
    let mut normal = || (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0;
    Vector2::new(normal(), normal())
}

fn random_motion(rng: &mut ChaCha8Rng, turn: f64, shift: f64) -> Isometry3<f64> {
    let mut vector = |size: f64| Vector3::from_fn(|_, _| size * (2.0 * rng.random::<f64>() - 1.0));
    Isometry3::new(vector(shift), vector(turn))
}

/// Boards before a ring of cameras, seen with noise; the scene holds the truth.
fn boards(seed: u64, noise_px: f64) -> Scene {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut scene = Scene::new(ring(4), vec![MODEL; 4]);
    let corner = |i: usize| Point3::new(16.0 * (i % 8) as f64 - 56.0, 16.0 * (i / 8) as f64 - 40.0, 0.0);
    scene.body = (0..48).map(corner).collect();
    for element in 0..15 {
        let world_from_body = random_motion(&mut rng, 0.6, 60.0);
        scene.structure.push(Element::Body { world_from_body });
        for camera in 0..4 {
            for point in 0..48 {
                let at = scene.cameras[camera].project(&(world_from_body * scene.body[point])).unwrap();
                let pixel = at + noise_px * noise(&mut rng);
                scene.observations.push(Observation { camera, element, point, pixel });
            }
        }
    }
    scene
}

fn points(seed: u64, noise_px: f64) -> Scene {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut scene = Scene::new(ring(4), vec![Free { focal: Focal::Tied, ..Free::POSE }; 4]);
    for element in 0..80 {
        let point = random_motion(&mut rng, 0.0, 150.0) * Point3::origin();
        scene.structure.push(Element::Point(point));
        for camera in 0..4 {
            let pixel = scene.cameras[camera].project(&point).unwrap() + noise_px * noise(&mut rng);
            scene.observations.push(Observation { camera, element, point: 0, pixel });
        }
    }
    scene
}

fn shaken(mut scene: Scene, seed: u64) -> Scene {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    for (camera, free) in scene.cameras.iter_mut().zip(&scene.free) {
        camera.cam_from_world = random_motion(&mut rng, 0.01, 8.0) * camera.cam_from_world;
        if free.focal != Focal::Held {
            camera.lens.focal_px *= 1.0 + 0.02 * rng.random::<f64>();
        }
        if free.distortion[0] {
            camera.lens.distortion = BrownConrady::default();
        }
    }
    for element in &mut scene.structure {
        match element {
            Element::Point(point) => *point = random_motion(&mut rng, 0.0, 5.0) * *point,
            Element::Body { world_from_body } => *world_from_body *= random_motion(&mut rng, 0.03, 5.0),
        }
    }
    scene
}

#[test]
fn what_was_projected_comes_back() {
    for truth in [boards(1, 0.0), points(1, 0.0)] {
        let found = adjust(&shaken(truth.clone(), 2), &Params::default()).unwrap();
        assert!(found.converged && found.rms_px < 1e-7, "{} px after {} steps", found.rms_px, found.steps);
        for (a, b) in found.cameras.iter().zip(&truth.cameras) {
            assert!((a.lens.focal_px - b.lens.focal_px).norm() < 1e-4, "{:?}", a.lens);
        }
    }
}

#[test]
fn derivatives_agree_with_the_fall_of_the_cost() {
    // Near the minimum a step with the right derivatives converges quadratically; wrong ones crawl.
    let mut boards = boards(3, 0.1);
    boards.free = vec![Free { center: false, distortion: [true, false, false, false, false], ..MODEL }; 4];
    for truth in [boards, points(3, 0.1)] {
        let found = adjust(&shaken(truth, 4), &Params::default()).unwrap();
        assert!(found.converged && found.steps < 20, "{} steps", found.steps);
    }
}

#[test]
fn deviations_predict_the_scatter_over_noise() {
    let truth = boards(1, 0.0);
    let (mut z, mut count) = (0.0, 0);
    for seed in 0..6 {
        let mut rng = ChaCha8Rng::seed_from_u64(100 + seed);
        let mut scene = truth.clone();
        scene.observations.iter_mut().for_each(|seen| seen.pixel += 0.1 * noise(&mut rng));
        let found = adjust(&scene, &Params::default()).unwrap();
        for ((camera, planted), spread) in
            found.cameras.iter().zip(&truth.cameras).zip(found.deviations.unwrap())
        {
            for axis in 0..2 {
                z += ((camera.lens.focal_px - planted.lens.focal_px)[axis] / spread.focal_px[axis]).powi(2);
                z +=
                    ((camera.lens.center_px - planted.lens.center_px)[axis] / spread.center_px[axis]).powi(2);
                count += 2;
            }
        }
    }
    let ratio = (z / f64::from(count)).sqrt();
    assert!((0.7..1.4).contains(&ratio), "{ratio}");
}

#[test]
fn gross_errors_do_not_pull_with_a_robust_loss() {
    let truth = boards(1, 0.0);
    let clean = boards(1, 0.05);
    let mut soiled = clean.clone();
    soiled.observations.iter_mut().step_by(37).for_each(|seen| seen.pixel += Vector2::new(25.0, -15.0));
    let error = |scene, loss| {
        let found = adjust(scene, &Params { loss, ..Params::default() }).unwrap();
        let off = |(a, b): (&Camera, &Camera)| (a.lens.focal_px - b.lens.focal_px).norm();
        found.cameras.iter().zip(&truth.cameras).map(off).fold(0.0, f64::max)
    };
    let (reached, pulled) = (error(&clean, Loss::Squares), error(&soiled, Loss::Squares));
    for loss in [Loss::Huber { scale_px: 0.1 }, Loss::Cauchy { scale_px: 0.1 }] {
        let robust = error(&soiled, loss);
        assert!(robust < 2.0 * reached && robust < 0.1 * pulled, "{loss:?}: {robust}, {reached}, {pulled}");
    }
}

#[test]
fn a_rigid_motion_of_the_rig_changes_no_residual() {
    let scene = shaken(boards(6, 0.1), 7);
    let motion = Isometry3::new(Vector3::new(100.0, -30.0, 500.0), Vector3::new(0.3, 1.0, -0.5));
    let mut moved = scene.clone();
    moved.cameras.iter_mut().for_each(|camera| camera.cam_from_world *= motion.inverse());
    for element in &mut moved.structure {
        if let Element::Body { world_from_body } = element {
            *world_from_body = motion * *world_from_body;
        }
    }
    let [here, there] = [&scene, &moved].map(|scene| adjust(scene, &Params::default()).unwrap());
    for (a, b) in here.residuals.iter().zip(&there.residuals) {
        assert!((a - b).norm() < 1e-6, "{a} {b}");
    }
}

#[test]
fn what_is_held_stays_bit_for_bit() {
    let mut scene = shaken(boards(8, 0.1), 9);
    scene.free = vec![Free::POSE, MODEL, Free::NOTHING, MODEL.without_pose()];
    let found = adjust(&scene, &Params::default()).unwrap();
    assert_eq!(found.cameras[0].lens, scene.cameras[0].lens);
    assert_eq!(found.cameras[2], scene.cameras[2]);
    assert_eq!(found.cameras[3].cam_from_world, scene.cameras[3].cam_from_world);
}
