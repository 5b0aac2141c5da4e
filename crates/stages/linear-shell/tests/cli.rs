//! The program as users run it.
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "a test may fail, and looks at files")]

use artifact::{
    FileRef, FrameWriter, Handle, HandleFrame, Handles, HandlesHeader, LargeScale, MeshRef, ResponseBasis,
    Unit, VertexSet, pc2,
};
use assert_cmd::Command;
use mesh::Mesh;
use nalgebra::Vector3;
use serde_json::Value;
use std::path::PathBuf;
use std::process::Output;
use testkit::shapes;

/// A folder with a scan in cm and a take of handles.
struct Folder {
    root: tempfile::TempDir,
    mesh: MeshRef,
}

const VERTICES: [u32; 5] = [0, 12, 90, 156, 168];

impl Folder {
    fn new() -> Self {
        Self::with(&shapes::bump_plane(12, 5.0, 15.0, 14.0))
    }

    fn with(mesh: &Mesh) -> Self {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("scan.obj");
        artifact::obj::write(&path, mesh, Unit::Cm).unwrap().publish().unwrap();
        let file = FileRef { name: "scan.obj".to_string(), sha256: artifact::sha256(&path).unwrap() };
        let folder =
            Self { root, mesh: MeshRef { file, unit: Unit::Cm, vertex_count: mesh.positions.len() } };
        folder.handles("handles.jsonl", &folder.mesh, &folder.frames(8));
        folder
    }

    /// Frames 1001… of a smooth motion; one marker is missing in frame 1003, all in 1006.
    fn frames(&self, count: i64) -> Vec<HandleFrame> {
        let moved = |frame: i64, handle: usize| {
            let phase = frame as f64 * 0.3 + handle as f64;
            Vector3::new(phase.sin(), 2.0 * phase.cos(), 3.0 * (phase * 0.7).sin())
        };
        let told = |frame: i64, handle: usize| frame != 1006 && !(frame == 1003 && handle == 2);
        (1001..1001 + count)
            .map(|frame| HandleFrame {
                frame,
                displacements: (0..5).map(|i| told(frame, i).then(|| moved(frame, i))).collect(),
                weights: vec![None; 5],
            })
            .collect()
    }

    fn handles(&self, name: &str, mesh: &MeshRef, frames: &[HandleFrame]) {
        let handle = |(i, &vertex): (usize, &u32)| Handle { marker: format!("m{i}"), vertex };
        let handles = VERTICES.iter().enumerate().map(handle).collect();
        let header = HandlesHeader { mesh: mesh.clone(), rate: None, handles, take: None, warp: None };
        let mut writer = FrameWriter::<Handles>::create(&self.path(name), header).unwrap();
        frames.iter().for_each(|frame| writer.write(frame).unwrap());
        writer.finish().unwrap().publish().unwrap();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(self.root.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    fn run(&self, arguments: &str) -> Output {
        let mut command = Command::cargo_bin("linear-shell").unwrap();
        command.current_dir(self.root.path()).args(arguments.split_whitespace()).output().unwrap()
    }

    fn succeed(&self, arguments: &str) -> Value {
        let output = self.run(&format!("{arguments} --json"));
        assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    }

    /// Expects exit code 1, all `words` in the message, and nothing new in the folder but what says it is partial.
    fn refuse(&self, arguments: &str, words: &[&str]) {
        let before = self.names();
        let output = self.run(arguments);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments}: {message}");
        words.iter().for_each(|word| assert!(message.contains(word), "'{word}' is not in: {message}"));
        assert_eq!(self.names(), before, "{arguments}");
    }
}

const RUN: &str = "--mesh scan.obj --handles handles.jsonl --out face.json";

fn samples(path: &std::path::Path) -> Vec<Vec<f32>> {
    let mut reader = pc2::Reader::open(path).unwrap();
    std::iter::from_fn(|| reader.read().unwrap()).collect()
}

#[test]
fn a_take_becomes_a_sequence() {
    let folder = Folder::new();
    let summary = folder.succeed(RUN);
    assert_eq!(summary["results"]["frames"], 7);
    assert_eq!(summary["results"]["gap_frames"], serde_json::json!([1006]));
    assert_eq!(summary["results"]["missing_frames"], serde_json::json!({ "m2": 1 }));
    assert_eq!(summary["results"]["leave_one_out"].as_object().unwrap().len(), 5);
    let index: LargeScale = artifact::read_document(&folder.path("face.json")).unwrap();
    assert_eq!(index.frames, [1001, 1002, 1003, 1004, 1005, 1007, 1008]);
    assert_eq!(index.mesh, folder.mesh);
    let rest = artifact::obj::read(&folder.path("scan.obj"), Unit::Mm).unwrap();
    let frames = samples(&folder.path("face.pc2"));
    assert_eq!(frames.len(), 7);
    // In centimetres, as the scan is.
    let told = folder.frames(1)[0].displacements[4].unwrap() / 10.0;
    for axis in 0..3 {
        let moved = f64::from(frames[0][168 * 3 + axis]) - rest.positions[168][axis];
        assert!((moved - told[axis]).abs() < 1e-5, "{moved} {}", told[axis]);
    }
    for name in ["face.json.prov.json", "face.pc2.prov.json"] {
        assert!(folder.path(name).exists(), "{name}");
    }
}

#[test]
fn direct_and_basis_and_every_format_agree() {
    let folder = Folder::new();
    folder.succeed(RUN);
    folder.succeed("--mesh scan.obj --handles handles.jsonl --out direct.json --mode direct");
    folder.succeed("--mesh scan.obj --handles handles.jsonl --out frames.json --format obj");
    folder.succeed("--mesh scan.obj --handles handles.jsonl --out fields.json --format npy --mode direct");
    let basis = samples(&folder.path("face.pc2"));
    for (a, b) in basis.iter().zip(samples(&folder.path("direct.pc2"))) {
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-5));
    }
    let third = artifact::obj::read(&folder.path("frames/frames.1003.obj"), Unit::Mm).unwrap();
    let flat: Vec<f32> = third.positions.iter().flat_map(|p| [p.x as f32, p.y as f32, p.z as f32]).collect();
    assert_eq!(flat, basis[2]);
    assert!(folder.path("fields/fields.1008.npy").exists());
    folder.succeed("--mesh scan.obj --handles handles.jsonl --out layer.json --format usda --up y");
    let layer = std::fs::read_to_string(folder.path("layer.usda")).unwrap();
    assert!(layer.contains("upAxis = \"Y\"") && layer.contains("1008:"), "{}", &layer[..400]);
}

#[test]
fn the_basis_is_kept_and_found_again() {
    let folder = Folder::new();
    let first = folder.succeed(&format!("{RUN} --cache kept --basis basis.json"));
    assert!(first["seconds"]["factor"].is_number());
    let bytes = std::fs::read(folder.path("face.pc2")).unwrap();
    let again = folder.succeed(&format!("{RUN} --cache kept"));
    assert!(again["seconds"]["factor"].is_null(), "{}", again["seconds"]);
    assert_eq!(std::fs::read(folder.path("face.pc2")).unwrap(), bytes);
    let header: ResponseBasis = artifact::read_document(&folder.path("basis.json")).unwrap();
    let (shape, values) = artifact::npy::read_f32(&folder.path(&header.array.name)).unwrap();
    assert_eq!(shape, [169, 5]);
    assert!(values.chunks(5).all(|row| (row.iter().sum::<f32>() - 1.0).abs() < 1e-5));
    // Other parameters, another basis; the elimination order of the mesh serves again.
    let stiffer = folder.succeed(&format!("{RUN} --cache kept --bending 400"));
    assert!(stiffer["seconds"]["factor"].is_number() && stiffer["seconds"]["ordering"].is_null());
}

#[test]
fn ranges_and_parts_join_to_the_whole() {
    let folder = Folder::new();
    folder.succeed(RUN);
    folder.succeed("--mesh scan.obj --handles handles.jsonl --out first.json --frames 1001-1004");
    folder.succeed("--mesh scan.obj --handles handles.jsonl --out second.json --frames 1005-");
    let mut joined = samples(&folder.path("first.pc2"));
    joined.extend(samples(&folder.path("second.pc2")));
    assert_eq!(joined, samples(&folder.path("face.pc2")));
}

#[test]
fn handles_may_come_through_a_pipe() {
    let folder = Folder::new();
    folder.succeed(RUN);
    let mut command = Command::cargo_bin("linear-shell").unwrap();
    command.current_dir(folder.root.path()).args("--mesh scan.obj --handles - --out piped.json".split(' '));
    command.write_stdin(std::fs::read(folder.path("handles.jsonl")).unwrap()).assert().success();
    assert_eq!(samples(&folder.path("piped.pc2")), samples(&folder.path("face.pc2")));
}

#[test]
fn threads_and_repeats_change_no_byte() {
    let folder = Folder::new();
    let made = |threads: usize| {
        folder.succeed(&format!("{RUN} --threads {threads}"));
        ["face.pc2", "face.json", "face.pc2.prov.json", "face.json.prov.json"]
            .map(|name| std::fs::read(folder.path(name)).unwrap())
    };
    assert!(made(1) == made(2));
}

/// Per-frame files are taken over by `--resume` only where they were made from the same inputs.
#[test]
fn frames_in_a_folder_are_resumed_or_made_again() {
    let folder = Folder::new();
    let run = "--mesh scan.obj --handles handles.jsonl --out frames.json --format obj --resume";
    folder.succeed(run);
    let fourth = std::fs::read(folder.path("frames/frames.1004.obj")).unwrap();
    std::fs::remove_file(folder.path("frames/frames.1004.obj")).unwrap();
    std::fs::write(folder.path("frames/frames.1001.obj"), "kept").unwrap();
    folder.succeed(run);
    assert_eq!(std::fs::read(folder.path("frames/frames.1004.obj")).unwrap(), fourth);
    assert_eq!(std::fs::read(folder.path("frames/frames.1001.obj")).unwrap(), b"kept");
    folder.succeed(&format!("{run} --bending 400"));
    assert_ne!(std::fs::read(folder.path("frames/frames.1001.obj")).unwrap(), b"kept");
}

/// A run that could not finish leaves a file that says so, and `--resume` makes of it what one run would have made,
/// side-cars included.
#[test]
fn an_unfinished_run_is_resumed() {
    let folder = Folder::new();
    folder.succeed(RUN);
    let outputs = ["face.pc2", "face.pc2.prov.json", "face.json", "face.json.prov.json"];
    let whole = outputs.map(|name| std::fs::read(folder.path(name)).unwrap());
    outputs.iter().for_each(|name| std::fs::remove_file(folder.path(name)).unwrap());
    assert_eq!(full_disk(&folder, 8).status.code(), Some(1));
    assert!(folder.path("face.pc2.partial").exists() && !folder.path("face.pc2").exists());
    let resumed = folder.run(&format!("{RUN} --resume"));
    let message = String::from_utf8_lossy(&resumed.stderr);
    assert!(resumed.status.success() && message.contains("frames are there already"), "{message}");
    assert!(outputs.map(|name| std::fs::read(folder.path(name)).unwrap()) == whole);
    assert!(!folder.path("face.pc2.partial").exists() && !folder.path("face.pc2.partial.key").exists());
    // What was left by a run on other handles is not continued.
    assert_eq!(full_disk(&folder, 8).status.code(), Some(1));
    folder.handles("handles.jsonl", &folder.mesh, &folder.frames(5));
    let other = folder.run(&format!("{RUN} --resume"));
    assert!(other.status.success() && !String::from_utf8_lossy(&other.stderr).contains("there already"));
}

#[test]
fn bad_input_is_refused_by_name() {
    let folder = Folder::new();
    folder.refuse("--mesh none.obj --handles handles.jsonl --out face.json", &["none.obj", "No such file"]);
    folder.refuse(&format!("{RUN} --unit mm"), &["scan.obj", "--unit says mm", "says cm"]);
    std::fs::write(folder.path("other.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    folder.refuse(
        "--mesh other.obj --handles handles.jsonl --out face.json",
        &["handles.jsonl", "scan.obj", "other.obj", "sha256"],
    );
    folder.refuse(&format!("{RUN} --frames 5-9"), &["handles.jsonl", "5-9"]);
    folder.refuse(&format!("{RUN} --soft 0"), &["--soft"]);
    folder.refuse("--mesh scan.obj --handles handles.jsonl --out face", &["face", ".json"]);
    let text = std::fs::read_to_string(folder.path("handles.jsonl")).unwrap();
    std::fs::write(folder.path("cut.jsonl"), &text[..text.len() - 30]).unwrap();
    folder
        .refuse("--mesh scan.obj --handles cut.jsonl --out face.json", &["cut.jsonl", "line 9", "cut short"]);
    std::fs::write(folder.path("twice.jsonl"), text.replace("\"vertex\":12", "\"vertex\":0")).unwrap();
    folder.refuse(
        "--mesh scan.obj --handles twice.jsonl --out face.json",
        &["twice.jsonl", "m1", "vertex 0", "m0"],
    );
    let other = MeshRef { vertex_count: 4, ..folder.mesh.clone() };
    let set = VertexSet {
        mesh: MeshRef { file: FileRef { name: "x.obj".into(), sha256: "0".repeat(64) }, ..other },
        name: "neck".into(),
        vertices: vec![1],
    };
    artifact::write_document(&folder.path("neck.json"), &set).unwrap().publish().unwrap();
    folder.refuse(&format!("{RUN} --held neck.json"), &["neck.json", "x.obj", "scan.obj"]);
}

#[test]
fn broken_meshes_are_refused_with_what_to_do() {
    let mut two = shapes::bump_plane(12, 5.0, 15.0, 14.0);
    let offset = two.positions.len() as u32;
    two.positions
        .extend([[0.0, 0.0, 500.0], [9.0, 0.0, 500.0], [0.0, 9.0, 500.0]].map(nalgebra::Point3::from));
    two.corner_uvs.clear();
    two.uvs.clear();
    two.polygons.push(&[offset, offset + 1, offset + 2]);
    let folder = Folder::with(&two);
    folder.refuse(
        RUN,
        &["scan.obj", "1 parts of the mesh have no handle", "vertex 169", "--free-components hold"],
    );
    let summary = folder.succeed(&format!("{RUN} --free-components hold"));
    assert_eq!(summary["results"]["surface"]["held_components"], 1);
    assert!(summary["warnings"].to_string().contains("parts of the mesh have no handle"));
}

/// Runs with a limit on the size of files, KiB: writing past it fails as on a full disk.
fn full_disk(folder: &Folder, limit: u32) -> Output {
    let program = assert_cmd::cargo::cargo_bin("linear-shell");
    let script = format!("ulimit -f {limit}; trap '' XFSZ; exec '{}' {RUN} --quiet", program.display());
    let mut bash = std::process::Command::new("bash");
    bash.args(["-c", &script]).current_dir(folder.root.path()).output().unwrap()
}

#[test]
fn a_full_disk_leaves_nothing_that_looks_complete() {
    let folder = Folder::new();
    let output = full_disk(&folder, 4);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("face.pc2"), "{message}");
    assert!(!folder.path("face.pc2").exists() && !folder.path("face.json").exists());
}

/// No output is written over an input, over another output, or over what is no file.
#[test]
fn names_that_are_taken_are_refused() {
    let folder = Folder::new();
    std::fs::copy(folder.path("handles.jsonl"), folder.path("take.json")).unwrap();
    folder.refuse(
        "--mesh scan.obj --handles take.json --out ./take.json",
        &["take.json", "written over an input"],
    );
    assert_eq!(
        folder.run("--mesh scan.obj --handles handles.jsonl --out a.json --basis a.json").status.code(),
        Some(1)
    );
    std::fs::create_dir(folder.path("face.pc2")).unwrap();
    folder.refuse(RUN, &["face.pc2", "exists and is not a file"]);
}

/// A damaged basis in the cache is noticed and made again.
#[test]
fn a_damaged_cache_is_made_again() {
    let folder = Folder::new();
    folder.succeed(&format!("{RUN} --cache kept"));
    let good = std::fs::read(folder.path("face.pc2")).unwrap();
    for entry in std::fs::read_dir(folder.path("kept")).unwrap() {
        let path = entry.unwrap().path();
        let mut bytes = std::fs::read(&path).unwrap();
        if path.extension().is_some_and(|ending| ending == "npy") {
            let end = bytes.len();
            bytes[end - 40..].fill(0);
            std::fs::write(&path, bytes).unwrap();
        }
    }
    let summary = folder.succeed(&format!("{RUN} --cache kept"));
    assert!(summary["warnings"].to_string().contains("made again"), "{}", summary["warnings"]);
    assert_eq!(std::fs::read(folder.path("face.pc2")).unwrap(), good);
}

#[test]
fn models_and_references_are_kept_apart() {
    let folder = Folder::new();
    let made = |options: &str| {
        let summary = folder.succeed(&format!("{RUN} --cache kept {options}"));
        (samples(&folder.path("face.pc2")), summary)
    };
    let (paper, summary) = made("");
    assert!(summary["results"].get("proxy_vertices").is_none());
    let (soft, summary) = made("--model soft-openings");
    assert_eq!(summary["results"]["proxy_vertices"], 169);
    assert!(summary["results"]["refinement_change"].as_f64().unwrap() < 1e-9);
    let (affine, _) = made("--model soft-openings --reference affine");
    assert!(paper != soft && soft != affine);
    // Direct, the same; the samples are float32 in cm.
    for (options, kept) in
        [("--model soft-openings", &soft), ("--model soft-openings --reference affine", &affine)]
    {
        let (direct, _) = made(&format!("{options} --mode direct"));
        let apart = direct
            .iter()
            .flatten()
            .zip(kept.iter().flatten())
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f32::max);
        assert!(apart < 2e-5, "{options}: {apart}");
    }
    folder.refuse(&format!("{RUN} --model soft-openings --softening 1"), &["softening is 1", "below 1"]);
}

#[test]
fn the_help_is_as_reviewed() {
    let output = Folder::new().run("--help");
    insta::assert_snapshot!("help", String::from_utf8_lossy(&output.stdout));
}

#[test]
fn a_closed_scan_is_warned_about() {
    let summary = Folder::new().succeed(RUN);
    assert!(summary["warnings"].to_string().contains("no opening"), "{}", summary["warnings"]);
}
