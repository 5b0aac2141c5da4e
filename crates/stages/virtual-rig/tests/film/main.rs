//! The film against scenes whose images are known.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests may")]

mod by_hand;
mod dots;
mod paint;
mod scene;
mod surfaces;

use crate::dots::dotted_ball;
use crate::scene::{film, mocap, shot};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use virtual_rig::film::{Film, Grain, Scene, Sensor, develop, expose};

fn with_threads<T: Send>(count: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap().install(work)
}

#[test]
fn the_bytes_do_not_depend_on_the_number_of_threads() {
    let mut random = ChaCha8Rng::seed_from_u64(21);
    let (ball, layers) = dotted_ball(&mut random);
    let ball = ball.moving(Vector3::new(1.0, 0.5, 0.0));
    let camera = mocap(&mut random);
    let take = || {
        let exposure = shot(&camera, &ball, &layers, &[]);
        let grain = Grain { seed: 1, camera: 0, frame: 1001 };
        let bytes = develop(&exposure, &Sensor::default(), grain).unwrap();
        (exposure, bytes)
    };
    let alone = with_threads(1, take);
    assert!(alone == with_threads(2, take) && alone == with_threads(3, take));
}

#[test]
fn eight_samples_a_side_agree_with_four() {
    let mut random = ChaCha8Rng::seed_from_u64(31);
    let (ball, layers) = dotted_ball(&mut random);
    let camera = mocap(&mut random);
    let scene = Scene { face: ball.solid(), layers: &layers, props: &[] };
    let [four, eight] =
        [4, 8].map(|samples_per_side| expose(&camera, &scene, &Film { samples_per_side, ..film() }).unwrap());
    let difference: f64 = four
        .radiance
        .iter()
        .zip(&eight.radiance)
        .map(|(one, other)| f64::from(one[0] - other[0]).powi(2))
        .sum::<f64>()
        / four.radiance.len() as f64;
    assert!(difference.sqrt() < 4e-3, "{}", difference.sqrt());
    let refused = expose(&camera, &scene, &Film { samples_per_side: 7, ..film() });
    assert!(refused.unwrap_err().to_string().contains("samples_per_side"));
}
