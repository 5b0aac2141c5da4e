//! The program as its users meet it: from a character to blended maps, and bad input.
#![allow(clippy::unwrap_used, clippy::panic, clippy::disallowed_methods, reason = "tests may")]

mod scene;

use artifact::gltf::{Character, write};
use artifact::picture::{read_rgb, write_rgb8};
use artifact::{
    BlendWeights, BonePlacement, FrameReader, Poses, ReferencePose, read_document, write_document,
};
use assert_cmd::Command;
use std::path::Path;
use tempfile::TempDir;

const POSES: [&str; 6] = ["--pose", "up=1", "--pose", "in=2", "--pose", "open=3"];
const SIZE: usize = 16;

/// A folder with the character and a map per pose: all texels of one normal.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    save(folder.path(), &scene::character());
    for (name, rgb) in [
        ("up", [128, 200, 230]),
        ("in", [180, 128, 240]),
        ("open", [100, 100, 220]),
        ("plain", [140, 128, 250]),
    ] {
        picture(&folder.path().join(format!("{name}.png")), SIZE, rgb);
    }
    folder
}

fn save(folder: &Path, character: &Character) {
    write(&folder.join("head.glb"), character).unwrap().publish().unwrap();
}

fn picture(path: &Path, size: usize, rgb: [u8; 3]) {
    write_rgb8(path, size, size, &rgb.repeat(size * size)).unwrap().publish().unwrap();
}

fn command(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wrinkle-blend"));
    command.current_dir(folder).args(words);
    command
}

fn done(folder: &Path, words: &[&str]) -> String {
    let assert = command(folder, words).assert().success();
    String::from_utf8([assert.get_output().stdout.clone(), assert.get_output().stderr.clone()].concat())
        .unwrap()
}

#[track_caller]
fn refused(folder: &Path, words: &[&str], parts: &[&str]) {
    let before = std::fs::read_dir(folder).unwrap().count();
    let assert = command(folder, words).assert().failure().code(1);
    let said = String::from_utf8(assert.get_output().stderr.clone()).unwrap();
    for part in parts {
        assert!(said.contains(part), "{said}\nwanted: {part}");
    }
    assert!(said.contains("to do:"), "{said}");
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), before, "nothing is left");
}

fn with<'a>(words: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    [words, more].concat()
}

#[test]
fn from_a_character_to_blended_maps() {
    let folder = folder();
    let at = folder.path();
    let maps = ["--map", "up=up.png", "--map", "in=in.png", "--map", "open=open.png"];
    let model = ["--model", "head.glb"];
    done(at, &[&["poses"], &model[..], &POSES, &maps, &["--out", "poses.json"]].concat());
    let poses: Poses = read_document(&at.join("poses.json")).unwrap();
    assert_eq!(poses.poses[2].bones.keys().collect::<Vec<_>>(), ["jaw"]);
    let given = ["--poses", "poses.json", "--rate", "1", "--first-frame", "1000"];
    let said = done(at, &[&["weights"], &model[..], &given, &["--out", "weights.jsonl"]].concat());
    assert!(said.contains("frames: 4"), "{said}");
    let reader = FrameReader::<BlendWeights>::open(&at.join("weights.jsonl")).unwrap();
    assert_eq!(reader.header().bones, ["left", "right", "jaw"]);
    let frames: Vec<_> = reader.map(Result::unwrap).collect();
    assert_eq!(frames.iter().map(|frame| frame.frame).collect::<Vec<_>>(), [1000, 1001, 1002, 1003]);
    assert!((frames[1].bones["up"]["left"] - 1.0).abs() < 1e-6);
    assert!(frames[0].vertices.as_ref().unwrap().is_empty(), "nothing shows at rest");
    let words =
        ["--weights", "weights.jsonl", "--poses", "poses.json", "--neutral", "plain.png", "--out", "maps"];
    done(at, &[&["maps"], &model[..], &words].concat());
    let [still, up] =
        [1000, 1001].map(|frame| read_rgb(&at.join(format!("maps/{frame:06}.png"))).unwrap().to_8_bits());
    assert!(still.chunks(3).all(|texel| texel == &still[..3]), "the neutral map, normalised");
    // The left bone moves the left half; the right half stays.
    let texel = |map: &[u8], x: usize| <[u8; 3]>::try_from(&map[3 * x..3 * x + 3]).unwrap();
    assert!(texel(&up, 0)[1] > 180 && texel(&up, SIZE - 1) == texel(&still, SIZE - 1), "{:?}", texel(&up, 0));
    done(at, &[&["show"], &model[..], &given, &["--frame", "1001", "--out", "show.ply"]].concat());
    done(at, &["shader", "--language", "wgsl", "--out", "wrinkles.wgsl"]);
}

#[test]
fn check_prints_the_crosstalk_and_warns() {
    let folder = folder();
    let said = done(folder.path(), &[&["check", "--model", "head.glb"], &POSES[..]].concat());
    assert!(said.contains("up: left 8.0 mm"), "{said}");
    assert!(said.contains("pose in shows") && said.contains("use --dual"), "{said}");
    let said = done(folder.path(), &[&["check", "--model", "head.glb", "--dual"], &POSES[..]].concat());
    assert!(!said.contains("warning"), "{said}");
}

#[test]
fn a_performance_becomes_poses() {
    let folder = folder();
    let said =
        done(folder.path(), &["fit-poses", "--model", "head.glb", "--rate", "4", "--out", "poses.json"]);
    assert!(said.contains("poses: 3"), "{said}");
    let poses: Poses = read_document(&folder.path().join("poses.json")).unwrap();
    assert_eq!(poses.poses.len(), 3);
}

#[test]
fn pipes_join_weights_and_maps() {
    let folder = folder();
    let words = [&["weights", "--model", "head.glb", "--rate", "1", "--out", "-"], &POSES[..]].concat();
    let weights = command(folder.path(), &words).assert().success().get_output().stdout.clone();
    let maps = ["--map", "up=up.png", "--map", "in=in.png", "--map", "open=open.png", "--out", "maps"];
    let words = [&["maps", "--model", "head.glb", "--weights", "-", "--frames", "2"], &maps[..]].concat();
    command(folder.path(), &words).write_stdin(weights).assert().success();
    assert!(folder.path().join("maps/000002.png").exists());
}

#[test]
fn bad_poses_are_named() {
    let folder = folder();
    let at = folder.path();
    let weights = ["weights", "--model", "head.glb", "--out", "w.jsonl"];
    refused(at, &with(&weights, &["--pose", "still=0"]), &["head.glb", "pose still: is the neutral pose"]);
    refused(at, &with(&weights, &["--pose", "a=1", "--pose", "a=2"]), &["--pose a: there are two poses"]);
    refused(
        at,
        &with(&weights, &["--pose", "a=1", "--head-bone", "skull"]),
        &["'skull' is none", "--head-bone"],
    );
    refused(
        at,
        &with(&weights, &["--pose", "a=1", "--animation", "run"]),
        &["has no animation 'run'", "poses"],
    );
    refused(at, &with(&weights, &["--pose", "a=1", "--mesh", "body"]), &["no mesh 'body'", "face"]);
    let bones =
        [("jaws".to_string(), BonePlacement { translation: Some([0.0; 3]), ..Default::default() })].into();
    let poses = Poses {
        model: None,
        poses: vec![ReferencePose { id: "shout".into(), bones, map: None }],
        modulation: None,
    };
    write_document(&at.join("poses.json"), &poses).unwrap().publish().unwrap();
    refused(at, &with(&weights, &["--poses", "poses.json"]), &["poses.json", "pose shout", "'jaws'", "jaw"]);
}

#[test]
fn bad_characters_are_named() {
    let folder = folder();
    let at = folder.path();
    let weights = ["weights", "--model", "bad.glb", "--pose", "a=1", "--out", "w.jsonl"];
    std::fs::write(at.join("bad.glb"), b"glTF\x02\0\0\0").unwrap();
    refused(at, &weights, &["bad.glb", "was cut"]);
    std::fs::write(at.join("bad.glb"), br#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0}]}"#).unwrap();
    refused(at, &weights, &["bad.glb", "has no skinned mesh"]);
}

#[test]
fn bad_maps_are_named() {
    let folder = folder();
    let at = folder.path();
    done(at, &[&["weights", "--model", "head.glb", "--rate", "1", "--out", "w.jsonl"], &POSES[..]].concat());
    let maps = [
        "maps",
        "--model",
        "head.glb",
        "--weights",
        "w.jsonl",
        "--out",
        "maps",
        "--map",
        "up=up.png",
        "--map",
        "in=in.png",
    ];
    refused(at, &maps, &["pose open: has no map"]);
    refused(at, &with(&maps, &["--map", "closed=up.png"]), &["no pose 'closed'"]);
    picture(&at.join("small.png"), 8, [128, 128, 255]);
    refused(
        at,
        &with(&maps, &["--map", "open=small.png"]),
        &["small.png: is 8 × 8, but the neutral map 16 × 16"],
    );
    picture(&at.join("black.png"), SIZE, [0, 0, 0]);
    let said = done(at, &with(&maps, &["--map", "open=black.png"]));
    assert!(said.contains("black.png: 100 % of its texels are no unit normals"), "{said}");
    // Weights above 1 are no weights.
    let text = std::fs::read_to_string(at.join("w.jsonl")).unwrap().replacen("\"up\":[1.0", "\"up\":[1.5", 1);
    std::fs::write(at.join("w.jsonl"), text).unwrap();
    let assert = command(at, &with(&maps, &["--map", "open=open.png"])).assert().failure().code(1);
    let said = String::from_utf8(assert.get_output().stderr.clone()).unwrap();
    assert!(said.contains("w.jsonl") && said.contains("vertex 0: the weight 1.5"), "{said}");
}

#[test]
fn the_help_says_what_there_is() {
    for name in ["", "check", "poses", "fit-poses", "weights", "maps", "show", "play", "shader"] {
        let words: Vec<&str> = [name, "--help"].into_iter().filter(|word| !word.is_empty()).collect();
        let output = command(Path::new("."), &words)
            .env("COLUMNS", "100")
            .assert()
            .success()
            .get_output()
            .stdout
            .clone();
        insta::assert_snapshot!(
            format!("help{}{name}", if name.is_empty() { "" } else { "_" }),
            String::from_utf8(output).unwrap()
        );
    }
}
