//! The program as users run it.
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "a test may fail, and looks at files")]

mod scene;

use artifact::{Correspondence, FrameReader, Handles, HeadTrajectories, Trajectories, Warp};
use assert_cmd::Command;
use scene::files::Folder;
use serde_json::Value;
use std::process::Output;

fn run(folder: &Folder, arguments: &str) -> Output {
    let mut command = Command::cargo_bin("rbf-warp").unwrap();
    command.current_dir(folder.root.path()).args(arguments.split_whitespace()).output().unwrap()
}

fn succeed(folder: &Folder, arguments: &str) -> Output {
    let output = run(folder, arguments);
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

/// Runs and expects exit code 1, a message with all `words`, and nothing new in the folder.
fn refuse(folder: &Folder, arguments: &str, words: &[&str]) {
    let before = folder.names();
    let output = run(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{arguments}: {message}");
    for word in words {
        assert!(message.contains(word), "'{word}' is not in: {message}");
    }
    assert_eq!(folder.names(), before, "{arguments}");
}

const FIT: &str =
    "fit --markers head.jsonl --correspondence correspondence.json --mesh scan.obj --unit cm --out warp.json";

#[test]
fn a_take_goes_through() {
    let folder = Folder::new(40);
    let summary = succeed(&folder, &format!("{FIT} --json --threads 1"));
    let summary: Value = serde_json::from_slice(&summary.stdout).unwrap();
    assert_eq!(summary["results"]["rest_frame"], 1002);
    assert_eq!(summary["results"]["polynomial_rank"], 10);
    let warp: Warp = artifact::read_document(&folder.path("warp.json")).unwrap();
    assert_eq!(warp.fit.leave_one_out_mm.len(), 40);
    succeed(&folder, "handles --warp warp.json --markers head.jsonl --out handles.jsonl --frames 1002-1003");
    let reader = FrameReader::<Handles>::open(&folder.path("handles.jsonl")).unwrap();
    assert_eq!(reader.header().mesh, warp.mesh);
    let frames: Vec<_> = reader.map(Result::unwrap).collect();
    assert_eq!(frames.iter().map(|frame| frame.frame).collect::<Vec<_>>(), [1002, 1003]);
    assert!(frames[0].displacements.iter().flatten().all(|d| d.norm() < 1e-12));
    assert!(frames[1].displacements.iter().flatten().any(|d| d.norm() > 0.1));
    assert!(folder.path("handles.jsonl.prov.json").exists());
}

#[test]
fn points_go_there_and_back() {
    let folder = Folder::new(40);
    succeed(&folder, FIT);
    succeed(&folder, "apply --warp warp.json --points scan.obj --unit cm --inverse --out mocap.obj");
    let summary =
        succeed(&folder, "apply --warp warp.json --points mocap.obj --unit cm --out back.obj --json");
    let summary: Value = serde_json::from_slice(&summary.stdout).unwrap();
    assert!(summary["seconds"]["evaluate"].is_number());
    let read = |name| artifact::read_mesh(&folder.path(name), artifact::Unit::Cm).unwrap();
    let (scan, back) = (read("scan.obj"), read("back.obj"));
    assert_eq!(scan.polygons, back.polygons);
    for (a, b) in scan.positions.iter().zip(&back.positions) {
        assert!((a - b).norm() < 2e-6);
    }
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let (one, two) = (Folder::new(40), Folder::new(40));
    for (folder, threads) in [(&one, 1), (&two, 2)] {
        succeed(folder, &format!("{FIT} --threads {threads}"));
        succeed(folder, "handles --warp warp.json --markers head.jsonl --out handles.jsonl");
        succeed(
            folder,
            &format!(
                "apply --warp warp.json --points scan.obj --unit cm --inverse --out m.obj --threads {threads}"
            ),
        );
    }
    assert_eq!(one.names(), two.names());
    for name in one.names() {
        assert_eq!(
            std::fs::read(one.path(&name)).unwrap(),
            std::fs::read(two.path(&name)).unwrap(),
            "{name}"
        );
    }
}

fn side_car(folder: &Folder, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(folder.path(name)).unwrap()).unwrap()
}

#[test]
fn a_marker_unit_agrees_or_is_refused_and_is_recorded() {
    let folder = Folder::new(40);
    let handles = "handles --warp warp.json --markers head.jsonl --out handles.jsonl";
    succeed(&folder, &format!("{FIT} --marker-unit mm"));
    assert_eq!(side_car(&folder, "warp.json.prov.json")["data"]["parameters"]["marker_unit"], "mm");
    for call in [FIT, handles] {
        let words = ["head.jsonl, unit: the file says mm, but --marker-unit says cm"];
        refuse(&folder, &format!("{call} --marker-unit cm"), &words);
    }
    succeed(&folder, &format!("{handles} --marker-unit mm --frames 1003-"));
    let parameters = &side_car(&folder, "handles.jsonl.prov.json")["data"]["parameters"];
    assert_eq!((&parameters["marker_unit"], &parameters["frames"]), (&"mm".into(), &"1003-".into()));
}

#[test]
fn values_out_of_range_are_usage_errors() {
    let folder = Folder::new(3);
    for (arguments, range) in [
        (format!("{FIT} --near-mm -1"), "a number from 0 on"),
        (format!("{FIT} --fill-frames -1"), "0..=4294967295"),
        ("correspond --mesh m --picks p --out o --max-distance-mm -1".into(), "a number above 0"),
        ("apply --warp w --points p --out o --inverse --tolerance-mm -1".into(), "a number above 0"),
    ] {
        let output = run(&folder, &arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments}: {message}");
        assert!(message.contains("'-1'") && message.contains(range), "{message}");
    }
}

/// Changes the markers of every frame and returns the fit's warnings.
fn warnings(change: impl Fn(usize, nalgebra::Point3<f64>) -> nalgebra::Point3<f64>) -> String {
    let folder = Folder::new(40);
    let mut head = Trajectories::read::<HeadTrajectories>(&folder.path("head.jsonl")).unwrap();
    for frame in &mut head.frames {
        for (marker, point) in frame.points.iter_mut().enumerate() {
            *point = point.map(|point| change(marker, point));
        }
    }
    folder.write_head("head.jsonl", &head);
    let summary: Value = serde_json::from_slice(&succeed(&folder, &format!("{FIT} --json")).stdout).unwrap();
    summary["warnings"].to_string()
}

#[test]
fn what_is_no_likeness_is_told() {
    let sound = warnings(|_, point| point);
    assert!(!sound.contains("mirrored") && !sound.contains("at best"), "{sound}");
    let mirrored = warnings(|_, p| nalgebra::Point3::new(p.x, -p.y, p.z));
    assert!(mirrored.contains("markers and scan look mirrored"), "{mirrored}");
    let strewn = warnings(|marker, p| p + nalgebra::Vector3::repeat(15.0 * (marker as f64 * 2.4).sin()));
    assert!(strewn.contains("mm from the scan at best") && !strewn.contains("mirrored"), "{strewn}");
}

#[test]
fn too_few_markers_are_refused_and_linear_is_offered() {
    let folder = Folder::new(9);
    refuse(&folder, FIT, &["head.jsonl", "9 markers", "at least 10", "--degree linear"]);
    succeed(&folder, &format!("{FIT} --degree linear"));
    succeed(&folder, &format!("{FIT} --degree auto"));
    refuse(&Folder::new(3), &format!("{FIT} --degree linear"), &["no frame shows four"]);
}

#[test]
fn two_markers_in_one_place_are_refused_by_name() {
    let folder = Folder::new(20);
    let mut head = Trajectories::read::<HeadTrajectories>(&folder.path("head.jsonl")).unwrap();
    head.frames.iter_mut().for_each(|frame| frame.points[4] = frame.points[11]);
    folder.write_head("head.jsonl", &head);
    refuse(&folder, FIT, &["head.jsonl", "m4 and m11", "mocap space"]);
}

#[test]
fn another_scan_or_unit_is_refused() {
    let folder = Folder::new(20);
    refuse(
        &folder,
        &FIT.replace("--unit cm", "--unit mm"),
        &["--unit says mm", "the correspondence says cm"],
    );
    let mut text = std::fs::read_to_string(folder.path("scan.obj")).unwrap();
    text.push_str("# touched\n");
    std::fs::write(folder.path("scan.obj"), text).unwrap();
    refuse(&folder, FIT, &["correspondence.json", "was made for mesh scan.obj", "to do"]);
}

#[test]
fn bad_files_are_refused_with_their_place() {
    let folder = Folder::new(20);
    refuse(&folder, &FIT.replace("head.jsonl", "none.jsonl"), &["none.jsonl", "cannot read"]);
    let text = std::fs::read_to_string(folder.path("head.jsonl")).unwrap();
    std::fs::write(folder.path("cut.jsonl"), &text[..text.len() - 30]).unwrap();
    refuse(&folder, &FIT.replace("head.jsonl", "cut.jsonl"), &["cut.jsonl, line 5", "cut short"]);
    refuse(
        &folder,
        &FIT.replace("head.jsonl", "correspondence.json")
            .replace("--markers correspondence.json", "--markers c.jsonl"),
        &["c.jsonl"],
    );
    refuse(&folder, &format!("{FIT} --rest-frame 7"), &["no frame 7", "1001 to 1004"]);
    succeed(&folder, FIT);
    refuse(&folder, "apply --warp warp.json --points scan.obj --out o.obj", &["unit is not stated"]);
    refuse(
        &folder,
        "apply --warp warp.json --points scan.obj --unit m --out o.obj",
        &["was made with", "not in m"],
    );
    refuse(&folder, "handles --warp warp.json --markers head.jsonl --out h.jsonl --frames 5-6", &["5-6"]);
}

#[test]
fn a_warp_of_another_take_is_refused_unless_told() {
    let folder = Folder::new(20);
    succeed(&folder, FIT);
    let mut head = Trajectories::read::<HeadTrajectories>(&folder.path("head.jsonl")).unwrap();
    head.frames.pop();
    folder.write_head("other.jsonl", &head);
    let handles = "handles --warp warp.json --markers other.jsonl --out handles.jsonl";
    refuse(&folder, handles, &["warp.json", "head.jsonl", "other.jsonl", "--across-takes"]);
    succeed(&folder, &format!("{handles} --across-takes"));
}

#[test]
fn points_out_of_reach_are_reported() {
    let folder = Folder::new(40);
    succeed(&folder, FIT);
    let mut text = std::fs::read_to_string(folder.path("scan.obj")).unwrap();
    text = text.replacen("v ", "v 1e7 1e7 1e7\nv ", 1);
    std::fs::write(folder.path("far.obj"), text).unwrap();
    let apply = "apply --warp warp.json --points far.obj --unit cm --inverse --out o.obj";
    refuse(&folder, apply, &["far.obj", "1 of 61 points", "vertices 0", "--keep-unconverged"]);
    let kept = succeed(&folder, &format!("{apply} --keep-unconverged --json"));
    let kept: Value = serde_json::from_slice(&kept.stdout).unwrap();
    assert_eq!(kept["results"]["unconverged"], 1);
    assert_eq!(kept["results"]["unconverged_vertices"], serde_json::json!([0]));
}

#[test]
fn handles_stream() {
    let folder = Folder::new(20);
    succeed(&folder, FIT);
    let head = std::fs::read(folder.path("head.jsonl")).unwrap();
    let mut command = Command::cargo_bin("rbf-warp").unwrap();
    command.current_dir(folder.root.path()).write_stdin(head);
    let piped =
        command.args(["handles", "--warp", "warp.json", "--markers", "-", "--out", "-", "--across-takes"]);
    let piped = piped.output().unwrap();
    assert!(piped.status.success());
    succeed(&folder, "handles --warp warp.json --markers head.jsonl --out handles.jsonl");
    assert_eq!(piped.stdout, std::fs::read(folder.path("handles.jsonl")).unwrap());
}

#[test]
fn help() {
    for command in ["", "correspond", "fit", "apply", "handles"] {
        let output = Command::cargo_bin("rbf-warp")
            .unwrap()
            .env("COLUMNS", "100")
            .args(command.split_whitespace())
            .arg("--help")
            .output()
            .unwrap();
        insta::assert_snapshot!(
            format!("help {command}").trim().replace(' ', "-"),
            String::from_utf8(output.stdout).unwrap()
        );
    }
}

#[test]
fn picks_become_a_correspondence() {
    let folder = Folder::new(20);
    std::fs::write(folder.path("picks.csv"), "marker,vertex\nm0,0\nm1,1\n").unwrap();
    let picks = "correspond --mesh scan.obj --unit cm --picks picks.csv --out picked.json";
    succeed(&folder, picks);
    let picked: Correspondence = artifact::read_document(&folder.path("picked.json")).unwrap();
    let whole: Correspondence = artifact::read_document(&folder.path("correspondence.json")).unwrap();
    assert_eq!((picked.mesh, &picked.pairs[..]), (whole.mesh, &whole.pairs[..2]));
    std::fs::write(folder.path("picks.csv"), "m0,0,0,0\n").unwrap();
    refuse(&folder, picks, &["picks.csv", "marker m0", "mm from the nearest vertex", "--max-distance-mm"]);
}
