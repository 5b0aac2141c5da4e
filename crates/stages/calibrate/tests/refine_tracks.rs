//! Laws of the refinement with tracks.
#![allow(clippy::unwrap_used, reason = "a scene that cannot be made is a broken test")]

mod rig;

use artifact::{CameraRig, Sample2d, Tracks2dFrame, Tracks2dHeader};
use calibrate::bundle::{Focal, Free};
use calibrate::{Error, RefineParams, refine_with_tracks};
use camera::Camera;
use nalgebra::{Isometry3, Point3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

const FRAMES: i64 = 12;

/// What the cameras see of a face that moves about, with noise per coordinate.
fn filmed(cameras: &[Camera], noise_px: f64) -> (Tracks2dHeader, Vec<Tracks2dFrame>) {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let face = rig::face();
    let header = Tracks2dHeader {
        cameras: rig::IDS.iter().map(ToString::to_string).collect(),
        markers: (0..face.len()).map(|i| format!("p{i}")).collect(),
        rate: None,
        take: None,
    };
    let frame = |frame: i64| {
        let mut random = |size: f64| Vector3::from_fn(|_, _| size * (2.0 * rng.random::<f64>() - 1.0));
        let motion = Isometry3::new(random(12.0), random(0.15));
        let places: Vec<Point3<f64>> = face.iter().map(|place| motion * place).collect();
        let seen = |camera: &Camera| {
            let track = rig::track(camera, &places, noise_px, &mut rng);
            Some(track.into_iter().map(|at| at.map(|at| Sample2d::seen(at.into()))).collect())
        };
        Tracks2dFrame { frame, cameras: cameras.iter().map(seen).collect() }
    };
    (header, (0..FRAMES).map(frame).collect())
}

fn named(cameras: &[Camera]) -> CameraRig {
    let cameras = rig::IDS.iter().zip(cameras).map(|(id, camera)| (id.to_string(), camera.clone().into()));
    CameraRig { cameras: cameras.collect(), take: None }
}

fn cameras_of(rig: &CameraRig) -> Vec<Camera> {
    rig.cameras.values().map(|camera| camera.camera.clone()).collect()
}

/// Cameras that were touched: turned by up to 0.2° and shifted by up to 1 mm.
fn touched(truth: &[Camera]) -> Vec<Camera> {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let mut random = |size: f64| Vector3::from_fn(|_, _| size * (2.0 * rng.random::<f64>() - 1.0));
    let touch = |camera: &Camera| Camera {
        cam_from_world: Isometry3::new(random(1.0), random(3.5e-3)) * camera.cam_from_world,
        ..camera.clone()
    };
    truth.iter().map(touch).collect()
}

#[test]
fn cameras_that_were_touched_are_put_back() {
    let truth = rig::cameras(7);
    let (header, frames) = filmed(&truth, 0.05);
    let start = touched(&truth);
    let refined = refine_with_tracks(&named(&start), &header, &frames, &RefineParams::default()).unwrap();
    let found = cameras_of(&refined.rig);
    // Points tell the shape; the size stays as the touched cameras have it.
    let (before, after) = (rig::shape_error(&truth, &start), rig::shape_error(&truth, &found));
    assert!(before > 0.05 && after < 0.005, "{before} mm, {after} mm");
    assert!(refined.report.converged && refined.report.rms_px < 0.1, "{:?}", refined.report.rms_px);
}

#[test]
fn a_rig_that_is_right_stays_where_it_is() {
    let truth = rig::cameras(7);
    let (header, frames) = filmed(&truth, 0.0);
    let free = Free { focal: Focal::Tied, ..Free::POSE };
    let params = RefineParams { free, ..RefineParams::default() };
    let refined = refine_with_tracks(&named(&truth), &header, &frames, &params).unwrap();
    for (found, camera) in cameras_of(&refined.rig).iter().zip(&truth) {
        assert!((found.eye_in_world() - camera.eye_in_world()).norm() < 1e-4);
        assert!((found.lens.focal_px - camera.lens.focal_px).norm() < 1e-3);
    }
}

#[test]
fn one_camera_is_put_back_among_others_that_are_held() {
    let truth = rig::cameras(8);
    let (header, frames) = filmed(&truth, 0.05);
    let mut start = truth.clone();
    start[2] = touched(&truth)[2].clone();
    let hold = rig::IDS.iter().filter(|id| **id != "m3").map(ToString::to_string).collect();
    let params = RefineParams { hold, ..RefineParams::default() };
    let refined = refine_with_tracks(&named(&start), &header, &frames, &params).unwrap();
    let found = cameras_of(&refined.rig);
    assert_eq!(found[0], truth[0]);
    let away = |camera: &Camera| (camera.eye_in_world() - truth[2].eye_in_world()).norm();
    assert!(away(&start[2]) > 0.5 && away(&found[2]) < 0.1, "{} {}", away(&start[2]), away(&found[2]));
}

#[test]
fn what_cannot_be_used_is_named() {
    let truth = rig::cameras(7);
    let (mut header, frames) = filmed(&truth, 0.0);
    let lonely: Vec<Tracks2dFrame> = frames
        .iter()
        .map(|frame| Tracks2dFrame {
            cameras: frame.cameras.iter().take(1).cloned().chain(vec![None; 7]).collect(),
            ..frame.clone()
        })
        .collect();
    let params = RefineParams::default();
    let refused = refine_with_tracks(&named(&truth), &header, &lonely, &params).unwrap_err();
    assert_eq!(refused, Error::NoTracks);
    header.cameras[1] = "m9".to_string();
    let refused = refine_with_tracks(&named(&truth), &header, &frames, &params).unwrap_err();
    assert_eq!(refused, Error::UnknownCamera("m9".to_string()));
}
