//! The binary: what it writes, and how it refuses.
#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod scene;

use artifact::{FrameWriter, Tracks2d, Trajectories, Trajectories3d};
use assert_cmd::Command;
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let rig = scene::rig();
    artifact::write_document(&folder.path().join("cameras.json"), &rig).unwrap().publish().unwrap();
    let mut writer =
        FrameWriter::<Tracks2d>::create(&folder.path().join("tracks.jsonl"), scene::header()).unwrap();
    let mut tracks = scene::tracks(&rig, &scene::still(30), 0.1, 1);
    (0..30).for_each(|frame| (0..6).for_each(|camera| scene::hide(&mut tracks, frame, camera, 5)));
    tracks.iter().for_each(|frame| writer.write(frame).unwrap());
    writer.finish().unwrap().publish().unwrap();
    folder
}

fn triangulate(folder: &Path, arguments: &[&str]) -> std::process::Output {
    let mut command = Command::cargo_bin("triangulate").unwrap();
    command.current_dir(folder).args(["--cameras", "cameras.json", "--tracks", "tracks.jsonl"]);
    command.args(["--out", "out/t.jsonl"]).args(arguments).output().unwrap()
}

fn refused(folder: &Path, arguments: &[&str], parts: &[&str]) {
    let output = triangulate(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{message}");
    parts.iter().for_each(|part| assert!(message.contains(part), "'{part}' is not said in: {message}"));
    let left = folder.join("out").read_dir().map_or(0, Iterator::count);
    assert_eq!(left, 0, "nothing may be left");
}

#[test]
fn it_writes_all_formats_alike_with_a_summary() {
    let folder = folder();
    let more = ["--c3d", "out/t.c3d", "--trc", "out/t.trc", "--picture", "out/t.png", "--json"];
    let output = triangulate(folder.path(), &more);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["results"]["coverage"]["p5"]["missing"], 30);
    assert_eq!(summary["warnings"][0], "no two cameras ever see these markers together: p5");
    let out = |name: &str| folder.path().join("out").join(name);
    let take = Trajectories::read::<Trajectories3d>(&out("t.jsonl")).unwrap();
    for name in ["t.c3d", "t.trc"] {
        let (other, warnings) = artifact::read_trajectories::<Trajectories3d>(&out(name), None).unwrap();
        assert_eq!((&other.header.markers, other.header.rate), (&take.header.markers, take.header.rate));
        assert!(warnings.is_empty(), "{warnings:?}");
        for (a, b) in take.frames.iter().zip(&other.frames) {
            let same = |(a, b): (&Option<nalgebra::Point3<f64>>, &Option<nalgebra::Point3<f64>>)| {
                a.is_some() == b.is_some() && a.zip(*b).is_none_or(|(a, b)| (a - b).norm() < 1e-4)
            };
            assert!(a.frame == b.frame && a.points.iter().zip(&b.points).all(same), "{name}");
        }
    }
    assert!(out("t.jsonl.prov.json").exists() && out("t.png").exists());
}

#[test]
fn threads_change_nothing() {
    let folder = folder();
    let bytes = |threads| {
        assert!(triangulate(folder.path(), &["--threads", threads]).status.success());
        std::fs::read(folder.path().join("out/t.jsonl")).unwrap()
    };
    assert_eq!(bytes("1"), bytes("2"));
}

#[test]
fn bad_tracks_are_refused_with_their_place() {
    let folder = folder();
    let path = folder.path();
    let text = std::fs::read_to_string(path.join("tracks.jsonl")).unwrap();
    let plant = |text: &str| std::fs::write(path.join("tracks.jsonl"), text).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    plant(&format!("{}\n{}\n{}\n", lines[0], lines[1], lines[1]));
    refused(path, &[], &["tracks.jsonl", "line 3", "frame 1001 follows frame 1001"]);
    plant(&text.replace("\"m6\"", "\"m9\""));
    refused(path, &[], &["tracks.jsonl, header", "names camera m9", "m1, m2"]);
    plant(lines[0]);
    refused(path, &[], &["tracks.jsonl", "holds no frames"]);
    let alone: Value = serde_json::from_str(lines[1]).unwrap();
    let alone = serde_json::json!({"frame": 1001, "points": {"m1": alone["points"]["m1"]}});
    plant(&format!("{}\n{alone}\n", lines[0]));
    refused(path, &[], &["tracks.jsonl", "no marker is seen by two cameras"]);
    plant(&text.replacen("\"p0\":[", "\"p0\":[9", 1));
    refused(
        path,
        &[],
        &["tracks.jsonl, frame 1001, camera m1, marker p0", "outside the camera's image of 656 × 490"],
    );
    plant(&text.replace("\"frame\":1030", "\"frame\":99999"));
    refused(
        path,
        &["--c3d", "out/t.c3d"],
        &["30 frames between 1001 and 99999", "would hold 98999", "to do"],
    );
    plant(&text);
    refused(path, &["--c3d", "out/t.bin"], &["out/t.bin", ".c3d"]);
    let mut command = Command::cargo_bin("triangulate").unwrap();
    command.current_dir(path).args([
        "--cameras",
        "cameras.json",
        "--tracks",
        "tracks.jsonl",
        "--out",
        "t.C3D",
    ]);
    let output = command.output().unwrap();
    assert!(output.status.code() == Some(1) && !path.join("t.C3D").exists());
    assert!(
        String::from_utf8_lossy(&output.stderr).contains("t.C3D: --out writes trajectories-3d as JSON Lines")
    );
}

#[test]
fn a_calibration_of_larger_images_is_refused() {
    let folder = folder();
    let mut rig = scene::rig();
    for camera in rig.cameras.values_mut() {
        let (camera, twice) = (&mut camera.camera, 2.0);
        camera.image_size = camera.image_size.map(|size| 2 * size);
        camera.lens.focal_px *= twice;
        camera.lens.center_px *= twice;
    }
    let path = folder.path().join("cameras.json");
    std::fs::remove_file(&path).unwrap();
    artifact::write_document(&path, &rig).unwrap().publish().unwrap();
    refused(
        folder.path(),
        &[],
        &["tracks.jsonl: the cameras contradict each other", "1312 × 980 px", "larger image size"],
    );
}

#[test]
fn a_mistyped_folder_is_not_made() {
    let folder = folder();
    for path in ["nosuch/deeper/t.c3d", "/nosuch/t.c3d"] {
        refused(folder.path(), &["--c3d", path], &[path, "there is no folder", "to do"]);
    }
    assert!(!folder.path().join("nosuch").exists());
}

#[test]
fn usage_is_exit_2_and_the_help_says_it_all() {
    let folder = folder();
    assert_eq!(triangulate(folder.path(), &["--smooth-ms", "-1"]).status.code(), Some(2));
    assert_eq!(triangulate(folder.path(), &["--noise-px", "0"]).status.code(), Some(2));
    let output = Command::cargo_bin("triangulate").unwrap().arg("--help").output().unwrap();
    insta::assert_snapshot!("help", String::from_utf8_lossy(&output.stdout));
}
