//! The recording is what a mocap system would see of the true surfaces.

use nalgebra::{Matrix3, Point3, Vector3};
use std::collections::BTreeSet;
use testkit::face::Face;
use testkit::{Performance, Recording};

fn performance() -> Performance {
    Performance::new(Face::new(1, 8_000), 25)
}

#[test]
fn has_85_markers_on_different_vertices_and_five_on_the_head() {
    let performance = performance();
    let vertices: BTreeSet<u32> = performance.markers.iter().map(|marker| marker.vertex).collect();
    assert_eq!(vertices.len(), 85);
    let names: BTreeSet<String> = performance.marker_names().into_iter().collect();
    assert_eq!(names.len(), 90);
    for name in ["lip_upper_2", "lip_corner_l", "lid_upper_r", "brow_l_1", "head_5"] {
        assert!(names.contains(name), "{name}");
    }
}

#[test]
fn starts_and_ends_neutral_and_every_marker_moves_with_its_vertex() {
    let performance = performance();
    assert!(performance.surface(0) == performance.face.mesh().positions);
    let end = performance.surface(24);
    let drift =
        end.iter().zip(&performance.face.mesh().positions).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(drift < 1e-9, "{drift}");
    let surface = performance.surface(6);
    for (marker, point) in performance.markers.iter().zip(performance.true_markers(6)) {
        assert_eq!(point, surface[marker.vertex as usize]);
    }
    assert_eq!(performance.weights[6].jaw_open, 1.0);
    assert_eq!(performance.weights[6].smile, 0.0);
}

#[test]
fn the_head_moves_rigidly_from_its_first_pose() {
    let performance = performance();
    let recording = Recording::default();
    let seen = performance.record(&recording, None);
    let first = performance.world_from_head(&recording, 0);
    assert!(first.rotation.angle() < 1e-12 && first.translation.vector.norm() < 1e-12);
    let turns =
        (0..25).map(|frame| performance.world_from_head(&recording, frame).rotation.angle().to_degrees());
    let largest = turns.fold(0.0, f64::max);
    assert!((3.0..=5.0).contains(&largest), "{largest}°");
    for (frame, sample) in seen.frames.iter().enumerate() {
        let pose = performance.world_from_head(&recording, frame);
        for marker in 85..90 {
            let held = pose * seen.frames[0].points[marker].expect("seen");
            assert!((held - sample.points[marker].expect("seen")).norm() < 1e-9);
        }
    }
}

/// Root mean square of what the best affine map of a set of points onto another leaves, and the largest.
fn affine_residual(from: &[Point3<f64>], onto: &[Point3<f64>]) -> (f64, f64) {
    let mean =
        |points: &[Point3<f64>]| points.iter().map(|p| p.coords).sum::<Vector3<f64>>() / points.len() as f64;
    let (p, q) = (mean(from), mean(onto));
    let pairs = || from.iter().zip(onto).map(|(a, b)| (a.coords - p, b.coords - q));
    let across: Matrix3<f64> = pairs().map(|(a, b)| b * a.transpose()).sum();
    let spread: Matrix3<f64> = pairs().map(|(a, _)| a * a.transpose()).sum();
    let Some(inverse) = spread.try_inverse() else { return (f64::NAN, f64::NAN) };
    let map = across * inverse;
    let left: Vec<f64> = pairs().map(|(a, b)| (map * a - b).norm()).collect();
    let square = left.iter().map(|x| x * x).sum::<f64>() / left.len() as f64;
    (square.sqrt(), left.into_iter().fold(0.0, f64::max))
}

#[test]
fn the_recording_is_bent_by_less_than_three_millimetres() {
    let performance = performance();
    let rest = performance.true_markers(0);
    let carried = |recording: &Recording| -> Vec<Point3<f64>> {
        rest.iter().map(|&point| recording.mocap_from_face(point)).collect()
    };
    let (rms, largest) = affine_residual(&rest, &carried(&Recording::default()));
    assert!(rms > 0.1 && largest < 3.0, "rms {rms}, largest {largest} mm");
    let (rms, _) = affine_residual(&rest, &carried(&Recording { bend_mm: 0.0, ..Recording::default() }));
    assert!(rms < 1e-9);
}

#[test]
fn noise_and_dropouts_are_options() {
    let performance = performance();
    let still = performance.record(&Recording::default(), None);
    assert!(still.frames.iter().flat_map(|frame| &frame.points).all(Option::is_some));
    let noisy =
        performance.record(&Recording { noise_mm: 0.05, dropouts: true, ..Recording::default() }, None);
    let pairs = still.frames.iter().zip(&noisy.frames).flat_map(|(a, b)| a.points.iter().zip(&b.points));
    let off: Vec<f64> = pairs.filter_map(|(a, b)| Some((a.as_ref()? - b.as_ref()?).norm_squared())).collect();
    let sigma = (off.iter().sum::<f64>() / (3.0 * off.len() as f64)).sqrt();
    assert!((0.047..0.053).contains(&sigma), "{sigma} mm");
    let hidden = noisy.frames.iter().flat_map(|frame| &frame.points).filter(|point| point.is_none()).count();
    assert_eq!(hidden, 8);
    assert!(noisy.frames[0].points.iter().all(Option::is_some), "the first frame is whole");
}
