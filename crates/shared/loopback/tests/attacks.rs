//! What a hostile page, program or network tries; and what a page of ours may do.
#![allow(clippy::unwrap_used, clippy::panic, clippy::disallowed_methods, reason = "tests may")]

use loopback::{Asset, Limits, Method, Request, Response, Root, Server, Stopper, asset};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::thread::JoinHandle;
use std::time::Duration;
use tempfile::TempDir;

const ASSETS: [Asset; 1] =
    [Asset { path: "", content_type: "text/html; charset=utf-8", bytes: b"<!doctype html>the page" }];

/// A server over a folder: `secret` lies beside the folder, `out` in it leads there.
struct Fixture {
    place: TempDir,
    port: u16,
    token: String,
    stopper: Stopper,
    thread: Option<JoinHandle<()>>,
}

impl Drop for Fixture {
    fn drop(&mut self) {
        self.stopper.stop();
        self.thread.take().unwrap().join().unwrap();
    }
}

fn answer(root: &Root, request: &Request) -> Response {
    let refused = |error: loopback::PathError| Response::refused(403, &error.to_string());
    if let Some(found) = asset(&ASSETS, &request.path) {
        return found;
    }
    match (request.method, request.path.strip_prefix("files/")) {
        (Method::Get, Some(path)) => root.existing(path).map_or_else(refused, |path| {
            Response::bytes("application/octet-stream", std::fs::read(path).unwrap())
        }),
        (Method::Put, Some(path)) => root.target(path).map_or_else(refused, |path| {
            std::fs::write(path, &request.body).unwrap();
            Response::done()
        }),
        (Method::Post, None) => {
            request.json::<Vec<i32>>().map_or_else(|no| no, |list| Response::json(&list.len()))
        }
        _ => Response::missing(),
    }
}

fn served() -> Fixture {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("take");
    std::fs::create_dir_all(folder.join("in")).unwrap();
    std::fs::write(place.path().join("secret"), "secret").unwrap();
    std::fs::write(folder.join("in/a b.txt"), "inside").unwrap();
    #[cfg(unix)]
    for (to, name) in [("../secret", "out"), ("../..", "far"), ("in", "near")] {
        std::os::unix::fs::symlink(to, folder.join(name)).unwrap();
    }
    let root = Root::new(&folder).unwrap();
    let limits = Limits { body: 1000, patience: Duration::from_millis(400), connections: 8 };
    let server = Server::bind(0, limits).unwrap();
    let (url, stopper) = (server.url(), server.stopper());
    let (port, token) = url.strip_prefix("http://127.0.0.1:").unwrap().split_once('/').unwrap();
    let (port, token) = (port.parse().unwrap(), token.trim_end_matches('/').to_string());
    let thread =
        std::thread::spawn(move || server.run(move |request: &Request| answer(&root, request)).unwrap());
    Fixture { place, port, token, stopper, thread: Some(thread) }
}

impl Fixture {
    /// The whole answer to a request as it stands.
    fn raw(&self, request: &str) -> String {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = Vec::new();
        // The server may close while we still write.
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    fn ask(&self, verb: &str, path: &str, headers: &str, body: &str) -> String {
        let head = format!(
            "{verb} {path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nConnection: close\r\n{headers}",
            self.port
        );
        let length =
            if body.is_empty() { String::new() } else { format!("Content-Length: {}\r\n", body.len()) };
        self.raw(&format!("{head}{length}\r\n{body}"))
    }

    fn own(&self) -> String {
        format!("Origin: http://127.0.0.1:{}\r\nSec-Fetch-Site: same-origin\r\n", self.port)
    }

    fn below(&self, path: &str) -> String {
        format!("/{}/{path}", self.token)
    }
}

#[track_caller]
fn is(answer: &str, status: u16) {
    assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "wanted {status}: {answer}");
}

#[test]
fn our_page_reads_and_writes() {
    let at = served();
    let page = at.ask("GET", &at.below(""), "", "");
    is(&page, 200);
    assert!(page.ends_with("the page"));
    for header in [
        "content-security-policy: default-src 'none'; script-src 'self'",
        "nosniff",
        "no-referrer",
        "no-store",
        "frame-ancestors 'none'",
    ] {
        assert!(page.contains(header), "{header}: {page}");
    }
    assert!(!page.contains("unsafe-inline") && !page.to_lowercase().contains("access-control"), "{page}");
    assert!(at.ask("GET", &at.below("files/in/a%20b.txt"), "", "").ends_with("inside"));
    is(&at.ask("PUT", &at.below("files/in/new.txt"), &at.own(), "text"), 204);
    assert_eq!(std::fs::read_to_string(at.place.path().join("take/in/new.txt")).unwrap(), "text");
    let json = format!("{}Content-Type: application/json; charset=utf-8\r\n", at.own());
    assert!(at.ask("POST", &at.below("api"), &json, "[1,2,3]").ends_with("\r\n\r\n3"));
    is(&at.ask("POST", &at.below("api"), &json, "[1,"), 400);
    is(&at.ask("POST", &at.below("api"), &at.own(), "[1]"), 415);
    is(&at.ask("GET", &at.below("nothing"), "", ""), 404);
}

#[test]
fn head_has_no_body_and_other_verbs_are_refused() {
    let at = served();
    let head = at.ask("HEAD", &at.below(""), "", "");
    is(&head, 200);
    assert!(head.ends_with("\r\n\r\n") && head.contains("content-length: 23"), "{head}");
    for verb in ["OPTIONS", "DELETE", "PATCH", "TRACE", "CONNECT", "PROPFIND"] {
        let answer = at.ask(
            verb,
            &at.below(""),
            "Origin: http://example.org\r\nAccess-Control-Request-Method: PUT\r\n",
            "",
        );
        assert!(["400", "403", "405"].contains(&&answer[9..12]), "{verb}: {answer}");
        assert!(!answer.to_lowercase().contains("access-control"), "{answer}");
    }
    let options = at.ask("OPTIONS", &at.below(""), "", "");
    is(&options, 405);
    assert!(options.contains("allow: GET, HEAD, PUT, POST"), "{options}");
}

#[test]
fn names_that_only_point_here_are_refused() {
    let at = served();
    let path = at.below("");
    for host in
        ["example.org", "127.0.0.1.example.org", "localhost@example.org", "0.0.0.0", "10.0.0.1:80", ""]
    {
        let answer = at.raw(&format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"));
        assert!(
            answer.starts_with("HTTP/1.1 403 ") || answer.starts_with("HTTP/1.1 400 "),
            "{host}: {answer}"
        );
    }
    let close = "Connection: close\r\n\r\n";
    is(&at.raw(&format!("GET {path} HTTP/1.1\r\n{close}")), 400);
    is(&at.raw(&format!("GET {path} HTTP/1.1\r\nHost: localhost\r\nHost: example.org\r\n{close}")), 400);
    is(&at.raw(&format!("GET http://example.org{path} HTTP/1.1\r\nHost: localhost\r\n{close}")), 400);
    // A tunnel's end has another port.
    is(&at.raw(&format!("GET {path} HTTP/1.1\r\nHost: localhost:9999\r\n{close}")), 200);
}

#[test]
fn without_the_token_there_is_nothing() {
    let at = served();
    let near = format!("{}0", &at.token[..at.token.len() - 1]);
    let wrong = [
        "/".to_string(),
        format!("/{near}/"),
        "/files/in/a%20b.txt".into(),
        format!("/?token={}", at.token),
        format!("/{}", at.token),
        "//".into(),
    ];
    for path in wrong.iter().filter(|path| **path != format!("/{}/", at.token)) {
        let answer = at.ask("GET", path, "", "");
        assert!(["400", "403"].contains(&&answer[9..12]), "{path}: {answer}");
        assert!(!answer.contains("the page") && !answer.contains("inside"));
    }
}

#[test]
fn no_path_leads_out_of_the_root() {
    let at = served();
    let ways = [
        "../secret",
        "in/../../secret",
        "%2e%2e/secret",
        "%2E%2e/secret",
        "in/%2e%2e/%2e%2e/secret",
        "..%2fsecret",
        "%2e%2e%2fsecret",
        "..%5csecret",
        "%252e%252e/secret",
        "out",
        "far/secret",
        "./in",
        "in//a",
        "/etc/passwd",
        "%2fetc/passwd",
        "C:/x",
        "in/a%00",
        "in\\..\\..\\secret",
        "~/x",
    ];
    for way in ways {
        for verb in ["GET", "PUT"] {
            let body = if verb == "PUT" { "overwritten" } else { "" };
            let answer = at.ask(verb, &at.below(&format!("files/{way}")), &at.own(), body);
            assert!(["400", "403"].contains(&&answer[9..12]), "{verb} {way}: {answer}");
            assert!(!answer.ends_with("secret") && !answer.contains("root:"), "{way}: {answer}");
        }
    }
    assert_eq!(std::fs::read_to_string(at.place.path().join("secret")).unwrap(), "secret");
    // A link that stays inside is well.
    assert!(at.ask("GET", &at.below("files/near/a%20b.txt"), "", "").ends_with("inside"));
}

#[test]
fn pages_of_other_sites_change_and_read_nothing() {
    let at = served();
    let foreign = [
        "Origin: http://example.org\r\n",
        "Origin: null\r\n",
        "Origin: https://127.0.0.1\r\n",
        "Origin: http://127.0.0.1:1\r\n",
        "",
        "Origin: http://example.org\r\nOrigin: http://127.0.0.1\r\n",
    ];
    for headers in foreign {
        is(&at.ask("POST", &at.below("api"), headers, "[1]"), 403);
        is(&at.ask("PUT", &at.below("files/in/new.txt"), headers, "text"), 403);
    }
    let cross = "Sec-Fetch-Site: cross-site\r\n";
    is(
        &at.ask(
            "PUT",
            &at.below("files/in/new.txt"),
            &format!("Origin: http://127.0.0.1:{}\r\n{cross}", at.port),
            "text",
        ),
        403,
    );
    for part in [
        "Sec-Fetch-Mode: no-cors\r\nSec-Fetch-Dest: script\r\n",
        "Sec-Fetch-Mode: navigate\r\nSec-Fetch-Dest: iframe\r\n",
        "",
    ] {
        is(&at.ask("GET", &at.below(""), &format!("{cross}{part}"), ""), 403);
    }
    // A link that somebody follows, e.g. from a chat in the browser.
    is(
        &at.ask(
            "GET",
            &at.below(""),
            &format!("{cross}Sec-Fetch-Mode: navigate\r\nSec-Fetch-Dest: document\r\n"),
            "",
        ),
        200,
    );
    assert!(!at.place.path().join("take/in/new.txt").exists());
}

#[test]
fn long_bodies_are_not_even_read() {
    let at = served();
    let head = format!(
        "PUT {} HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\n",
        at.below("files/in/new.txt")
    );
    let start = std::time::Instant::now();
    let answer = at.raw(&format!("{head}Content-Length: 1000000000\r\n\r\nx"));
    is(&answer, 413);
    assert!(answer.contains("connection: close"), "{answer}");
    let answer = at.raw(&format!("{head}Expect: 100-continue\r\nContent-Length: 1000000000\r\n\r\n"));
    is(&answer, 413);
    // One that does not say how long it is.
    let part = format!("{:x}\r\n{}\r\n", 600, "x".repeat(600));
    is(&at.raw(&format!("{head}Transfer-Encoding: chunked\r\n\r\n{part}{part}{part}")), 413);
    assert!(start.elapsed() < Duration::from_secs(8));
    // Two lengths that disagree, and a head without an end.
    is(&at.raw(&format!("{head}Content-Length: 3\r\nContent-Length: 4\r\n\r\nabcd")), 400);
    let answer = at.raw(&format!("{head}X: {}\r\n\r\n", "x".repeat(200_000)));
    assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 4"), "{answer}");
    assert!(!at.place.path().join("take/in/new.txt").exists());
}

#[test]
fn slow_clients_hold_nobody_up() {
    let at = served();
    let slow = |text: &str| {
        let mut stream = TcpStream::connect(("127.0.0.1", at.port)).unwrap();
        stream.write_all(text.as_bytes()).unwrap();
        stream
    };
    let head = format!(
        "PUT {} HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\nContent-Length: 9\r\n\r\nab",
        at.below("files/in/new.txt")
    );
    // As many as the server has seats: the next one gets its turn as soon as their time is over.
    let mut held: Vec<TcpStream> = (0..8).map(|i| slow(if i % 2 == 0 { "GET /" } else { &head })).collect();
    is(&at.ask("GET", &at.below(""), "", ""), 200);
    for stream in &mut held {
        stream.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
        let mut rest = Vec::new();
        let _ = stream.read_to_end(&mut rest);
        let rest = String::from_utf8_lossy(&rest).into_owned();
        assert!(rest.is_empty() || rest.starts_with("HTTP/1.1 408"), "{rest}");
    }
    assert!(!at.place.path().join("take/in/new.txt").exists());
}

#[test]
fn a_site_that_fails_fails_alone() {
    let server = Server::bind(0, Limits::default()).unwrap();
    let (url, stopper) = (server.url(), server.stopper());
    let thread = std::thread::spawn(move || {
        server
            .run(
                |request: &Request| if request.path == "x" { panic!("on purpose") } else { Response::done() },
            )
            .unwrap();
    });
    let (host, path) = url.strip_prefix("http://").unwrap().split_once('/').unwrap();
    for (name, status) in [("x", 500), ("y", 204)] {
        let mut stream = TcpStream::connect(host).unwrap();
        write!(stream, "GET /{path}{name} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        is(&answer, status);
    }
    stopper.stop();
    thread.join().unwrap();
}

#[test]
fn a_taken_port_is_named() {
    let one = Server::bind(0, Limits::default()).unwrap();
    let port = one.url().split([':', '/']).nth(4).unwrap().parse().unwrap();
    let error = Server::bind(port, Limits::default()).err().unwrap().to_string();
    assert!(error.contains(&port.to_string()) && error.contains("to do:"), "{error}");
}
