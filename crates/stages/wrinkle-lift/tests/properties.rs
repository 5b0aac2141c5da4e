//! Laws of the stage.
#![allow(clippy::unwrap_used, reason = "tests may")]

mod scene;

use artifact::{SectionDeviation, SectionState, ValleyPoint};
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use proptest::prelude::*;
use scene::{Planted, brow, camera, dome, lifted, pose, reversed, worst};
use wrinkle_lift::{Ground, Lost, Params, arrange};

fn one_view(azimuth_deg: f64, planted: &Planted) -> Vec<ValleyPoint> {
    let camera = camera(azimuth_deg);
    let sections = brow(planted.seen(&camera, &pose(), [0.0, 1.0], 60));
    lifted(&[(camera, pose(), sections)], &Params::default()).0.valleys["brow"].clone()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// What was projected comes back: from any side, for any valley.
    #[test]
    fn lifting_undoes_projection(azimuth in -45.0..45.0f64, d_mm in 0.3..2.5f64, w_mm in 1.0..4.0f64) {
        let planted = Planted { d_mm, w_mm, ..Planted::default() };
        let [place, width, depth] = worst(&one_view(azimuth, &planted), &planted);
        prop_assert!(place < 0.05 && width < 0.03 && depth < 0.03, "{place} mm, {width}, {depth}");
    }

    /// A motion of the head that the cameras follow changes nothing on the face.
    #[test]
    fn rigid_motion_costs_nothing(axis in prop::array::uniform3(-1.0..1.0f64), shift in prop::array::uniform3(-200.0..200.0f64)) {
        let planted = Planted::default();
        let still = one_view(20.0, &planted);
        let motion = Isometry3::new(Vector3::from(shift), Vector3::from(axis));
        let mut camera = camera(20.0);
        camera.cam_from_world *= motion.inverse();
        let moved = motion * pose();
        let sections = brow(planted.seen(&camera, &moved, [0.0, 1.0], 60));
        let points = lifted(&[(camera, moved, sections)], &Params::default()).0.valleys["brow"].clone();
        prop_assert_eq!(points.len(), still.len());
        for (a, b) in points.iter().zip(&still) {
            prop_assert!((Point3::from(a.at_mm) - Point3::from(b.at_mm)).norm() < 1e-6);
            prop_assert!((a.w_mm - b.w_mm).abs() < 1e-6);
        }
    }
}

#[test]
fn points_lie_on_the_mesh_and_say_which_side_is_right() {
    let (mesh, planted) = (dome(), Planted::default());
    let ground = Ground::of(&mesh);
    for point in one_view(-25.0, &planted) {
        let spot = wrinkle_lift::Spot { face: point.face, barycentric: point.barycentric };
        let foot = Point3::from(point.at_mm) + Vector3::from(point.normal) * point.d_mm;
        assert!((foot - ground.at(&spot, &mesh.positions)).norm() < 1e-9);
        // The wrinkle runs along +x and is seen from +z: its right is −y.
        assert!(
            point.across[1] < -0.8 && (point.kappa - 0.2).abs() < 1e-9 && (point.epsilon - 0.1).abs() < 1e-9
        );
    }
}

#[test]
fn without_parallax_the_bottom_lands_beside_its_place() {
    let (planted, camera) = (Planted::default(), camera(0.0));
    // From below: across the wrinkle.
    let tilted = Isometry3::rotation(Vector3::x() * 0.6);
    let sections = brow(planted.seen(&camera, &tilted, [0.0, 1.0], 60));
    let views = [(camera, tilted, sections)];
    let with = lifted(&views, &Params::default()).0.valleys["brow"].clone();
    let without = lifted(&views, &Params { parallax: false, ..Params::default() }).0.valleys["brow"].clone();
    assert!(worst(&with, &planted)[0] < 0.05);
    let off = worst(&without, &planted)[0];
    assert!(off > 0.5, "d tan τ is missing: {off} mm");
}

#[test]
fn a_curve_followed_from_its_other_end_is_the_same_valley() {
    let planted = Planted::default();
    let cameras = [camera(-15.0), camera(25.0)];
    let seen = |i: usize| planted.seen(&cameras[i], &pose(), [0.0, 1.0], 60);
    let views =
        |second| [(cameras[0].clone(), pose(), brow(seen(0))), (cameras[1].clone(), pose(), brow(second))];
    let (mesh, params) = (dome(), Params::default());
    let ground = Ground::of(&mesh);
    let [same, turned] = [seen(1), reversed(&seen(1))].map(|second| lifted(&views(second), &params).0);
    let mut frames = [same, turned];
    arrange(&mut frames, &ground, &mesh.positions);
    let [a, b] = frames.map(|frame| frame.valleys["brow"].clone());
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(&b) {
        assert!((Point3::from(a.at_mm) - Point3::from(b.at_mm)).norm() < 1e-6);
        assert!((a.x_mm - b.x_mm).abs() < 1e-6 && (a.kappa - b.kappa).abs() < 1e-9);
    }
}

#[test]
fn two_cameras_make_one_valley_of_their_parts() {
    let planted = Planted::default();
    let cameras = [camera(-35.0), camera(35.0)];
    let part = |i: usize, part| brow(planted.seen(&cameras[i], &pose(), part, 40));
    let views = [
        (cameras[0].clone(), pose(), part(0, [0.0, 0.6])),
        (cameras[1].clone(), pose(), part(1, [0.4, 1.0])),
    ];
    let (frame, tally) = lifted(&views, &Params::default());
    let points = &frame.valleys["brow"];
    assert!(worst(points, &planted)[0] < 0.05);
    let ends = [points[0].at_mm[0], points[points.len() - 1].at_mm[0]];
    assert!(ends[0] < -24.0 && ends[1] > 24.0, "{ends:?}");
    let step = |pair: &[ValleyPoint]| (Point3::from(pair[1].at_mm) - Point3::from(pair[0].at_mm)).norm();
    assert!(points.windows(2).all(|pair| (0.2..0.9).contains(&step(pair))), "evenly spaced");
    assert!(tally.apart_mm["brow"].iter().all(|apart| *apart < 0.05));
}

#[test]
fn widths_are_those_across_the_valley_however_the_image_tells_them() {
    let (planted, camera) = (Planted::default(), camera(40.0));
    let tilted = Isometry3::rotation(Vector3::new(0.5, 0.0, 0.2));
    let mut sections = planted.seen(&camera, &tilted, [0.0, 1.0], 60);
    let at: Vec<Vector2<f64>> = sections.iter().map(|section| section.at.into()).collect();
    // Told perpendicular to the curve in the image, as they are measured: shorter, but for the same rims.
    let mut askew = 1.0f64;
    for i in 1..sections.len() - 1 {
        let along = (at[i + 1] - at[i - 1]).normalize();
        let normal = Vector2::new(-along.y, along.x);
        let share = normal.dot(&Vector2::from(sections[i].normal));
        askew = askew.min(share);
        (sections[i].normal, sections[i].w_px) = (normal.into(), sections[i].w_px * share);
        sections[i].d_px *= share;
    }
    assert!(askew < 0.9, "{askew}");
    let (frame, _) = lifted(&[(camera, tilted, brow(sections))], &Params::default());
    let [place, width, depth] = worst(&frame.valleys["brow"], &planted);
    assert!(place < 0.05 && width < 0.03 && depth < 0.03, "{place} mm, {width}, {depth}");
}

#[test]
fn cameras_that_disagree_are_told_and_nothing_jumps() {
    let planted = Planted::default();
    let cameras = [camera(-10.0), camera(10.0)];
    let first = planted.seen(&cameras[0], &pose(), [0.0, 1.0], 60);
    let mut second = planted.seen(&cameras[1], &pose(), [0.3, 0.7], 30);
    // 4 mm beside it, and known to be poor.
    for section in &mut second {
        section.at[1] += 24.0;
        section.deviation = Some(SectionDeviation { w_px: 0.3 * section.w_px, d_px: 0.5 * section.d_px });
    }
    let views = [(cameras[0].clone(), pose(), brow(first)), (cameras[1].clone(), pose(), brow(second))];
    let (frame, tally) = lifted(&views, &Params::default());
    let apart = &tally.apart_mm["brow"];
    assert!(apart.iter().all(|apart| (3.0..6.0).contains(apart)), "{apart:?}");
    let off = worst(&frame.valleys["brow"], &planted)[0];
    assert!(off < 0.1, "the surer camera is followed: {off} mm");
}

#[test]
fn short_gaps_are_bridged_and_long_ones_split() {
    let (planted, camera) = (Planted::default(), camera(10.0));
    let all = planted.seen(&camera, &pose(), [0.0, 1.0], 101);
    // 50 mm of wrinkle: a section every half millimetre.
    let without = |gap: std::ops::Range<usize>| {
        let mut sections = all.clone();
        sections[gap].iter_mut().for_each(|section| section.state = SectionState::Failed);
        lifted(&[(camera.clone(), pose(), brow(sections))], &Params::default())
    };
    let middle = |points: &[ValleyPoint]| points[points.len() / 2];
    let (short, _) = without(48..53);
    assert!(worst(&short.valleys["brow"], &planted)[0] < 0.05);
    assert!(middle(&short.valleys["brow"]).d_mm > 1.4);
    let (long, tally) = without(40..61);
    assert_eq!(middle(&long.valleys["brow"]).d_mm, 0.0);
    assert!(worst(&long.valleys["brow"][..10], &planted)[0] < 0.05);
    assert!((8.0..13.0).contains(&tally.split_mm) && tally.bridged_mm == 0.0, "{}", tally.split_mm);
    assert_eq!(tally.cameras["w1"].lost[&Lost::Unmeasured], 21);
}

#[test]
fn flat_sections_are_flat_where_they_are() {
    let (planted, camera) = (Planted { d_mm: 0.0, ..Planted::default() }, camera(10.0));
    let sections = brow(planted.seen(&camera, &pose(), [0.0, 1.0], 60));
    let (frame, _) = lifted(&[(camera, pose(), sections)], &Params::default());
    let points = &frame.valleys["brow"];
    assert!(points.iter().all(|point| point.d_mm == 0.0));
    let on_line = |point: &ValleyPoint| {
        (0..=500).any(|i| (planted.at(f64::from(i) / 500.0).foot - Point3::from(point.at_mm)).norm() < 0.1)
    };
    assert!(points.iter().all(on_line));
}

#[test]
fn a_camera_that_sees_no_valley_counts_against_shallow_ones_only() {
    let cameras = [camera(-15.0), camera(15.0)];
    let deepest = |d_mm: f64| {
        let seen = |i: usize, d_mm| {
            brow(Planted { d_mm, ..Planted::default() }.seen(&cameras[i], &pose(), [0.0, 1.0], 60))
        };
        let views = [(cameras[0].clone(), pose(), seen(0, d_mm)), (cameras[1].clone(), pose(), seen(1, 0.0))];
        let (frame, _) = lifted(&views, &Params::default());
        frame.valleys["brow"].iter().map(|point| point.d_mm).fold(0.0, f64::max)
    };
    assert_eq!(deepest(0.19), 0.0, "d/w below 0.1");
    assert!((deepest(1.5) - 1.5).abs() < 0.05);
    assert!((0.05..0.29).contains(&deepest(0.3)));
}

#[test]
fn bulges_that_no_skin_has_are_depth_unless_someone_knows_better() {
    let (planted, camera) = (Planted::default(), camera(10.0));
    let deepest = |state: SectionState, doubt: Option<f64>, epsilon: f64| {
        let mut sections = planted.seen(&camera, &pose(), [0.0, 1.0], 60);
        for section in sections.iter_mut().filter(|section| section.d_px > 0.0) {
            let of = |length: f64| doubt.map_or(0.0, |doubt| doubt * length);
            section.deviation =
                doubt.map(|_| SectionDeviation { w_px: of(section.w_px), d_px: of(section.d_px) });
            (section.epsilon, section.state) = (epsilon, state);
        }
        let (frame, _) = lifted(&[(camera.clone(), pose(), brow(sections))], &Params::default());
        frame.valleys["brow"].iter().map(|point| point.d_mm).fold(0.0, f64::max)
    };
    let relief = (1.0 + (0.6f64 - 2.0).exp() / 0.4) / 1.18;
    assert!((deepest(SectionState::Measured, Some(0.05), 0.6) / (1.5 * relief) - 1.0).abs() < 0.03);
    assert!((deepest(SectionState::Measured, Some(0.05), 0.1) - 1.5).abs() < 0.05, "believable as it is");
    let scaled = deepest(SectionState::Edited, Some(0.05), 0.6);
    assert!((scaled / (1.5 * relief) - 1.0).abs() < 0.03, "scaled ones as measured ones");
    assert!((deepest(SectionState::Edited, None, 0.6) - 1.5).abs() < 0.05, "nobody doubts it");
}

#[test]
fn what_the_skin_hides_or_misses_is_counted_and_left_out() {
    let (planted, front) = (Planted::default(), camera(0.0));
    let sections = brow(planted.seen(&front, &pose(), [0.0, 1.0], 60));
    let behind = (camera(180.0), pose(), sections.clone());
    let (frame, tally) = lifted(&[behind], &Params::default());
    assert!(frame.valleys.is_empty());
    assert_eq!(tally.cameras["w1"].lost[&Lost::Hidden], 60, "it sees the back of the skin");
    let mut away = front.clone();
    away.cam_from_world = Isometry3::rotation(Vector3::y() * 1.5) * away.cam_from_world;
    let (frame, tally) = lifted(&[(away, pose(), sections)], &Params::default());
    assert!(frame.valleys.is_empty());
    assert_eq!(tally.cameras["w1"].lost[&Lost::Missed], 60);
    assert_eq!((tally.cameras["w1"].gone, tally.cameras["w1"].example.as_deref()), (1, Some("brow")));
}

#[test]
fn a_coarse_mesh_is_told() {
    let narrow = Planted { w_mm: 0.5, d_mm: 0.3, ..Planted::default() };
    let camera = camera(0.0);
    let sections = brow(narrow.seen(&camera, &pose(), [0.0, 1.0], 60));
    let (_, tally) = lifted(&[(camera, pose(), sections)], &Params::default());
    assert!(tally.coarse > tally.points / 2, "edges of 1.5 mm under a valley of 1 mm");
}

#[test]
fn lengths_along_a_wrinkle_count_alike_in_all_frames() {
    let (planted, camera, mesh) = (Planted::default(), camera(5.0), dome());
    let ground = Ground::of(&mesh);
    let frame = |part| {
        let sections = brow(planted.seen(&camera, &pose(), part, 60));
        lifted(&[(camera.clone(), pose(), sections)], &Params::default()).0
    };
    let mut frames = [frame([0.0, 1.0]), frame([0.3, 0.9])];
    let drift = arrange(&mut frames, &ground, &mesh.positions);
    assert!(drift.iter().all(|off| *off < 0.05) && !drift.is_empty());
    let [whole, part] = frames.map(|frame| frame.valleys["brow"].clone());
    for point in part {
        let same = |a: &&ValleyPoint, b: &&ValleyPoint| {
            (a.x_mm - point.x_mm).abs().total_cmp(&(b.x_mm - point.x_mm).abs())
        };
        let other = whole.iter().min_by(same).unwrap();
        assert!((Point3::from(other.at_mm) - Point3::from(point.at_mm)).norm() < 0.4);
    }
}

#[test]
fn parameters_out_of_range_are_named() {
    let wrong = Params { step_mm: 0.0, ..Params::default() }.check().unwrap_err();
    assert!(wrong.to_string().contains("step-mm is 0"));
}
