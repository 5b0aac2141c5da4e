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
/// Enough frames that the run is still at work when the signal comes; it is sent after a twentieth of them.
const FRAMES: usize = 3000;
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

#[test]
fn an_interrupted_sequence_resumes_to_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    std::fs::copy(tiny_face().join("00-take/scan.obj"), path.join("scan.obj")).expect("a copy");
    let ids = ["lip_upper_1", "lip_corner_l", "lip_corner_r", "forehead_m_1", "jaw_r_1", "nose_m_1"];
    let handles = long_take("02-rbf-warp/handles.jsonl", "handles", "displacements_mm", &ids);
    std::fs::write(path.join("handles.jsonl"), handles).expect("a file");
    let line = "linear-shell --mesh scan.obj --handles handles.jsonl --mode direct --threads 1 --out";
    succeed(path, &format!("{line} whole/face.json"));

    let mut child = start(path, &format!("{line} cut/face.json"));
    let cut = path.join("cut");
    let whole_bytes = std::fs::read(path.join("whole/face.pc2")).expect("a cache");
    let written = || std::fs::metadata(cut.join("face.pc2.partial")).map_or(0, |file| file.len());
    wait_until(&mut child, "the first frames are there", || written() > whole_bytes.len() as u64 / 20);
    interrupt(child, "-INT");
    assert_eq!(names(&cut), ["face.pc2.partial", "face.pc2.partial.key"]);
    assert!(written() < whole_bytes.len() as u64);

    let said = succeed(path, &format!("{line} cut/face.json --resume"));
    assert!(said.stderr.contains("frames are there already"), "{}", said.stderr);
    assert_eq!(names(&cut), names(&path.join("whole")));
    for name in ["face.pc2", "face.json"] {
        let made = |folder: &str| std::fs::read(path.join(folder).join(name)).expect("an output");
        assert!(made("cut") == made("whole"), "{name} differs after an interruption");
    }
}

/// The take comes through a pipe that stays open, so that the output is unfinished for sure.
#[test]
fn an_interrupted_stream_leaves_nothing() {
    for signal in ["-INT", "-TERM"] {
        let folder = tempfile::tempdir().expect("a folder");
        let warp = tiny_face().join("02-rbf-warp/warp.json");
        let line = format!("rbf-warp handles --warp {} --markers - --out made/handles.jsonl", warp.display());
        let mut child = start(folder.path(), &line);
        let take = std::fs::read(tiny_face().join("01-stabilize/head.jsonl")).expect("a take");
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
    let take = long_take("00-take/markers.jsonl", "markers", "points", &ids);
    std::fs::write(folder.path().join("markers.jsonl"), take).expect("a file");
    let line = "stabilize --markers markers.jsonl --head-markers head_* --swaps report --out made/head.jsonl --pose -";
    let mut child = start(folder.path(), line);
    let made = folder.path().join("made");
    wait_until(&mut child, "an output was begun", || made.exists() && has_part(&made));
    interrupt(child, "-INT");
    assert_eq!(names(&made), [""; 0]);
}
