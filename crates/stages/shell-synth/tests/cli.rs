//! The program as users run it.
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "a test may fail, and looks at files")]

mod support;

use artifact::{
    FileRef, FrameWriter, LargeScale, MeshRef, SequenceForm, Space, Unit, Valleys, ValleysFrame,
    ValleysHeader, Wrinkle, Wrinkled, pc2,
};
use assert_cmd::Command;
use nalgebra::Point3;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;
use support::{frame, plate, pushed, valley};

/// A folder with a scan in cm, a sequence of frames 1–10 that pushes it, and a valley in every second of them.
struct Folder {
    root: tempfile::TempDir,
    mesh: MeshRef,
}

fn wrinkle(id: &str) -> Wrinkle {
    serde_json::from_value(serde_json::json!({ "id": id, "paint": "green" })).unwrap()
}

impl Folder {
    fn new() -> Self {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("scan.obj");
        artifact::obj::write(&path, &plate(), Unit::Cm).unwrap().publish().unwrap();
        let file = FileRef { name: "scan.obj".to_string(), sha256: artifact::sha256(&path).unwrap() };
        let mesh = MeshRef { file, unit: Unit::Cm, vertex_count: plate().positions.len() };
        let folder = Self { root, mesh };
        folder.large_scale("large.json", &folder.mesh);
        let depth = |t: i64| 0.08 * t as f64;
        let known: Vec<ValleysFrame> =
            [2, 4, 6, 8, 10].map(|t| frame(t, &[("fold", valley(30, 0.0, 1.2, depth(t)))])).into();
        folder.valleys("valleys.jsonl", &folder.mesh, &known);
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    fn large_scale(&self, name: &str, mesh: &MeshRef) {
        let cache = Path::new(name).with_extension("pc2").display().to_string();
        let mut writer = pc2::Writer::create(&self.path(&cache), mesh.vertex_count, 1).unwrap();
        for t in 1..=10 {
            let in_cm = |p: &Point3<f64>| [p.x, p.y, p.z].map(|x| (x / 10.0) as f32);
            let coordinates: Vec<f32> = pushed(1.0 - 0.004 * f64::from(t)).iter().flat_map(in_cm).collect();
            writer.write(&coordinates).unwrap();
        }
        writer.finish().unwrap().publish().unwrap();
        let (frames, form) = ((1..=10).collect(), SequenceForm::Pc2);
        let index = LargeScale { mesh: mesh.clone(), cache, form, rate: None, frames, take: None };
        artifact::write_document(&self.path(name), &index).unwrap().publish().unwrap();
    }

    fn valleys(&self, name: &str, mesh: &MeshRef, frames: &[ValleysFrame]) {
        let wrinkles = vec![wrinkle("fold")];
        let header =
            ValleysHeader { mesh: mesh.clone(), wrinkles, rate: None, take: None, space: Space::Face };
        let mut writer = FrameWriter::<Valleys>::create(&self.path(name), header).unwrap();
        frames.iter().for_each(|frame| writer.write(frame).unwrap());
        writer.finish().unwrap().publish().unwrap();
    }

    fn run(&self, more: &[&str]) -> Output {
        let names = ["--mesh", "scan.obj", "--large-scale", "large.json", "--valleys", "valleys.jsonl"];
        let mut command = Command::new(env!("CARGO_BIN_EXE_shell-synth"));
        command.current_dir(self.root.path()).args(names).args(more).output().unwrap()
    }

    fn files(&self) -> usize {
        std::fs::read_dir(self.root.path()).unwrap().count()
    }
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_sequence_gets_its_wrinkles_and_says_how() {
    let folder = Folder::new();
    let output = folder.run(&["--out", "made.json", "--report", "made.csv", "--json"]);
    assert!(output.status.success(), "{}", said(&output));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["results"]["frames"], 10);
    assert_eq!(summary["results"]["inverted_triangles"], 0);
    assert_eq!(summary["results"]["creases"][0]["wrinkle"], "fold");
    let index: Wrinkled = artifact::read_document(&folder.path("made.json")).unwrap();
    assert_eq!((index.0.frames.len(), index.0.mesh), (10, folder.mesh.clone()));
    let rows = std::fs::read_to_string(folder.path("made.csv")).unwrap();
    assert!(
        rows.lines().next().unwrap().starts_with("frame,wrinkles,free_vertices")
            && rows.contains("\n10,fold,")
    );
    for name in ["made.json.prov.json", "made.pc2.prov.json"] {
        assert!(folder.path(name).exists(), "{name}");
    }
    // What no valley reaches has the bytes of the large-scale sequence: the first row of vertices in the last frame.
    let (before, after) =
        ["large.pc2", "made.pc2"].map(|name| std::fs::read(folder.path(name)).unwrap()).into();
    let last = before.len() - folder.mesh.vertex_count * 12;
    assert_eq!(before[last..last + 61 * 12], after[last..last + 61 * 12]);
    assert_ne!(before[last..], after[last..]);
}

#[test]
fn a_part_of_the_frames_equals_the_same_part_of_the_whole() {
    let folder = Folder::new();
    let whole = folder.run(&["--out", "whole.json", "--quiet"]);
    let part = folder.run(&["--out", "part.json", "--frames", "6-9", "--threads", "1", "--quiet"]);
    assert!(whole.status.success() && part.status.success(), "{}{}", said(&whole), said(&part));
    let samples = |name: &str| std::fs::read(folder.path(name)).unwrap()[32..].to_vec();
    let bytes = folder.mesh.vertex_count * 12;
    assert!(samples("part.pc2") == samples("whole.pc2")[5 * bytes..9 * bytes]);
}

/// A run that could not finish leaves a file that says so, and `--resume` makes of it the bytes that one run would have made.
#[test]
fn an_unfinished_run_is_resumed() {
    let folder = Folder::new();
    let read = |name: &str| std::fs::read(folder.path(name)).unwrap();
    let whole = folder.run(&["--out", "made.json", "--quiet"]);
    assert!(whole.status.success(), "{}", said(&whole));
    let expected = ["made.pc2", "made.json"].map(read);
    // The disk is full in the sixth frame.
    let limit = (5 * folder.mesh.vertex_count * 12 + 4000) / 1024;
    let words = "--mesh scan.obj --large-scale large.json --valleys valleys.jsonl --out made.json --quiet";
    for name in ["made.pc2", "made.json"] {
        std::fs::remove_file(folder.path(name)).unwrap();
    }
    let program = env!("CARGO_BIN_EXE_shell-synth");
    let script = format!("ulimit -f {limit}; trap '' XFSZ; exec '{program}' {words}");
    let mut bash = std::process::Command::new("bash");
    let cut = bash.args(["-c", &script]).current_dir(folder.root.path()).output().unwrap();
    assert_eq!(cut.status.code(), Some(1), "{}", said(&cut));
    assert!(folder.path("made.pc2.partial").exists() && !folder.path("made.json").exists());
    let resumed = folder.run(&["--out", "made.json", "--resume"]);
    assert!(resumed.status.success() && said(&resumed).contains("there already"), "{}", said(&resumed));
    assert!(["made.pc2", "made.json"].map(read) == expected);
    assert!(!folder.path("made.pc2.partial").exists());
}

#[test]
fn parts_joined_are_the_whole() {
    let folder = Folder::new();
    let mut joined = Vec::new();
    let samples = |name: &str| std::fs::read(folder.path(name)).unwrap()[32..].to_vec();
    for (frames, name) in [("1-3", "a"), ("4-8", "b"), ("9-10", "c")] {
        let made = folder.run(&["--out", &format!("{name}.json"), "--frames", frames, "--quiet"]);
        assert!(made.status.success(), "{}", said(&made));
        joined.extend(samples(&format!("{name}.pc2")));
    }
    assert!(folder.run(&["--out", "whole.json", "--quiet"]).status.success());
    assert!(joined == samples("whole.pc2"));
}

#[test]
fn a_finer_scan_is_written_with_its_map() {
    let folder = Folder::new();
    folder.valleys("valleys.jsonl", &folder.mesh, &[frame(4, &[("fold", valley(30, 0.0, 0.4, 0.3))])]);
    let output = folder.run(&["--out", "made.json", "--frames", "4-4", "--refine", "fine.obj"]);
    assert!(output.status.success(), "{}", said(&output));
    assert!(!said(&output).contains("its depth will be lost"), "{}", said(&output));
    let fine = artifact::read_mesh(&folder.path("fine.obj"), Unit::Cm).unwrap();
    let index: Wrinkled = artifact::read_document(&folder.path("made.json")).unwrap();
    assert_eq!(index.0.mesh.vertex_count, fine.positions.len());
    assert_eq!(index.0.mesh.file.sha256, artifact::sha256(&folder.path("fine.obj")).unwrap());
    let map = std::fs::read_to_string(folder.path("fine.csv")).unwrap();
    assert_eq!(map.lines().count() - 1, fine.positions.len() - plate().positions.len());
    let refused = folder.run(&["--out", "made.json", "--refine", "fine.obj", "--refine-edges", "0"]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(said(&refused).contains("--refine-edges"), "{}", said(&refused));
}

#[test]
fn another_mesh_is_refused_with_the_file_and_what_to_do() {
    let folder = Folder::new();
    let mut other = folder.mesh.clone();
    other.file.sha256 = "0".repeat(64);
    folder.valleys("valleys.jsonl", &other, &[frame(2, &[])]);
    let before = folder.files();
    let output = folder.run(&["--out", "made.json"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("valleys.jsonl") && said(&output).contains("to do"), "{}", said(&output));
    folder.valleys("valleys.jsonl", &folder.mesh, &[frame(2, &[])]);
    folder.large_scale("large.json", &other);
    let output = folder.run(&["--out", "made.json"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("large.json"), "{}", said(&output));
    assert_eq!(folder.files(), before, "nothing is left");
}

#[test]
fn a_triangle_that_is_not_there_is_named_with_frame_wrinkle_and_point() {
    let folder = Folder::new();
    let mut points = valley(30, 0.0, 1.2, 0.5);
    points[3].face = 70_000;
    folder.valleys("valleys.jsonl", &folder.mesh, &[frame(4, &[("fold", points)])]);
    let output = folder.run(&["--out", "made.json"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("frame 4, wrinkle fold, point 3"), "{}", said(&output));
}

#[test]
fn a_valley_too_narrow_for_the_mesh_is_warned_of_with_numbers() {
    let folder = Folder::new();
    folder.valleys("valleys.jsonl", &folder.mesh, &[frame(4, &[("fold", valley(30, 0.0, 0.4, 0.3))])]);
    let output = folder.run(&["--out", "made.json"]);
    assert!(output.status.success(), "{}", said(&output));
    assert!(said(&output).contains("wrinkle fold: it is down to w = 0.40 mm wide"), "{}", said(&output));
}

#[test]
fn frames_that_are_not_there_are_refused() {
    let output = Folder::new().run(&["--out", "made.json", "--frames", "50-60"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("it has frames from 1 to 10"), "{}", said(&output));
}

#[test]
fn the_help_says_it_all() {
    let output = Command::new(env!("CARGO_BIN_EXE_shell-synth")).arg("--help").output().unwrap();
    insta::assert_snapshot!("help", String::from_utf8_lossy(&output.stdout));
}
