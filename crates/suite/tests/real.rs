//! Recorded data as it is: a dirty scan, and a take with mixed-up labels.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "a test fails by panicking, in folders of its own, and says what it skips"
)]

mod support;

use serde_json::{Value, json};
use std::path::Path;
use support::{call, summary};

/// Writes handles for a mesh by hand: four vertices, two frames.
fn write_handles(folder: &Path, mesh: &str, name: &str) {
    // The summary of a comparison tells the file's hash and how many vertices there are.
    let looked = summary(folder, &format!("artifact-diff {mesh} {mesh} --unit mm"));
    let sha256 = hash_of(&looked["inputs"]);
    let path = folder.join(mesh);
    let text = std::fs::read_to_string(&path).expect("the mesh");
    let vertex_count = text.lines().filter(|line| line.starts_with("v ")).count();
    let vertices = [0, vertex_count / 3, vertex_count / 2, vertex_count - 1];
    let handles: Vec<Value> =
        vertices.iter().map(|vertex| json!({ "marker": format!("m{vertex}"), "vertex": vertex })).collect();
    let file = json!({ "name": path.file_name().expect("a name").to_string_lossy(), "sha256": sha256 });
    let mesh = json!({ "file": file, "unit": "mm", "vertex_count": vertex_count });
    let header = json!({ "schema": "handles/1", "data": { "mesh": mesh, "handles": handles } });
    let mut lines = vec![header.to_string()];
    for frame in [1, 2] {
        let moved: serde_json::Map<String, Value> =
            vertices.iter().map(|vertex| (format!("m{vertex}"), json!([0.0, frame, 0.5]))).collect();
        lines.push(json!({ "frame": frame, "displacements_mm": moved }).to_string());
    }
    std::fs::write(folder.join(name), lines.join("\n") + "\n").expect("a file");
}

/// The first hash among a summary's inputs.
fn hash_of(inputs: &Value) -> String {
    match inputs {
        Value::Object(fields) => match fields.get("sha256").and_then(Value::as_str) {
            Some(hash) => hash.to_string(),
            None => hash_of(fields.values().next().expect("an input")),
        },
        Value::Array(list) => hash_of(&list[0]),
        other => panic!("no input: {other}"),
    }
}

#[test]
fn a_dirty_scan_is_refused_by_name_joined_or_mended() {
    let Some(scan) = testkit::data("head_meshmonk_demoface/DemoFace_10K.obj") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    std::fs::copy(scan, path.join("face.obj")).expect("a copy");
    write_handles(path, "face.obj", "handles.jsonl");
    let line = "linear-shell --mesh face.obj --handles handles.jsonl --out out/face.json";

    let refused = call(path, line);
    assert_eq!(refused.code, Some(1), "{}", refused.stderr);
    for word in ["face.obj", "bow-tie", "vertex", "--bow-ties join", "mesh-clip"] {
        assert!(refused.stderr.contains(word), "'{word}' is not in: {}", refused.stderr);
    }
    assert!(!path.join("out").exists(), "something is left");

    let joined = summary(path, &format!("{line} --bow-ties join --free-components hold"));
    assert_eq!(joined["results"]["surface"]["bow_ties"], 21);
    assert_eq!(joined["results"]["frames"], 2);

    let clip = "mesh-clip --mesh face.obj --unit mm --drop-non-manifold --keep-largest-component --out clean.obj \
                --map map.json";
    let clipped = summary(path, clip);
    assert_eq!(clipped["results"]["components"], 1, "{}", clipped["results"]);
    write_handles(path, "clean.obj", "clean.jsonl");
    let clean = summary(path, "linear-shell --mesh clean.obj --handles clean.jsonl --out clean/face.json");
    assert_eq!(clean["results"]["surface"]["bow_ties"], 0);
    assert_eq!(clean["results"]["frames"], 2);
}

/// Around frames 819 to 862 three labels of the singer's eyes are mixed up.
#[test]
fn mixed_up_labels_of_a_recorded_take_are_warned_about_by_name() {
    let Some(take) = testkit::data("c3d/Facial-Sing_frames0001-1500.c3d") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let line = format!(
        "stabilize --markers {} --head-markers root-* --out head.jsonl --pose pose.jsonl",
        take.display()
    );
    let warnings = summary(folder.path(), &line)["warnings"].to_string();
    for marker in ["section3-1", "section3-2", "section4-2"] {
        assert!(warnings.contains(marker), "{marker} is not in: {warnings}");
    }
}
