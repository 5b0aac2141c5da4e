//! Recorded takes: a singer with six head markers, and two takes of 41 face markers without any.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests are tests too")]

mod scene;

use artifact::{MarkerFrame, MarkerHeader, Rate, SampleStatus, Trajectories, Unit};
use nalgebra::{Isometry3, Point3};
use scene::{largest_difference, moved, nodding};
use stabilize::{Params, stabilize};

/// What the stage promises.
const INVARIANCE_MM: f64 = 0.02;

fn take(markers: Vec<String>, rate: u32, rows: Vec<Vec<Option<Point3<f64>>>>) -> Trajectories {
    let frame = |(number, points): (i64, Vec<Option<Point3<f64>>>)| MarkerFrame {
        frame: number,
        status: vec![SampleStatus::Measured; points.len()],
        points,
    };
    let frames = (1..).zip(rows).map(frame).collect();
    let header = MarkerHeader { unit: Unit::Mm, rate: Some(Rate::per_second(rate)), markers, take: None };
    Trajectories { header, frames }
}

/// The singer: just enough of C3D for this file (little-endian, real), independent of the project's reader.
fn singer() -> Option<Trajectories> {
    let bytes = artifact::read_bytes(&testkit::data("c3d/Facial-Sing_frames0001-1500.c3d")?).unwrap();
    let word = |at: usize| usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
    let real = |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
    let (count, frame_count, start) = (word(2), word(8) + 1 - word(6), (word(16) - 1) * 512);
    let row = |f: usize| {
        let point = |m: usize| {
            let at = start + 16 * (f * count + m);
            (real(at + 12) >= 0.0).then(|| Point3::new(real(at), real(at + 4), real(at + 8)))
        };
        (0..count).map(point).collect()
    };
    let labels = bytes.windows(6).position(|window| window == b"LABELS").unwrap() + 6;
    let width = usize::from(bytes[labels + 4]);
    let label = |m: usize| {
        let at = labels + 6 + m * width;
        String::from_utf8_lossy(&bytes[at..at + width]).trim().to_string()
    };
    Some(take((0..count).map(label).collect(), 100, (0..frame_count).map(row).collect()))
}

/// AnimFace (Miguel Ramos Carretero, CC BY-SA 4.0): centimetres, 60 Hz.
fn animface(name: &str) -> Option<Trajectories> {
    let text = artifact::read_text(&testkit::data(&format!("face_markers_animface/{name}.csv"))?).unwrap();
    let mut lines = text.lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').skip(1).collect();
    let markers = columns.chunks(3).map(|c| c[0].trim_end_matches("_x").to_string()).collect();
    let row = |line: &str| {
        let numbers: Vec<f64> =
            line.split(',').skip(1).map(|cell| 10.0 * cell.parse::<f64>().unwrap()).collect();
        numbers.chunks(3).map(|p| Some(Point3::new(p[0], p[1], p[2]))).collect()
    };
    Some(take(markers, 60, lines.map(row).collect()))
}

fn roots() -> Params {
    Params { head_markers: vec!["root-*".into()], drop: vec!["Unlabeled*".into()], ..Default::default() }
}

/// Around frames 819 to 862 three labels of the singer's eyes are mixed up. Elsewhere nothing is.
#[test]
fn the_singers_mixed_up_labels_are_found_and_nothing_else() {
    let Some(take) = singer() else { return };
    let report = stabilize(&take, &roots()).unwrap().report;
    let jumps: Vec<_> = report.jumps.iter().map(|jump| (jump.marker.as_str(), jump.frames)).collect();
    assert_eq!(
        jumps,
        [("section3-1", [821, 843]), ("section3-2", [821, 862]), ("section4-2", [844, 863])],
        "slides across the face, and a stay at section4-1's place"
    );
    assert!(report.jumps.iter().all(|jump| jump.removed));
    assert!(
        (60.0..75.0).contains(&report.jumps[0].step_mm) && (60.0..75.0).contains(&report.jumps[1].step_mm)
    );
    assert_eq!(report.jumps[2].at_place_of[0].marker, "section4-1");
    let missing = |id: &str| report.gaps[id].missing;
    assert_eq!(["section3-1", "section4-1", "section4-2", "section13-2"].map(missing), [33, 42, 110, 55]);
    assert_eq!((report.pose_gap_frames, report.never_seen.len()), (0, 0));
    assert!(report.residual_rms_mm < 1.0, "{}", report.residual_rms_mm);
}

#[test]
fn fast_real_speech_is_no_jump() {
    for name in ["jaw", "eyebrows"] {
        let Some(take) = animface(name) else { return };
        assert_eq!(stabilize(&take, &Params::default()).unwrap().report.jumps, [], "{name}");
    }
}

#[test]
fn a_planted_head_motion_changes_no_face() {
    let takes = [(singer(), roots()), (animface("jaw"), Params::default())];
    for (take, params) in takes.into_iter().filter_map(|(take, params)| Some((take?, params))) {
        let still = stabilize(&take, &params).unwrap();
        let shaken = stabilize(&moved(&take, nodding), &params).unwrap();
        let at = take.frames.iter().position(|f| f.frame == still.pose_header.reference_frame).unwrap();
        let gauge: Isometry3<f64> = nodding(at);
        let worst = largest_difference(&shaken.head, &still.head, &gauge);
        assert!(worst < INVARIANCE_MM, "{worst} mm");
    }
}

/// A jump away and back while the jaw is open, when the lip is far from its usual place anyhow.
#[test]
fn a_jump_of_an_open_mouth_takes_no_more_than_the_jump() {
    let Some(mut take) = animface("jaw") else { return };
    let lip = take.marker("Mouth_Down").unwrap();
    take.frames[431..440].iter_mut().for_each(|frame| frame.points[lip].as_mut().unwrap().z += 25.0);
    let jumps = stabilize(&take, &Params::default()).unwrap().report.jumps;
    let found: Vec<_> = jumps.iter().map(|jump| (jump.marker.as_str(), jump.frames, jump.removed)).collect();
    assert_eq!(found, [("Mouth_Down", [432, 440], true)]);
}
