//! The player: what the program serves, and what a real browser makes of it.
#![allow(clippy::unwrap_used, clippy::panic, clippy::disallowed_methods, reason = "tests may")]

mod scene;

use artifact::gltf::write;
use artifact::picture::{read_rgb, write_rgb8};
use artifact::{BlendWeights, FrameReader};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use tempfile::TempDir;

const SIZE: usize = 64;
const MODEL: [&str; 8] = ["--model", "head.glb", "--pose", "up=1", "--pose", "in=2", "--pose", "open=3"];
const MAPS: [&str; 8] =
    ["--map", "up=up.png", "--map", "in=in.png", "--map", "open=open.png", "--neutral", "plain.png"];

/// A folder with the character and maps whose normals differ from texel to texel.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("head.glb"), &scene::character()).unwrap().publish().unwrap();
    for (seed, name) in ["plain", "up", "in", "open"].iter().enumerate() {
        picture(&folder.path().join(format!("{name}.png")), SIZE, 7 * seed + 1);
    }
    folder
}

fn picture(path: &Path, size: usize, seed: usize) {
    let slope = |i: usize, period: usize| (40.0 * (i as f64 / period as f64).sin()) as i32;
    let texel = |at: usize| {
        let (x, y) = (at % size, at / size);
        let [p, q] = [slope(x + 3 * seed, 2 + seed % 5), slope(y + x, 3 + seed % 4)];
        [(128 + p) as u8, (128 + q) as u8, (250 - (p * p + q * q) / 140) as u8]
    };
    let rgb: Vec<u8> = (0..size * size).flat_map(texel).collect();
    write_rgb8(path, size, size, &rgb).unwrap().publish().unwrap();
}

fn program(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wrinkle-blend"));
    command.current_dir(folder).args(words);
    command
}

fn done(folder: &Path, words: &[&str]) {
    let output = program(folder, words).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// A running player and its address.
struct Playing {
    child: Child,
    url: String,
}

impl Drop for Playing {
    fn drop(&mut self) {
        // The test's own child, if it still runs.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn play(folder: &Path, more: &[&str]) -> Playing {
    let words = [&["play", "--no-open"], &MODEL[..], &MAPS, more].concat();
    let mut child = program(folder, &words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut url = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut url).unwrap();
    assert!(url.starts_with("http://127.0.0.1:"), "{url}");
    Playing { child, url: url.trim().to_string() }
}

impl Playing {
    fn host(&self) -> (&str, &str) {
        self.url.strip_prefix("http://").unwrap().split_once('/').unwrap()
    }

    /// Status and body.
    fn get(&self, path: &str) -> (u16, Vec<u8>) {
        let (host, _) = self.host();
        let mut stream = TcpStream::connect(host).unwrap();
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|window| window == b"\r\n\r\n").unwrap();
        let status = String::from_utf8_lossy(&answer[9..12]).parse().unwrap();
        (status, answer[end + 4..].to_vec())
    }

    fn below(&self, path: &str) -> String {
        format!("/{}{path}", self.host().1)
    }
}

#[test]
fn what_is_served_is_whole_and_only_for_who_knows_the_address() {
    let folder = folder();
    let playing = play(folder.path(), &["--expression", "doubt=up:0.5+in:0.2"]);
    for (path, start) in
        [("", "<!doctype html>"), ("player.js", ""), ("equations.glsl", "// Wrinkles that follow")]
    {
        let (status, body) = playing.get(&playing.below(path));
        assert!(status == 200 && body.starts_with(start.as_bytes()) && !body.is_empty(), "{path}");
    }
    let (_, body) = playing.get(&playing.below("scene.json"));
    let about: Value = serde_json::from_slice(&body).unwrap();
    assert_eq!(about["map_size"], serde_json::json!([SIZE, SIZE]));
    let scene = &about["scene"];
    assert_eq!(scene["poses"].as_array().unwrap().len(), 3);
    assert_eq!(scene["expressions"][6]["weights"], serde_json::json!([0.5, 0.2, 0.0]));
    assert_eq!(scene["expressions"][0]["lacks"], serde_json::json!(["a smile"]));
    let (_, block) = playing.get(&playing.below("scene.bin"));
    let span = &scene["parts"][0]["triangles"];
    assert_eq!(span["length"], 96);
    assert!(span["offset"].as_u64().unwrap() + 4 * 96 <= block.len() as u64);
    // The map is the file's, texel by texel.
    let (_, map) = playing.get(&playing.below("maps/2.png"));
    std::fs::write(folder.path().join("served.png"), map).unwrap();
    let same = |name: &str| read_rgb(&folder.path().join(name)).unwrap();
    assert_eq!(same("served.png"), same("in.png"));
    assert_eq!(playing.get(&playing.below("maps/9.png")).0, 404);
    assert_eq!(playing.get("/").0, 403);
    assert_eq!(playing.get("/scene.json").0, 403);
}

#[cfg(unix)]
#[test]
fn ctrl_c_is_how_it_ends() {
    let folder = folder();
    let mut playing = play(folder.path(), &[]);
    Command::new("kill").args(["-INT", &playing.child.id().to_string()]).status().unwrap();
    assert_eq!(playing.child.wait().unwrap().code(), Some(0));
}

#[track_caller]
fn refused(folder: &Path, words: &[&str], parts: &[&str]) {
    let output = program(folder, words).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(output.stdout.is_empty() && said.contains("to do:"), "{said}");
    for part in parts {
        assert!(said.contains(part), "{said}\nwanted: {part}");
    }
}

#[test]
fn what_cannot_be_played_is_named() {
    let folder = folder();
    let at = folder.path();
    let words = |more: &[&'static str]| [&["play", "--no-open"], &MODEL[..], &MAPS, more].concat();
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let busy: Vec<&str> = [&words(&[])[..], &["--port", &port]].concat();
    refused(at, &busy, &[&port, "is taken"]);
    picture(&at.join("small.png"), 8, 1);
    refused(at, &words(&["--map", "open=small.png"]), &["small.png: is 8 × 8, but the neutral map 64 × 64"]);
    refused(
        at,
        &words(&["--expression", "joy=smile:1"]),
        &["--expression joy", "no pose 'smile'", "up, in, open"],
    );
    let lacking = ["play", "--no-open", "--model", "head.glb", "--pose", "up=1"];
    refused(at, &lacking, &["pose up: has no map"]);
    let mut plain = scene::character();
    plain.meshes[0].uvs.clear();
    write(&at.join("plain.glb"), &plain).unwrap().publish().unwrap();
    let bare = ["play", "--no-open", "--model", "plain.glb", "--pose", "up=1", "--map", "up=up.png"];
    refused(at, &bare, &["plain.glb", "mesh face: has no texture coordinates"]);
    std::fs::write(at.join("bad.glb"), br#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0}]}"#).unwrap();
    let bare = ["play", "--no-open", "--model", "bad.glb", "--pose", "up=1", "--map", "up=up.png"];
    refused(at, &bare, &["bad.glb", "has no skinned mesh"]);
}

/// Every eighth of the way between two poses of the animation, and the frames of the clip that say the same.
const STEPS: usize = 8;

/// The share of the texels under triangles that are within a code of the reference, and the worst of all.
fn agreement(folder: &Path, number: usize) -> (f64, u8) {
    let reference = read_rgb(&folder.join(format!("maps/{number:06}.png"))).unwrap().to_8_bits();
    let shown = std::fs::read(folder.join(format!("{number}.rgba"))).unwrap();
    let (mut under, mut near, mut worst) = (0, 0, 0);
    for (shown, wanted) in shown.chunks(4).zip(reference.chunks(3)).filter(|(shown, _)| shown[3] == 255) {
        let apart = shown.iter().zip(wanted).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
        under += 1;
        near += usize::from(apart <= 1);
        worst = worst.max(apart);
    }
    assert_eq!(under, SIZE * SIZE, "the character covers its map");
    (near as f64 / under as f64, worst)
}

/// `how` poses are compared, and what only the page wears.
fn in_browser(how: &[&str], worn: &[&str]) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser/player.mjs");
    let Some(mut node) = testkit::node(&script, true) else { return };
    let folder = folder();
    let at = folder.path();
    let playing = play(at, &[how, worn].concat());
    let states: Vec<Value> = (0..=3 * STEPS)
        .map(|step| serde_json::json!({ "poses": [0, 0, 0], "clip": "poses", "frame": 30.0 * step as f64 / STEPS as f64 }))
        .collect();
    let output =
        node.arg(&playing.url).arg(at).arg(serde_json::to_string(&states).unwrap()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    check_page(&found);
    let rate = STEPS.to_string();
    done(at, &[&["weights", "--rate", &rate, "--out", "w.jsonl"], &MODEL[..], how].concat());
    done(
        at,
        &[&["maps", "--model", "head.glb", "--weights", "w.jsonl", "--out", "maps"], &MAPS[..]].concat(),
    );
    assert_eq!(agreement(at, 0), (1.0, 0), "neutral is exact");
    for number in 1..states.len() {
        let (share, worst) = agreement(at, number);
        assert!(share >= 0.999 && worst <= 2, "state {number}: {share}, {worst}");
    }
    check_shares(at);
}

fn check_page(found: &Value) {
    assert_eq!(found["failed"], Value::Null, "{found}");
    assert_eq!(found["errors"], serde_json::json!([]), "{found}");
    assert_eq!(found["uploads_while_moving"], 0, "{found}");
    assert!(found["uploads_at_start"].as_u64().unwrap() > 0, "uploads are counted");
    for law in [
        "slider_moves",
        "wrinkles_show",
        "influence_shows",
        "looks_come_back",
        "keys_turn",
        "neutral_comes_back",
        "two_live",
    ] {
        assert_eq!(found[law], true, "{law}: {found}");
    }
    assert_eq!(found["overflows"], false, "all controls are seen at 1280 × 720: {found}");
}

/// The page's shares of bones are the program's.
fn check_shares(at: &Path) {
    let reader = FrameReader::<BlendWeights>::open(&at.join("w.jsonl")).unwrap();
    let header = reader.header().clone();
    for frame in reader.map(Result::unwrap) {
        let text = std::fs::read_to_string(at.join(format!("{}.json", frame.frame))).unwrap();
        let page: Value = serde_json::from_str(&text).unwrap();
        for (pose, id) in header.poses.iter().enumerate() {
            for (bone, share) in &frame.bones[id] {
                let number = header.bones.iter().position(|name| name == bone).unwrap();
                let shown = page["shares"][pose][number].as_f64().unwrap();
                assert!(
                    (shown - share).abs() < 1e-5,
                    "frame {}, {id}, {bone}: {shown}, not {share}",
                    frame.frame
                );
            }
        }
    }
}

#[test]
fn the_browser_draws_the_reference() {
    in_browser(&[], &[]);
}

#[test]
fn the_browser_shares_out_and_masks_as_the_reference_does() {
    in_browser(&["--dual", "--mask", "paper"], &["--color", "up.png"]);
}
