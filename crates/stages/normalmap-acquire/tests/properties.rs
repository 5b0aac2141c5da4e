//! Laws: unit normals, codes, surfaces from slopes, warps, what exposure does not change.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests may")]

use artifact::GreenAxis;
use normalmap_acquire::{
    Face, Light, Mode, Pair, Params, Photo, Plane, Region, Warp, acquire, estimated_light, fit_modulation,
    integrated, normal_codes, normal_of, paper_normals,
};
use proptest::prelude::*;

fn pairs(side: f64, motion: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<Pair> {
    let place = |i: usize| [0.05, 0.35, 0.65, 0.95][i] * side;
    let pair = |i: usize| {
        let from = [place(i % 4), place(i / 4)];
        Pair { id: i.to_string(), from, to: motion(from) }
    };
    (0..16).map(pair).collect()
}

fn photo(light: Plane) -> Photo {
    Photo { usable: light.map(|_| 1.0), light }
}

/// Skin with a groove along a line, seen under open sky: darkening by its depth.
fn skin(angle: f64, depth: f64, gain: f64) -> Plane {
    let (s, c) = angle.sin_cos();
    Plane::from_fn(128, 128, |x, y| {
        let (x, y) = (x as f64 - 64.0, y as f64 - 64.0);
        let grain = 0.4 + 0.01 * (0.8 * x).sin() * (0.9 * y).sin();
        gain * grain * (1.0 - depth * (-((c * y - s * x) / 4.0).powi(2)).exp())
    })
}

fn face() -> Face {
    Face { pairs: pairs(128.0, |at| at), io_px: 260.0, ..Face::default() }
}

fn found(expression: Plane) -> [Plane; 3] {
    let neutral = photo(skin(0.0, 0.0, 1.0));
    let region = Region::of(Mode::Estimator);
    acquire(&neutral, &photo(expression), &face(), &region, &Params::default()).unwrap().normals
}

fn largest(a: &[Plane; 3], b: &[Plane; 3]) -> f64 {
    let pairs = a.iter().zip(b).flat_map(|(a, b)| a.values.iter().zip(&b.values));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn normals_have_unit_length_and_face_us(angle in 0.0..3.1, depth in 0.05..0.6) {
        let normals = found(skin(angle, depth, 1.0));
        for at in 0..normals[0].values.len() {
            let [x, y, z] = [0, 1, 2].map(|axis| normals[axis].values[at]);
            prop_assert!((x * x + y * y + z * z - 1.0).abs() < 1e-12 && z > 0.0);
        }
    }

    #[test]
    fn exposure_changes_nothing(angle in 0.0..3.1, gain in 0.5..1.6) {
        prop_assert!(largest(&found(skin(angle, 0.3, 1.0)), &found(skin(angle, 0.3, gain))) < 2e-3);
    }

    #[test]
    fn codes_come_back_within_their_step(x in -0.7..0.7, y in -0.7..0.7) {
        let z = f64::sqrt(1.0 - x * x - y * y);
        let normal = [x, y, z].map(|value| Plane::filled(1, 1, value));
        for green in [GreenAxis::Opengl, GreenAxis::Directx] {
            let codes = normal_codes(&normal, green, 255.0);
            let back = normal_of([codes[0] / 255.0, codes[1] / 255.0, codes[2] / 255.0], green);
            for (value, wanted) in back.iter().zip([x, y, z]) {
                prop_assert!((value - wanted).abs() < 0.01);
            }
        }
    }

    #[test]
    fn an_affine_motion_is_followed_exactly(a in -0.2..0.2, b in -0.2..0.2, shift in -30.0..30.0) {
        let motion = |[x, y]: [f64; 2]| [x + a * y + shift, y + b * x - shift];
        let warp = Warp::fit(&pairs(200.0, motion), 60.0, 1e-3).unwrap();
        for at in [[3.0, 90.0], [150.0, 20.0], [230.0, 190.0]] {
            let (found, wanted) = (warp.at(at), motion(at));
            prop_assert!((found[0] - wanted[0]).abs() < 1e-7 && (found[1] - wanted[1]).abs() < 1e-7);
        }
    }
}

#[test]
fn the_slopes_of_a_surface_give_it_back() {
    for (width, height) in [(96, 80), (131, 67)] {
        let surface = Plane::from_fn(width, height, |x, y| {
            let (x, y) = (x as f64 - 50.0, y as f64 - 35.0);
            6.0 * (-(x * x + y * y) / 150.0).exp()
        });
        let back = integrated(&surface.gradient(), 1e-5);
        let at = |plane: &Plane, x: usize, y: usize| plane.at(x, y) - plane.at(5, 5);
        for (x, y) in [(50, 35), (44, 30), (60, 40), (20, 60)] {
            assert!((at(&back, x, y) - at(&surface, x, y)).abs() < 0.12, "{x} {y}: {}", at(&back, x, y));
        }
    }
}

#[test]
fn the_papers_rule_recovers_a_sphere_under_a_flash() {
    // The ratio of a dent with the sphere's form is its normal's z, and is lowest at its rim.
    let z = |x: usize, y: usize| {
        let square = (x as f64 - 32.0).powi(2) + (y as f64 - 32.0).powi(2);
        (1.0 - square / 2500.0).max(0.1).sqrt()
    };
    let ratio = Plane::from_fn(65, 65, z);
    let [x, y, found] = paper_normals(&ratio, &ratio.map(|_| 1.0), 0.0);
    for (column, row) in [(40, 32), (20, 25), (32, 50)] {
        assert!((found.at(column, row) - z(column, row)).abs() < 1e-12);
        // A ball: it leans away from its top, towards the darker rim; y is up.
        assert!((x.at(column, row) - (column as f64 - 32.0) / 50.0).abs() < 2e-3);
        assert!((y.at(column, row) + (row as f64 - 32.0) / 50.0).abs() < 2e-3);
    }
    assert_eq!(found.at(32, 32), 1.0);
}

#[test]
fn a_skewed_landmark_is_told_by_the_others() {
    let mut pairs = pairs(200.0, |at| at);
    pairs[5].to[0] += 40.0;
    let warp = Warp::fit(&pairs, 60.0, 1e-3).unwrap();
    let worst = (0..16).max_by(|a, b| warp.left_out()[*a].total_cmp(&warp.left_out()[*b])).unwrap();
    assert!(worst == 5 && warp.left_out()[5] > 25.0, "{:?}", warp.left_out());
}

#[test]
fn landmarks_that_are_off_are_mended_by_the_pictures() {
    let grain = |x: f64, y: f64| {
        let wave =
            (0.31 * x + 0.12 * y).sin() * (0.27 * y - 0.09 * x).cos() + 0.6 * (0.52 * x - 0.41 * y).sin();
        0.4 * (1.0 + 0.12 * wave)
    };
    let neutral = photo(Plane::from_fn(160, 160, |x, y| grain(x as f64, y as f64)));
    let moved = photo(Plane::from_fn(160, 160, |x, y| grain(x as f64 - 2.5, y as f64 + 1.5)));
    let face = Face { pairs: pairs(160.0, |at| at), io_px: 200.0, ..Face::default() };
    let left = |refine: bool| {
        let region = Region { refine, ..Region::of(Mode::Estimator) };
        let found = acquire(&neutral, &moved, &face, &region, &Params::default()).unwrap();
        let square = |x: usize, y: usize| (found.warped.at(x, y) / neutral.light.at(x, y)).ln().powi(2);
        let sum: f64 =
            (40..120).flat_map(|y| (40..120).map(move |x| (x, y))).map(|(x, y)| square(x, y)).sum();
        (sum / 6400.0).sqrt()
    };
    let (without, with) = (left(false), left(true));
    assert!(with < 0.3 * without, "{with} of {without}");
}

#[test]
fn the_share_of_a_flash_is_found_in_shading() {
    let ball = |axis: usize| {
        Plane::from_fn(100, 100, |x, y| {
            let (x, y) = ((x as f64 - 50.0) / 80.0, -(y as f64 - 50.0) / 80.0);
            [x, y, (1.0 - x * x - y * y).sqrt()][axis]
        })
    };
    let normals = [ball(0), ball(1), ball(2)];
    let weight = Plane::filled(100, 100, 1.0);
    for share in [0.0, 0.5, 0.9] {
        let light = normals[2].with(&normals[0], |z, x| 0.4 * ((1.0 - share) + share * (z + 0.2 * x)));
        let Light { flash_share, tilt } = estimated_light(&light, &normals, &weight).unwrap();
        assert!((flash_share - share).abs() < 0.01, "{flash_share}");
        assert!(share == 0.0 || (tilt[0] - 0.2).abs() < 0.01, "{tilt:?}");
    }
}

#[test]
fn a_cosine_is_found_again() {
    let theta = |x: f64| ((std::f64::consts::PI * (1.0 + x)).cos() + 1.0) / 2.0;
    let frames: Vec<[f64; 2]> = (0..=20).map(|i| [f64::from(i) / 20.0, theta(f64::from(i) / 20.0)]).collect();
    let found = fit_modulation(&frames).unwrap();
    assert!(found.rms < 1e-9 && found.cosine_rms < 1e-9, "{found:?}");
    assert!(found.curve.windows(2).all(|pair| pair[0][0] < pair[1][0] && pair[0][1] <= pair[1][1]));
    assert!(fit_modulation(&frames[..2]).is_err());
}
