//! Chessboards that stand on their head are numbered alike in all cameras.
#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

mod rig;

use calibrate::doctor::{Patient, numbered_alike};
use nalgebra::{Isometry3, Point3, Vector3};

#[test]
fn a_chessboard_that_stands_on_its_head_is_numbered_like_in_the_other_cameras() {
    let cameras = rig::cameras(2);
    let corner = |id: u32| Point3::new(16.0 * f64::from(id % 5) - 32.0, 16.0 * f64::from(id / 5) + 5.0, 60.0);
    let ways: [Vec<u32>; 2] = [(0..20).collect(), (0..20).rev().collect()];
    let seen = |c: usize, way: usize| {
        let place = |id: u32| (id, cameras[c].project(&corner(ways[way][id as usize])).unwrap());
        (c, (0..20).map(place).collect())
    };
    let mut patients: Vec<Patient> = (0..6)
        .map(|c| Patient { id: rig::IDS[c].into(), camera: cameras[c].clone(), footage_size: None })
        .collect();
    // The first is turned: it must not spoil the others' numbers.
    let turned = Isometry3::rotation(Vector3::z() * 0.2) * patients[0].camera.cam_from_world;
    patients[0].camera.cam_from_world = turned;
    let found = numbered_alike(&patients, (0..6).map(|c| seen(c, c % 2)).collect(), &ways);
    let alike = seen(1, 0).1 == found[1].1;
    for (c, corners) in found.into_iter().skip(1) {
        assert_eq!(corners, seen(c, usize::from(!alike)).1, "camera {c}");
    }
}
