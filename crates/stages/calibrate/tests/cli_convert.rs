//! `calibrate convert`: from every format to every other, and how it refuses.
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "a test may fail, and looks at files")]

use artifact::{CameraRig, RigCamera, read_document, write_document};
use assert_cmd::Command;
use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use serde_json::Value;
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;

fn rig() -> CameraRig {
    let camera = |x: f64, k3: f64| {
        let pose = Camera::pose_looking_at(Point3::new(x, 50.0, 700.0), Point3::origin(), Vector3::y());
        let distortion = BrownConrady { k1: -0.1, k2: 0.02, p1: 0.001, p2: -0.002, k3 };
        let lens = Lens {
            focal_px: Vector2::new(900.5, 901.25),
            center_px: Vector2::new(327.5, 244.25),
            distortion,
        };
        RigCamera::from(Camera { image_size: [656, 490], lens, cam_from_world: pose })
    };
    let mut first = camera(-200.0, 0.0);
    (first.rms_px, first.views) = (Some(0.125), Some(24));
    CameraRig { cameras: [("m1".into(), first), ("m2".into(), camera(150.0, 0.25))].into(), take: None }
}

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_document(&folder.path().join("cameras.json"), &rig()).unwrap().publish().unwrap();
    folder
}

fn convert(folder: &TempDir, arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("calibrate").unwrap();
    command.current_dir(folder.path()).arg("convert").args(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[track_caller]
fn done(folder: &TempDir, arguments: &[&str]) -> String {
    let output = convert(folder, arguments);
    assert!(output.status.success(), "{}", said(&output));
    said(&output)
}

fn listing(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Exit 1, all parts in the message, nothing new on the disk.
#[track_caller]
fn assert_refused(folder: &TempDir, arguments: &[&str], parts: &[&str]) {
    let before = listing(folder.path());
    let output = convert(folder, arguments);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    for part in parts {
        assert!(said(&output).contains(part), "'{part}' is not said in: {}", said(&output));
    }
    assert_eq!(listing(folder.path()), before, "nothing may be left");
}

fn pixel(rig: &CameraRig, id: &str) -> Vector2<f64> {
    rig.cameras[id].camera.project(&Point3::new(30.0, -40.0, 20.0)).unwrap()
}

#[test]
fn cameras_go_through_every_format_and_come_back() {
    let folder = folder();
    let mut last = ("furrow", "cameras.json");
    for (format, name) in [
        ("opencv", "a.yml"),
        ("anipose", "b.toml"),
        ("opencv", "c.json"),
        ("colmap", "d"),
        ("furrow", "e.json"),
    ] {
        done(&folder, &[last.1, "--from", last.0, "--to", format, "--unit", "m", "--out", name]);
        last = (format, name);
    }
    let back: CameraRig = read_document(&folder.path().join("e.json")).unwrap();
    for id in ["m1", "m2"] {
        assert!((pixel(&back, id) - pixel(&rig(), id)).norm() < 1e-10);
        let (eye, true_eye) =
            (back.cameras[id].camera.eye_in_world(), rig().cameras[id].camera.eye_in_world());
        assert!((eye - true_eye).norm() < 1e-9, "{eye}");
    }
    let expected: Vec<String> = ["cameras.txt", "images.txt", "points3D.txt"]
        .iter()
        .flat_map(|name| [name.to_string(), format!("{name}.prov.json")])
        .collect();
    assert_eq!(listing(&folder.path().join("d")), expected);
}

#[test]
fn what_is_lost_is_told_and_inputs_are_recorded() {
    let folder = folder();
    let message = done(
        &folder,
        &["cameras.json", "--from", "furrow", "--to", "colmap", "--unit", "mm", "--out", "colmap"],
    );
    assert!(
        message.contains("no place for the reprojection errors and image counts of m1; not kept"),
        "{message}"
    );
    done(&folder, &["colmap", "--from", "colmap", "--to", "furrow", "--unit", "mm", "--out", "again.json"]);
    let side_car: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("again.json.prov.json")).unwrap()).unwrap();
    let data = &side_car["data"];
    assert_eq!((&data["stage"], &data["parameters"]["unit"]), (&"calibrate convert".into(), &"mm".into()));
    assert_eq!(data["results"]["cameras"], serde_json::json!(["m1", "m2"]));
    let inputs = data["inputs"].to_string();
    assert!(inputs.contains("cameras.txt") && inputs.contains("images.txt"), "{inputs}");
}

const INTRINSICS: &str = "%YAML:1.0\n---\nM1: [ [800, 0, 320], [0, 800, 240], [0, 0, 1] ]\nD1: [ 0, 0, 0, 0 ]\n\
M2: [ [810, 0, 320], [0, 810, 240], [0, 0, 1] ]\nD2: [ 0, 0, 0, 0, 0, 0, 0, 0.5 ]\n";
const EXTRINSICS: &str = "%YAML:1.0\n---\nR: [ 0, 0, 0 ]\nT: [ -6.5, 0, 0 ]\n";

#[test]
fn a_stereo_pair_gets_names() {
    let folder = folder();
    std::fs::write(folder.path().join("in.yml"), INTRINSICS).unwrap();
    std::fs::write(folder.path().join("ex.yml"), EXTRINSICS).unwrap();
    let to = ["--from", "opencv", "--to", "furrow", "--unit", "cm", "--out", "rig.json"];
    let arguments = |more: &[&'static str]| [&["in.yml", "ex.yml"], &to[..], more].concat();
    assert_refused(&folder, &arguments(&[]), &["in.yml, line 3, M1", "how large the images are", "to do"]);
    let size = ["--image-size", "640x480"];
    assert_refused(
        &folder,
        &arguments(&size),
        &["in.yml, line 6, D2", "k6 = 0.5", "k1, k2, p1, p2, k3 only"],
    );
    assert_refused(&folder, &[&["in.yml"], &to[..], &size].concat(), &["in.yml: lacks R", "extrinsics"]);
    std::fs::write(folder.path().join("in.yml"), INTRINSICS.replace("0.5", "0")).unwrap();
    let rename = |names| arguments(&[&size[..], &["--rename", names]].concat());
    assert_refused(&folder, &rename("3=left"), &["camera 3: there is none", "one of 1, 2"]);
    assert_refused(&folder, &rename("1=2"), &["camera 2: two cameras would have this name"]);
    done(&folder, &rename("1=left,2=right"));
    let found: CameraRig = read_document(&folder.path().join("rig.json")).unwrap();
    assert_eq!(found.cameras["left"].camera.cam_from_world, Isometry3::identity());
    assert_eq!(
        found.cameras["right"].camera.cam_from_world.translation.vector,
        Vector3::new(-65.0, 0.0, 0.0)
    );
}

#[test]
fn bad_files_are_refused_by_name() {
    let folder = folder();
    let to = ["--to", "furrow", "--unit", "mm", "--out", "x.json"];
    let refused = |input: &str, from: &str, parts: &[&str]| {
        assert_refused(&folder, &[&[input, "--from", from], &to[..]].concat(), parts);
    };
    refused("none.toml", "anipose", &["none.toml: cannot read"]);
    refused("cameras.json", "opencv", &["cameras.json", "holds no cameras"]);
    refused("cameras.json", "anipose", &["cameras.json, line 1", "is not TOML"]);
    refused("cameras.json", "colmap", &["cameras.json: is a file", "name the folder"]);
    assert_refused(
        &folder,
        &["cameras.json", "--from", "furrow", "--to", "opencv", "--unit", "mm", "--out", "a.xml"],
        &["a.xml", "use .yml, .yaml or .json"],
    );
    let usage = convert(&folder, &["cameras.json", "--from", "furrow", "--to", "colmap", "--out", "a"]);
    assert_eq!(usage.status.code(), Some(2));
    assert!(said(&usage).contains("--unit"), "{}", said(&usage));
}

#[test]
fn help_reads_well() {
    let output = Command::cargo_bin("calibrate")
        .unwrap()
        .args(["convert", "--help"])
        .env("COLUMNS", "100")
        .output()
        .unwrap();
    insta::assert_snapshot!("help-convert", String::from_utf8_lossy(&output.stdout));
}
