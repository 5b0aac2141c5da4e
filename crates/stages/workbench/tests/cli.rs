//! The binary as its pages meet it: HTTP by hand, in folders of its own.
#![allow(
    clippy::disallowed_methods,
    clippy::unwrap_used,
    reason = "a test fails by panicking, in folders of its own"
)]

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use tempfile::TempDir;

const TAKE: &str = r#"{"schema":"take/2","data":{"subject":"s","session":"s","take":"t","rate":{"frames":50,"seconds":1},"start_timecode":null,
"first_frame":1,"clock":"trigger","cameras":[],"mesh_unit":"mm","mesh_up":"y","references":{},"consent":{"licence":"own","credit":"","notes":""}}}"#;

/// A program that serves, stopped when dropped.
struct Bench {
    folder: TempDir,
    child: Child,
    port: u16,
    /// The random part of the address, `/token/`.
    root: String,
}

impl Drop for Bench {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_workbench"))
}

fn bench(folder: TempDir) -> Bench {
    let mut child = program()
        .arg(folder.path())
        .args(["--no-open", "--quiet"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut url = String::new();
    BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut url).unwrap();
    let (port, root) = url.trim().strip_prefix("http://127.0.0.1:").unwrap().split_once('/').unwrap();
    Bench { folder, child, port: port.parse().unwrap(), root: format!("/{root}") }
}

impl Bench {
    /// Status and body of an answer.
    fn ask(&self, method: &str, path: &str, kind: &str, body: &[u8]) -> (u16, Vec<u8>) {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        let Self { port, root, .. } = self;
        write!(stream, "{method} {root}{path} HTTP/1.1\r\nhost: 127.0.0.1:{port}\r\norigin: http://127.0.0.1:{port}\r\ncontent-type: {kind}\r\ncontent-length: {}\r\nconnection: close\r\n\r\n", body.len()).unwrap();
        stream.write_all(body).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|window| window == b"\r\n\r\n").unwrap();
        let status = std::str::from_utf8(&answer[9..12]).unwrap().parse().unwrap();
        (status, answer.split_off(end + 4))
    }

    fn get(&self, path: &str) -> Value {
        let (status, body) = self.ask("GET", path, "text/plain", b"");
        assert_eq!(status, 200, "{path}: {}", String::from_utf8_lossy(&body));
        serde_json::from_slice(&body).unwrap()
    }

    fn draft(&self, id: &str, base: &Value, text: &str) -> u16 {
        let base = base.as_str().unwrap_or("");
        self.ask("PUT", &format!("draft/{id}?page=a&base={base}"), "text/plain", text.as_bytes()).0
    }

    fn save(&self, id: &str, base: &Value) -> (u16, Value) {
        let base = base.as_str().unwrap_or("");
        let (status, body) =
            self.ask("POST", &format!("save/{id}?page=a&base={base}"), "application/json", b"null");
        (status, serde_json::from_slice(&body).unwrap_or_else(|_| json!(String::from_utf8_lossy(&body))))
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.folder.path().join(name)
    }
}

fn take() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("take.json"), TAKE).unwrap();
    folder
}

fn labels(x: f64) -> String {
    format!(
        "{{\"schema\":\"labels/1\",\"data\":{{\"take\":null,\"frame\":1,\"cameras\":{{\"m1\":{{\"nose\":[{x},20.25]}}}}}}}}\n"
    )
}

fn names_in(folder: &Path) -> Vec<String> {
    let names =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.collect()
}

#[test]
fn a_save_checks_writes_and_keeps_what_it_replaces() {
    let bench = bench(take());
    let fresh = bench.get("document/labels");
    assert_eq!(fresh, json!({ "version": null, "saved": null, "draft": null, "stale_draft": null }));
    assert_eq!(bench.draft("labels", &Value::Null, &labels(10.5)), 204);
    assert!(!bench.path("labels.json").exists(), "a draft is no save");
    assert_eq!(bench.get("document/labels")["draft"], labels(10.5));
    let (status, saved) = bench.save("labels", &Value::Null);
    assert_eq!((status, &saved["is_changed"]), (200, &json!(true)), "{saved}");
    assert_eq!(std::fs::read_to_string(bench.path("labels.json")).unwrap(), labels(10.5));
    bench.draft("labels", &saved["version"], &labels(11.0));
    let (_, again) = bench.save("labels", &saved["version"]);
    assert_eq!(std::fs::read_to_string(bench.path(".workbench/previous/labels.json")).unwrap(), labels(10.5));
    assert_eq!(bench.get("document/labels")["version"], again["version"]);
    assert_eq!(bench.get("document/labels")["draft"], Value::Null);
}

#[test]
fn a_file_that_says_the_same_keeps_its_bytes() {
    let folder = take();
    // As somebody else would write it.
    let spaced = labels(10.5).replace(":{", ": {").replace(",\"", ", \"");
    std::fs::write(folder.path().join("labels.json"), &spaced).unwrap();
    let bench = bench(folder);
    let version = bench.get("document/labels")["version"].clone();
    bench.draft("labels", &version, &labels(10.5));
    let (status, saved) = bench.save("labels", &version);
    assert_eq!((status, &saved["is_changed"], &saved["version"]), (200, &json!(false), &version));
    assert_eq!(std::fs::read_to_string(bench.path("labels.json")).unwrap(), spaced);
}

#[test]
fn what_stages_would_refuse_is_not_saved() {
    let bench = bench(take());
    bench.draft("labels", &Value::Null, &labels(10.5).replace("20.25", "\"low\""));
    let (status, said) = bench.save("labels", &Value::Null);
    assert!(status == 422 && said.as_str().unwrap().contains("line 1"), "{status} {said}");
    bench.draft("picks", &Value::Null, "marker,x,y,z\nnose,1,2\n");
    let (status, said) = bench.save("picks", &Value::Null);
    assert!(status == 422 && said.as_str().unwrap().contains("picks.csv"), "{status} {said}");
    bench.draft("paint/w1", &Value::Null, "no picture");
    assert_eq!(bench.save("paint/w1", &Value::Null).0, 422);
    let mut names = names_in(bench.folder.path());
    names.sort();
    assert_eq!(names, [".workbench", "take.json"], "the drafts are kept, nothing else is written");
}

#[test]
fn drafts_outlive_the_program() {
    let first = bench(take());
    first.draft("edits", &Value::Null, "wrinkle-edits/1\nscale depth 2\n");
    let folder = tempfile::tempdir().unwrap();
    std::fs::rename(first.folder.path(), folder.path().join("take")).unwrap();
    drop(first);
    let take = tempfile::tempdir().unwrap();
    std::fs::remove_dir(take.path()).unwrap();
    std::fs::rename(folder.path().join("take"), take.path()).unwrap();
    let second = bench(take);
    assert_eq!(second.get("document/edits")["draft"], "wrinkle-edits/1\nscale depth 2\n");
}

#[test]
fn a_file_that_was_changed_meanwhile_is_not_written_over() {
    let bench = bench(take());
    bench.draft("labels", &Value::Null, &labels(10.5));
    std::fs::write(bench.path("labels.json"), labels(99.0)).unwrap();
    let (status, _) = bench.save("labels", &Value::Null);
    assert_eq!(status, 409);
    assert_eq!(std::fs::read_to_string(bench.path("labels.json")).unwrap(), labels(99.0));
    let shown = bench.get("document/labels");
    assert_eq!((&shown["draft"], &shown["stale_draft"]), (&Value::Null, &json!(labels(10.5))));
}

#[test]
fn the_second_window_only_looks_until_it_takes_over() {
    let bench = bench(take());
    let here = |page: &str, takes_over: bool| {
        let call = json!({ "page": page, "takes_over": takes_over }).to_string();
        bench.ask("POST", "here", "application/json", call.as_bytes()).1
    };
    assert_eq!(here("b", false), b"true");
    assert_eq!(here("a", false), b"false");
    assert_eq!(bench.draft("labels", &Value::Null, &labels(1.0)), 423);
    assert_eq!(here("a", true), b"true");
    assert_eq!(bench.draft("labels", &Value::Null, &labels(1.0)), 204);
}

#[test]
fn nothing_outside_the_take_is_read_or_written() {
    let outer = tempfile::tempdir().unwrap();
    std::fs::write(outer.path().join("labels.json"), labels(1.0)).unwrap();
    let folder = take();
    std::os::unix::fs::symlink(outer.path(), folder.path().join("paint-mask")).unwrap();
    let bench = bench(folder);
    for path in [
        "document/paint/..%2f..%2fx",
        "document/paint/%2e%2e",
        "picture/paint/../labels",
        "document/passwd",
        "image/m1/1",
        "nothing",
    ] {
        let (status, _) = bench.ask("GET", path, "text/plain", b"");
        assert!(matches!(status, 400 | 404 | 422), "{path}: {status}");
    }
    assert_eq!(bench.ask("PUT", "draft/other?page=a", "text/plain", b"x").0, 404);
    assert_eq!(names_in(outer.path()), ["labels.json"]);
}

#[test]
fn pages_say_what_they_wait_for() {
    let bench = bench(take());
    let overview = bench.get("overview");
    let labels = &overview["pages"][0];
    assert_eq!((&labels["id"], &labels["needs"][0]["is_there"]), (&json!("labels"), &json!(false)));
    let (status, said) = bench.ask("GET", "cameras", "text/plain", b"");
    assert!(status == 422 && String::from_utf8_lossy(&said).contains("just take TAKE"), "{status}");
}

#[test]
fn a_folder_that_is_not_there_is_named() {
    let run = program().args(["nowhere", "--no-open"]).output().unwrap();
    let said = String::from_utf8(run.stderr).unwrap();
    assert!(run.status.code() == Some(1) && said.contains("nowhere"), "{said}");
}
