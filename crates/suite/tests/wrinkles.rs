//! From footage and masks to cross-sections, as a user runs it: `tools/wrinkles` on the take of the golden chain.
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

fn wrinkles(folder: &Path, words: &[&str]) -> Said {
    let programs = binary("wrinkle-track").parent().expect("their folder");
    let tool = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tools/wrinkles");
    said(Command::new(tool).current_dir(folder).env("FURROW_BIN", programs).args(words))
}

fn take(folder: &Path) {
    let rig = tiny_face().join("00-virtual-rig/take");
    for file in files(&rig) {
        let target = folder.join("take").join(&file);
        std::fs::create_dir_all(target.parent().expect("its folder")).expect("a folder");
        std::fs::copy(rig.join(&file), target).expect("a copy");
    }
}

fn age(folder: &Path, name: &str) -> SystemTime {
    std::fs::metadata(folder.join(name)).and_then(|file| file.modified()).expect("a file")
}

#[test]
fn footage_becomes_sections_a_table_and_pictures_and_a_second_run_only_what_is_new() {
    let folder = tempfile::tempdir().expect("a folder");
    take(folder.path());
    let done = wrinkles(folder.path(), &["take", "out"]);
    assert_eq!(done.code, Some(0), "{}", done.stderr);
    for name in [
        "paint.png",
        "names.csv",
        "curves.png",
        "sections.jsonl",
        "sections.jsonl.prov.json",
        "pictures/w1-1003-sections.png",
        "pictures/w2-1003-light.png",
        "report.txt",
    ] {
        assert!(folder.path().join("out").join(name).exists(), "{name} is missing: {}", done.stderr);
    }
    assert!(
        done.stdout.contains("w1 w1_green_1") && done.stdout.contains("paint green: tells"),
        "{}",
        done.stdout
    );
    let first = ["out/wrinkles.jsonl", "out/parts/1003-1003.jsonl", "out/sections.jsonl"]
        .map(|name| age(folder.path(), name));
    std::fs::write(folder.path().join("take/wrinkle-edits.txt"), "wrinkle-edits/1\nscale depth 2 of w1_*\n")
        .expect("a file");
    let again = wrinkles(folder.path(), &["take", "out"]);
    assert_eq!(again.code, Some(0), "{}", again.stderr);
    let second = ["out/wrinkles.jsonl", "out/parts/1003-1003.jsonl", "out/sections.jsonl"]
        .map(|name| age(folder.path(), name));
    assert_eq!(first[..2], second[..2], "what was measured stays");
    assert!(second[2] > first[2], "the edits are new");
    assert!(
        std::fs::read_to_string(folder.path().join("out/sections.jsonl"))
            .expect("a text")
            .contains("\"edited\"")
    );
}

#[test]
fn what_is_missing_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    take(folder.path());
    let cases: [(&[&str], &str); 5] = [
        (&["nowhere", "out"], "nowhere has no take.json"),
        (&["take", "take"], "is no run of wrinkles"),
        (&["take", "out", "--mask", "a"], "there is no option --mask"),
        (&["take", "out", "--masks", "a"], "there are no masks in a"),
        (&["take", "out", "--edits", "a.txt"], "there is no a.txt"),
    ];
    for (words, expected) in cases {
        let done = wrinkles(folder.path(), words);
        assert!(done.code == Some(1) && done.stderr.contains(expected), "{words:?}: {}", done.stderr);
    }
}
