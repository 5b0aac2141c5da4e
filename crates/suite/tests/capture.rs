//! From footage to markers, as a user runs it: `tools/capture` on the take of the golden chain, and on the recorded session of
//! four webcams.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::disallowed_methods,
    reason = "a test fails by panicking"
)]

mod support;

use assert_cmd::Command;
use std::path::{Path, PathBuf};
use support::likeness::files;
use support::{Said, binary, said, tiny_face};

fn tool(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tools").join(name)
}

fn capture(folder: &Path, words: &[&str]) -> Said {
    let programs = binary("capture-sync").parent().expect("their folder");
    let mut command = Command::new(tool("capture"));
    said(command.current_dir(folder).env("FURROW_BIN", programs).args(words))
}

/// The golden take, with its calibrated cameras beside it as if they came from elsewhere.
fn take(folder: &Path) {
    let rig = tiny_face().join("00-virtual-rig");
    for file in files(&rig.join("take")) {
        let target = folder.join("take").join(&file);
        std::fs::create_dir_all(target.parent().expect("its folder")).expect("a folder");
        std::fs::copy(rig.join("take").join(&file), target).expect("a copy");
    }
    std::fs::copy(rig.join("truth/cameras-calibrated.json"), folder.join("take/cameras.json"))
        .expect("a copy");
}

#[test]
fn footage_becomes_markers_a_table_and_pictures() {
    let folder = tempfile::tempdir().expect("a folder");
    take(folder.path());
    for round in 0..2 {
        let done = capture(folder.path(), &["take", "out", "--head-markers", "head_*"]);
        assert_eq!(done.code, Some(0), "round {round}: {}", done.stderr);
        let notes = folder.path().join("out/notes.txt");
        assert_eq!(notes.exists(), round > 0, "round {round}");
        std::fs::write(notes, "mine").expect("a file");
    }
    // What a run did not make is not its to remove, and what it did make cannot be given to the next one.
    let again = capture(folder.path(), &["take", "out", "--cameras", "out/cameras.json"]);
    assert!(
        again.code == Some(1) && again.stderr.contains("put it beside the take first"),
        "{}",
        again.stderr
    );
    assert!(folder.path().join("out/notes.txt").exists() && folder.path().join("out/cameras.json").exists());
    for name in [
        "head.jsonl",
        "pose.jsonl",
        "markers.c3d",
        "markers.trc",
        "markers.png",
        "tracks.png",
        "tracks/m1/001001.png",
    ] {
        assert!(folder.path().join("out").join(name).exists(), "{name} is missing");
    }
    let report = std::fs::read_to_string(folder.path().join("out/report.txt")).expect("a report");
    for said in ["reprojection/px", "markers: 86 in 3 frames", "head: head_1", "doctor:"] {
        assert!(report.contains(said), "{said} is not in\n{report}");
    }
}

#[test]
fn what_is_missing_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    take(folder.path());
    let cases: [(&str, &[&str], &str); 5] = [
        ("nothing", &["nowhere", "out"], "nowhere has no take.json"),
        ("no labels", &["take", "out"], "has no labels.json"),
        ("no cameras", &["take", "out"], "bring one, or say --cameras"),
        ("foreign", &["take", "take"], "is no run of capture"),
        ("option", &["take", "out", "--heads", "a"], "there is no option --heads"),
    ];
    for (case, words, expected) in cases {
        match case {
            "no labels" => std::fs::remove_file(folder.path().join("take/labels.json")).expect("a file"),
            "no cameras" => std::fs::remove_file(folder.path().join("take/cameras.json")).expect("a file"),
            _ => {}
        }
        let done = capture(folder.path(), words);
        assert!(done.stderr.contains(expected), "{case}: {}", done.stderr);
        assert_eq!(done.code == Some(0), case == "no labels", "{case}: {:?}", done.code);
    }
}

/// Boards need OpenCV, videos too.
#[cfg(feature = "video")]
#[test]
fn four_webcams_are_calibrated_from_their_own_footage() {
    let Some(data) = testkit::data("multicam_caliscope_4cam") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let made = said(Command::new(tool("board-take")).arg(data).arg(folder.path().join("take")));
    assert_eq!(made.code, Some(0), "{}", made.stderr);
    let done = capture(folder.path(), &["take", "out"]);
    assert_eq!(done.code, Some(0), "{}", done.stderr);
    let cameras =
        std::fs::read_to_string(folder.path().join("out/cameras.json.prov.json")).expect("a side-car");
    let side_car: serde_json::Value = serde_json::from_str(&cameras).expect("JSON");
    let rms = side_car["data"]["results"]["rms_px"].as_f64().expect("a number");
    // Half a pixel is what corners of a moved board in webcams' compressed images have.
    assert!(rms > 0.2 && rms < 0.9, "{rms} px");
    assert!(done.stderr.contains("has no labels.json"), "{}", done.stderr);
}
