//! All binaries behave alike: help, version, usage errors, missing files, closed pipes.
//!
//! The binaries belong to other packages, so the suite asks cargo to build them once and to say where they are.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::disallowed_methods,
    reason = "a test fails by panicking, in folders of its own"
)]

use assert_cmd::Command;
use serde_json::Value;
use std::path::PathBuf;
use std::process::Stdio;
use std::sync::OnceLock;

/// What the names of files that are not there begin with.
const MISSING: &str = "missing-input";
const MESH: &str = "missing-input.obj";
const STREAM: &str = "missing-input.jsonl";
const DOCUMENT: &str = "missing-input.json";
/// Where a run would write.
const OUT: &str = "out";

/// The least that each binary needs to get as far as reading an input. All inputs are missing, so that the order in
/// which a stage reads them does not matter. A stage with subcommands may have one line each.
const CALLS: &[(&str, &[&str])] = &[
    ("artifact-diff", &["missing-input.obj", "missing-input-2.obj", "--unit", "mm"]),
    ("linear-shell", &["--mesh", MESH, "--unit", "mm", "--handles", STREAM, "--out", OUT]),
    ("mesh-clip", &["--mesh", MESH, "--unit", "mm", "--out", "out.obj", "--map", "map.json"]),
    ("preview", &["--mesh", MESH, "--unit", "mm", "--out", OUT]),
    (
        "rbf-warp",
        &[
            "fit",
            "--markers",
            STREAM,
            "--correspondence",
            DOCUMENT,
            "--mesh",
            MESH,
            "--unit",
            "mm",
            "--out",
            OUT,
        ],
    ),
    ("stabilize", &["--markers", STREAM, "--out", "head.jsonl", "--pose", "pose.jsonl"]),
    // `house new-stage` adds here
];

/// Every stage of the workspace, from its metadata.
fn stages() -> Vec<String> {
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
fn binaries() -> &'static [(String, PathBuf)] {
    static BINARIES: OnceLock<Vec<(String, PathBuf)>> = OnceLock::new();
    BINARIES.get_or_init(|| {
        let stages = stages();
        let built = cargo(&["test", "--workspace", "--no-run", "--quiet", "--message-format=json"]);
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

/// Runs a check on every binary and reports all that fail it, not only the first.
fn each(check: impl Fn(&str, &mut Command) -> Result<(), String>) {
    let folder = tempfile::tempdir().expect("a folder");
    let faults: Vec<String> = binaries()
        .iter()
        .filter_map(|(name, path)| {
            let mut command = Command::new(path);
            command.current_dir(folder.path());
            check(name, &mut command).err().map(|fault| format!("{name}: {fault}"))
        })
        .collect();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

struct Said {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

fn said(command: &mut Command) -> Said {
    let output = command.output().expect("the binary starts");
    Said {
        code: output.status.code(),
        stdout: String::from_utf8_lossy(&output.stdout).to_string(),
        stderr: String::from_utf8_lossy(&output.stderr).to_string(),
    }
}

fn require(holds: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(what()) }
}

/// The exit code is `code`, nothing is on standard output, and standard error says something but no panic.
fn refused(said: &Said, code: i32) -> Result<(), String> {
    require(said.code == Some(code), || format!("exit code {:?}, not {code}: {}", said.code, said.stderr))?;
    require(said.stdout.is_empty(), || format!("standard output says {:?}", said.stdout))?;
    require(!said.stderr.trim().is_empty(), || "standard error is silent".to_string())?;
    require(!said.stderr.contains("panicked"), || format!("it panics: {}", said.stderr))
}

fn calls(name: &str) -> Vec<&'static [&'static str]> {
    CALLS.iter().filter(|(other, _)| *other == name).map(|(_, arguments)| *arguments).collect()
}

/// The words before the first option: the subcommand, if there is one.
fn subcommand(arguments: &[&'static str]) -> Vec<&'static str> {
    arguments
        .first()
        .filter(|word| !word.starts_with('-') && !word.starts_with(MISSING))
        .copied()
        .into_iter()
        .collect()
}

#[test]
fn every_stage_tells_how_it_is_called() {
    for name in stages() {
        assert!(!calls(&name).is_empty(), "{name} has no line in CALLS");
    }
    let known = stages();
    for (name, _) in CALLS {
        assert!(known.iter().any(|stage| stage == name), "CALLS names {name}, which is no stage");
    }
}

#[test]
fn help_is_on_standard_output_and_tells_the_common_options() {
    each(|name, command| {
        let said = said(command.arg("--help"));
        require(said.code == Some(0), || format!("--help exits with {:?}: {}", said.code, said.stderr))?;
        require(said.stderr.is_empty(), || format!("--help writes to standard error: {}", said.stderr))?;
        for option in ["--quiet", "--verbose", "--threads", "--json", "--help", "--version"] {
            require(said.stdout.contains(option), || format!("--help does not tell {option}"))?;
        }
        require(said.stdout.contains(name), || "--help does not name the binary".to_string())
    });
}

#[test]
fn subcommands_have_help_too() {
    for (name, path) in binaries() {
        for subcommand in calls(name).into_iter().map(subcommand).filter(|words| !words.is_empty()) {
            let said = said(Command::new(path).args(&subcommand).arg("--help"));
            assert!(
                said.code == Some(0) && said.stdout.contains("--threads"),
                "{name} {subcommand:?} --help"
            );
        }
    }
}

#[test]
fn version_is_on_standard_output() {
    each(|name, command| {
        let said = said(command.arg("--version"));
        require(said.code == Some(0), || format!("--version exits with {:?}", said.code))?;
        let expected = format!("{name} {}", env!("CARGO_PKG_VERSION"));
        require(said.stdout.trim() == expected, || {
            format!("--version says {:?}, not {expected:?}", said.stdout)
        })
    });
}

#[test]
fn an_unknown_option_is_a_usage_error() {
    each(|_, command| {
        let said = said(command.arg("--no-such-option"));
        refused(&said, 2)?;
        require(said.stderr.contains("--no-such-option"), || format!("does not name it: {}", said.stderr))
    });
}

#[test]
fn no_threads_is_a_usage_error() {
    each(|name, _| {
        let path = &binaries().iter().find(|(other, _)| other == name).expect("built").1;
        for arguments in calls(name) {
            let said = said(Command::new(path).args(arguments).args(["--threads", "0"]));
            refused(&said, 2)?;
            require(said.stderr.contains("--threads"), || {
                format!("does not name --threads: {}", said.stderr)
            })?;
        }
        Ok(())
    });
}

#[test]
fn a_missing_input_is_named_and_nothing_is_left() {
    for (name, path) in binaries() {
        for arguments in calls(name) {
            let folder = tempfile::tempdir().expect("a folder");
            let said = said(Command::new(path).current_dir(folder.path()).args(arguments));
            refused(&said, 1).unwrap_or_else(|fault| panic!("{name} {arguments:?}: {fault}"));
            assert!(said.stderr.contains(MISSING), "{name} does not name the file: {}", said.stderr);
            let left = std::fs::read_dir(folder.path()).expect("the folder").count();
            assert_eq!(left, 0, "{name} {arguments:?} leaves something behind");
        }
    }
}

#[test]
fn quiet_errors_are_still_said() {
    for (name, path) in binaries() {
        for arguments in calls(name) {
            let folder = tempfile::tempdir().expect("a folder");
            let said = said(Command::new(path).current_dir(folder.path()).args(arguments).arg("--quiet"));
            refused(&said, 1).unwrap_or_else(|fault| panic!("{name} {arguments:?} --quiet: {fault}"));
        }
    }
}

#[test]
#[cfg(unix)]
fn a_closed_pipe_is_no_failure() {
    for (name, path) in binaries() {
        for arguments in [&["--help"][..], &["--version"]] {
            let (reader, writer) = std::io::pipe().expect("a pipe");
            drop(reader);
            let child = std::process::Command::new(path)
                .args(arguments)
                .stdout(writer)
                .stderr(Stdio::piped())
                .spawn()
                .and_then(std::process::Child::wait_with_output)
                .expect("the binary starts");
            let stderr = String::from_utf8_lossy(&child.stderr);
            assert!(!stderr.contains("panicked"), "{name} {arguments:?}: {stderr}");
            assert!(child.status.success(), "{name} {arguments:?}: {}: {stderr}", child.status);
        }
    }
}
