//! The binary as its users meet it.
#![allow(clippy::disallowed_methods, clippy::unwrap_used, reason = "tests write and read files of their own")]

use assert_cmd::Command;

const HEADER: &str = r#"{"schema":"board-corners/1","data":{"board":{"chessboard":{"columns":3,"rows":2,"square_mm":10}},"cameras":{"m1":[64,48]},"take":null}}"#;

fn refused(lines: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("corners.jsonl"), lines).unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_calibrate"))
        .current_dir(folder.path())
        .args(["board", "--corners", "corners.jsonl", "--out", "cameras.json"])
        .assert();
    let said = String::from_utf8(run.failure().code(1).get_output().stderr.clone()).unwrap();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "only the input is there");
    said
}

#[test]
fn a_corner_that_the_board_lacks_is_named_with_its_place() {
    let said = refused(&format!("{HEADER}\n{}\n", r#"{"frame":0,"corners":{"m1":[[6,1.0,2.0]]}}"#));
    assert!(said.contains("corners.jsonl") && said.contains("frame 0, camera m1, corner 6"), "{said}");
}

#[test]
fn an_unknown_camera_is_named() {
    let said = refused(&format!("{HEADER}\n{}\n", r#"{"frame":0,"corners":{"m7":[[0,1.0,2.0]]}}"#));
    assert!(said.contains("m7") && said.contains("line 2"), "{said}");
}

#[test]
fn a_camera_with_too_few_views_is_named() {
    let view = |frame| {
        format!(r#"{{"frame":{frame},"corners":{{"m1":[[0,1,1],[1,5,1],[2,9,1],[3,1,5],[4,5,5],[5,9,5]]}}}}"#)
    };
    let said = refused(&format!("{HEADER}\n{}\n{}\n", view(0), view(1)));
    assert!(said.contains("camera m1: 2 of its pictures"), "{said}");
}
