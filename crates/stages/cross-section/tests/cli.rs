//! The program: a small take from files to sections, and bad input.

#![allow(clippy::unwrap_used, clippy::panic, clippy::disallowed_methods, reason = "tests may")]

mod scene;

use artifact::picture::write_rgb8;
use artifact::{
    CameraFrames, CameraRig, Clock, FrameReader, FrameRun, FrameWriter, Frames, HeadPose, HeadPoseFrame,
    HeadPoseHeader, Rate, SectionState, Sections, SectionsFrame, Shown, SyncCamera, SyncFrame, SyncHeader,
    SyncSource, TakeRef, TimeBase, Wrinkle, Wrinkles2d, Wrinkles2dFrame, Wrinkles2dHeader, write_document,
};
use assert_cmd::Command;
use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use scene::{SIZE, Scene};
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;

const FRAMES: [i64; 3] = [1001, 1005, 1009];

fn take_of(name: &str) -> TakeRef {
    TakeRef { take: name.into(), session: "day-1".into(), sha256: "0".repeat(64) }
}

fn write_frames(folder: &Path, transfer: &str, take: Option<TakeRef>) {
    write_frames_of(folder, transfer, take, &FRAMES);
}

fn write_frames_of(folder: &Path, transfer: &str, take: Option<TakeRef>, numbers: &[i64]) {
    let camera = CameraFrames {
        images: "w1/{frame:06}.png".into(),
        image_size: SIZE.map(|side| side as u32),
        transfer: transfer.into(),
        bit_depth: 8,
        frames: FrameRun::runs(numbers),
    };
    let frames = Frames { take, cameras: [("w1".to_string(), camera)].into() };
    write_document(&folder.join("frames.json"), &frames).unwrap().publish().unwrap();
}

fn write_picture(folder: &Path, frame: i64, rgb: &[u8]) {
    let path = folder.join(format!("w1/{frame:06}.png"));
    write_rgb8(&path, SIZE[0], SIZE[1], rgb).unwrap().publish().unwrap();
}

fn write_sync(folder: &Path, missing: Option<i64>) {
    let rate = Rate::per_second(50);
    let camera = SyncCamera {
        rate,
        every: 4,
        phase: 1001,
        offset_frames: 0.0,
        drift_ppm: 0.0,
        source: SyncSource::Stated,
    };
    let header =
        SyncHeader { rate, clock: Clock::Trigger, cameras: [("w1".to_string(), camera)].into(), take: None };
    let mut writer = FrameWriter::<TimeBase>::create(&folder.join("sync.jsonl"), header).unwrap();
    for (index, frame) in FRAMES.into_iter().enumerate() {
        let shown = Some(Shown { index: index as i64, time_s: None, doubled: false });
        let shown = shown.filter(|_| missing != Some(frame));
        writer.write(&SyncFrame { frame, shows: [("w1".to_string(), shown)].into() }).unwrap();
    }
    writer.finish().unwrap().publish().unwrap();
}

fn write_wrinkles(folder: &Path, take: Option<TakeRef>, shift: f64) {
    let header = Wrinkles2dHeader {
        cameras: vec!["w1".into()],
        wrinkles: vec![Wrinkle { id: "brow".into(), paint: Some("green".into()) }],
        rate: Some(Rate::per_second(50)),
        take,
    };
    let mut writer = FrameWriter::<Wrinkles2d>::create(&folder.join("wrinkles.jsonl"), header).unwrap();
    for frame in FRAMES {
        let mut curve = Scene { off: 1.0, ..Scene::default() }.curve();
        curve.controls.iter_mut().for_each(|control| control[0] += shift);
        let curves = [("w1".to_string(), [("brow".to_string(), curve)].into())].into();
        writer.write(&Wrinkles2dFrame { frame, curves }).unwrap();
    }
    writer.finish().unwrap().publish().unwrap();
}

fn take() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for frame in FRAMES {
        let scene = Scene { ratio: if frame == 1001 { 0.0 } else { 0.4 }, epsilon: 0.2, ..Scene::default() };
        write_picture(folder.path(), frame, &scene.picture(frame as u64));
    }
    write_frames(folder.path(), "srgb", None);
    write_sync(folder.path(), None);
    write_wrinkles(folder.path(), None, 0.0);
    folder
}

fn call(folder: &TempDir, words: &[&str]) -> Output {
    let source = ["--frames", "frames.json", "--sync", "sync.jsonl", "--wrinkles", "wrinkles.jsonl"];
    let mut command = Command::cargo_bin("cross-section").unwrap();
    command.current_dir(folder.path()).arg(words[0]).args(source).args(&words[1..]).output().unwrap()
}

const MEASURE: [&str; 3] = ["measure", "--out", "sections.jsonl"];

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn sections(folder: &TempDir) -> Vec<SectionsFrame> {
    FrameReader::<Sections>::open(&folder.path().join("sections.jsonl"))
        .unwrap()
        .map(Result::unwrap)
        .collect()
}

fn assert_refused(folder: &TempDir, parts: &[&str]) {
    let output = call(folder, &MEASURE);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    for part in parts {
        assert!(said(&output).contains(part), "'{part}' is missing in: {}", said(&output));
    }
    assert!(!folder.path().join("sections.jsonl").exists());
}

#[test]
fn a_take_becomes_sections() {
    let folder = take();
    let output = call(&folder, &MEASURE);
    assert!(output.status.success(), "{}", said(&output));
    let frames = sections(&folder);
    assert_eq!(frames.len(), 3);
    let deep = |frame: &SectionsFrame| {
        let all = &frame.sections["w1"]["brow"];
        all.iter().filter(|section| section.state == SectionState::Measured).count() as f64 / all.len() as f64
    };
    assert!(deep(&frames[0]) == 0.0 && deep(&frames[1]) > 0.8 && deep(&frames[2]) > 0.8);
}

#[test]
fn threads_and_parts_change_no_byte() {
    let folder = take();
    let bytes = |words: &[&str]| {
        assert!(call(&folder, &[&MEASURE[..], words].concat()).status.success());
        std::fs::read_to_string(folder.path().join("sections.jsonl")).unwrap()
    };
    let whole = bytes(&["--threads", "1"]);
    assert_eq!(whole, bytes(&["--threads", "3"]));
    let rows = |text: &str| text.lines().skip(1).map(String::from).collect::<Vec<_>>();
    let parts = [rows(&bytes(&["--range", "1001-1004"])), rows(&bytes(&["--range", "1005-1009"]))].concat();
    assert_eq!(rows(&whole), parts);
}

#[test]
fn smoothed_parts_join_to_the_smoothed_whole() {
    let folder = take();
    let rows = |range: &str| {
        assert!(
            call(&folder, &[&MEASURE[..], &["--smooth", "1", "--range", range]].concat()).status.success()
        );
        let text = std::fs::read_to_string(folder.path().join("sections.jsonl")).unwrap();
        text.lines().skip(1).map(String::from).collect::<Vec<_>>()
    };
    assert_eq!(rows("1001-1009"), [rows("1001-1005"), rows("1006-1009")].concat());
}

#[test]
fn a_missing_image_is_a_gap_with_a_warning() {
    let folder = take();
    write_frames_of(folder.path(), "srgb", None, &[1001, 1009]);
    write_sync(folder.path(), Some(1005));
    let output = call(&folder, &MEASURE);
    assert!(output.status.success() && said(&output).contains("1005 of camera w1"), "{}", said(&output));
    assert!(sections(&folder)[1].sections.is_empty());
}

#[test]
fn an_unknown_response_is_refused_by_name() {
    let folder = take();
    write_frames(folder.path(), "log-c", None);
    assert_refused(&folder, &["frames.json", "w1", "log-c"]);
}

#[test]
fn wrinkles_of_another_take_are_refused() {
    let folder = take();
    write_frames(folder.path(), "srgb", Some(take_of("smile")));
    write_wrinkles(folder.path(), Some(take_of("frown")), 0.0);
    assert_refused(&folder, &["wrinkles.jsonl", "smile", "frown"]);
}

#[test]
fn a_wrinkle_that_leaves_the_image_fails_there() {
    let folder = take();
    write_wrinkles(folder.path(), None, 60.0);
    let output = call(&folder, &MEASURE);
    assert!(output.status.success(), "{}", said(&output));
    let all = &sections(&folder)[1].sections["w1"]["brow"];
    assert_eq!(all.last().unwrap().state, SectionState::Failed);
    assert!(all.iter().all(|section| section.w_px.is_finite()));
}

#[test]
fn clipped_pixels_are_left_out_and_counted() {
    let folder = take();
    let mut rgb = Scene { epsilon: 0.2, ..Scene::default() }.picture(5);
    for (x, y, value) in (60..64).flat_map(|x| [(x, 40, 255), (x, 60, 0)]) {
        rgb[3 * (y * SIZE[0] + x)..][..3].fill(value);
    }
    write_picture(folder.path(), 1005, &rgb);
    let output = call(&folder, &MEASURE);
    assert!(output.status.success(), "{}", said(&output));
    assert!(said(&output).contains("4 saturated and 4 black pixels"), "{}", said(&output));
}

#[test]
fn half_sized_colours_are_warned_of() {
    let folder = take();
    let mut rgb = Scene { noise: 0.03, ..Scene::default() }.picture(5);
    // Colour differences of the left of two neighbours for both.
    for pair in rgb.chunks_exact_mut(6) {
        let luma = |c: &[u8]| 0.299 * f64::from(c[0]) + 0.587 * f64::from(c[1]) + 0.114 * f64::from(c[2]);
        let off = luma(&pair[3..]) - luma(&pair[..3]);
        for k in 0..3 {
            pair[3 + k] = (f64::from(pair[k]) + off).round().clamp(0.0, 255.0) as u8;
        }
    }
    write_picture(folder.path(), 1005, &rgb);
    let output = call(&folder, &MEASURE);
    assert!(output.status.success() && said(&output).contains("4:2:0"), "{}", said(&output));
}

#[test]
fn parameters_out_of_range_are_named() {
    let folder = take();
    let output = call(&folder, &[&MEASURE[..], &["--lens-blur-px", "-1"]].concat());
    assert_ne!(output.status.code(), Some(0));
    let output = call(&folder, &[&MEASURE[..], &["--step-px", "0"]].concat());
    assert!(output.status.code() == Some(1) && said(&output).contains("step-px"), "{}", said(&output));
}

#[test]
fn pictures_are_drawn() {
    let folder = take();
    let words = ["show", "--camera", "w1", "--frame", "1005", "--out", "over.png", "--profiles", "sheet.png"];
    let output = call(&folder, &words);
    assert!(output.status.success(), "{}", said(&output));
    assert!(folder.path().join("over.png").exists() && folder.path().join("sheet.png").exists());
    let output = call(&folder, &["show", "--camera", "w9", "--frame", "1005", "--out", "other.png"]);
    assert!(output.status.code() == Some(1) && said(&output).contains("w9"), "{}", said(&output));
}

#[test]
fn geometry_is_asked_for_as_a_whole() {
    let folder = take();
    let output = call(&folder, &[&MEASURE[..], &["--mesh", "face.obj", "--unit", "mm"]].concat());
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("--head-pose"), "{}", said(&output));
}

#[test]
fn a_known_face_says_the_tilt() {
    let folder = take();
    let leaning = Scene { ratio: 0.3, epsilon: 0.2, tilt: 30f64.to_radians().tan(), ..Scene::default() };
    write_picture(folder.path(), 1005, &leaning.picture(5));
    // A wall 500 mm before the camera, which shows 0.5 mm in a pixel.
    let corners = "v -100 -100 0\nv 100 -100 0\nv 100 100 0\nv -100 100 0\nf 1 2 3 4\n";
    std::fs::write(folder.path().join("face.obj"), corners).unwrap();
    let lens = Lens {
        focal_px: Vector2::repeat(1000.0),
        center_px: Vector2::new(79.5, 47.5),
        distortion: BrownConrady::default(),
    };
    let eye = Point3::new(0.0, -250.0, 433.0);
    let camera = Camera {
        image_size: SIZE.map(|side| side as u32),
        lens,
        cam_from_world: Camera::pose_looking_at(eye, Point3::origin(), Vector3::y()),
    };
    let rig = CameraRig { cameras: [("w1".to_string(), camera.into())].into(), take: None };
    write_document(&folder.path().join("cameras.json"), &rig).unwrap().publish().unwrap();
    let header = HeadPoseHeader { rate: None, reference_frame: 1001, markers: vec![], take: None };
    let mut poses = FrameWriter::<HeadPose>::create(&folder.path().join("pose.jsonl"), header).unwrap();
    for frame in FRAMES {
        let world_from_head = Some(Isometry3::identity());
        poses.write(&HeadPoseFrame { frame, world_from_head, residual_mm: None, markers_used: 4 }).unwrap();
    }
    poses.finish().unwrap().publish().unwrap();
    let geometry =
        ["--mesh", "face.obj", "--unit", "mm", "--cameras", "cameras.json", "--head-pose", "pose.jsonl"];
    let output = call(&folder, &[&MEASURE[..], &geometry].concat());
    assert!(output.status.success(), "{}", said(&output));
    // The curve runs to the right, and its right side is below, where the camera stands.
    for section in &sections(&folder)[1].sections["w1"]["brow"] {
        assert!((section.tilt_rad.unwrap().to_degrees() - 30.0).abs() < 9.0, "{section:?}");
    }
}

#[test]
fn help_says_what_there_is() {
    for words in [&["--help"][..], &["measure", "--help"], &["show", "--help"]] {
        let output = Command::cargo_bin("cross-section").unwrap().args(words).output().unwrap();
        let name = words.join("-").replace("--help", "help");
        insta::assert_snapshot!(name, String::from_utf8(output.stdout).unwrap());
    }
}
