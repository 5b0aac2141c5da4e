//! From footage to a wrinkled face, as a user runs it: `tools/take` on the take of the golden chain.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::disallowed_methods,
    reason = "a test fails by panicking"
)]

mod support;

use assert_cmd::Command;
use std::path::Path;
use std::time::SystemTime;
use support::likeness::files;
use support::{Said, binary, said, tiny_face};

fn run(folder: &Path, words: &[&str]) -> Said {
    let programs = binary("shell-synth").parent().expect("their folder");
    let tool = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tools/take");
    let words = ["take", "out", "--head-markers", "head_*", "--no-pictures"].iter().chain(words);
    said(Command::new(tool).current_dir(folder).env("FURROW_BIN", programs).args(words))
}

/// The golden take, with its calibrated cameras beside it as if they came from elsewhere.
fn take(folder: &Path) {
    let rig = tiny_face().join("00-virtual-rig");
    for file in files(&rig.join("take")) {
        let target = folder.join("take").join(&file);
        std::fs::create_dir_all(target.parent().expect("its folder")).expect("a folder");
        std::fs::copy(rig.join("take").join(&file), target).expect("a copy");
    }
    std::fs::copy(rig.join("truth/cameras-calibrated.json"), folder.join("take/cameras.json"))
        .expect("a copy");
}

fn age(folder: &Path, name: &str) -> SystemTime {
    let file = std::fs::metadata(folder.join("out").join(name));
    file.and_then(|file| file.modified()).unwrap_or_else(|_| panic!("{name} is not there"))
}

#[test]
fn what_is_missing_is_asked_for_and_the_rest_is_done_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    take(folder.path());
    std::fs::rename(at("take/picks.csv"), at("picks.csv")).expect("a file");
    let first = run(folder.path(), &[]);
    assert_eq!(first.code, Some(0), "{}", first.stderr);
    assert!(
        first.stderr.contains("picks.csv: where each marker sits") && first.stderr.contains("Still missing")
    );
    let measured = ["capture/sync/sync.jsonl", "capture/tracks.jsonl", "capture/markers.jsonl"];
    let before = measured.map(|name| age(folder.path(), name));
    assert!(at("out/wrinkles/sections.jsonl").exists() && !at("out/large-scale").exists());

    std::fs::rename(at("picks.csv"), at("take/picks.csv")).expect("a file");
    let second = run(folder.path(), &[]);
    assert_eq!(second.code, Some(0), "{}", second.stderr);
    assert!(!second.stderr.contains("Still missing"), "{}", second.stderr);
    assert_eq!(measured.map(|name| age(folder.path(), name)), before, "what was there stays");
    assert!(second.stdout.contains("wrinkles on the face"), "{}", second.stdout);

    // Half a file is not taken for a whole one.
    let (folded, valleys) = ("medium-scale/wrinkled.pc2", "medium-scale/valleys.jsonl");
    let (whole, lifted) =
        (std::fs::read(at("out").join(folded)).expect("a file"), age(folder.path(), valleys));
    std::fs::write(at("out").join(folded), &whole[..whole.len() / 2]).expect("a file");
    let third = run(folder.path(), &[]);
    assert_eq!(third.code, Some(0), "{}", third.stderr);
    assert_eq!(std::fs::read(at("out").join(folded)).expect("a file"), whole);
    assert_eq!(age(folder.path(), valleys), lifted);
}
