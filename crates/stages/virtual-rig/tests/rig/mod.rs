//! Runs of the binary, for the tests of its command line.
#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

use assert_cmd::Command;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Output;
use tempfile::TempDir;

/// The smallest take: seconds even without optimisation.
pub(crate) const SMALL: &str =
    "--length tiny --vertices 2000 --image-scale 0.25 --no-calibration --no-normals";

/// Runs a command line in a folder; words are divided by spaces.
pub(crate) fn call(folder: &TempDir, line: &str) -> Output {
    let mut command = Command::cargo_bin("virtual-rig").unwrap();
    command.current_dir(folder.path()).args(line.split_whitespace()).output().unwrap()
}

/// Runs a command line that must succeed.
pub(crate) fn succeed(folder: &TempDir, line: &str) -> Output {
    let output = call(folder, line);
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

/// Makes a small take in `out`.
pub(crate) fn make(folder: &TempDir, out: &str, more: &str) -> BTreeMap<PathBuf, Vec<u8>> {
    succeed(folder, &format!("make {SMALL} --out {out} {more}"));
    files(&folder.path().join(out))
}

/// All files of a folder, by their paths in it.
pub(crate) fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut waiting = vec![folder.to_path_buf()];
    while let Some(next) = waiting.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => waiting.push(path),
                false => {
                    let bytes = std::fs::read(&path).unwrap();
                    found.insert(path.strip_prefix(folder).unwrap().to_path_buf(), bytes);
                }
            }
        }
    }
    found
}

pub(crate) fn plant(folder: &TempDir, name: &str, text: &str) {
    std::fs::write(folder.path().join(name), text).unwrap();
}

/// Expects the exit code and a message with all `words`, and nothing in `out`.
pub(crate) fn refused(folder: &TempDir, code: i32, more: &str, words: &[&str]) {
    let output = call(folder, &format!("make {SMALL} --out out {more}"));
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{more}: {message}");
    for word in words {
        assert!(message.contains(word), "{more}: '{word}' is not said in: {message}");
    }
    assert!(!message.contains("panicked") && !folder.path().join("out").exists(), "{more}: {message}");
}
