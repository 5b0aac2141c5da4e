//! Laws that hold for every warp.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod scene;

use nalgebra::{Matrix3, Point3, Vector3};
use operators::{Inverse, InvertParams, RbfMap};
use proptest::prelude::*;
use rand::Rng;
use rbf_warp::{Degree, Error, InterpolantFit, Pairs, fit_interpolant, map_of};
use scene::*;

fn fit(from: &Points, to: &Points, degree: Degree) -> (InterpolantFit, RbfMap) {
    let names = names(from.len());
    let fit = fit_interpolant(pairs(&names, from, to), degree).unwrap();
    let map = map_of(&fit.interpolant);
    (fit, map)
}

/// A random quadratic map of the face's size, its quadratic part a good share of it.
fn quadratic_map(seed: u64) -> impl Fn(&Point3<f64>) -> Point3<f64> {
    let mut rng = rng(seed);
    let linear = Matrix3::from_fn(|_, _| normal(&mut rng));
    let forms: [Matrix3<f64>; 3] = std::array::from_fn(|_| Matrix3::from_fn(|_, _| normal(&mut rng) / 100.0));
    let shift = normal3(&mut rng, 100.0);
    move |p| {
        let form = Vector3::from_fn(|k, _| p.coords.dot(&(forms[k] * p.coords)));
        Point3::from(shift + linear * p.coords + form)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn hits_its_centers(seed in 0u64.., count in 10usize..100) {
        let rng = &mut rng(seed);
        let from = face(count, rng);
        let to = expression(&from, 1.0, rng);
        let (_, map) = fit(&from, &to, Degree::Quadratic);
        for (from, to) in from.iter().zip(&to) {
            prop_assert!((map.at(from) - to).norm() < 1e-9);
        }
    }

    #[test]
    fn reproduces_affine_and_quadratic_maps(seed in 0u64.., count in 20usize..100) {
        let rng = &mut rng(seed);
        let from = face(count, rng);
        let planted = quadratic_map(seed);
        let to: Points = from.iter().map(&planted).collect();
        let (fit, map) = fit(&from, &to, Degree::Quadratic);
        prop_assume!(fit.polynomial_rank == 10);
        let size = to.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
        for _ in 0..50 {
            let point = near(&from, 60.0, rng);
            prop_assert!((map.at(&point) - planted(&point)).norm() < 1e-8 * size);
        }
    }

    #[test]
    fn linear_degree_reproduces_affine_maps(seed in 0u64.., count in 4usize..40) {
        let rng = &mut rng(seed);
        let from = face(count, rng);
        let linear = Matrix3::from_fn(|_, _| normal(rng));
        let planted = |p: &Point3<f64>| Point3::from(linear * p.coords + Vector3::new(1.0, 2.0, 3.0));
        let to: Points = from.iter().map(planted).collect();
        let (fit, map) = fit(&from, &to, Degree::Linear);
        prop_assume!(fit.polynomial_rank == 4);
        let point = near(&from, 60.0, rng);
        prop_assert!((map.at(&point) - planted(&point)).norm() < 1e-7);
    }

    #[test]
    fn moves_with_both_spaces(seed in 0u64.., degenerate in 0usize..3) {
        let rng = &mut rng(seed);
        let from = [face, ellipsoid, plane][degenerate](40, rng);
        let to = expression(&from, 1.0, rng);
        let (a, b) = (rigid(rng), rigid(rng));
        let (fit_here, here) = fit(&from, &to, Degree::Quadratic);
        let moved = |points: &Points, by: &nalgebra::Isometry3<f64>| points.iter().map(|p| by * p).collect();
        let (fit_there, there) = fit(&moved(&from, &a), &moved(&to, &b), Degree::Quadratic);
        prop_assert_eq!(fit_here.polynomial_rank, fit_there.polynomial_rank);
        for _ in 0..20 {
            let point = near(&from, 20.0, rng);
            prop_assert!((there.at(&(a * point)) - b * here.at(&point)).norm() < 1e-7);
        }
    }

    #[test]
    fn jacobian_is_the_derivative(seed in 0u64..) {
        let rng = &mut rng(seed);
        let from = face(50, rng);
        let to = expression(&from, 1.0, rng);
        let (_, map) = fit(&from, &to, Degree::Quadratic);
        let point = near(&from, 20.0, rng);
        let (value, jacobian) = map.with_jacobian(&point);
        prop_assert!((value - map.at(&point)).norm() < 1e-11);
        for axis in 0..3 {
            let step = Vector3::ith(axis, 1e-3);
            let slope = (map.at(&(point + step)) - map.at(&(point - step))) / 2e-3;
            prop_assert!((slope - jacobian.column(axis)).norm() < 1e-6);
        }
    }

    #[test]
    fn there_and_back_is_the_identity(seed in 0u64..) {
        let rng = &mut rng(seed);
        let from = face(90, rng);
        let to = expression(&from, 0.5, rng);
        let (_, forward) = fit(&from, &to, Degree::Quadratic);
        let (_, backward) = fit(&to, &from, Degree::Quadratic);
        let points: Points = (0..700).map(|_| near(&from, 10.0, rng)).collect();
        let unfolded = |p: &&Point3<f64>| forward.with_jacobian(p).1.determinant() > 0.2;
        let points: Points = points.iter().filter(unfolded).copied().collect();
        let mut images = points.clone();
        forward.map_all(&mut images);
        let inverse = Inverse::of(forward.clone(), backward, InvertParams::default());
        for (point, found) in points.iter().zip(inverse.preimages(&images)) {
            prop_assert!(inverse.is_found(&found), "{found:?}");
            prop_assert!((found.point - point).norm() < 1e-6, "{point} {found:?}");
        }
    }

    #[test]
    fn leave_one_out_equals_a_refit(seed in 0u64.., quadratic in any::<bool>()) {
        let rng = &mut rng(seed);
        let from = face(60, rng);
        let to = expression(&from, 1.0, rng);
        let degree = if quadratic { Degree::Quadratic } else { Degree::Linear };
        let (whole, _) = fit(&from, &to, degree);
        let terms = if quadratic { 10 } else { 4 };
        prop_assume!(whole.polynomial_rank == terms);
        for left in 0..from.len() {
            let without = |points: &Points| -> Points {
                points.iter().enumerate().filter(|(i, _)| *i != left).map(|(_, p)| *p).collect()
            };
            let (part, map) = fit(&without(&from), &without(&to), degree);
            prop_assume!(part.polynomial_rank == terms);
            let refit = (map.at(&from[left]) - to[left]).norm();
            let analytic = whole.leave_one_out_mm[left].unwrap();
            prop_assert!((refit - analytic).abs() < 1e-7 * (1.0 + refit), "{refit} {analytic}");
        }
    }

    /// Centers on or near a plane or an ellipsoid: the warp stays about as close to the similarity as a linear one,
    /// which no quadric can mislead. (How far that is, is up to the data: two markers pushed together may ask for a lot.)
    #[test]
    fn degenerate_markers_never_give_a_wild_warp(
        seed in 0u64.., count in 12usize..90, flat in any::<bool>(), off in prop_oneof![Just(0.0), 1e-6..5.0f64],
    ) {
        let rng = &mut rng(seed);
        let exact = if flat { plane(count, rng) } else { ellipsoid(count, rng) };
        let from: Points = exact.iter().map(|p| p + normal3(rng, off)).collect();
        let to = expression(&from, 1.0, rng);
        let points: Points = (0..200).map(|_| near(&from, 20.0, rng)).chain(from.iter().copied()).collect();
        let deviation = |degree| {
            let (fit, map) = fit(&from, &to, degree);
            points.iter().map(|p| (map.at(p) - fit.similarity * p).norm()).fold(0.0, f64::max)
        };
        let (quadratic, linear) = (deviation(Degree::Quadratic), deviation(Degree::Linear));
        prop_assert!(quadratic < 5.0 * linear, "{quadratic} mm, linear {linear} mm");
    }

    #[test]
    fn a_point_maps_alike_alone_and_among_others(seed in 0u64.., count in 1usize..1200) {
        let rng = &mut rng(seed);
        let from = face(40, rng);
        let to = expression(&from, 1.0, rng);
        let (_, map) = fit(&from, &to, Degree::Quadratic);
        let points: Points = (0..count).map(|_| near(&from, 20.0, rng)).collect();
        let mut images = points.clone();
        map.map_all(&mut images);
        let i = rng.random_range(0..count);
        prop_assert_eq!(map.at(&points[i]), images[i]);
    }
}

#[test]
fn a_plane_and_an_ellipsoid_lose_the_terms_that_they_do_not_determine() {
    for (points, rank) in
        [(ellipsoid(60, &mut rng(1)), 9), (plane(60, &mut rng(1)), 6), (face(60, &mut rng(1)), 10)]
    {
        let to = expression(&points, 1.0, &mut rng(2));
        let (fit, map) = fit(&points, &to, Degree::Quadratic);
        assert_eq!(fit.polynomial_rank, rank);
        for (from, to) in points.iter().zip(&to) {
            assert!((map.at(from) - to).norm() < 1e-9);
        }
    }
}

/// What no marker determines follows the similarity: off a plane, the warp neither collapses nor flips.
#[test]
fn off_a_plane_the_warp_follows_the_similarity() {
    let points = plane(40, &mut rng(3));
    let turn = rigid(&mut rng(4));
    let to: Points = points.iter().map(|p| turn * p).collect();
    let (_, map) = fit(&points, &to, Degree::Quadratic);
    for _ in 0..50 {
        let point = near(&points, 50.0, &mut rng(5));
        assert!((map.at(&point) - turn * point).norm() < 1e-9);
        assert!((map.with_jacobian(&point).1.determinant() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn two_markers_in_one_place_are_named() {
    let mut from = face(20, &mut rng(6));
    let to = expression(&from, 1.0, &mut rng(7));
    from[11] = from[3];
    let names = names(20);
    let error = fit_interpolant(pairs(&names, &from, &to), Degree::Quadratic).unwrap_err();
    assert!(
        matches!(error, Error::Coincident { ref first, ref second, .. } if first == "m3" && second == "m11")
    );
}

#[test]
fn too_few_markers_are_refused_by_number() {
    let (from, names) = (face(9, &mut rng(8)), names(9));
    let of = |count: usize, degree| {
        let pairs = Pairs {
            markers: &names[..count],
            from: &from[..count],
            to: &from[..count],
            space: "mocap space",
        };
        fit_interpolant(pairs, degree).map(|fit| fit.polynomial_terms)
    };
    assert_eq!(of(9, Degree::Quadratic).unwrap_err(), Error::TooFewForQuadratic { count: 9 });
    assert_eq!(of(9, Degree::Auto).unwrap(), 4);
    assert_eq!(of(4, Degree::Linear).unwrap(), 4);
    assert_eq!(of(3, Degree::Linear).unwrap_err(), Error::TooFew { count: 3 });
    assert!(Error::TooFewForQuadratic { count: 9 }.to_string().contains("--degree linear"));
}

#[test]
fn markers_on_a_line_are_refused() {
    let from: Points = (0..12).map(|i| Point3::new(f64::from(i) * 5.0, 1.0, 2.0)).collect();
    let names = names(12);
    let error = fit_interpolant(pairs(&names, &from, &from), Degree::Quadratic).unwrap_err();
    assert!(matches!(error, Error::Degenerate { .. }), "{error}");
}
