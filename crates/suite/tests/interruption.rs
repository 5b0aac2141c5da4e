//! An interrupted run leaves nothing that looks complete, and what can be resumed is resumed to the same bytes.
#![cfg(unix)]
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::disallowed_methods,
    reason = "a test fails by panicking, in folders of its own, and watches a clock"
)]

mod support;

use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use support::{binary, names, succeed, tiny_face};

/// What a shell reports of a program that was stopped by Ctrl-C.
const INTERRUPTED: i32 = 130;
/// Enough frames that the run is still at work when the signal comes: 27 MB, of which 1 MB is waited for.
const FRAMES: usize = 1200;
/// Longer than any of these runs takes to get there.
const PATIENCE: Duration = Duration::from_secs(60);

fn start(folder: &Path, line: &str) -> Child {
    let mut words = line.split_whitespace();
    let mut command = Command::new(binary(words.next().expect("a stage")));
    command.current_dir(folder).args(words);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts")
}

/// Waits until `is_so`; fails if the program ends before.
fn wait_until(child: &mut Child, what: &str, is_so: impl Fn() -> bool) {
    let begin = Instant::now();
    while !is_so() {
        let ended = child.try_wait().expect("a state");
        assert!(ended.is_none(), "the program ended ({ended:?}) before {what}");
        assert!(begin.elapsed() < PATIENCE, "{what}: not after {PATIENCE:?}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Sends a signal, and returns what the program said about it. Its standard input stays open and its standard output
/// unread until it has ended, so that nothing but the signal ends it.
fn interrupt(mut child: Child, signal: &str) -> String {
    let (input, output) = (child.stdin.take(), child.stdout.take());
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill runs");
    assert!(sent.success(), "kill {signal}");
    let ended = child.wait_with_output().expect("it ends");
    drop((input, output));
    let said = String::from_utf8_lossy(&ended.stderr).to_string();
    assert_eq!(ended.status.code(), Some(INTERRUPTED), "{signal}: {said}");
    assert!(said.contains("interrupted"), "{signal}: {said}");
    said
}

fn has_part(folder: &Path) -> bool {
    names(folder).iter().any(|name| name.ends_with(".part"))
}

/// The lines of a golden file.
fn golden(file: &str) -> Vec<Value> {
    let text = std::fs::read_to_string(tiny_face().join(file)).expect("a golden file");
    text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

/// A long take: the golden frames over and over under new numbers, of a few markers or handles only.
fn long_take(file: &str, list: &str, per_frame: &str, ids: &[&str]) -> String {
    let lines = golden(file);
    let mut header = lines[0].clone();
    let listed = header["data"][list].as_array_mut().expect("a list");
    listed.retain(|entry| ids.contains(&entry["marker"].as_str().or(entry.as_str()).expect("an id")));
    assert_eq!(listed.len(), ids.len());
    let mut text = format!("{header}\n");
    for number in 0..FRAMES {
        let values = &lines[1 + number % (lines.len() - 1)][per_frame];
        let kept: serde_json::Map<String, Value> =
            ids.iter().map(|id| ((*id).to_string(), values[*id].clone())).collect();
        text.push_str(&format!("{}\n", json!({ "frame": 1001 + number, per_frame: kept })));
    }
    text
}

/// A folder with a scan and a long take, and the start of the command line that makes a sequence of them.
fn sequence_folder() -> (tempfile::TempDir, &'static str) {
    let folder = tempfile::tempdir().expect("a folder");
    let scan = folder.path().join("scan.obj");
    std::fs::copy(tiny_face().join("00-virtual-rig/take/scan.obj"), scan).expect("a copy");
    let ids = ["lip_lower_1", "lip_corner_l", "lip_corner_r", "forehead_m_1", "jaw_r_1", "nose_m_1"];
    let handles = long_take("06-rbf-warp/handles.jsonl", "handles", "displacements_mm", &ids);
    std::fs::write(folder.path().join("handles.jsonl"), handles).expect("a file");
    (folder, "linear-shell --mesh scan.obj --handles handles.jsonl --threads 1")
}

/// Starts a run that writes `cut/face.json`, and interrupts it when some frames are written.
fn cut_short(folder: &Path, line: &str) {
    let mut child = start(folder, &format!("{line} --out cut/face.json"));
    let cut = folder.join("cut");
    let written = || std::fs::metadata(cut.join("face.pc2.partial")).map_or(0, |file| file.len());
    wait_until(&mut child, "the first frames are there", || written() > 1_000_000);
    interrupt(child, "-INT");
    assert_eq!(names(&cut), ["face.pc2.partial", "face.pc2.partial.key"]);
}

fn assert_same(first: &Path, second: &Path) {
    assert_eq!(names(first), names(second));
    for name in names(first) {
        let bytes = |folder: &Path| std::fs::read(folder.join(&name)).expect("an output");
        assert!(bytes(first) == bytes(second), "{name} differs");
    }
}

/// Side-cars too: what a run finds is found in all frames, also in those that were there already.
#[test]
fn an_interrupted_sequence_resumes_to_the_same_bytes() {
    let (folder, line) = sequence_folder();
    let path = folder.path();
    succeed(path, &format!("{line} --mode direct --out whole/face.json"));
    cut_short(path, &format!("{line} --mode direct"));
    let said = succeed(path, &format!("{line} --mode direct --out cut/face.json --resume"));
    assert!(said.stderr.contains("frames are there already"), "{}", said.stderr);
    assert_same(&path.join("cut"), &path.join("whole"));
}

#[test]
fn what_another_run_left_is_not_continued() {
    let (folder, line) = sequence_folder();
    let path = folder.path();
    cut_short(path, &format!("{line} --mode direct"));
    let other = succeed(path, &format!("{line} --mode basis --out cut/face.json --resume"));
    assert!(!other.stderr.contains("there already"), "{}", other.stderr);
    succeed(path, &format!("{line} --mode basis --out whole/face.json"));
    assert_same(&path.join("cut"), &path.join("whole"));
}

/// The take comes through a pipe that stays open, so that the output is unfinished for sure.
#[test]
fn an_interrupted_stream_leaves_nothing() {
    for signal in ["-INT", "-TERM"] {
        let folder = tempfile::tempdir().expect("a folder");
        let warp = tiny_face().join("06-rbf-warp/warp.json");
        let line = format!("rbf-warp handles --warp {} --markers - --out made/handles.jsonl", warp.display());
        let mut child = start(folder.path(), &line);
        let take = std::fs::read(tiny_face().join("05-stabilize/head.jsonl")).expect("a take");
        child.stdin.as_mut().expect("a pipe").write_all(&take).expect("it reads");
        let made = folder.path().join("made");
        wait_until(&mut child, "an output was begun", || made.exists() && has_part(&made));
        interrupt(child, signal);
        assert_eq!(names(&made), [""; 0], "{signal}");
    }
}

/// Nobody reads the poses, so that the trajectories beside them stay unfinished for sure.
#[test]
fn an_interrupted_stabilize_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let ids = ["head_1", "head_2", "head_3", "head_4", "head_5", "nose_m_1"];
    let take = long_take("00-virtual-rig/truth/markers.jsonl", "markers", "points", &ids);
    std::fs::write(folder.path().join("markers.jsonl"), take).expect("a file");
    let line = "stabilize --markers markers.jsonl --head-markers head_* --swaps report --out made/head.jsonl --pose -";
    let mut child = start(folder.path(), line);
    let made = folder.path().join("made");
    wait_until(&mut child, "an output was begun", || made.exists() && has_part(&made));
    interrupt(child, "-INT");
    assert_eq!(names(&made), [""; 0]);
}
