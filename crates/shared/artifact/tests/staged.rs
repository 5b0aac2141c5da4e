//! Outputs appear whole or not at all.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod support;

use artifact::{Sink, Staged, stage_bytes};
use std::io::Write;
use std::path::{Path, PathBuf};
use support::{Place, bytes, refusal, says};

#[test]
fn an_output_shows_only_when_it_is_published() {
    let place = Place::new();
    let path = place.path("out.json");
    let staged = stage_bytes(&path, b"whole").unwrap();
    assert!(!path.exists());
    assert_eq!(bytes(staged.temporary().unwrap()), b"whole");
    assert!(place.names()[0].starts_with(".out.json."), "hidden while unfinished: {:?}", place.names());
    staged.publish().unwrap();
    assert_eq!((place.names(), bytes(&path)), (vec!["out.json".to_string()], b"whole".to_vec()));
}

#[test]
fn an_output_that_is_dropped_leaves_nothing() {
    let place = Place::new();
    let path = place.file("out.json", "before");
    drop(stage_bytes(&path, b"after").unwrap());
    assert_eq!((place.names(), bytes(&path)), (vec!["out.json".to_string()], b"before".to_vec()));
    let mut sink = Sink::create(&path).unwrap();
    sink.write_all(b"half").unwrap();
    drop(sink);
    assert_eq!((place.names(), bytes(&path)), (vec!["out.json".to_string()], b"before".to_vec()));
}

#[test]
fn a_reserved_name_keeps_its_ending_and_leaves_nothing() {
    let place = Place::new();
    let path = place.path("footage/m1.avi");
    let staged = Staged::reserve(&path).unwrap();
    let temporary = staged.temporary().unwrap().to_path_buf();
    assert_eq!((temporary.parent(), temporary.extension()), (path.parent(), path.extension()));
    std::fs::write(&temporary, b"half").unwrap();
    drop(staged);
    assert!(!temporary.exists() && !path.exists());
    let staged = Staged::reserve(&path).unwrap();
    std::fs::write(&temporary, b"whole").unwrap();
    staged.publish().unwrap();
    assert_eq!((temporary.exists(), bytes(&path)), (false, b"whole".to_vec()));
    assert!(Staged::reserve(&place.path("m1")).err().unwrap().to_string().contains("has no ending"));
}

#[test]
fn publishing_replaces_the_whole_file_at_once() {
    let place = Place::new();
    let path = place.file("out.json", "a longer text from before");
    // Whoever has the old file open keeps all of it: the name moves, the bytes stay.
    let mut old = std::fs::File::open(&path).unwrap();
    stage_bytes(&path, b"after").unwrap().publish().unwrap();
    let mut seen = String::new();
    std::io::Read::read_to_string(&mut old, &mut seen).unwrap();
    assert_eq!((seen.as_str(), bytes(&path)), ("a longer text from before", b"after".to_vec()));
}

#[test]
fn missing_folders_are_made() {
    let place = Place::new();
    stage_bytes(&place.path("a/b/out.json"), b"x").unwrap().publish().unwrap();
    assert_eq!(bytes(&place.path("a/b/out.json")), b"x");
}

#[test]
fn a_patch_changes_the_start_and_goes_on_at_the_end() {
    let place = Place::new();
    let mut sink = Sink::create(&place.path("out")).unwrap();
    sink.write_all(b"count 0, ").unwrap();
    sink.patch(6, b"7").unwrap();
    sink.write_all(b"end").unwrap();
    sink.finish().unwrap().publish().unwrap();
    assert_eq!(bytes(&place.path("out")), b"count 7, end");
}

#[test]
fn paths_that_cannot_be_written_are_refused_by_name() {
    let place = Place::new();
    let file = place.file("file", "x");
    let message = refusal(stage_bytes(&file.join("out.json"), b"x"));
    says(&message, &["file: cannot make the folder: "]);
    says(&refusal(stage_bytes(Path::new(".."), b"x")), &["is not a file name", "name a file to write"]);
    // A folder of that name: the file cannot take its place.
    std::fs::create_dir_all(place.path("taken/inside")).unwrap();
    let message = refusal(stage_bytes(&place.path("taken"), b"x"));
    says(&message, &["taken: exists and is not a file", "give another name"]);
    assert_eq!(place.names(), ["file", "taken"], "nothing is left");
}

/// Where this process writes `path` before it is published.
fn temporary_of(path: &Path) -> PathBuf {
    let name = format!(".{}.{}.part", artifact::file_name(path), std::process::id());
    path.with_file_name(name)
}

/// A device that is always full stands where the temporary file would be.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_named_and_leaves_nothing() {
    let place = Place::new();
    let path = place.path("out.json");
    std::os::unix::fs::symlink("/dev/full", temporary_of(&path)).unwrap();
    let message = refusal(stage_bytes(&path, b"more than fits"));
    says(&message, &["out.json: cannot write: ", "the disk is full: free some space and run again"]);
    assert!(place.names().is_empty(), "{:?}", place.names());

    // With so much data that the disk is already full before the end.
    std::os::unix::fs::symlink("/dev/full", temporary_of(&path)).unwrap();
    let message = refusal(stage_bytes(&path, &vec![0; 4 << 20]));
    says(&message, &["out.json: cannot write: ", "the disk is full"]);
    assert!(place.names().is_empty());

    // The writers of each format say the same.
    let mesh = mesh::Mesh::from_triangles(vec![[0.0; 3]; 3], &[[0, 1, 2]]);
    for name in ["a.obj", "a.ply"] {
        let path = place.path(name);
        std::os::unix::fs::symlink("/dev/full", temporary_of(&path)).unwrap();
        let message = refusal(artifact::write_mesh(&path, &mesh, artifact::Unit::Mm));
        says(&message, &[name, "the disk is full"]);
    }
    let path = place.path("a.pc2");
    std::os::unix::fs::symlink("/dev/full", temporary_of(&path)).unwrap();
    let written = artifact::pc2::Writer::create(&path, 3, 0).and_then(|mut writer| {
        writer.write(&[0.0; 9])?;
        writer.finish()
    });
    says(&refusal(written), &["a.pc2", "the disk is full"]);
    assert!(place.names().is_empty());
}

/// A process of its own, which may write no more than 512 bytes to a file.
#[cfg(target_os = "linux")]
#[test]
fn a_limit_of_the_system_is_named_and_leaves_what_can_be_resumed() {
    let place = Place::new();
    let test = std::env::current_exe().unwrap();
    let script = r#"trap '' XFSZ; ulimit -f 1; exec "$0" --exact within_a_limit --ignored --nocapture"#;
    let shell = std::process::Command::new("sh")
        .args(["-c", script])
        .arg(test)
        .env("FURROW_TEST_PLACE", place.path(""))
        .output()
        .unwrap();
    assert!(shell.status.success(), "{}", String::from_utf8_lossy(&shell.stderr));
    assert_eq!(place.names(), ["r.pc2.partial", "r.pc2.partial.key"]);
    let (_, there) = artifact::pc2::Writer::resumable(&place.path("r.pc2"), 10, 0, "key", true).unwrap();
    assert!(there >= 1, "whole samples below the limit are kept");
}

/// Run by the test above.
#[test]
#[ignore = "needs a limit on the size of files"]
fn within_a_limit() {
    let Ok(folder) = std::env::var("FURROW_TEST_PLACE") else { return };
    let folder = Path::new(&folder);
    let message = refusal(stage_bytes(&folder.join("out.json"), &[0; 5000]));
    says(&message, &["out.json: cannot write: ", "a limit of the system or a quota is reached"]);
    let (mut writer, _) =
        artifact::pc2::Writer::resumable(&folder.join("r.pc2"), 10, 0, "key", true).unwrap();
    let written = (0..40).try_for_each(|_| writer.write(&[0.5; 30])).and_then(|()| writer.finish());
    says(&refusal(written), &["r.pc2: cannot write: ", "a limit of the system or a quota is reached"]);
}

/// All unfinished files of a process go, so the test has a process of its own.
#[test]
fn unfinished_files_go_when_a_run_is_interrupted() {
    let place = Place::new();
    let other = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "within_an_interrupted_run", "--ignored"])
        .env("FURROW_TEST_PLACE", place.path(""))
        .output()
        .unwrap();
    assert!(other.status.success(), "{}", String::from_utf8_lossy(&other.stdout));
    assert_eq!(place.names(), ["published"]);
}

/// Run by the test above.
#[test]
#[ignore = "removes the unfinished files of all tests beside it"]
fn within_an_interrupted_run() {
    let Ok(folder) = std::env::var("FURROW_TEST_PLACE") else { return };
    let stage = |name: &str| stage_bytes(&Path::new(&folder).join(name), b"x").unwrap();
    stage("published").publish().unwrap();
    let staged: Vec<Staged> = ["a", "b"].into_iter().map(stage).collect();
    assert!(staged.iter().all(|output| output.temporary().unwrap().exists()));
    artifact::discard_unfinished();
    // As at the end of an interrupted process, nothing is dropped.
    std::mem::forget(staged);
}
