//! Whole takes through the library: rest frame, missing markers, warnings, displacements.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod scene;

use artifact::{
    Correspondence, FileRef, MarkerFrame, MarkerHeader, MeshRef, Pair, SampleStatus, TakeRef, Trajectories,
    Unit,
};
use nalgebra::Point3;
use operators::{Inverse, InvertParams};
use rbf_warp::*;
use scene::*;

const REST: i64 = 1007;

struct Take {
    trajectories: Trajectories,
    correspondence: Correspondence,
    positions: Points,
}

fn source() -> Source {
    let trajectories = FileRef { name: "head.jsonl".into(), sha256: "a".repeat(64) };
    Source { trajectories, take: None }
}

/// Markers that open and close an expression; at frame 1007 they are those of the scan, moved rigidly.
fn take(count: usize) -> Take {
    let rng = &mut rng(11);
    let positions = face(count, rng);
    let face_from_mocap = rigid(rng);
    let ids = names(count);
    let frame = |number: i64| {
        let share = (number - REST) as f64;
        let point = |(i, p): (usize, &Point3<f64>)| {
            let bend =
                nalgebra::Vector3::new(0.0, 0.3 * share * (p.x / 20.0).sin(), 0.2 * share * (i % 3) as f64);
            Some(face_from_mocap.inverse() * (p + bend))
        };
        MarkerFrame {
            frame: number,
            points: positions.iter().enumerate().map(point).collect(),
            status: vec![SampleStatus::Measured; count],
        }
    };
    let header = MarkerHeader { unit: Unit::Mm, rate: None, markers: ids.clone(), take: None };
    let trajectories = Trajectories { header, frames: (1001..1015).map(frame).collect() };
    let file = FileRef { name: "scan.obj".into(), sha256: "b".repeat(64) };
    let mesh = MeshRef { file, unit: Unit::Mm, vertex_count: count };
    let pair =
        |(i, marker): (usize, String)| Pair { marker, vertex: i as u32, position_mm: positions[i].into() };
    let pairs = ids.into_iter().enumerate().map(pair).collect();
    Take { trajectories, correspondence: Correspondence { mesh, pairs }, positions }
}

fn fit(take: &Take, params: &FitParams) -> rbf_warp::Result<FittedWarp> {
    fit_warp(&take.trajectories, source(), &take.correspondence, &take.positions, params)
}

#[test]
fn the_frame_most_like_the_scan_is_rest() {
    let fitted = fit(&take(40), &FitParams::default()).unwrap();
    assert_eq!(fitted.warp.rest_frame, REST);
    assert!(fitted.warp.fit.similarity_rms_mm < 1e-9);
    assert!((fitted.warp.fit.smallest_determinant - 1.0).abs() < 1e-6);
    assert_eq!(fitted.warnings, []);
}

#[test]
fn a_frame_that_hides_markers_is_not_rest() {
    let mut take = take(40);
    take.trajectories.frames[1].points[..30].fill(None);
    take.trajectories.frames.remove((REST - 1001) as usize);
    let fitted = fit(&take, &FitParams::default()).unwrap();
    assert_ne!(fitted.warp.rest_frame, 1002);
}

#[test]
fn rest_displacements_are_zero_and_the_others_follow_the_face() {
    let take = take(40);
    let warp = fit(&take, &FitParams::default()).unwrap().warp;
    let displacer = Displacer::new(&warp, &take.trajectories.header);
    let mut frame = take.trajectories.frames[0].clone();
    frame.points[3] = None;
    let moved = displacer.frame(&frame);
    assert_eq!(moved.displacements[3], None);
    // The warp is rigid here, so displacements are those planted.
    let planted = -6.0 * 0.3 * (take.positions[4].x / 20.0).sin();
    assert!((moved.displacements[4].unwrap().y - planted).abs() < 1e-8);
    let rest = displacer.frame(&take.trajectories.frames[6]);
    assert!(rest.displacements.iter().flatten().all(|d| d.norm() < 1e-12));
}

#[test]
fn a_marker_missing_at_rest_comes_from_its_neighbours_in_time() {
    let mut take = take(40);
    let truth = take.trajectories.frames[6].points[5].unwrap();
    take.trajectories.frames[5].points[5] = None;
    take.trajectories.frames[6].points[5] = None;
    let params = FitParams { rest_frame: RestFrame::Number(REST), ..FitParams::default() };
    let fitted = fit(&take, &params).unwrap();
    assert_eq!(fitted.warnings, [Warning::FilledAtRest { marker: "m5".into(), frame: REST }]);
    let center = map_of(&fitted.warp.face_from_mocap).centers()[5];
    assert!((center - truth).norm() < 1e-6, "motion is linear in time");
}

#[test]
fn a_marker_missing_for_longer_is_left_out_by_name() {
    let mut take = take(40);
    take.trajectories.frames[4..9].iter_mut().for_each(|frame| frame.points[5] = None);
    let params = FitParams { rest_frame: RestFrame::Number(REST), fill_frames: 2, ..FitParams::default() };
    let fitted = fit(&take, &params).unwrap();
    assert!(fitted.warp.fit.left_out["m5"].contains("within 2 frames"));
    assert!(!fitted.warp.markers.contains(&"m5".to_string()));
    assert_eq!(fitted.warp.markers.len(), 39);
}

#[test]
fn markers_without_a_partner_are_named() {
    let mut take = take(40);
    take.correspondence.pairs[7].marker = "ghost".into();
    let fitted = fit(&take, &FitParams::default()).unwrap();
    let left_out = &fitted.warp.fit.left_out;
    assert_eq!(left_out["ghost"], "not in the trajectories");
    assert_eq!(left_out["m7"], "not picked on the scan");
    assert!(fitted.warnings.iter().any(|w| w.to_string().contains("ghost")));
}

#[test]
fn a_wrong_unit_and_a_wrong_pick_are_noticed() {
    let mut take = take(40);
    for frame in &mut take.trajectories.frames {
        frame.points.iter_mut().flatten().for_each(|p| *p /= 10.0);
    }
    let fitted = fit(&take, &FitParams::default()).unwrap();
    assert!((fitted.warp.fit.similarity_scale - 10.0).abs() < 1e-6);
    assert!(fitted.warnings.iter().any(|w| matches!(w, Warning::Units { .. })));

    let mut take = self::take(40);
    let (a, b) = (take.correspondence.pairs[2].clone(), take.correspondence.pairs[20].clone());
    (take.correspondence.pairs[2].marker, take.correspondence.pairs[20].marker) = (b.marker, a.marker);
    let fitted =
        fit(&take, &FitParams { rest_frame: RestFrame::Number(REST), ..FitParams::default() }).unwrap();
    let blamed =
        |w: &Warning| matches!(w, Warning::Suspicious { marker, .. } if marker == "m2" || marker == "m20");
    assert!(fitted.warnings.iter().any(blamed), "{:?}", fitted.warnings);
    assert!(fitted.warnings.iter().any(|w| matches!(w, Warning::Folded { .. } | Warning::Unreached { .. })));
}

#[test]
fn another_mesh_and_an_unknown_frame_are_refused() {
    let mut take = take(40);
    let params = FitParams { rest_frame: RestFrame::Number(3), ..FitParams::default() };
    assert_eq!(fit(&take, &params).unwrap_err(), Error::NoSuchFrame { frame: 3, first: 1001, last: 1014 });
    take.positions[9].x += 1.0;
    let refused = Error::OtherMesh { marker: "m9".into(), vertex: 9 };
    assert_eq!(fit(&take, &FitParams::default()).unwrap_err(), refused);
}

#[test]
fn a_warp_serves_its_own_file_and_its_session() {
    let mut warp = fit(&take(20), &FitParams::default()).unwrap().warp;
    let other = FileRef { name: "other.jsonl".into(), sha256: "c".repeat(64) };
    let of = |take: &str, session: &str| TakeRef {
        take: take.into(),
        session: session.into(),
        sha256: take.repeat(64),
    };
    assert_eq!(mismatch(&warp, &warp.trajectories, None), None);
    assert!(mismatch(&warp, &other, None).is_some());
    assert!(mismatch(&warp, &other, Some(&of("2", "monday"))).is_some());
    warp.take = Some(of("1", "monday"));
    assert_eq!(mismatch(&warp, &other, Some(&of("2", "monday"))), None);
    assert!(mismatch(&warp, &other, Some(&of("3", "tuesday"))).unwrap().contains("tuesday"));
    assert!(mismatch(&warp, &FileRef { name: "-".into(), sha256: String::new() }, None).is_some());
}

#[test]
fn a_point_that_the_warp_does_not_reach_is_not_found() {
    // A fold: y = x² like, so that some places have no preimage.
    let from = face(60, &mut rng(21));
    let to: Points = from.iter().map(|p| Point3::new(p.x * p.x / 50.0, p.y, p.z)).collect();
    let names = names(60);
    let fit = |from, to| fit_interpolant(pairs(&names, from, to), Degree::Quadratic).unwrap().interpolant;
    let (forward, backward) = (map_of(&fit(&from, &to)), map_of(&fit(&to, &from)));
    let inverse = Inverse::of(forward, backward, InvertParams::default());
    let found = inverse.preimages(&[Point3::new(-40.0, 0.0, 80.0), Point3::new(20.0, 0.0, 80.0)]);
    assert!(!inverse.is_found(&found[0]) && found[0].residual_mm > 1.0);
    assert!(inverse.is_found(&found[1]) && found[1].determinant > 0.0, "{:?}", found[1]);
}

#[test]
fn picks_snap_to_the_nearest_vertex() {
    let positions = face(50, &mut rng(31));
    let file = FileRef { name: "scan.obj".into(), sha256: "b".repeat(64) };
    let mesh = MeshRef { file, unit: Unit::Mm, vertex_count: 50 };
    let snap = |picks: &[(&str, Place)]| {
        let picks: Vec<_> = picks.iter().map(|(id, place)| (id.to_string(), *place)).collect();
        correspond(&picks, &positions, mesh.clone(), 3.0)
    };
    let beside =
        |vertex: usize, mm: f64| Place::Point(positions[vertex] + nalgebra::Vector3::new(0.0, 0.0, mm));
    let snapped = snap(&[("a", beside(7, 0.5)), ("b", Place::Vertex(9))]).unwrap();
    assert_eq!(snapped.correspondence.pairs[0].vertex, 7);
    assert_eq!(snapped.correspondence.pairs[1].vertex, 9);
    assert!((snapped.distances_mm[0] - 0.5).abs() < 1e-12);
    assert!(matches!(snap(&[("a", beside(7, 400.0))]), Err(Error::FarPick { .. })));
    let same = Error::SameVertex { first: "a".into(), second: "b".into(), vertex: 7 };
    assert_eq!(snap(&[("a", beside(7, 0.5)), ("b", Place::Vertex(7))]).unwrap_err(), same);
    assert_eq!(
        snap(&[("a", Place::Vertex(1)), ("a", Place::Vertex(2))]).unwrap_err(),
        Error::PickedTwice { marker: "a".into() }
    );
    assert!(matches!(snap(&[("a", Place::Vertex(50))]), Err(Error::NoSuchVertex { .. })));
    assert!(matches!(snap(&[]), Err(Error::Nothing { .. })));
    assert!(matches!(
        snap(&[("a", Place::Point(Point3::new(f64::NAN, 0.0, 0.0)))]),
        Err(Error::NotFinite { .. })
    ));
}
