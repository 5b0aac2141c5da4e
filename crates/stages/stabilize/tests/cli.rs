//! The binary: what it writes, and how it refuses.
#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

mod scene;

use artifact::{FrameReader, HeadPose, HeadTrajectories, Trajectories, Trajectories3d};
use assert_cmd::Command;
use scene::{HEAD_COUNT, hide, moved, nodding, talking};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

fn write(folder: &TempDir, name: &str, take: &Trajectories) {
    take.write::<Trajectories3d>(&folder.path().join(name)).unwrap().publish().unwrap();
}

fn nodding_take() -> Trajectories {
    moved(&talking(40, 0.05, 1), nodding)
}

/// Runs in the folder, on `take.jsonl`, with more arguments.
fn stabilize(folder: &TempDir, arguments: &[&str]) -> std::process::Output {
    let mut command = Command::cargo_bin("stabilize").unwrap();
    command.current_dir(folder.path()).args([
        "--markers",
        "take.jsonl",
        "--out",
        "head.jsonl",
        "--pose",
        "pose.jsonl",
    ]);
    command.args(arguments).output().unwrap()
}

const NAMED: [&str; 2] = ["--head-markers", "head-*"];

/// Exit 1, all parts in the message, nothing left but the inputs.
fn assert_refused(folder: &TempDir, arguments: &[&str], parts: &[&str]) {
    let before = listing(folder.path());
    let output = stabilize(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{message}");
    for part in parts {
        assert!(message.contains(part), "'{part}' is not said in: {message}");
    }
    assert_eq!(listing(folder.path()), before, "nothing may be left");
}

#[allow(clippy::disallowed_methods, reason = "the test looks what was left")]
fn listing(folder: &Path) -> Vec<String> {
    let names = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[allow(clippy::disallowed_methods, reason = "the test plants bad files and reads side-cars")]
fn plant(folder: &TempDir, name: &str, text: &str) {
    std::fs::write(folder.path().join(name), text).unwrap();
}

#[allow(clippy::disallowed_methods, reason = "the test compares bytes")]
fn bytes(folder: &TempDir, name: &str) -> Vec<u8> {
    std::fs::read(folder.path().join(name)).unwrap()
}

#[test]
fn it_writes_both_kinds_with_side_cars_and_a_summary() {
    let folder = tempfile::tempdir().unwrap();
    let mut take = nodding_take();
    hide(&mut take, HEAD_COUNT, 0..40);
    write(&folder, "take.jsonl", &take);
    let output = stabilize(&folder, &["--head-markers", "head-*", "--json", "--reference-frame", "1005"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    let results = &summary["results"];
    assert_eq!(results["head_markers"].as_array().unwrap().len(), HEAD_COUNT);
    assert_eq!((&results["reference_frame"], &results["never_seen"][0]), (&1005.into(), &"face-0".into()));
    assert_eq!(summary["warnings"][0], "marker face-0 is missing in all frames");

    let head = Trajectories::read::<HeadTrajectories>(&folder.path().join("head.jsonl")).unwrap();
    assert_eq!((head.header.markers.len(), head.frames.len()), (30, 40), "head markers are left out");
    let pose = FrameReader::<HeadPose>::open(&folder.path().join("pose.jsonl")).unwrap();
    assert_eq!((pose.header().reference_frame, pose.header().markers.len()), (1005, HEAD_COUNT));
    let side_car: Value = serde_json::from_slice(&bytes(&folder, "pose.jsonl.prov.json")).unwrap();
    assert_eq!(side_car["data"]["results"], *results);
    assert_eq!(side_car["data"]["parameters"]["smooth_ms"], 60.0);
}

#[test]
fn unit_and_frames_stand_in_the_side_cars() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder, "take.jsonl", &nodding_take());
    let parameters = |arguments: &[&str]| -> Value {
        assert!(stabilize(&folder, &[&NAMED, arguments].concat()).status.success());
        let side_car: Value = serde_json::from_slice(&bytes(&folder, "head.jsonl.prov.json")).unwrap();
        side_car["data"]["parameters"].clone()
    };
    let stated = parameters(&["--marker-unit", "mm", "--frames", "1003-"]);
    assert_eq!((&stated["marker_unit"], &stated["frames"]), (&"mm".into(), &"1003-".into()));
    let plain = parameters(&[]);
    assert_eq!((&plain["marker_unit"], &plain["frames"]), (&Value::Null, &"all".into()));
    assert_refused(
        &folder,
        &["--marker-unit", "cm"],
        &["take.jsonl, unit: the file says mm, but --marker-unit says cm"],
    );
}

/// The head is found from the whole take, so that parts written apart join to the whole, byte for byte.
#[test]
fn parts_join_to_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder, "take.jsonl", &nodding_take());
    assert!(stabilize(&folder, &NAMED).status.success());
    let whole = bytes(&folder, "head.jsonl");
    let part = |range: &str| {
        assert!(stabilize(&folder, &["--head-markers", "head-*", "--frames", range]).status.success());
        bytes(&folder, "head.jsonl")
    };
    let (first, second) = (part("-1020"), part("1021-"));
    let header = second.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    assert_eq!([&first[..], &second[header..]].concat(), whole);
}

#[test]
fn it_reads_standard_input_and_writes_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder, "take.jsonl", &nodding_take());
    assert!(stabilize(&folder, &NAMED).status.success());
    let mut command = Command::cargo_bin("stabilize").unwrap();
    command
        .current_dir(folder.path())
        .args(["--markers", "-", "--out", "-", "--pose", "p.jsonl"])
        .args(NAMED);
    let output = command.write_stdin(bytes(&folder, "take.jsonl")).output().unwrap();
    assert!(output.status.success());
    assert_eq!(output.stdout, bytes(&folder, "head.jsonl"));
}

#[test]
fn bad_head_markers_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let mut take = nodding_take();
    for frame in &mut take.frames {
        let [a, b] = [0, 1].map(|m| frame.points[m].unwrap());
        frame.points[2] = Some(nalgebra::center(&a, &b));
    }
    write(&folder, "take.jsonl", &take);
    let named = |ids: &'static str| ["--head-markers", ids];
    assert_refused(
        &folder,
        &named("head-0,head-9"),
        &["take.jsonl", "marker head-9", "did you mean head-0 or head-1"],
    );
    assert_refused(&folder, &named("nose-*"), &["take.jsonl", "nose-*"]);
    assert_refused(
        &folder,
        &named("head-0,head-1"),
        &["take.jsonl", "2 head markers (head-0, head-1)", "three"],
    );
    assert_refused(
        &folder,
        &named("head-0,head-1,head-2"),
        &["take.jsonl", "head-0, head-1, head-2", "line"],
    );
    assert_refused(&folder, &["--head-markers", "head-*", "--drop", "ghost*"], &["take.jsonl", "ghost*"]);
    assert_refused(&folder, &named("head-0"), &["take.jsonl", "1 head marker (head-0)"]);
    write(&folder, "take.jsonl", &nodding_take());
    let all = ["take.jsonl", "the head markers (*) are all 36 markers", "--keep-head-markers"];
    assert_refused(&folder, &named("*"), &all);
}

#[test]
fn frames_that_cannot_serve_are_refused_by_number() {
    let folder = tempfile::tempdir().unwrap();
    let mut take = nodding_take();
    (0..HEAD_COUNT).for_each(|m| hide(&mut take, m, 9..10));
    write(&folder, "take.jsonl", &take);
    let at = |frame: &'static str| ["--head-markers", "head-*", "--reference-frame", frame];
    assert_refused(&folder, &at("1010"), &["take.jsonl, frame 1010", "0 of 6 head markers"]);
    assert_refused(&folder, &at("-3"), &["take.jsonl, frame -3", "1001 to 1040"]);
    assert_refused(&folder, &["--head-markers", "head-*", "--frames", "5-7"], &["take.jsonl", "5-7"]);

    (0..HEAD_COUNT).for_each(|m| hide(&mut take, m, 0..40));
    write(&folder, "take.jsonl", &take);
    assert_refused(&folder, &NAMED, &["take.jsonl", "no frame shows three head markers", "head-0"]);
}

#[test]
fn bad_files_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    assert_refused(&folder, &NAMED, &["take.jsonl", "cannot read"]);
    let header =
        r#"{"schema":"trajectories-3d/1","data":{"unit":"mm","rate":null,"markers":["a","b"],"take":null}}"#;
    plant(&folder, "take.jsonl", header);
    assert_refused(&folder, &[], &["take.jsonl", "holds no frames"]);
    plant(&folder, "take.jsonl", &format!("{header}\n{{\"frame\":4,\"points\":{{\"a\":[1,2,3]}}}}\n"));
    assert_refused(&folder, &[], &["take.jsonl", "no frame rate", "--take"]);
    let untimed = ["--smooth-ms", "0", "--fill-ms", "0", "--jump-mm", "10"];
    assert_refused(&folder, &untimed, &["take.jsonl", "has 1 marker seen"]);
    plant(&folder, "take.jsonl", &header.replace("\"mm\"", "\"cm\""));
    assert_refused(&folder, &[], &["take.jsonl", "unit", "cm"]);
    plant(&folder, "take.jsonl", &header.replace("trajectories-3d", "head-trajectories"));
    assert_refused(&folder, &[], &["take.jsonl", "head-trajectories/1"]);
    plant(&folder, "take.jsonl", &format!("{header}\n{{\"frame\":4,\"points\":{{\"c\":[1,2,3]}}}}\n"));
    assert_refused(&folder, &[], &["take.jsonl", "line 2", "frame 4, marker c"]);
}

fn manifest(rate: u32) -> String {
    format!(
        r#"{{"schema":"take/1","data":{{"subject":"s","session":"d","take":"t","rate":{{"frames":{rate},"seconds":1}},
        "start_timecode":null,"first_frame":1001,"clock":"mocap","mesh_unit":"mm","mesh_up":"y",
        "consent":{{"licence":"test","credit":null,"notes":null}}}}}}"#
    )
}

#[test]
fn the_take_gives_the_rate_and_is_checked() {
    let folder = tempfile::tempdir().unwrap();
    let mut take = nodding_take();
    take.header.rate = None;
    write(&folder, "take.jsonl", &take);
    plant(&folder, "manifest.json", &manifest(100));
    let with_take = ["--head-markers", "head-*", "--take", "manifest.json"];
    assert!(stabilize(&folder, &with_take).status.success());
    let head = Trajectories::read::<HeadTrajectories>(&folder.path().join("head.jsonl")).unwrap();
    assert_eq!(head.header.rate, Some(artifact::Rate::per_second(100)));
    let reference = head.header.take.clone().unwrap();
    assert_eq!(reference.take, "t");

    let folder = tempfile::tempdir().unwrap();
    take.header.rate = Some(artifact::Rate::per_second(60));
    write(&folder, "take.jsonl", &take);
    plant(&folder, "manifest.json", &manifest(100));
    assert_refused(&folder, &with_take, &["take.jsonl", "60 Hz", "manifest.json says 100 Hz"]);
    take.header.rate = None;
    take.header.take = Some(artifact::TakeRef { sha256: "0".repeat(64), ..reference });
    write(&folder, "take.jsonl", &take);
    assert_refused(&folder, &with_take, &["take.jsonl", "was made from take t (sha256 000000000000…)"]);
}

#[test]
fn outputs_must_differ_and_usage_is_exit_2() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder, "take.jsonl", &nodding_take());
    for (option, range) in [
        ("--fill-ms", "a time from 0 to 10000 ms"),
        ("--smooth-ms", "a time from 0 to 10000 ms"),
        ("--jump-mm", "a positive length in mm"),
    ] {
        let output = stabilize(&folder, &[option, "-1"]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("'-1'") && message.contains(range), "{message}");
    }
    let mut command = Command::cargo_bin("stabilize").unwrap();
    command.current_dir(folder.path()).args(["--markers", "take.jsonl", "--out", "x", "--pose", "x"]);
    assert_eq!(command.output().unwrap().status.code(), Some(1));
    assert_eq!(stabilize(&folder, &["--jump-mm", "far"]).status.code(), Some(2));
    assert_eq!(stabilize(&folder, &["--reference-frame", "first"]).status.code(), Some(2));
}

#[test]
fn the_help_says_it_all() {
    let output = Command::cargo_bin("stabilize").unwrap().arg("--help").output().unwrap();
    insta::assert_snapshot!("help", String::from_utf8_lossy(&output.stdout));
}
