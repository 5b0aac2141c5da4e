//! Recorded markers: a real face must not look degenerate, and must invert.
#![allow(
    clippy::unwrap_used,
    clippy::disallowed_methods,
    clippy::print_stdout,
    reason = "a test may fail, looks at files, and says what it skips"
)]

mod scene;

use nalgebra::{Point3, Vector3};
use operators::{Inverse, InvertParams};
use rbf_warp::{Degree, fit_interpolant, map_of};
use scene::*;

/// Two frames of the 41 AnimFace markers, mm.
fn animface() -> Option<(Points, Points)> {
    let text = std::fs::read_to_string(testkit::data("face_markers_animface")?.join("jaw.csv")).unwrap();
    let frame = |row: usize| -> Points {
        let numbers: Vec<f64> =
            text.lines().nth(row + 1).unwrap().split(',').map(|x| x.parse().unwrap()).collect();
        numbers[1..].chunks(3).map(|p| Point3::new(p[0], p[1], p[2]) * 10.0).collect()
    };
    Some((frame(400), frame(0)))
}

/// The 90 markers on the neutral scan, on another expression, and the neutral scan itself, mm.
fn ict(expression: &str) -> Option<(Points, Points, Points)> {
    let folder = testkit::data("ict_facekit_dev")?;
    let about = std::fs::read_to_string(folder.join("sequence.json")).unwrap();
    let about: serde_json::Value = serde_json::from_str(&about).unwrap();
    let markers: Vec<usize> =
        about["marker_vertices"].as_array().unwrap().iter().map(|v| v.as_u64().unwrap() as usize).collect();
    let mesh = |name: &str| artifact::read_mesh(&folder.join(name), artifact::Unit::Cm).unwrap().positions;
    let (neutral, other) = (mesh("neutral.obj"), mesh(expression));
    let on = |points: &Points| markers.iter().map(|&vertex| points[vertex]).collect();
    Some((on(&neutral), on(&other), neutral))
}

#[test]
fn real_markers_determine_every_term() {
    let sets = [animface(), ict("smile.obj").map(|(neutral, smile, _)| (smile, neutral))];
    for (rest, scan) in sets.into_iter().flatten() {
        let names = names(rest.len());
        let fit = fit_interpolant(pairs(&names, &rest, &scan), Degree::Quadratic).unwrap();
        assert_eq!(fit.polynomial_rank, 10);
        assert!(fit.condition < 1e7, "{}", fit.condition);
        let mut errors: Vec<f64> = fit.leave_one_out_mm.iter().map(|error| error.unwrap()).collect();
        errors.sort_by(f64::total_cmp);
        // Neighbours are 15 mm away and the mouth is wide open in one of the two: millimetres, but not more.
        assert!(errors[errors.len() / 2] < 6.0, "{errors:?}");
    }
}

#[test]
fn the_scan_goes_back_to_mocap_space() {
    for expression in ["smile.obj", "mouth_pucker.obj", "cheek_puff.obj"] {
        let Some((neutral, other, scan)) = ict(expression) else { return };
        let names = names(90);
        let fit = |from, to| fit_interpolant(pairs(&names, from, to), Degree::Quadratic).unwrap().interpolant;
        let (forward, backward) = (map_of(&fit(&other, &neutral)), map_of(&fit(&neutral, &other)));
        let inverse = Inverse::of(forward.clone(), backward, InvertParams::default());
        let narrow_face = &scan[..6706];
        let found = inverse.preimages(narrow_face);
        assert!(found.iter().all(|preimage| inverse.is_found(preimage)));
        let mut images: Points = found.iter().map(|preimage| preimage.point).collect();
        forward.map_all(&mut images);
        let worst = images.iter().zip(narrow_face).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(worst < 1e-6, "{worst}");
    }
}

/// Root mean square distance after the best similarity, as a share of the scan's spread.
fn unlikeness(rest: &Points, scan: &Points) -> f64 {
    let fit = fit_interpolant(pairs(&names(rest.len()), rest, scan), Degree::Quadratic).unwrap();
    let centre = Point3::from(scan.iter().map(|p| p.coords).sum::<Vector3<f64>>() / scan.len() as f64);
    let apart: f64 = rest.iter().zip(scan).map(|(a, b)| (fit.similarity * a - b).norm_squared()).sum();
    let spread: f64 = scan.iter().map(|p| (p - centre).norm_squared()).sum();
    (apart / spread).sqrt()
}

/// A tenth of the spread, from which a fit warns, lies between a smile and a wide-open mouth at rest.
#[test]
fn a_warning_of_unlike_faces_spares_a_smile() {
    if let Some((neutral, smile, _)) = ict("smile.obj") {
        assert!(unlikeness(&smile, &neutral) < 0.1, "{}", unlikeness(&smile, &neutral));
    }
    if let Some((open, neutral)) = animface() {
        assert!((0.1..0.2).contains(&unlikeness(&open, &neutral)), "{}", unlikeness(&open, &neutral));
    }
}
