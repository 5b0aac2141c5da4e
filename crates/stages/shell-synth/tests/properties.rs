//! Laws that the stage keeps.
#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

mod support;

use nalgebra::{Point3, Rotation3, Vector3};
use shell_synth::{Error, Params, Refinement, Synthesis, Track};
use support::{at, frame, ids, plate, pushed, valley};

fn farthest(a: &[Point3<f64>], b: &[Point3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// Two valleys 6 mm apart, w = 1 mm.
fn pair(depth: f64) -> Synthesis {
    let valleys = [frame(1, &[("a", valley(20, 0.0, 1.0, depth)), ("b", valley(40, 0.0, 1.0, depth))])];
    Synthesis::new(&plate(), &ids(&["a", "b"]), &valleys, &Params::default()).unwrap()
}

#[test]
fn a_valley_is_as_deep_as_measured_and_a_bulge_rises_between_two() {
    let made = pair(0.6).frame(1, &pushed(0.92), None).unwrap();
    for row in [20, 40] {
        assert!((made.positions[at(30, row)].z + 0.6).abs() < 1e-9, "{}", made.positions[at(30, row)].z);
    }
    let between = made.positions[at(30, 30)].z;
    assert!((0.03..0.5).contains(&between), "{between}");
    assert!(made.regions.iter().all(|region| region.inverted_triangles == 0 && region.descent.converged));
}

#[test]
fn without_a_valley_a_frame_comes_back_as_it_is() {
    let large = pushed(0.9);
    let closed = pair(0.0).frame(1, &large, None).unwrap();
    assert!(closed.positions == large && closed.regions.is_empty());
    let far_in_time = pair(0.6).frame(500, &large, None).unwrap();
    assert_eq!(far_in_time.positions, large);
}

#[test]
fn what_no_valley_reaches_does_not_move_by_a_bit() {
    let large = pushed(0.95);
    let made = pair(0.6).frame(1, &large, None).unwrap();
    // Reach is 5 w = 5 mm.
    let mut still = 0;
    for row in (0..3).chain(58..61) {
        for column in 0..61 {
            assert_eq!(made.positions[at(column, row)], large[at(column, row)]);
            still += 1;
        }
    }
    assert_eq!(still, 366);
}

#[test]
fn the_energy_never_rises() {
    for region in pair(0.6).frame(1, &pushed(0.92), None).unwrap().regions {
        assert!(region.descent.energy <= region.descent.first_energy, "{region:?}");
        assert!(!region.levels.is_empty(), "{region:?}");
        assert!(region.levels.iter().all(|level| level.energy <= level.first_energy), "{region:?}");
    }
}

#[test]
fn a_rigid_motion_moves_the_result_rigidly() {
    let synthesis = pair(0.6);
    let turn = Rotation3::from_scaled_axis(Vector3::new(0.4, -0.9, 0.3));
    let moved = |points: &[Point3<f64>]| -> Vec<Point3<f64>> {
        points.iter().map(|p| turn * p + Vector3::new(30.0, -20.0, 50.0)).collect()
    };
    // Domed, since a flat plate that is pushed has two folds of the same energy.
    let large: Vec<Point3<f64>> = pushed(0.97)
        .iter()
        .map(|p| Point3::new(p.x, p.y, ((p.x - 9.0) * (p.x - 9.0) + (p.y - 9.0) * (p.y - 9.0)) / -60.0))
        .collect();
    let here = synthesis.frame(1, &large, None).unwrap();
    let there = synthesis.frame(1, &moved(&large), None).unwrap();
    let apart = farthest(&moved(&here.positions), &there.positions);
    assert!(apart < 1e-3, "{apart}");
}

#[test]
fn a_frame_does_not_depend_on_where_the_sequence_starts() {
    // First the skin is pushed, then the valleys deepen: the way that leads a naive warm start into another fold.
    let depths = [0.0, 0.0, 0.15, 0.3, 0.5, 0.7];
    let given: Vec<_> = (0..6)
        .map(|t| {
            frame(
                t,
                &[
                    ("a", valley(24, 0.0, 1.0, depths[t as usize])),
                    ("b", valley(36, 0.0, 1.0, depths[t as usize])),
                ],
            )
        })
        .collect();
    let synthesis = Synthesis::new(&plate(), &ids(&["a", "b"]), &given, &Params::default()).unwrap();
    let large = |t: i64| pushed(1.0 - 0.08 * (t as f64 / 2.0).min(1.0));
    let mut before = None;
    let mut warm = 0;
    for t in 0..6 {
        let cold = synthesis.frame(t, &large(t), None).unwrap();
        let chained = synthesis.frame(t, &large(t), before.as_ref()).unwrap();
        warm += chained.regions.iter().filter(|region| region.warm).count();
        assert!(farthest(&cold.positions, &chained.positions) < 0.01, "frame {t}");
        before = Some(chained.memory);
    }
    assert!(warm > 0, "no frame started from the one before");
}

#[test]
fn between_known_frames_depth_lies_between() {
    let given = [
        frame(0, &[]),
        frame(4, &[("a", valley(30, 0.0, 1.2, 0.8))]),
        frame(8, &[("a", valley(30, 0.0, 1.2, 0.8))]),
    ];
    let synthesis = Synthesis::new(&plate(), &ids(&["a"]), &given, &Params::default()).unwrap();
    let depth = |t: i64| -synthesis.frame(t, &pushed(0.97), None).unwrap().positions[at(30, 30)].z;
    let depths: Vec<f64> = (0..=6).map(depth).collect();
    assert_eq!(depths[0], 0.0, "an appearing wrinkle comes from nothing");
    assert!(depths.windows(2).all(|pair| pair[1] >= pair[0] - 1e-6), "{depths:?}");
    assert!((depths[4] - 0.8).abs() < 1e-9 && (depths[6] - 0.8).abs() < 1e-9, "{depths:?}");
}

#[test]
fn a_crease_that_wanders_is_put_back() {
    let given: Vec<_> = (0..5)
        .map(|t| frame(t, &[("a", valley(30, [0.0, 0.06, 0.12, 0.18, 0.24][t as usize], 1.2, 0.8))]))
        .collect();
    let made = |track: Track| {
        let params = Params { track, ..Params::default() };
        let synthesis = Synthesis::new(&plate(), &ids(&["a"]), &given, &params).unwrap();
        let drift = synthesis.creases()[0].drift;
        let frames: Vec<_> =
            [0, 4].map(|t| synthesis.frame(t, &pushed(0.97), None).unwrap().positions).into();
        (drift, farthest(&frames[0], &frames[1]))
    };
    let ((steady, still), (wandering, moved)) = (made(Track::Steady), made(Track::AsFound));
    assert!((steady.found_mm - 0.12).abs() < 0.01 && steady.used_mm == 0.0, "{steady:?}");
    assert!(still < 1e-9 && moved > 0.05, "{still} {moved}");
    assert!(wandering.used_mm > 0.1);
}

#[test]
fn a_small_shift_of_a_valley_makes_no_vertex_jump() {
    let made = |shift: f64| {
        let given = [frame(1, &[("a", valley(30, shift, 1.03, 0.6))])];
        let synthesis = Synthesis::new(&plate(), &ids(&["a"]), &given, &Params::default()).unwrap();
        synthesis.frame(1, &pushed(0.96), None).unwrap().positions
    };
    for shift in [0.05, 0.08, 0.11, 0.14] {
        let jump = farthest(&made(shift), &made(shift + 0.01));
        assert!(jump < 0.04, "{jump} mm at {shift}");
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let with = |count: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
        pool.install(|| pair(0.6).frame(1, &pushed(0.95), None).unwrap())
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn a_valley_at_rest_is_found() {
    let mut scan = plate();
    let profile = artifact::ProfileShape { w: 1.2, d: 0.5, epsilon: 0.2, kappa: 0.0 };
    scan.positions.iter_mut().for_each(|p| p.z += profile.at(p.y - 9.0).0);
    let given = [frame(1, &[("a", valley(30, 0.0, 1.2, 0.8))])];
    let depth = |mesh: &mesh::Mesh| {
        Synthesis::new(mesh, &ids(&["a"]), &given, &Params::default()).unwrap().creases()[0].at_rest_mm
    };
    assert!((depth(&scan) - 0.5).abs() < 0.15, "{}", depth(&scan));
    assert!(depth(&plate()).abs() < 1e-9);
}

#[test]
fn valleys_of_another_mesh_are_refused_by_name() {
    let mut points = valley(30, 0.0, 1.0, 0.5);
    points[7].face = 9_000_000;
    let refused = Synthesis::new(&plate(), &ids(&["a"]), &[frame(3, &[("a", points)])], &Params::default());
    let Err(Error::NoSuchTriangle { frame, wrinkle, point, .. }) = refused else { panic!("it was taken") };
    assert_eq!((frame, wrinkle.as_str(), point), (3, "a", 7));
}

#[test]
fn a_frame_of_another_mesh_is_refused() {
    let refused = pair(0.5).frame(1, &[Point3::origin()], None);
    assert_eq!(refused, Err(Error::VertexCount { found: 1, expected: 3721 }));
}

#[test]
fn the_papers_shell_settles() {
    let valleys = [frame(1, &[("a", valley(30, 0.0, 1.2, 0.5))])];
    let synthesis = Synthesis::new(&plate(), &ids(&["a"]), &valleys, &Params::paper()).unwrap();
    let made = synthesis.frame(1, &pushed(0.99), None).unwrap();
    assert!(made.regions.iter().all(|region| region.descent.converged));
    assert!((made.positions[at(30, 30)].z + 0.5).abs() < 1e-9);
}

/// Length of the longest edge of the triangles whose middle is within `reach` mm of the valley in row 30.
fn longest_near(mesh: &mesh::Mesh, reach: f64) -> f64 {
    let mut longest = 0.0f64;
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|vertex| mesh.positions[vertex as usize]);
        let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        if (middle.y - 9.0).abs() < reach && (5.0..13.0).contains(&middle.x) {
            longest = longest.max((b - a).norm()).max((c - b).norm()).max((a - c).norm());
        }
    }
    longest
}

#[test]
fn a_finer_mesh_has_edges_enough_and_is_the_same_surface() {
    let valleys = [frame(1, &[("a", valley(30, 0.0, 0.4, 0.3))])];
    let scan = plate();
    let made = Refinement::new(&scan, &ids(&["a"]), &valleys, 6.0, &Params::default()).unwrap();
    assert!(longest_near(&scan, 0.4) > 0.3 && longest_near(&made.mesh, 0.4) <= 0.8 / 6.0 + 1e-9);
    let triangles = made.mesh.triangles();
    let area: f64 = mesh::triangle_areas(&made.mesh.positions, &triangles).iter().sum();
    assert!((area - 18.0 * 18.0).abs() < 1e-9, "{area}");
    // Triangles fit: the boundary has not grown a hole, and far from the valley nothing changes.
    let around = mesh::Connectivity::of(made.mesh.positions.len(), &triangles);
    assert_eq!(around.boundary_loops().len(), 1);
    let far =
        made.mesh.positions[scan.positions.len()..].iter().map(|p| (p.y - 9.0).abs()).fold(0.0, f64::max);
    assert!(far < 4.0, "{far}");
    // Every triangle keeps a third of the least angle at rest, and its side.
    for corners in triangles {
        let [a, b, c] = corners.map(|vertex| made.mesh.positions[vertex as usize]);
        assert!((b - a).cross(&(c - a)).z > 0.0 && (b - a).angle(&(c - a)) > 0.26);
    }
}

#[test]
fn frames_and_valleys_are_carried_to_the_finer_mesh() {
    let valleys = [frame(1, &[("a", valley(30, 0.1, 0.4, 0.3))])];
    let scan = plate();
    let made = Refinement::new(&scan, &ids(&["a"]), &valleys, 6.0, &Params::default()).unwrap();
    let affine = |p: &Point3<f64>| Point3::new(p.x + 0.2 * p.y, 0.9 * p.y, 0.3 * p.x);
    let carried = made.carry(&scan.positions.iter().map(affine).collect::<Vec<_>>());
    let expected: Vec<Point3<f64>> = made.mesh.positions.iter().map(affine).collect();
    assert!(farthest(&carried, &expected) < 1e-12);
    let place = |mesh: &mesh::Mesh, point: &artifact::ValleyPoint| -> Point3<f64> {
        let corners = mesh.triangles()[point.face as usize];
        let at: Vector3<f64> =
            (0..3).map(|i| mesh.positions[corners[i] as usize].coords * point.barycentric[i]).sum();
        Point3::from(at)
    };
    let finer = made.valleys(&scan, &valleys);
    for (new, old) in finer[0].valleys["a"].iter().zip(&valleys[0].valleys["a"]) {
        assert!((place(&made.mesh, new) - place(&scan, old)).norm() < 1e-9);
    }
    let depth = |mesh: &mesh::Mesh, valleys: &[artifact::ValleysFrame]| {
        let synthesis = Synthesis::new(mesh, &ids(&["a"]), valleys, &Params::default()).unwrap();
        let made = synthesis.frame(1, &mesh.positions, None).unwrap();
        made.positions.iter().map(|p| -p.z).fold(0.0, f64::max)
    };
    let deep = depth(&made.mesh, &finer);
    assert!((deep - 0.3).abs() < 0.02 && deep > depth(&scan, &valleys) + 0.02, "{deep}");
}

#[test]
fn both_sides_of_a_fold_that_closes_stay_apart() {
    // A deep narrow fold, in skin that is pushed together to half of its length.
    let crossed = |self_contact: bool| {
        let valleys = [frame(1, &[("a", valley(30, 0.0, 0.6, 3.0))])];
        let params = Params { self_contact, influence_widths: 12.0, ..Params::default() };
        let synthesis = Synthesis::new(&plate(), &ids(&["a"]), &valleys, &params).unwrap();
        let made = synthesis.frame(1, &pushed(0.5), None).unwrap();
        assert!(made.regions.iter().all(|region| region.descent.converged));
        let line = 9.0 * 0.5;
        // How far vertices of one side lie beyond the crease, where the valley is.
        let beyond = |row: u32| {
            let side = if row > 30 { 1.0 } else { -1.0 };
            (22..39).map(|column| side * (line - made.positions[at(column, row)].y)).fold(0.0, f64::max)
        };
        (20..=40).filter(|&row| row != 30).map(beyond).fold(0.0, f64::max)
    };
    let (without, with) = (crossed(false), crossed(true));
    assert!(without > 0.1, "the case is none: {without}");
    assert!(with < 0.01, "{with}");
}
