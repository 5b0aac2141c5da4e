//! The commands `wand` and `doctor`: what they write, and how they refuse.
#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

mod rig;

use artifact::{CameraRig, Document, picture, read_document, write_document};
use assert_cmd::Command;
use camera::Camera;
use nalgebra::{Point3, Vector2};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::fmt::Write;
use std::path::Path;
use tempfile::TempDir;

fn calibrate(folder: &TempDir, arguments: &[&str]) -> std::process::Output {
    Command::cargo_bin("calibrate").unwrap().current_dir(folder.path()).args(arguments).output().unwrap()
}

fn said(output: &std::process::Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[allow(clippy::disallowed_methods, reason = "the test plants files")]
fn plant(folder: &TempDir, name: &str, text: &str) {
    std::fs::write(folder.path().join(name), text).unwrap();
}

/// The table of a wand of 120 frames, and the cameras of the truth.
fn table(folder: &TempDir) -> (Vec<Camera>, Vec<Point3<f64>>) {
    let (truth, path) = (rig::cameras(5), rig::wand_path(120, 90.0, 5));
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut text = String::from("frame,camera,x,y\n");
    for (id, camera) in rig::IDS.iter().zip(&truth) {
        for (frame, seen) in rig::track(camera, &path, 0.05, &mut rng).iter().enumerate() {
            if let Some(seen) = seen {
                writeln!(text, "{frame},{id},{},{}", seen.x, seen.y).unwrap();
            }
        }
    }
    plant(folder, "points.csv", &text);
    (truth, path)
}

fn write<T: Document>(folder: &TempDir, name: &str, document: &T) {
    write_document(&folder.path().join(name), document).unwrap().publish().unwrap();
}

/// A rig whose lenses are all nearly right, so that image sizes are known.
fn about(truth: &[Camera]) -> CameraRig {
    let camera = |(id, camera): (&&str, &Camera)| {
        let mut camera = camera.clone();
        camera.lens.focal_px *= 1.01;
        (id.to_string(), camera.into())
    };
    CameraRig { cameras: rig::IDS.iter().zip(truth).map(camera).collect(), take: None }
}

#[test]
fn a_table_becomes_cameras_that_the_doctor_finds_healthy() {
    let folder = tempfile::tempdir().unwrap();
    let (truth, path) = table(&folder);
    write(&folder, "about.json", &about(&truth));
    let length = format!("10:90={}", (path[10] - path[90]).norm());
    let words = [
        "wand",
        "points.csv",
        "--intrinsics",
        "about.json",
        "--scale",
        &length,
        "--out",
        "cameras.json",
        "--out-tracks",
        "wand.jsonl",
    ];
    let done = calibrate(&folder, &words);
    assert!(done.status.success(), "{}", said(&done));
    let found: CameraRig = read_document(&folder.path().join("cameras.json")).unwrap();
    let cameras: Vec<Camera> = found.cameras.values().map(|camera| camera.camera.clone()).collect();
    assert!(rig::marker_error(&truth, &cameras) < 0.08);
    let healthy =
        calibrate(&folder, &["doctor", "cameras.json", "--tracks", "wand.jsonl", "--scale", &length]);
    assert!(healthy.status.success(), "{}", said(&healthy));

    let mut ill = found;
    ill.cameras.get_mut("m3").unwrap().camera.lens.focal_px *= 1.02;
    write(&folder, "ill.json", &ill);
    let examined = calibrate(&folder, &["doctor", "ill.json", "--tracks", "wand.jsonl"]);
    assert_eq!(examined.status.code(), Some(1));
    let report = String::from_utf8_lossy(&examined.stdout);
    assert!(report.contains("camera m3: its focal length is +") && report.contains("to do: "), "{report}");
}

/// A dark picture with a bright disc.
fn shoot(path: &Path, size: [u32; 2], at: Option<Vector2<f64>>) {
    let [width, height] = size.map(|side| side as usize);
    let mut rgb = vec![8_u8; 3 * width * height];
    if let Some(at) = at {
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let share = (4.5 - (Vector2::new(x as f64, y as f64) - at).norm()).clamp(0.0, 1.0);
            // Coded as sRGB, like a camera's.
            let code = 255.0
                * if share <= 0.003_130_8 { 12.92 * share } else { 1.055 * share.powf(1.0 / 2.4) - 0.055 };
            if share > 0.0 {
                rgb[3 * (y * width + x)..][..3].fill(code.max(8.0) as u8);
            }
        }
    }
    picture::write_rgb8(path, width, height, &rgb).unwrap().publish().unwrap();
}

#[test]
#[allow(clippy::disallowed_methods, reason = "the test makes folders of images")]
fn folders_of_images_become_cameras() {
    let folder = tempfile::tempdir().unwrap();
    let (mut truth, path) = (rig::cameras(4), rig::wand_path(60, 90.0, 4));
    truth.truncate(6);
    for (id, camera) in rig::IDS.iter().zip(&truth) {
        std::fs::create_dir_all(folder.path().join("wand").join(id)).unwrap();
        for (frame, point) in path.iter().enumerate() {
            let pixel = camera.project(point).filter(|pixel| camera.contains(*pixel));
            shoot(&folder.path().join(format!("wand/{id}/{frame:06}.png")), camera.image_size, pixel);
        }
    }
    let done = calibrate(&folder, &["wand", "wand", "--scale", "850", "--out", "cameras.json", "--json"]);
    assert!(done.status.success(), "{}", said(&done));
    let summary: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert!(summary["results"]["worst_rms_px"].as_f64().unwrap() < 0.05, "{}", summary["results"]);
    let found: CameraRig = read_document(&folder.path().join("cameras.json")).unwrap();
    let cameras: Vec<Camera> = found.cameras.values().map(|camera| camera.camera.clone()).collect();
    assert!(rig::shape_error(&truth, &cameras) < 0.08);
}

#[test]
fn what_is_wrong_is_named_and_nothing_is_left() {
    let folder = tempfile::tempdir().unwrap();
    let (truth, _) = table(&folder);
    write(&folder, "about.json", &about(&truth));
    plant(&folder, "cut.csv", "frame,camera,x,y\n1,m1,3.5,4\n1,m1,3.5\n");
    plant(&folder, "twice.csv", "frame,camera,x,y\n1,m1,3.5,4\n1,m1,3.5,7\n");
    plant(&folder, "few.csv", "frame,camera,x,y\n1,m1,3.5,4\n1,m2,3.5,7\n1,m3,3.5,7\n");
    let cases: [(&str, &[&str], &[&str]); 6] = [
        ("points.csv", &["--scale", "unknown"], &["camera m1", "image size is not known", "--take"]),
        ("cut.csv", &["--scale", "unknown"], &["line 3", "four cells"]),
        ("twice.csv", &["--scale", "unknown"], &["line 3", "already"]),
        (
            "few.csv",
            &["--scale", "850", "--intrinsics", "about.json"],
            &["camera m1", "1 frames; 20 are needed"],
        ),
        ("points.csv", &["--scale", "m1:m9=10", "--intrinsics", "about.json"], &["there is no camera m9"]),
        ("nowhere", &["--scale", "850"], &["nowhere", "neither a folder of images nor points"]),
    ];
    for (input, more, parts) in cases {
        let refused = calibrate(&folder, &[&["wand", input, "--out", "cameras.json"], more].concat());
        let message = said(&refused);
        assert_eq!(refused.status.code(), Some(1), "{message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{parts:?} in {message}");
        assert!(!folder.path().join("cameras.json").exists());
    }
    let unsaid = calibrate(&folder, &["wand", "points.csv", "--out", "cameras.json"]);
    assert_eq!(unsaid.status.code(), Some(2), "the scale is asked for: {}", said(&unsaid));
}

#[test]
fn help_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    for command in ["wand", "doctor"] {
        let help = calibrate(&folder, &[command, "--help"]);
        insta::assert_snapshot!(command, String::from_utf8_lossy(&help.stdout));
    }
}
