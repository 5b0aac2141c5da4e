//! The program: a small take from files to valleys, and bad input.
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "tests may, in folders of their own")]

mod scene;

use artifact::picture::write_rgb8;
use artifact::*;
use assert_cmd::Command;
use nalgebra::Point3;
use scene::{BENT, Planted, brow, camera, dome, pose, worst};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;

/// Images are taken in every second frame; the sequence has all.
const FRAMES: [i64; 2] = [1001, 1003];
const LAST: i64 = 1004;

fn take_of(name: &str, session: &str) -> TakeRef {
    TakeRef { take: name.into(), session: session.into(), sha256: "ab".repeat(32) }
}

fn take() -> Option<TakeRef> {
    Some(take_of("smile", "day-1"))
}

fn mesh_ref(folder: &Path) -> MeshRef {
    let file =
        FileRef { name: "face.obj".into(), sha256: artifact::sha256(&folder.join("face.obj")).unwrap() };
    MeshRef { file, unit: Unit::Mm, vertex_count: dome().positions.len() }
}

fn write_mesh_and_sequence(folder: &Path) {
    let mesh = dome();
    artifact::write_mesh(&folder.join("face.obj"), &mesh, Unit::Mm).unwrap().publish().unwrap();
    let mut cache = pc2::Writer::create(&folder.join("large.pc2"), mesh.positions.len(), 1001).unwrap();
    for _ in 1001..=LAST {
        let flat: Vec<f32> =
            mesh.positions.iter().flat_map(|point| [point.x, point.y, point.z]).map(|x| x as f32).collect();
        cache.write(&flat).unwrap();
    }
    cache.finish().unwrap().publish().unwrap();
    let index = LargeScale {
        mesh: mesh_ref(folder),
        cache: "large.pc2".into(),
        form: SequenceForm::Pc2,
        rate: Some(Rate::per_second(50)),
        frames: (1001..=LAST).collect(),
        take: take(),
    };
    write_document(&folder.join("large.json"), &index).unwrap().publish().unwrap();
}

fn write_warp(folder: &Path, mesh: MeshRef, take: Option<TakeRef>) {
    let interpolant = |polynomial: Vec<[f64; 3]>| Interpolant {
        origin_mm: [0.0; 3],
        scale_mm: 100.0,
        centers: vec![[0.1, 0.2, 0.0], [0.3, -0.1, 0.0]],
        weights: vec![[0.0; 3]; 2],
        polynomial,
    };
    let same = vec![[0.0; 3], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 100.0]];
    let fit = WarpFit {
        condition: 1.0,
        polynomial_rank: 10,
        similarity_rms_mm: 0.1,
        similarity_scale: 1.0,
        similarity_residual_mm: BTreeMap::new(),
        leave_one_out_mm: BTreeMap::new(),
        smallest_determinant: 0.9,
        left_out: BTreeMap::new(),
    };
    let warp = Warp {
        face_from_mocap: interpolant(BENT.to_vec()),
        mocap_from_face: interpolant(same),
        markers: vec!["a".into(), "b".into()],
        vertices: vec![1, 2],
        mesh,
        rest_frame: 1001,
        trajectories: FileRef { name: "head.jsonl".into(), sha256: "cd".repeat(32) },
        take,
        fit,
    };
    write_document(&folder.join("warp.json"), &warp).unwrap().publish().unwrap();
}

fn write_poses(folder: &Path, missing: &[i64], take: Option<TakeRef>) {
    let header = HeadPoseHeader {
        rate: Some(Rate::per_second(50)),
        reference_frame: 1001,
        markers: vec!["h1".into()],
        take,
    };
    let mut writer = FrameWriter::<HeadPose>::create(&folder.join("pose.jsonl"), header).unwrap();
    for frame in 1001..=LAST {
        let world_from_head = (!missing.contains(&frame)).then(pose);
        writer.write(&HeadPoseFrame { frame, world_from_head, residual_mm: None, markers_used: 3 }).unwrap();
    }
    writer.finish().unwrap().publish().unwrap();
}

fn write_cameras(folder: &Path, ids: &[&str]) {
    let cameras = ids.iter().map(|id| (id.to_string(), RigCamera::from(camera(15.0)))).collect();
    write_document(&folder.join("cameras.json"), &CameraRig { cameras, take: None })
        .unwrap()
        .publish()
        .unwrap();
}

fn write_sync(folder: &Path, offset_frames: f64) {
    let rate = Rate::per_second(50);
    let clock =
        SyncCamera { rate, every: 2, phase: 1001, offset_frames, drift_ppm: 0.0, source: SyncSource::Stated };
    let header =
        SyncHeader { rate, clock: Clock::Trigger, cameras: [("w1".to_string(), clock)].into(), take: take() };
    let mut writer = FrameWriter::<TimeBase>::create(&folder.join("sync.jsonl"), header).unwrap();
    for (index, frame) in FRAMES.into_iter().enumerate() {
        let shown = Shown { index: index as i64, time_s: None, doubled: false };
        writer.write(&SyncFrame { frame, shows: [("w1".to_string(), Some(shown))].into() }).unwrap();
    }
    writer.finish().unwrap().publish().unwrap();
}

fn write_sections(folder: &Path, camera_seen: &camera::Camera) {
    let header = SectionsHeader {
        cameras: vec!["w1".into()],
        wrinkles: vec![Wrinkle { id: "brow".into(), paint: Some("green".into()) }],
        profile: Profile::Rounded,
        rate: Some(Rate::per_second(50)),
        take: take(),
    };
    let mut writer = FrameWriter::<Sections>::create(&folder.join("sections.jsonl"), header).unwrap();
    for frame in FRAMES {
        let sections = brow(Planted::default().seen(camera_seen, &pose(), [0.0, 1.0], 60));
        writer.write(&SectionsFrame { frame, sections: [("w1".to_string(), sections)].into() }).unwrap();
    }
    writer.finish().unwrap().publish().unwrap();
}

fn write_footage(folder: &Path) {
    let [width, height] = camera(15.0).image_size;
    for frame in FRAMES {
        let rgb = vec![90; 3 * (width * height) as usize];
        write_rgb8(&folder.join(format!("w1/{frame:06}.png")), width as usize, height as usize, &rgb)
            .unwrap()
            .publish()
            .unwrap();
    }
    let images = CameraFrames {
        images: "w1/{frame:06}.png".into(),
        image_size: [width, height],
        transfer: "srgb".into(),
        bit_depth: 8,
        frames: FrameRun::runs(&FRAMES),
    };
    let frames = Frames { take: take(), cameras: [("w1".to_string(), images)].into() };
    write_document(&folder.join("frames.json"), &frames).unwrap().publish().unwrap();
}

fn small_take() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write_mesh_and_sequence(at);
    write_warp(at, mesh_ref(at), take());
    write_poses(at, &[], take());
    write_cameras(at, &["w1"]);
    write_sync(at, 0.0);
    write_sections(at, &camera(15.0));
    folder
}

const FACE: [&str; 12] = [
    "--mesh",
    "face.obj",
    "--unit",
    "mm",
    "--large-scale",
    "large.json",
    "--warp",
    "warp.json",
    "--head-pose",
    "pose.jsonl",
    "--cameras",
    "cameras.json",
];
const RUN: [&str; 6] = ["--sync", "sync.jsonl", "--sections", "sections.jsonl", "--out", "valleys.jsonl"];

fn program(folder: &Path, words: &[&str]) -> Output {
    Command::cargo_bin("wrinkle-lift").unwrap().current_dir(folder).args(words).output().unwrap()
}

fn lift(folder: &Path, more: &[&str]) -> Output {
    program(folder, &[&["run"], &FACE[..], &RUN[..], more].concat())
}

/// What is said where a run fails and leaves nothing.
fn refused(folder: &Path) -> String {
    let output = lift(folder, &[]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(!folder.join("valleys.jsonl").exists());
    assert!(said.contains("to do:"), "{said}");
    said
}

fn valleys(folder: &Path) -> Vec<ValleysFrame> {
    FrameReader::<Valleys>::open(&folder.join("valleys.jsonl"))
        .unwrap()
        .collect::<artifact::Result<_>>()
        .unwrap()
}

#[test]
fn a_take_becomes_valleys_with_their_provenance() {
    let folder = small_take();
    let output = lift(folder.path(), &["--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["results"]["lifted"], 120);
    let frames = valleys(folder.path());
    assert_eq!(frames.iter().map(|frame| frame.frame).collect::<Vec<_>>(), FRAMES);
    for frame in &frames {
        let [place, width, depth] = worst(&frame.valleys["brow"], &Planted::default());
        assert!(place < 0.05 && width < 0.03 && depth < 0.03, "{place} {width} {depth}");
    }
    assert!(folder.path().join("valleys.jsonl.prov.json").exists());
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let folder = small_take();
    let bytes = |threads: &str| {
        assert!(lift(folder.path(), &["--threads", threads]).status.success());
        artifact::read_bytes(&folder.path().join("valleys.jsonl")).unwrap()
    };
    assert_eq!(bytes("1"), bytes("3"));
}

#[test]
fn an_image_between_two_frames_is_lifted_at_its_time() {
    let folder = small_take();
    write_sync(folder.path(), 0.4);
    // The face stands still, so that the time in between shows the same.
    assert!(lift(folder.path(), &[]).status.success());
    for frame in valleys(folder.path()) {
        assert!(worst(&frame.valleys["brow"], &Planted::default())[0] < 0.05);
    }
    // Nothing is known after the last frame of the head.
    write_poses(folder.path(), &[1004], take());
    let output = lift(folder.path(), &[]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && said.contains("1 images") && said.contains("frame 1003"), "{said}");
    assert_eq!(valleys(folder.path()).len(), 1);
}

#[test]
fn frames_without_a_pose_are_left_out_and_told() {
    let folder = small_take();
    write_poses(folder.path(), &[1003], take());
    let output = lift(folder.path(), &[]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("first in frame 1003: the head has no pose"), "{said}");
    assert_eq!(valleys(folder.path()).len(), 1);
    write_poses(folder.path(), &[1001, 1002, 1003, 1004], take());
    artifact::discard_unfinished();
    std::fs::remove_file(folder.path().join("valleys.jsonl")).unwrap();
    assert!(refused(folder.path()).contains("pose.jsonl: no frame has a pose"));
}

#[test]
fn another_mesh_is_named_with_its_hash() {
    let folder = small_take();
    let other = MeshRef {
        file: FileRef { name: "other.obj".into(), sha256: "12".repeat(32) },
        ..mesh_ref(folder.path())
    };
    write_warp(folder.path(), other.clone(), take());
    let said = refused(folder.path());
    assert!(said.contains("warp.json") && said.contains("other.obj") && said.contains("1212"), "{said}");
    write_warp(folder.path(), mesh_ref(folder.path()), take());
    let path = folder.path().join("large.json");
    let mut index: LargeScale = read_document(&path).unwrap();
    index.mesh = other;
    write_document(&path, &index).unwrap().publish().unwrap();
    let said = refused(folder.path());
    assert!(said.contains("large.json") && said.contains("other.obj"), "{said}");
}

#[test]
fn a_warp_or_pose_of_another_recording_is_named() {
    let folder = small_take();
    write_warp(folder.path(), mesh_ref(folder.path()), Some(take_of("frown", "day-2")));
    let said = refused(folder.path());
    assert!(said.contains("warp.json") && said.contains("day-2") && said.contains("sha256 abab"), "{said}");
    // Another take of the same session has the same markers.
    write_warp(folder.path(), mesh_ref(folder.path()), Some(take_of("frown", "day-1")));
    write_poses(folder.path(), &[], Some(take_of("frown", "day-1")));
    let said = refused(folder.path());
    assert!(said.contains("pose.jsonl") && said.contains("take frown"), "{said}");
}

#[test]
fn a_camera_that_is_not_calibrated_is_named() {
    let folder = small_take();
    write_cameras(folder.path(), &["m1", "m2"]);
    let said = refused(folder.path());
    assert!(said.contains("camera w1 is not calibrated") && said.contains("m1, m2"), "{said}");
}

#[test]
fn cameras_that_look_elsewhere_end_the_run() {
    let folder = small_take();
    let mut away = camera(15.0);
    away.cam_from_world = nalgebra::Isometry3::rotation(nalgebra::Vector3::y() * 0.5) * away.cam_from_world;
    let cameras = [("w1".to_string(), RigCamera::from(away))].into();
    write_document(&folder.path().join("cameras.json"), &CameraRig { cameras, take: None })
        .unwrap()
        .publish()
        .unwrap();
    let said = refused(folder.path());
    assert!(said.contains("sections.jsonl, camera w1: 100 % of 120 sections miss the face"), "{said}");
}

#[test]
fn a_picture_shows_where_valleys_land() {
    let folder = small_take();
    write_footage(folder.path());
    assert!(lift(folder.path(), &[]).status.success());
    let words = [
        "--frames",
        "frames.json",
        "--sync",
        "sync.jsonl",
        "--valleys",
        "valleys.jsonl",
        "--camera",
        "w1",
        "--frame",
        "1003",
        "--crop",
        "400,250,600,400",
        "--out",
        "seen.png",
    ];
    let output = program(folder.path(), &[&["show"], &FACE[..], &words[..]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let picture = artifact::picture::read_rgb(&folder.path().join("seen.png")).unwrap();
    assert_eq!([picture.width, picture.height], [1200, 400]);
    // The deepest place of the valley is red where the camera sees it, in both halves.
    let bottom: Point3<f64> = Planted::default().at(0.5).bottom;
    let head = scene::spaces().head_from_face.preimages(&[bottom])[0].point;
    let at = camera(15.0).project(&(pose() * head)).unwrap();
    for left in [0.0, 600.0] {
        let [red, green, _] =
            picture.at((at.x - 400.0 + left).round() as usize, (at.y - 250.0).round() as usize);
        assert!(red > 1.5 * green, "{red} {green}");
    }
    let words = [
        "--frames",
        "frames.json",
        "--sync",
        "sync.jsonl",
        "--valleys",
        "valleys.jsonl",
        "--camera",
        "w1",
        "--frame",
        "1002",
        "--out",
        "no.png",
    ];
    let output = program(folder.path(), &[&["show"], &FACE[..], &words[..]].concat());
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(1) && said.contains("has no frame 1002"), "{said}");
}

#[test]
fn values_out_of_range_are_refused_by_name() {
    let folder = small_take();
    let output = lift(folder.path(), &["--max-view-deg", "95"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(1) && said.contains("max-view-deg is 95"), "{said}");
}

#[test]
fn help_says_what_there_is() {
    for words in [&["--help"][..], &["run", "--help"], &["show", "--help"]] {
        let output = Command::cargo_bin("wrinkle-lift").unwrap().args(words).output().unwrap();
        let name = words.join("-").replace("--help", "help");
        insta::assert_snapshot!(name, String::from_utf8(output.stdout).unwrap());
    }
}
