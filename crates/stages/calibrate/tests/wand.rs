//! Cameras from a waved point.
#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

mod rig;

use calibrate::bundle::Free;
use calibrate::wand::{Ends, Error, Length, Params, Scale, Sightings, WandCamera, calibrate};
use camera::Camera;
use nalgebra::{Point3, Vector2};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

fn sightings(cameras: &[Camera], path: &[Point3<f64>], noise_px: f64, seed: u64) -> Sightings {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let camera = |(id, camera): (&&str, &Camera)| WandCamera {
        id: id.to_string(),
        image_size: camera.image_size,
        lens: None,
        track: rig::track(camera, path, noise_px, &mut rng),
    };
    Sightings {
        frames: (0..path.len() as i64).collect(),
        cameras: rig::IDS.iter().zip(cameras).map(camera).collect(),
    }
}

/// Lengths between some places of the point, as if measured.
fn lengths(path: &[Point3<f64>]) -> Scale {
    let pairs = [(0, 60), (20, 110), (45, 170)];
    let length = |(a, b): (usize, usize)| Length {
        ends: Ends::Frames(a as i64, b as i64),
        mm: (path[a] - path[b]).norm(),
    };
    Scale::Lengths(pairs.map(length).to_vec())
}

#[test]
fn a_waved_point_tells_all_cameras() {
    for seed in 1..=6 {
        let truth = rig::cameras(seed);
        let path = rig::wand_path(200, 90.0, seed);
        let sightings = sightings(&truth, &path, 0.05, seed);
        let found = calibrate(&sightings, &Params { scale: lengths(&path), ..Params::default() }).unwrap();
        let error = rig::marker_error(&truth, &found.cameras);
        assert!(error < 0.03, "seed {seed}: {error} mm");
    }
}

/// Takes a camera out of what it saw: by chance, and for a long while.
fn hide(sightings: &mut Sightings, share: f64, rng: &mut ChaCha8Rng) {
    for (c, camera) in sightings.cameras.iter_mut().enumerate() {
        let count = camera.track.len();
        for (frame, seen) in camera.track.iter_mut().enumerate() {
            let is_away = (frame + 23 * c) % count < count / 5;
            if is_away || rng.random_bool(share) {
                *seen = None;
            }
        }
    }
}

#[test]
fn lost_and_wrong_sightings_do_no_harm() {
    for seed in 1..=4 {
        let truth = rig::cameras(seed);
        let path = rig::wand_path(240, 90.0, seed);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut sightings = sightings(&truth, &path, 0.05, seed);
        hide(&mut sightings, 0.15, &mut rng);
        let mut wrong = [0; 8];
        for (camera, wrong) in sightings.cameras.iter_mut().zip(&mut wrong) {
            let [width, height] = camera.image_size.map(f64::from);
            for seen in camera.track.iter_mut().flatten() {
                if !rng.random_bool(0.08) {
                    continue;
                }
                // A reflection somewhere else.
                *seen = Vector2::new(rng.random_range(0.0..width), rng.random_range(0.0..height));
                *wrong += 1;
            }
        }
        let found =
            calibrate(&sightings, &Params { scale: Scale::Distance(850.0), ..Params::default() }).unwrap();
        let error = rig::shape_error(&truth, &found.cameras);
        assert!(error < 0.03, "seed {seed}: {error} mm");
        assert!(
            found
                .rejected
                .iter()
                .zip(wrong)
                .all(|(rejected, wrong)| rejected + 2 >= wrong && *rejected <= wrong + 4)
        );
    }
}

#[test]
fn wide_lenses_with_strong_distortion_are_found() {
    for seed in 1..=3 {
        let mut truth = rig::cameras(seed);
        truth.truncate(6);
        for camera in &mut truth {
            camera.lens.focal_px *= 0.4;
            camera.lens.distortion.k1 *= 1.5;
        }
        let path = rig::wand_path(300, 220.0, seed);
        let mut params = Params::default();
        params.free.distortion = [true, true, true, true, false];
        let found = calibrate(&sightings(&truth, &path, 0.05, seed), &params).unwrap();
        let error = rig::shape_error(&truth, &found.cameras);
        assert!(error < 0.04, "seed {seed}: {error} mm");
    }
}

#[test]
fn three_cameras_will_do_and_two_with_known_lenses() {
    let truth = rig::cameras(2);
    let path = rig::wand_path(300, 90.0, 2);
    let all = sightings(&truth, &path, 0.03, 2);
    let chosen = |places: &[usize], known: bool| {
        let camera =
            |&c: &usize| WandCamera { lens: known.then_some(truth[c].lens), ..all.cameras[c].clone() };
        Sightings { frames: all.frames.clone(), cameras: places.iter().map(camera).collect() }
    };
    let eyes = |cameras: &[Camera]| cameras.iter().map(Camera::eye_in_world).collect::<Vec<_>>();
    let three = calibrate(&chosen(&[0, 3, 5], false), &Params::default()).unwrap();
    let [a, b, c] = eyes(&three.cameras)[..] else { panic!("three cameras") };
    let [x, y, z] = [0, 3, 5].map(|c| truth[c].eye_in_world());
    let ratio = ((a - b).norm() / (b - c).norm()) / ((x - y).norm() / (y - z).norm());
    assert!((ratio - 1.0).abs() < 0.03, "the triangle of the cameras keeps its form: {ratio}");
    let two = calibrate(&chosen(&[1, 4], true), &Params { free: Free::POSE, ..Params::default() }).unwrap();
    let turn = |cameras: &[Camera], [a, b]: [usize; 2]| {
        (cameras[b].cam_from_world * cameras[a].cam_from_world.inverse()).rotation
    };
    let off = turn(&two.cameras, [0, 1]).angle_to(&turn(&truth, [1, 4]));
    assert!(off < 3e-3, "the second camera is turned by {off} rad");
}

#[test]
fn the_order_of_the_cameras_and_the_unit_of_length_change_nothing() {
    let truth = rig::cameras(3);
    let path = rig::wand_path(200, 90.0, 3);
    let all = sightings(&truth, &path, 0.05, 3);
    let once = calibrate(&all, &Params { scale: Scale::Distance(850.0), ..Params::default() }).unwrap();
    let twice = calibrate(&all, &Params { scale: Scale::Distance(1700.0), ..Params::default() }).unwrap();
    for (a, b) in once.cameras.iter().zip(&twice.cameras) {
        assert!((2.0 * a.eye_in_world().coords - b.eye_in_world().coords).norm() < 1e-9);
        assert_eq!(a.lens, b.lens);
    }
    let mut turned = all.clone();
    turned.cameras.rotate_left(3);
    let mut other =
        calibrate(&turned, &Params { scale: Scale::Distance(850.0), ..Params::default() }).unwrap();
    other.cameras.rotate_right(3);
    for (a, b) in once.cameras.iter().zip(&other.cameras) {
        assert!((a.lens.focal_px.x / b.lens.focal_px.x - 1.0).abs() < 1e-4);
    }
}

#[test]
fn what_cannot_be_found_is_refused_by_name() {
    let truth = rig::cameras(1);
    let path = rig::wand_path(120, 90.0, 1);
    let all = sightings(&truth, &path, 0.05, 1);
    let refused = |sightings: &Sightings, params: &Params| calibrate(sightings, params).unwrap_err();
    let mut few = all.clone();
    few.cameras[2].track[12..].fill(None);
    assert!(
        matches!(refused(&few, &Params::default()), Error::TooFewFrames { camera, seen: 12 } if camera == "m3")
    );
    let mut two = all.clone();
    two.cameras.truncate(2);
    assert_eq!(refused(&two, &Params::default()), Error::TooFewCameras(2));
    let mut mirrored = all.clone();
    mirrored.cameras[4].track.iter_mut().flatten().for_each(|pixel| pixel.x = 655.0 - pixel.x);
    assert_eq!(refused(&mirrored, &Params::default()), Error::Mirrored(vec!["m5".into()]));
    let length = Length { ends: Ends::Frames(3, 999), mm: 10.0 };
    let params = Params { scale: Scale::Lengths(vec![length]), ..Params::default() };
    assert!(refused(&all, &params).to_string().contains("there is no frame 999"));
}

#[test]
fn lengths_that_contradict_each_other_are_refused() {
    let truth = rig::cameras(1);
    let path = rig::wand_path(120, 90.0, 1);
    let apart = |a: usize, b: usize| (truth[a].eye_in_world() - truth[b].eye_in_world()).norm();
    let length = |a: &str, b: &str, mm| Length { ends: Ends::Cameras(a.into(), b.into()), mm };
    let known = vec![length("m1", "m6", apart(0, 5)), length("m1", "m2", 1.1 * apart(0, 1))];
    let params = Params { scale: Scale::Lengths(known), ..Params::default() };
    let refused = calibrate(&sightings(&truth, &path, 0.05, 1), &params).unwrap_err();
    assert!(matches!(refused, Error::Contradiction { .. }), "{refused}");
    assert!(refused.to_string().contains("m1:m2="), "{refused}");
}

#[test]
fn a_camera_a_frame_late_is_named() {
    let truth = rig::cameras(1);
    let path = rig::wand_path(120, 90.0, 1);
    let mut all = sightings(&truth, &path, 0.05, 1);
    all.cameras[2].track.rotate_right(1);
    all.cameras[2].track[0] = None;
    let said = calibrate(&all, &Params::default()).map(|wand| wand.rejected);
    assert!(matches!(&said, Err(Error::Apart(id)) if id == "m3"), "{said:?}");
}
