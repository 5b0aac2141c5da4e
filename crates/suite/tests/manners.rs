//! All binaries behave alike: help, version, usage errors, missing files, closed pipes.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::disallowed_methods,
    reason = "a test fails by panicking, in folders of its own"
)]

mod support;

use assert_cmd::Command;
use std::process::Stdio;
use support::{Said, binaries, binary, said, stages};

/// What the names of files that are not there begin with.
const MISSING: &str = "missing-input";
const MESH: &str = "missing-input.obj";
const STREAM: &str = "missing-input.jsonl";
const DOCUMENT: &str = "missing-input.json";
/// Where a run would write.
const OUT: &str = "out";

/// The least that each binary needs to get as far as reading an input. All inputs are missing, so that the order in
/// which a stage reads them does not matter. A stage with subcommands has one line for each.
const CALLS: &[(&str, &[&str])] = &[
    ("artifact-diff", &["missing-input.obj", "missing-input-2.obj", "--unit", "mm"]),
    ("linear-shell", &["--mesh", MESH, "--unit", "mm", "--handles", STREAM, "--out", "out.json"]),
    (
        "mesh-clip",
        &[
            "--mesh",
            MESH,
            "--unit",
            "mm",
            "--out",
            "out.obj",
            "--map",
            "map.json",
            "--keep-largest-component",
        ],
    ),
    ("preview", &["--mesh", MESH, "--unit", "mm", "--out", OUT]),
    ("preview", &["tile", "missing-input.png", "--out", OUT]),
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
    (
        "rbf-warp",
        &["correspond", "--mesh", MESH, "--unit", "mm", "--picks", "missing-input.csv", "--out", OUT],
    ),
    ("rbf-warp", &["handles", "--warp", DOCUMENT, "--markers", STREAM, "--out", OUT]),
    ("rbf-warp", &["apply", "--warp", DOCUMENT, "--points", MESH, "--unit", "mm", "--out", "out.obj"]),
    ("stabilize", &["--markers", STREAM, "--out", "head.jsonl", "--pose", "pose.jsonl"]),
    ("virtual-rig", &["make", "--scenario", DOCUMENT, "--out", OUT]),
    ("virtual-rig", &["scenario", "--scenario", DOCUMENT, "--out", "out.json"]),
    ("virtual-rig", &["score", "tracks-2d", STREAM, "--truth", MISSING]),
    ("capture-sync", &["run", DOCUMENT, "--out", OUT]),
    ("capture-sync", &["check", STREAM]),
    (
        "marker-track",
        &["track", "--frames", DOCUMENT, "--sync", STREAM, "--labels", DOCUMENT, "--out", "out.jsonl"],
    ),
    (
        "marker-track",
        &[
            "detect", "--frames", DOCUMENT, "--sync", STREAM, "--camera", "m1", "--color", "2040c0", "--out",
            "out.png", "--csv", "out.csv",
        ],
    ),
    (
        "marker-track",
        &["show", "--frames", DOCUMENT, "--sync", STREAM, "--tracks", STREAM, "--camera", "m1", "--out", OUT],
    ),
    ("triangulate", &["--cameras", DOCUMENT, "--tracks", STREAM, "--out", "out.jsonl"]),
    ("calibrate", &["board", "--corners", STREAM, "--out", "out.json"]),
    ("calibrate", &["refine", "--cameras", DOCUMENT, "--corners", STREAM, "--out", "out.json"]),
    (
        "calibrate",
        &["convert", DOCUMENT, "--from", "opencv", "--to", "furrow", "--unit", "mm", "--out", "out.json"],
    ),
    ("calibrate", &["wand", STREAM, "--scale", "800", "--out", "out.json"]),
    ("calibrate", &["doctor", DOCUMENT, "--tracks", STREAM]),
    ("marker-track", &["label", "missing-input.csv", "--out", "out.json"]),
    ("marker-plan", &["--mesh", MESH, "--unit", "mm", "--out", "out.csv"]),
    (
        "wrinkle-track",
        &["train", "--frames", DOCUMENT, "--sync", STREAM, "--masks", MISSING, "--out", "out.json"],
    ),
    (
        "wrinkle-track",
        &[
            "track",
            "--frames",
            DOCUMENT,
            "--sync",
            STREAM,
            "--masks",
            MISSING,
            "--model",
            DOCUMENT,
            "--out",
            "out.jsonl",
        ],
    ),
    ("wrinkle-track", &["apply", "--frames", DOCUMENT, "--sync", STREAM, "--model", DOCUMENT, "--out", OUT]),
    ("wrinkle-track", &["show", "--frames", DOCUMENT, "--sync", STREAM, "--curves", STREAM, "--out", OUT]),
    (
        "cross-section",
        &[
            "measure",
            "--frames",
            "missing-input.json",
            "--sync",
            STREAM,
            "--wrinkles",
            STREAM,
            "--out",
            "out.jsonl",
        ],
    ),
    ("wrinkle-edit", &["apply", "--sections", STREAM, "--scale-depth", "2", "--out", "out.jsonl"]),
    (
        "wrinkle-edit",
        &[
            "show", "--frames", DOCUMENT, "--sync", STREAM, "--after", STREAM, "--camera", "w1", "--frame",
            "1001", "--out", "out.png",
        ],
    ),
    (
        "wrinkle-lift",
        &[
            "run",
            "--mesh",
            MESH,
            "--unit",
            "mm",
            "--large-scale",
            DOCUMENT,
            "--warp",
            DOCUMENT,
            "--head-pose",
            STREAM,
            "--cameras",
            DOCUMENT,
            "--sync",
            STREAM,
            "--sections",
            STREAM,
            "--out",
            "out.jsonl",
        ],
    ),
    (
        "wrinkle-lift",
        &[
            "show",
            "--mesh",
            MESH,
            "--unit",
            "mm",
            "--large-scale",
            DOCUMENT,
            "--warp",
            DOCUMENT,
            "--head-pose",
            STREAM,
            "--cameras",
            DOCUMENT,
            "--frames",
            DOCUMENT,
            "--sync",
            STREAM,
            "--valleys",
            STREAM,
            "--camera",
            "w1",
            "--frame",
            "1001",
            "--out",
            "out.png",
        ],
    ),
    ("wrinkle-removal", &["--mesh", MESH, "--unit", "mm", "--detect", "--out", "out.obj"]),
    (
        "scan-refine",
        &["--mesh", MESH, "--unit", "mm", "--object-map", "missing-input.png", "--out", "out.obj"],
    ),
    ("shell-synth", &["--mesh", MESH, "--large-scale", DOCUMENT, "--valleys", STREAM, "--out", "out.json"]),
    ("bake", &["--low", MESH, "--high", "missing-input.obj", "--unit", "mm", "--out", "maps"]),
    (
        "normalmap-acquire",
        &[
            "acquire",
            "--neutral",
            "missing-input.png",
            "--neutral-landmarks",
            DOCUMENT,
            "--expression",
            "missing-input-2.png",
            "--expression-landmarks",
            DOCUMENT,
            "--out",
            "out.png",
        ],
    ),
    (
        "normalmap-acquire",
        &[
            "fit-modulation",
            "--neutral",
            "missing-input.png",
            "--neutral-landmarks",
            DOCUMENT,
            "--frames",
            "missing-input-{frame}.png",
            "--frame-landmarks",
            "missing-input-{frame}.json",
            "--out",
            "out.json",
        ],
    ),
    ("wrinkle-blend", &["check", "--model", "missing-input.glb", "--poses", DOCUMENT]),
    ("wrinkle-blend", &["poses", "--model", "missing-input.glb", "--pose", "a=1", "--out", "out.json"]),
    ("wrinkle-blend", &["fit-poses", "--model", "missing-input.glb", "--out", "out.json"]),
    (
        "wrinkle-blend",
        &["weights", "--model", "missing-input.glb", "--poses", DOCUMENT, "--out", "out.jsonl"],
    ),
    ("wrinkle-blend", &["maps", "--model", "missing-input.glb", "--weights", STREAM, "--out", OUT]),
    (
        "wrinkle-blend",
        &["show", "--model", "missing-input.glb", "--poses", DOCUMENT, "--frame", "1", "--out", "out.ply"],
    ),
    ("wrinkle-blend", &["play", "--no-open", "--model", "missing-input.glb", "--poses", DOCUMENT]),
    ("workbench", &["missing-input", "--no-open"]),
    // `house new-stage` adds here
];

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
        for arguments in calls(name) {
            let said = said(Command::new(binary(name)).args(arguments).args(["--threads", "0"]));
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
