//! The binaries of the workspace, the fixtures, and recorded data, for all tests of the suite.
//!
//! The binaries belong to other packages, so the suite asks cargo to build them once and to say where they are.
#![allow(dead_code, clippy::print_stdout, reason = "each test uses its part; absent data is told of")]

pub(crate) mod likeness;

use assert_cmd::Command;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Every stage of the workspace, from its metadata.
pub(crate) fn stages() -> Vec<String> {
    let printed = cargo(&["metadata", "--format-version", "1", "--no-deps"]);
    let metadata: Value = serde_json::from_str(&printed).expect("cargo metadata prints JSON");
    let packages = metadata["packages"].as_array().expect("packages");
    let mut names: Vec<String> = packages
        .iter()
        .filter(|package| package["metadata"]["furrow"]["floor"] == 4)
        .map(|package| package["name"].as_str().expect("a name").to_string())
        .collect();
    names.sort();
    assert!(!names.is_empty(), "the workspace has stages");
    names
}

fn cargo(arguments: &[&str]) -> String {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_string());
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let output =
        std::process::Command::new(cargo).args(arguments).current_dir(root).output().expect("cargo starts");
    assert!(output.status.success(), "cargo {arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("cargo prints text")
}

/// The stages' binaries by name. Cargo says where they are, and builds them if they are not; it is asked as
/// `cargo test --workspace` asks, so that after that nothing is left to build.
pub(crate) fn binaries() -> &'static [(String, PathBuf)] {
    static BINARIES: OnceLock<Vec<(String, PathBuf)>> = OnceLock::new();
    BINARIES.get_or_init(|| {
        let stages = stages();
        let mut asked = vec!["test", "--workspace", "--no-run", "--quiet", "--message-format=json"];
        if cfg!(feature = "video") {
            asked.extend([
                "--features",
                "virtual-rig/video,capture-sync/video,calibrate/detect,calibrate/video,normalmap-acquire/video,suite/video",
            ]);
        }
        let built = cargo(&asked);
        let messages = built.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
        let mut found: Vec<(String, PathBuf)> = messages
            .filter_map(|message| binary_of(&message))
            .filter(|(name, _)| stages.contains(name))
            .collect();
        found.sort();
        let names: Vec<&String> = found.iter().map(|(name, _)| name).collect();
        assert_eq!(names, stages.iter().collect::<Vec<_>>(), "every stage has a binary of its name");
        found
    })
}

/// The binary that one of cargo's messages tells of; none if it is a test or a library.
fn binary_of(message: &Value) -> Option<(String, PathBuf)> {
    let is_binary = message["target"]["kind"][0] == "bin" && message["profile"]["test"] == false;
    let path = message["executable"].as_str().filter(|_| is_binary)?;
    Some((message["target"]["name"].as_str()?.to_string(), path.into()))
}

/// What a program said.
pub(crate) struct Said {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

pub(crate) fn said(command: &mut Command) -> Said {
    let output = command.output().expect("the binary starts");
    Said {
        code: output.status.code(),
        stdout: String::from_utf8_lossy(&output.stdout).to_string(),
        stderr: String::from_utf8_lossy(&output.stderr).to_string(),
    }
}

/// The binary of a stage.
pub(crate) fn binary(name: &str) -> &'static Path {
    let found = binaries().iter().find(|(other, _)| other == name);
    found.map_or_else(|| panic!("{name} is no stage"), |(_, path)| path.as_path())
}

/// Runs a command line in a folder; its first word names the stage.
pub(crate) fn call(folder: &Path, line: &str) -> Said {
    let mut words = line.split_whitespace();
    let name = words.next().expect("a stage");
    said(Command::new(binary(name)).current_dir(folder).args(words))
}

/// As [`call`], and fails the test if the program fails.
pub(crate) fn succeed(folder: &Path, line: &str) -> Said {
    let said = call(folder, line);
    assert_eq!(said.code, Some(0), "{line}\n{}", said.stderr);
    said
}

/// The summary of a run that succeeds.
pub(crate) fn summary(folder: &Path, line: &str) -> Value {
    let said = succeed(folder, &format!("{line} --json"));
    serde_json::from_str(&said.stdout).unwrap_or_else(|error| panic!("{line}: {error}"))
}

/// The tiny take and what every stage makes of it.
pub(crate) fn tiny_face() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/tiny-face")
}

/// Names in a folder, in order.
pub(crate) fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("the folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().to_string()).collect();
    names.sort();
    names
}
