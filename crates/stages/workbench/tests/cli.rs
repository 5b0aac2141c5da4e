//! The binary as its users meet it.
#![allow(clippy::disallowed_methods, reason = "tests write and read files of their own")]

use assert_cmd::Command;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn binary(folder: &std::path::Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_workbench"));
    command.current_dir(folder);
    command
}

#[test]
fn moves_a_mesh_and_says_how_it_was_made() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("in.obj"), TRIANGLE).unwrap();
    binary(folder.path())
        .args(["--mesh", "in.obj", "--unit", "mm", "--offset-mm", "2", "--out", "out.obj"])
        .assert()
        .success()
        .stdout("");
    let moved = std::fs::read_to_string(folder.path().join("out.obj")).unwrap();
    assert!(moved.contains("v 0 0 2"), "{moved}");
    assert!(folder.path().join("out.obj.prov.json").exists());
}

#[test]
fn a_broken_mesh_is_named_with_its_line_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("in.obj"), "v 0 0 0\nv 1 x 0\n").unwrap();
    let run = binary(folder.path()).args(["--mesh", "in.obj", "--unit", "mm", "--out", "out.obj"]).assert();
    let said = String::from_utf8(run.failure().code(1).get_output().stderr.clone()).unwrap();
    assert!(said.contains("in.obj") && said.contains("line 2"), "{said}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "only the input is there");
}

#[test]
fn a_mesh_without_a_unit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("in.obj"), TRIANGLE).unwrap();
    binary(folder.path()).args(["--mesh", "in.obj", "--out", "out.obj"]).assert().failure().code(1);
}
