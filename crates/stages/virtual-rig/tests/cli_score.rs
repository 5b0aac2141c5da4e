//! `virtual-rig score` as users run it: truth fed back is perfect, a known error is found, and what cannot be compared is
//! refused by name.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod truth_folder;

use artifact::{
    CameraRig, HeadPose, HeadTrajectories, LargeScale, Sections, Stream, TimeBase, Tracks2d, Trajectories3d,
    Valleys, Wrinkled, Wrinkles2d,
};
use assert_cmd::Command;
use nalgebra::{Isometry3, Vector2, Vector3};
use serde_json::Value;
use std::collections::BTreeMap;
use std::process::Output;
use truth_folder::Folder;

fn run(folder: &Folder, arguments: &str) -> Output {
    let mut command = Command::cargo_bin("virtual-rig").unwrap();
    command.current_dir(folder.root.path()).arg("score").args(arguments.split_whitespace()).output().unwrap()
}

/// The metrics of a run, as they stand in its summary.
fn rows(folder: &Folder, arguments: &str) -> Vec<Value> {
    let output = run(folder, &format!("{arguments} --truth truth --json"));
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    summary["results"]["metrics"].as_array().unwrap().clone()
}

/// Values by name without stage; none where there is no number.
fn values(folder: &Folder, arguments: &str) -> BTreeMap<String, Option<f64>> {
    let name = |row: &Value| row["metric"].as_str().unwrap().split_once('/').unwrap().1.to_string();
    rows(folder, arguments).iter().map(|row| (name(row), row["value"].as_f64())).collect()
}

fn assert_found(folder: &Folder, arguments: &str, name: &str, planted: f64) {
    let found = values(folder, arguments)[name].unwrap();
    assert!((found - planted).abs() <= 0.01 * planted, "{arguments}, {name}: {found}, planted {planted}");
}

/// Expects exit code 1 and a message with all `words`.
fn refuse(folder: &Folder, arguments: &str, words: &[&str]) {
    let output = run(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{arguments}: {message}");
    for word in words.iter().chain(&["to do: "]) {
        assert!(message.contains(word), "{arguments}: '{word}' is not in: {message}");
    }
}

/// Kind, its file in the truth, the usual stage, and the metrics that this small take cannot give.
const KINDS: [(&str, &str, &str, &[&str]); 14] = [
    ("tracks-2d", "tracks-2d.jsonl", "marker-track", &[]),
    ("trajectories-3d", "markers.jsonl", "triangulate", &["filled_rms_mm"]),
    ("head-trajectories", "head.jsonl", "stabilize", &["filled_rms_mm"]),
    ("head-pose", "pose.jsonl", "stabilize", &[]),
    ("cameras", "cameras-calibrated.json", "calibrate", &[]),
    ("sync", "sync.jsonl", "capture-sync", &[]),
    ("large-scale", "large-scale.json", "linear-shell", &[]),
    ("wrinkled", "wrinkled.json --against truth/large-scale.json", "shell-synth", &["bulge_height_rel"]),
    ("wrinkles-2d", "wrinkles-2d.jsonl", "wrinkle-track", &[]),
    ("sections", "sections.jsonl", "cross-section", &[]),
    ("valleys", "valleys.jsonl", "shell-synth", &[]),
    ("masks", "paint", "wrinkle-track", &[]),
    ("normals", "normals", "scan-refine", &[]),
    ("normals", "wrinkled.json", "scan-refine", &[]),
];

#[test]
fn truth_fed_back_is_perfect() {
    let folder = Folder::new();
    for (kind, file, stage, unmeasured) in KINDS {
        for row in rows(&folder, &format!("{kind} truth/{file}")) {
            let name = row["metric"].as_str().unwrap().strip_prefix(&format!("{stage}/")).unwrap();
            let best = if row["unit"] == "share" { 1.0 } else { 0.0 };
            match row["value"].as_f64() {
                Some(value) => assert_eq!(value, best, "{kind}: {name}"),
                None => assert!(unmeasured.contains(&name), "{kind}: {name}: {}", row["reason"]),
            }
        }
    }
}

#[test]
fn known_errors_of_streams_are_found() {
    let folder = Folder::new();
    folder.change::<Tracks2d>("tracks-2d.jsonl", |frame| {
        let samples = frame.cameras.iter_mut().flatten().flatten().flatten();
        samples.for_each(|sample| sample.at += Vector2::new(0.3, 0.4));
    });
    assert_found(&folder, "tracks-2d out/tracks-2d.jsonl", "rms_px", 0.5);
    folder.change::<Trajectories3d>("markers.jsonl", |frame| {
        frame.points.iter_mut().flatten().for_each(|point| *point += Vector3::new(0.03, 0.04, 0.0));
    });
    assert_found(&folder, "trajectories-3d out/markers.jsonl", "rms_mm", 0.05);
    folder.change::<HeadPose>("pose.jsonl", |frame| {
        let turn = Isometry3::rotation(Vector3::z() * 1f64.to_radians());
        if frame.frame > 1001 {
            frame.world_from_head = frame.world_from_head.map(|pose| pose * turn);
        }
    });
    assert_found(&folder, "head-pose out/pose.jsonl", "rotation_max_deg", 1.0);
    folder.change::<Sections>("sections.jsonl", |frame| {
        let sections = frame.sections.values_mut().flat_map(|wrinkles| wrinkles.values_mut().flatten());
        sections.for_each(|section| section.d_px *= 1.1);
    });
    assert_found(&folder, "sections out/sections.jsonl", "depth_rel", 0.1);
    folder.change::<Wrinkles2d>("wrinkles-2d.jsonl", |frame| {
        let curves = frame.curves.values_mut().flat_map(|curves| curves.values_mut());
        curves.flat_map(|curve| &mut curve.controls).for_each(|control| control[1] += 0.75);
    });
    assert_found(&folder, "wrinkles-2d out/wrinkles-2d.jsonl", "curve_px", 0.75);
    folder.change::<Valleys>("valleys.jsonl", |frame| {
        frame.valleys.values_mut().flatten().for_each(|point| point.at_mm[0] += 0.2);
    });
    assert_found(&folder, "valleys out/valleys.jsonl", "position_mm", 0.2);
    folder.change_header::<TimeBase>("sync.jsonl", |header| {
        header.cameras.get_mut("m2").unwrap().offset_frames += 0.25;
    });
    assert_found(&folder, "sync out/sync.jsonl", "offset_frames", 0.25);
    folder.change_document::<CameraRig>("cameras-calibrated.json", |rig| {
        rig.cameras.get_mut("m3").unwrap().camera.lens.focal_px *= 1.02;
    });
    assert_found(&folder, "cameras out/cameras-calibrated.json", "focal_rel", 0.02);
    let same = "cameras out/cameras-calibrated.json --against out/cameras-calibrated.json";
    assert_eq!(values(&folder, same)["focal_rel"], Some(0.0));
}

#[test]
fn a_rigid_motion_of_head_space_is_no_error() {
    let folder = Folder::new();
    let motion = Isometry3::new(Vector3::new(10.0, -20.0, 5.0), Vector3::new(0.1, 0.2, -0.3));
    folder.change::<HeadTrajectories>("head.jsonl", |frame| {
        frame.points.iter_mut().flatten().for_each(|point| *point = motion * *point);
    });
    assert!(values(&folder, "head-trajectories out/head.jsonl")["rms_all_mm"].unwrap() < 1e-9);
    refuse(&folder, "trajectories-3d out/head.jsonl --truth truth", &["holds 'head-trajectories/1'"]);
}

#[test]
fn markers_that_one_camera_sees_are_not_asked_for_but_scored_where_filled() {
    let folder = Folder::new();
    let hide = |frame: &mut artifact::Tracks2dFrame| {
        for samples in frame.cameras.iter_mut().take(2).flatten() {
            samples[0].as_mut().unwrap().state = artifact::TrackState::Predicted;
        }
    };
    folder.change::<Tracks2d>("tracks-2d.jsonl", hide);
    std::fs::copy(folder.path("out/tracks-2d.jsonl"), folder.path("truth/tracks-2d.jsonl")).unwrap();
    folder.change::<Trajectories3d>("markers.jsonl", |frame| frame.points[0] = None);
    let lost = values(&folder, "trajectories-3d out/markers.jsonl");
    assert_eq!((lost["coverage"], lost["missing"]), (Some(1.0), Some(0.0)));
    folder.change::<Trajectories3d>("markers.jsonl", |frame| {
        frame.points[0].as_mut().unwrap().x += 0.5;
        frame.status[0] = artifact::SampleStatus::SingleCamera;
    });
    let filled = values(&folder, "trajectories-3d out/markers.jsonl");
    assert_eq!(filled["rms_mm"], Some(0.0));
    assert!((filled["filled_rms_mm"].unwrap() - 0.5).abs() < 1e-9);
}

#[test]
fn known_errors_of_surfaces_are_found() {
    let folder = Folder::new();
    folder.change_samples("large-scale.pc2", 0.5);
    folder.change_document::<LargeScale>("large-scale.json", |_| ());
    assert_found(&folder, "large-scale out/large-scale.json", "rms_mm", 0.5);
    assert_eq!(values(&folder, "normals out/large-scale.json")["missing"], Some(0.0));
    assert!(values(&folder, "normals out/large-scale.json")["p90_deg"].unwrap() > 1.0);
    // A surface without its wrinkles lacks exactly them.
    std::fs::copy(folder.path("truth/large-scale.pc2"), folder.path("out/wrinkled.pc2")).unwrap();
    folder.change_document::<Wrinkled>("wrinkled.json", |_| ());
    let flat = values(&folder, "wrinkled out/wrinkled.json --against truth/large-scale.json");
    assert_eq!((flat["region_error_ratio"], flat["outside_moved"]), (Some(1.0), Some(0.0)));
    assert!((flat["valley_depth_rel"].unwrap() - 1.0).abs() < 0.01);
    assert_eq!(values(&folder, "wrinkled out/wrinkled.json")["outside_moved"], None);
}

#[test]
fn known_errors_of_pictures_are_found() {
    let folder = Folder::new();
    folder.copy_pictures("paint", "out/{camera}-{frame:06}-mask.png");
    std::fs::remove_file(folder.path("out/m2-001003-mask.png")).unwrap();
    std::fs::copy(folder.path("out/m1-001001-mask.png"), folder.path("out/m1-002000-mask.png")).unwrap();
    let pattern = "masks out/{camera}-{frame:06}-mask.png --truth truth";
    let found = values(&folder, "masks out/{camera}-{frame:06}-mask.png");
    assert_eq!(found["missing"], Some(1.0));
    assert!(String::from_utf8(run(&folder, pattern).stderr).unwrap().contains("m1-002000-mask.png"));
    assert_eq!(
        values(&folder, "masks out/{camera}-{frame:06}-mask.png --frames 1001-1002")["missing"],
        Some(0.0)
    );
    let single = "masks out/m1-001001-mask.png --against truth/paint/m1/001001.png";
    assert_eq!(values(&folder, single)["pixel_f1"], Some(1.0));

    folder.write_normals("out", 0.05);
    assert_found(&folder, "normals out", "mean_deg", 0.05f64.to_degrees());
}

#[test]
fn frames_can_be_chosen() {
    let folder = Folder::new();
    folder.change::<Tracks2d>("tracks-2d.jsonl", |frame| {
        if frame.frame == 1003 {
            frame.cameras[0] = None;
        }
    });
    let recall = |frames: &str| {
        values(&folder, &format!("tracks-2d out/tracks-2d.jsonl --frames {frames}"))["recall"].unwrap()
    };
    assert_eq!(recall("1001-1002"), 1.0);
    assert!((recall("1003-1003") - 2.0 / 3.0).abs() < 1e-12);
    let rows = rows(&folder, "large-scale truth/large-scale.json --frames 1002-");
    assert_eq!(rows[0]["context"]["frames"], 3);
    for kind in ["tracks-2d truth/tracks-2d.jsonl", "large-scale truth/large-scale.json", "masks truth/paint"]
    {
        let outside = format!("{kind} --truth truth --frames 2000-2100");
        refuse(&folder, &outside, &["none of the frames 2000-2100", "from 1001 to 1004"]);
    }
}

#[test]
fn the_table_is_for_people_and_the_prefix_can_be_chosen() {
    let folder = Folder::new();
    let output = run(&folder, "tracks-2d truth/tracks-2d.jsonl --truth truth --stage mine");
    assert!(output.status.success() && output.stdout.is_empty());
    let table = String::from_utf8(output.stderr).unwrap();
    assert!(table.contains("mine/recall") && table.contains("1 share"), "{table}");
    let summary = run(&folder, "tracks-2d truth/tracks-2d.jsonl --truth truth --json --quiet").stdout;
    let summary: Value = serde_json::from_slice(&summary).unwrap();
    assert_eq!(summary["stage"], "virtual-rig score");
    let inputs: Vec<&String> = summary["inputs"].as_object().unwrap().keys().collect();
    assert_eq!(inputs, ["truth tracks-2d.jsonl", "result"]);
}

#[test]
fn a_truth_without_the_file_is_named() {
    let folder = Folder::new();
    for (kind, file, ..) in KINDS {
        let needed = match kind {
            "wrinkles-2d" => "sections.jsonl",
            "normals" if file.ends_with("json") => "wrinkled.json",
            _ => file.split_whitespace().next().unwrap(),
        };
        let hidden = folder.path("hidden");
        std::fs::rename(folder.path("truth").join(needed), &hidden).unwrap();
        let result = if file.ends_with("jsonl") || file.contains("json") { "x.json" } else { "out" };
        refuse(
            &folder,
            &format!("{kind} {result} --truth truth"),
            &[needed, "is not there", "virtual-rig make"],
        );
        std::fs::rename(&hidden, folder.path("truth").join(needed)).unwrap();
    }
    refuse(&folder, "sync x.jsonl --truth nowhere", &["nowhere: is no folder", "virtual-rig make"]);
    refuse(&folder, "sync truth/sync.jsonl --truth .", &["sync.jsonl", "--truth ./truth"]);
}

#[test]
fn another_take_is_refused() {
    let folder = Folder::new();
    fn other<S: Stream>(folder: &Folder, name: &str, kind: &str, change: impl Fn(&mut S::Header)) {
        folder.change_header::<S>(name, change);
        refuse_other(folder, kind, name);
    }
    fn refuse_other(folder: &Folder, kind: &str, name: &str) {
        let words = ["take t2", "the truth of its own take", name];
        let output = run(folder, &format!("{kind} out/{name} --truth truth"));
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{message}");
        words.iter().for_each(|word| assert!(message.contains(word), "{message}"));
    }
    let t2 = || Some(truth_folder::take("t2"));
    other::<Tracks2d>(&folder, "tracks-2d.jsonl", "tracks-2d", |header| header.take = t2());
    other::<Trajectories3d>(&folder, "markers.jsonl", "trajectories-3d", |header| header.take = t2());
    other::<Valleys>(&folder, "valleys.jsonl", "valleys", |header| header.take = t2());
    folder.change_document::<LargeScale>("large-scale.json", |index| index.take = t2());
    std::fs::copy(folder.path("truth/large-scale.pc2"), folder.path("out/large-scale.pc2")).unwrap();
    refuse_other(&folder, "large-scale", "large-scale.json");
    let against = "wrinkled truth/wrinkled.json --truth truth --against out/large-scale.json";
    refuse(&folder, against, &["out/large-scale.json: is of another take"]);
}

#[test]
fn a_result_without_a_take_is_believed_with_a_warning() {
    let folder = Folder::new();
    folder.change_header::<Tracks2d>("tracks-2d.jsonl", |header| header.take = None);
    let output = run(&folder, "tracks-2d out/tracks-2d.jsonl --truth truth");
    assert!(output.status.success());
    assert!(String::from_utf8(output.stderr).unwrap().contains("names no take"));
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let folder = Folder::new();
    folder.change_header::<Tracks2d>("tracks-2d.jsonl", |header| header.markers[0] = "stray".into());
    refuse(
        &folder,
        "tracks-2d out/tracks-2d.jsonl --truth truth",
        &["marker stray", "p1", "tracks-2d.jsonl"],
    );
    refuse(&folder, "tracks-2d truth/sections.jsonl --truth truth", &["holds 'sections/1'", "tracks-2d"]);
    refuse(&folder, "wrinkled truth/large-scale.json --truth truth", &["holds 'large-scale/1'"]);
    refuse(&folder, "sync nothing.jsonl --truth truth", &["nothing.jsonl"]);
    refuse(&folder, "sync truth/sync.jsonl --truth truth --against x", &["--against: the kind sync"]);
    refuse(
        &folder,
        "sync truth/sync.jsonl --truth truth --marker-unit mm",
        &["--marker-unit: the kind sync"],
    );
    refuse(&folder, "masks nothing --truth truth", &["nothing: is not there"]);
    refuse(&folder, "masks take --truth truth", &["take: holds no picture", "take/m1/001001.png"]);
    refuse(&folder, "masks truth/paint/m1/001001.png --truth truth", &["a single picture", "--against"]);
    refuse(&folder, "masks out/{frame:06}.png --truth truth", &["one picture for 2 cameras", "{camera}"]);
    refuse(&folder, "normals truth/paint --truth truth", &["m1, frame 1001, image size"]);
    let scan = std::fs::read_to_string(folder.path("take/scan.obj")).unwrap();
    std::fs::write(folder.path("take/scan.obj"), format!("# edited\n{scan}")).unwrap();
    refuse(
        &folder,
        "wrinkled truth/wrinkled.json --truth truth",
        &["take/scan.obj: is not the scan of this take"],
    );
    std::fs::remove_file(folder.path("take/scan.obj")).unwrap();
    refuse(&folder, "normals truth/wrinkled.json --truth truth", &["take/scan.obj: is not there"]);
}

#[test]
fn usage_errors_exit_with_2() {
    let folder = Folder::new();
    for arguments in
        ["nonsense x --truth truth", "sync --truth truth", "sync x", "sync x --truth t --frames 9-1"]
    {
        assert_eq!(run(&folder, arguments).status.code(), Some(2), "{arguments}");
    }
}

#[test]
fn help() {
    let mut command = Command::cargo_bin("virtual-rig").unwrap();
    let output = command.env("COLUMNS", "100").args(["score", "--help"]).output().unwrap();
    insta::assert_snapshot!("help-score", String::from_utf8(output.stdout).unwrap());
}
