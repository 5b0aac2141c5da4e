//! The workbench as a person meets it: its pages in a real browser, and the stages on what it wrote.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::disallowed_methods,
    reason = "a test fails by panicking"
)]

mod support;

use assert_cmd::Command;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command as Program, Stdio};
use support::likeness::files;
use support::{binary, said, tiny_face};

/// The golden take and what a run made of it, without what people bring; its labels beside it.
fn take(folder: &Path) {
    let rig = tiny_face().join("00-virtual-rig");
    for file in files(&rig.join("take")) {
        let target = folder.join("take").join(&file);
        std::fs::create_dir_all(target.parent().expect("its folder")).expect("a folder");
        std::fs::copy(rig.join("take").join(&file), target).expect("a copy");
    }
    std::fs::rename(folder.join("take/labels.json"), folder.join("labels.json")).expect("labels");
    let _ = std::fs::remove_file(folder.join("take/labels.json.prov.json"));
    std::fs::create_dir_all(folder.join("run/capture")).expect("a folder");
    std::fs::copy(rig.join("truth/cameras-calibrated.json"), folder.join("run/capture/cameras.json"))
        .expect("cameras");
    std::fs::copy(rig.join("truth/head.jsonl"), folder.join("run/capture/head.jsonl")).expect("markers");
    works("capture-sync", folder, &["run", "take/take.json", "--out", "run/capture/sync"]);
}

fn works(stage: &str, folder: &Path, words: &[&str]) {
    let done = said(Command::new(binary(stage)).current_dir(folder).args(words));
    assert_eq!(done.code, Some(0), "{stage} {words:?}: {}", done.stderr);
}

/// A workbench that serves, stopped when dropped.
struct Bench(Child);

impl Drop for Bench {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn bench(folder: &Path) -> (Bench, String) {
    let mut child = Program::new(binary("workbench"))
        .current_dir(folder)
        .args(["take", "--run", "run", "--no-open", "--quiet"])
        .stdout(Stdio::piped())
        .spawn()
        .expect("a program");
    let mut url = String::new();
    BufReader::new(child.stdout.as_mut().expect("its output")).read_line(&mut url).expect("an address");
    (Bench(child), url.trim().to_string())
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).expect("a file")).expect("JSON")
}

#[test]
fn what_a_person_does_at_the_pages_is_what_the_stages_read() {
    let script =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../stages/workbench/tests/browser/workbench.mjs");
    let Some(mut node) = testkit::node(&script, true) else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    take(folder);
    let (_bench, url) = bench(folder);
    let run = node.arg(&url).arg(folder.join("labels.json")).output().expect("node");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let found: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    check_page(&found);
    check_labels(folder);
    let images = ["--frames", "run/capture/sync/frames.json", "--sync", "run/capture/sync/sync.jsonl"];
    let track =
        [&["track"], &images[..], &["--labels", "take/labels.json", "--out", "tracks.jsonl"]].concat();
    works("marker-track", folder, &track);
    let train = [&["train"], &images[..], &["--masks", "take/paint-mask", "--out", "paint.json"]].concat();
    works("wrinkle-track", folder, &train);
    let scan = ["--mesh", "take/scan.obj", "--take", "take/take.json", "--picks", "take/picks.csv"];
    works("rbf-warp", folder, &[&["correspond"], &scan[..], &["--out", "pairs.json"]].concat());
}

fn check_page(found: &Value) {
    assert_eq!(found["errors"], serde_json::json!([]), "{found}");
    let says = |key: &str, words: &str| {
        let text = found[key].as_str().unwrap_or_default();
        assert!(text.contains(words), "{key}: {text}");
    };
    says("fit", "median");
    says("lacking", "84 picked");
    says("painted", "Not saved");
    says("unpainted", "says the same as before");
    says("learnt", "of held-out pixels told rightly");
    says("second", "Another window works on this take");
    assert_eq!(found["doubtful"], 0, "labels that agree with the other camera: {found}");
}

/// Clicks 1 px beside the dots found their centres; where none was found in these small images, the place itself is kept.
fn check_labels(folder: &Path) {
    let (wanted, found) = (json(&folder.join("labels.json")), json(&folder.join("take/labels.json")));
    let mut offs = Vec::new();
    for camera in ["m3", "m4"] {
        for (marker, at) in found["data"]["cameras"][camera].as_object().expect("dots") {
            let wanted = &wanted["data"]["cameras"][camera][marker];
            let off = |axis: usize| at[axis].as_f64().expect("px") - wanted[axis].as_f64().expect("px");
            offs.push((off(0).hypot(off(1)), format!("{camera} {marker}: {at} for {wanted}")));
        }
    }
    offs.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(offs.len() > 130, "{} dots are named", offs.len());
    assert!(offs[offs.len() / 2].0 < 0.5, "the median is {:?}", offs[offs.len() / 2]);
    assert!(offs.last().is_some_and(|worst| worst.0 < 1.6), "{:?}", offs.last());
}
