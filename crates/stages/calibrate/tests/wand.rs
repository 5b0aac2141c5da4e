//! Cameras from a waved point.

mod rig;

use calibrate::wand::{Ends, Length, Params, Scale, Sightings, WandCamera, calibrate};
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
        println!("seed {seed}: {error:.4} mm, rms {:.3?} px, rejected {:?}", found.rms_px, found.rejected);
        assert!(error < 0.08, "seed {seed}: {error} mm");
    }
}
