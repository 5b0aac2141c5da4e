//! Laws of the calibration from a board.
#![allow(clippy::unwrap_used, reason = "a scene that cannot be made is a broken test")]

use calibrate::{
    Board, Corners, CornersFrame, CornersHeader, Error, Params, RefineParams, calibrate_board,
    refine_with_corners,
};
use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Isometry3, Point2, Point3, Vector2, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

const BOARD: Board = Board::Chessboard { columns: 8, rows: 6, square_mm: 16.0 };

fn rig() -> BTreeMap<String, Camera> {
    let camera = |i: usize| {
        let angle = -0.7 + 0.7 * i as f64;
        let eye = Point3::new(900.0 * angle.sin(), 120.0, 900.0 * angle.cos());
        let distortion = BrownConrady { k1: -0.12, k2: 0.08, p1: 3e-4, p2: -2e-4, k3: 0.0 };
        let lens =
            Lens { focal_px: Vector2::new(900.0, 905.0), center_px: Vector2::new(331.0, 240.0), distortion };
        let cam_from_world = Camera::pose_looking_at(eye, Point3::origin(), Vector3::y());
        (format!("m{}", i + 1), Camera { image_size: [656, 490], lens, cam_from_world })
    };
    (0..3).map(camera).collect()
}

/// What the rig sees of boards in many poses, with noise.
fn filmed(noise_px: f64) -> Corners {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let rig = rig();
    let cameras = rig.iter().map(|(id, camera)| (id.clone(), camera.image_size)).collect();
    let frame = |frame: i64| {
        let mut random = |size: f64| Vector3::from_fn(|_, _| size * (2.0 * rng.random::<f64>() - 1.0));
        let (shift, turn) = (random(80.0), random(0.5));
        // Half a turn about x: the board's face looks at the cameras.
        let facing = Isometry3::rotation(Vector3::x() * std::f64::consts::PI);
        let world_from_board =
            Isometry3::new(shift, turn) * facing * Isometry3::translation(-56.0, -40.0, 0.0);
        let mut seen = BTreeMap::new();
        for (id, camera) in &rig {
            let mut see = |(i, corner): (usize, Point3<f64>)| {
                let noise = Vector2::from_fn(|_, _| noise_px * (2.0 * rng.random::<f64>() - 1.0));
                (i as u32, (camera.project(&(world_from_board * corner)).unwrap() + noise).into())
            };
            seen.insert(id.clone(), BOARD.corners().into_iter().enumerate().map(&mut see).collect());
        }
        CornersFrame { frame, seen }
    };
    Corners {
        header: CornersHeader { board: BOARD, cameras, take: None },
        frames: (0..14).map(frame).collect(),
    }
}

/// The largest difference of what the rigs say about how each camera stands to the first, mm, and of focal lengths, px.
fn difference(found: &artifact::CameraRig) -> (f64, f64) {
    let truth = rig();
    let (first, first_true) = (&found.cameras["m1"].camera, &truth["m1"]);
    let (mut place, mut focal) = (0.0, 0.0);
    for (id, camera) in &truth {
        let own = &found.cameras[id].camera;
        let here = first.cam_from_world * own.eye_in_world();
        let there = first_true.cam_from_world * camera.eye_in_world();
        place = f64::max(place, (here - there).norm());
        focal = f64::max(focal, (own.lens.focal_px - camera.lens.focal_px).norm());
    }
    (place, focal)
}

#[test]
fn a_filmed_rig_is_recovered() {
    let found = calibrate_board(&filmed(0.0), &Params::default()).unwrap();
    let (place, focal) = difference(&found.rig);
    assert!(found.report.converged && place < 1e-5 && focal < 1e-5, "{place} mm {focal} px");
}

#[test]
fn boards_that_stand_on_their_head_are_turned() {
    let mut corners = filmed(0.05);
    let straight = calibrate_board(&corners, &Params::default()).unwrap();
    for frame in corners.frames.iter_mut().step_by(3) {
        let seen = frame.seen.get_mut("m2").unwrap();
        *seen = seen.iter().map(|(id, at)| (47 - id, *at)).collect();
    }
    let turned = calibrate_board(&corners, &Params::default()).unwrap();
    assert_eq!((straight.report.renumbered_views, turned.report.renumbered_views), (0, 5));
    assert!((straight.report.rms_px - turned.report.rms_px).abs() < 1e-9);
}

#[test]
fn cameras_that_never_saw_the_board_together_are_named() {
    let mut corners = filmed(0.05);
    for frame in &mut corners.frames {
        frame.seen.retain(|id, _| (id == "m3") == (frame.frame % 2 == 0));
    }
    let refused = calibrate_board(&corners, &Params::default()).unwrap_err();
    assert_eq!(refused, Error::Apart(vec![vec!["m1".into(), "m2".into()], vec!["m3".into()]]));
}

#[test]
fn a_camera_that_sees_nothing_is_named() {
    let mut corners = filmed(0.05);
    corners.frames.iter_mut().for_each(|frame| drop(frame.seen.remove("m2")));
    let refused = calibrate_board(&corners, &Params::default()).unwrap_err();
    assert_eq!(refused, Error::FewViews { camera: "m2".into(), views: 0 });
}

#[test]
fn the_world_is_the_camera_that_was_named() {
    let params = Params { world_camera: Some("m2".into()), ..Params::default() };
    let found = calibrate_board(&filmed(0.05), &params).unwrap();
    assert!(found.rig.cameras["m2"].camera.eye_in_world().coords.norm() < 1e-9);
}

#[test]
fn a_camera_that_was_knocked_is_put_back() {
    let corners = filmed(0.05);
    let known = calibrate_board(&corners, &Params::default()).unwrap().rig;
    let mut knocked = known.clone();
    let camera = &mut knocked.cameras.get_mut("m3").unwrap().camera;
    camera.cam_from_world =
        Isometry3::new(Vector3::new(2.0, 0.0, -1.0), Vector3::new(0.0, 5e-3, 0.0)) * camera.cam_from_world;
    let refined = refine_with_corners(&knocked, &corners, &RefineParams::default()).unwrap();
    let stands = |rig: &artifact::CameraRig| {
        rig.cameras["m1"].camera.cam_from_world * rig.cameras["m3"].camera.eye_in_world()
    };
    let [known, knocked, refined] = [&known, &knocked, &refined.rig].map(stands);
    let (before, after) = ((knocked - known).norm(), (refined - known).norm());
    assert!(after < 0.01 && before > 1.0, "{before} mm, {after} mm");
}

#[test]
fn a_mirrored_camera_fits_with_none() {
    let mut corners = filmed(0.05);
    for frame in &mut corners.frames {
        let seen = frame.seen.get_mut("m2").unwrap();
        // As a detector would number the mirrored picture: columns from the other side.
        *seen =
            seen.iter().map(|(id, at)| (id / 8 * 8 + 7 - id % 8, Point2::new(655.0 - at.x, at.y))).collect();
    }
    let report = calibrate_board(&corners, &Params::default()).unwrap().report;
    let (id, _) = report.misfit().unwrap();
    assert_eq!(id, "m2");
    assert!(calibrate_board(&filmed(0.05), &Params::default()).unwrap().report.misfit().is_none());
}
