//! `virtual-rig make`, `scenario` and `groove` as users run them: what they write. What they refuse stands in `refusals.rs`.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod rig;

use assert_cmd::Command;
use rig::{SMALL, call, files, make, plant, succeed};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

type Files = BTreeMap<PathBuf, Vec<u8>>;

fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).unwrap()
}

fn lines(bytes: &[u8]) -> Vec<&str> {
    std::str::from_utf8(bytes).unwrap().lines().collect()
}

/// What a tiny take consists of, but for side-cars.
fn expected() -> Vec<PathBuf> {
    let mut names: Vec<String> = Vec::new();
    for camera in ["m1", "m2", "m3", "m4", "m5", "m6"] {
        names.push(format!("take/footage/{camera}.csv"));
        names.extend((0..3).map(|image| format!("take/footage/{camera}/{image:06}.png")));
    }
    for camera in ["w1", "w2"] {
        names.push(format!("take/footage/{camera}.csv"));
        names.push(format!("take/footage/{camera}/000000.png"));
        names.push(format!("take/paint-mask/{camera}.png"));
        names.push(format!("truth/paint/{camera}/001003.png"));
    }
    names.extend(["labels.json", "picks.csv", "scan.obj", "take.json"].map(|name| format!("take/{name}")));
    let documents = ["scenario", "cameras", "cameras-calibrated", "large-scale", "wrinkled"];
    names.extend(documents.map(|name| format!("truth/{name}.json")));
    names.extend(["large-scale", "wrinkled"].map(|name| format!("truth/{name}.pc2")));
    let streams = ["sync", "tracks-2d", "markers", "head", "pose", "valleys", "wrinkles-2d", "sections"];
    names.extend(streams.map(|name| format!("truth/{name}.jsonl")));
    let mut paths: Vec<PathBuf> = names.into_iter().map(PathBuf::from).collect();
    paths.sort();
    paths
}

#[test]
fn a_take_is_whole_and_its_manifest_comes_last() {
    let folder = tempfile::tempdir().unwrap();
    let output = succeed(&folder, &format!("make {SMALL} --out take-1 --json"));
    let made = files(&folder.path().join("take-1"));
    let is_side_car = |path: &&PathBuf| path.to_string_lossy().ends_with(".prov.json");
    let plain: Vec<&PathBuf> = made.keys().filter(|path| !is_side_car(path)).collect();
    assert_eq!(plain, expected().iter().collect::<Vec<_>>());

    let summary = json(&output.stdout);
    assert_eq!((&summary["results"]["images"], &summary["results"]["markers"]), (&20.into(), &90.into()));
    let outputs: Vec<&str> =
        summary["outputs"].as_array().unwrap().iter().map(|path| path.as_str().unwrap()).collect();
    assert!(outputs.last().unwrap().ends_with("take/take.json"), "{outputs:?}");
    for output in outputs {
        let side_car = PathBuf::from(format!("{output}.prov.json"));
        let side_car = json(&made[side_car.strip_prefix("take-1").unwrap()]);
        assert_eq!(side_car["data"]["stage"], "virtual-rig make", "{output}");
        assert_eq!(side_car["data"]["parameters"]["scenario"]["seed"], 1, "{output}");
    }
    let manifest = json(&made[Path::new("take/take.json")]);
    let scan = artifact::sha256_of(&made[Path::new("take/scan.obj")]);
    assert_eq!(manifest["data"]["references"]["scan"]["sha256"], scan.as_str());
    let scenario = artifact::sha256_of(&made[Path::new("truth/scenario.json")]);
    assert_eq!(manifest["data"]["references"]["scenario"]["sha256"], scenario.as_str());
    let take = artifact::sha256_of(&made[Path::new("take/take.json")]);
    let header = json(lines(&made[Path::new("truth/markers.jsonl")])[0].as_bytes());
    assert_eq!(header["data"]["take"]["sha256"], take.as_str());
}

#[test]
fn the_number_of_threads_changes_no_byte_and_the_seed_changes_the_person() {
    let folder = tempfile::tempdir().unwrap();
    let one = make(&folder, "one", "--threads 1");
    let two = make(&folder, "two", "--threads 2");
    let differ: Vec<&PathBuf> = one.keys().filter(|path| two.get(*path) != one.get(*path)).collect();
    assert!(one.len() == two.len() && differ.is_empty(), "{differ:?}");

    let other = make(&folder, "other", "--seed 2");
    for name in ["take/scan.obj", "take/picks.csv", "take/footage/m1/000000.png", "truth/valleys.jsonl"] {
        assert_ne!(one[Path::new(name)], other[Path::new(name)], "{name}");
    }
}

/// Parts have the images and the lines of the whole, and the same manifest.
#[test]
fn a_part_of_the_frames_is_a_part_of_the_take() {
    let folder = tempfile::tempdir().unwrap();
    let whole = make(&folder, "whole", "");
    let part = make(&folder, "part", "--frames 1002-1003");
    for name in
        ["take/take.json", "take/scan.obj", "take/picks.csv", "truth/cameras.json", "truth/scenario.json"]
    {
        assert_eq!(part[Path::new(name)], whole[Path::new(name)], "{name}");
    }
    let pictures = |files: &Files| -> Vec<PathBuf> {
        files.keys().filter(|path| path.extension().is_some_and(|ending| ending == "png")).cloned().collect()
    };
    assert_eq!(pictures(&whole).len(), pictures(&part).len() + 6, "one image less for each mocap camera");
    pictures(&part).iter().for_each(|path| assert_eq!(part[path], whole[path], "{}", path.display()));
    let streams = |path: &&PathBuf| path.extension().is_some_and(|ending| ending == "jsonl");
    for path in whole.keys().filter(streams) {
        let (all, some) = (lines(&whole[path]), lines(&part[path]));
        let sparse = all.len() == 2;
        assert_eq!(some[0], all[0], "{}", path.display());
        assert_eq!(some[1..], all[if sparse { 1 } else { 2 }..], "{}", path.display());
    }
    let [all, some] = [&whole, &part].map(|files| &files[Path::new("truth/wrinkled.pc2")]);
    let values = (all.len() - 32) / 3;
    assert_eq!(some[32..], all[32 + values..], "wrinkled.pc2");
}

/// Labels, marked paint and images that cameras film before or after the take stand in one part each, as in the whole.
#[test]
fn all_parts_of_the_frames_are_the_whole_take() {
    let folder = tempfile::tempdir().unwrap();
    let faults = "--fault dropped=0.3 --fault offset=1@m4 --fault offset=-2@m5";
    let [whole, early, late] =
        [("whole", ""), ("early", "--frames 1001-1004"), ("late", "--frames 1005-1008")]
            .map(|(out, frames)| make(&folder, out, &format!("--count 8 {faults} {frames}")));
    let once = |path: &&PathBuf| {
        let name = path.to_string_lossy();
        name.ends_with(".png") || name.ends_with("labels.json")
    };
    for path in whole.keys().filter(once) {
        let parts = [&early, &late].map(|part| part.get(path));
        let found: Vec<_> = parts.into_iter().flatten().collect();
        assert_eq!(found, [&whole[path]], "{}", path.display());
    }
    let of_parts = early.keys().chain(late.keys()).filter(once).count();
    assert_eq!(of_parts, whole.keys().filter(once).count());
    assert!(whole.contains_key(Path::new("take/labels.json")));
    for name in ["sync", "tracks-2d", "markers", "wrinkles-2d", "sections"] {
        let path = PathBuf::from(format!("truth/{name}.jsonl"));
        let [all, first, second] = [&whole, &early, &late].map(|files| lines(&files[&path]));
        assert_eq!(all[1..], [&first[1..], &second[1..]].concat(), "{name}");
    }
}

/// Cameras whose clocks are off film before or after the take too; the truth has its frames only.
#[test]
fn the_truth_is_of_the_frames_of_the_take() {
    let folder = tempfile::tempdir().unwrap();
    let made = make(&folder, "out", "--count 4 --fault offset=2@m2 --fault offset=-1.6@m3");
    assert_eq!(
        json(&made[Path::new("truth/large-scale.json")])["data"]["frames"],
        json(b"[1001,1002,1003,1004]")
    );
    assert_eq!(json(&made[Path::new("take/labels.json")])["data"]["frame"], 1001);
    for camera in ["m2", "m3"] {
        let image =
            |number: i64| made.contains_key(&PathBuf::from(format!("take/footage/{camera}/{number:06}.png")));
        assert!((0..4).all(image) && !image(4), "{camera}: all its images are in its footage");
    }
    let sync = lines(&made[Path::new("truth/sync.jsonl")]);
    let shows = |camera: &str| -> Vec<Value> {
        sync[1..].iter().map(|line| json(line.as_bytes())["shows"][camera]["index"].clone()).collect()
    };
    assert_eq!(sync.len(), 5);
    assert_eq!(Value::from(shows("m2")), json(b"[null,null,0,1]"));
    assert_eq!(Value::from(shows("m3")), json(b"[2,3,null,null]"));
}

/// The same files give the same side-cars, wherever they lie and whichever way they are named.
#[test]
fn side_cars_hold_no_paths() {
    let folder = tempfile::tempdir().unwrap();
    let home = tempfile::tempdir().unwrap();
    let row = |frame: i32| format!("00:00:00:{frame:02}.0,1,0.{frame}\n");
    let text = format!("Timecode,BlendShapeCount,EyeBlinkLeft\n{}", (0..4).map(row).collect::<String>());
    plant(&folder, "blinks.csv", &text);
    plant(&home, "blinks.csv", &text);
    let weights = home.path().join("blinks.csv");
    let near = make(&folder, "near", "--frames 1001-1001 --weights blinks.csv");
    let far = make(&folder, "far", &format!("--frames 1001-1001 --weights {}", weights.display()));
    assert_eq!(near, far);
    let side_car = json(&near[Path::new("take/take.json.prov.json")]);
    assert_eq!(side_car["data"]["parameters"]["weights"], "blinks.csv");
}

#[test]
fn truth_comes_without_footage_too() {
    let folder = tempfile::tempdir().unwrap();
    let filmed = make(&folder, "filmed", "");
    let plain = make(&folder, "plain", "--no-footage");
    assert!(!plain.keys().any(|path| path.extension().is_some_and(|ending| ending == "png")));
    for name in ["take/scan.obj", "truth/scenario.json", "truth/wrinkled.pc2"] {
        assert_eq!(plain[Path::new(name)], filmed[Path::new(name)], "{name}");
    }
    for name in ["truth/sync.jsonl", "truth/markers.jsonl", "truth/pose.jsonl", "truth/valleys.jsonl"] {
        // The headers name their manifests.
        let [plain, filmed] = [&plain, &filmed].map(|files| lines(&files[Path::new(name)])[1..].to_vec());
        assert_eq!(plain, filmed, "{name}");
    }
    let about_images =
        ["take/labels.json", "truth/tracks-2d.jsonl", "truth/wrinkles-2d.jsonl", "truth/sections.jsonl"];
    for name in about_images.iter().chain(&["take/footage/m1.csv"]) {
        assert!(filmed.contains_key(Path::new(name)) && !plain.contains_key(Path::new(name)), "{name}");
    }
    let manifest = json(&plain[Path::new("take/take.json")]);
    let cameras = manifest["data"]["cameras"].as_array().unwrap();
    assert!(cameras.len() == 8 && cameras.iter().all(|camera| camera["footage"].is_null()), "{manifest}");
}

/// Takes that differ have manifests that differ; the published seed is the published scenario.
#[test]
fn no_two_takes_share_a_manifest() {
    let folder = tempfile::tempdir().unwrap();
    let manifest = |out: &str, more: &str| {
        make(&folder, out, &format!("--no-footage {more}"))[Path::new("take/take.json")].clone()
    };
    let plain = manifest("plain", "");
    assert_eq!(json(&plain)["data"]["take"], "standard-1+-1");
    assert_eq!(manifest("again", "--seed 1"), plain);
    assert_ne!(manifest("rotated", "--fault rotated=2@m2"), plain);
    let printed = |more: &str| succeed(&folder, &format!("scenario {more}")).stdout;
    assert_eq!(printed("--seed 1"), printed(""));
    assert_eq!(json(&printed(""))["data"]["name"], "standard-1");
    assert_eq!(json(&printed("--fault mirrored=1@m1"))["data"]["name"], "standard-1+");
}

#[test]
fn a_printed_scenario_makes_the_same_take() {
    let folder = tempfile::tempdir().unwrap();
    let choice = "--length tiny --vertices 2000 --image-scale 0.25 --seed 3";
    let printed = succeed(&folder, &format!("scenario --scenario standard {choice}"));
    plant(&folder, "mine.json", std::str::from_utf8(&printed.stdout).unwrap());
    let rest = "--no-calibration --no-normals --no-footage";
    succeed(&folder, &format!("make {choice} {rest} --out named"));
    succeed(&folder, &format!("make --scenario mine.json {rest} --out mine"));
    let [named, mine] = ["named", "mine"].map(|name| files(&folder.path().join(name)));
    for (path, bytes) in named.iter().filter(|(path, _)| !path.to_string_lossy().ends_with(".prov.json")) {
        assert_eq!(mine[path], *bytes, "{}", path.display());
    }
}

#[test]
fn grooves_are_darker_the_deeper_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let summary = json(&succeed(&folder, "groove --ratio 0.1,0.5,1 --rays 256 --json").stdout);
    let light: Vec<f64> =
        summary["results"]["table"].as_array().unwrap().iter().map(|row| row[1].as_f64().unwrap()).collect();
    assert!(light.len() == 3 && light.is_sorted_by(|one, next| one > next), "{light:?}");
    let refused = call(&folder, "groove --ratio 9");
    let message = String::from_utf8_lossy(&refused.stderr);
    assert!(refused.status.code() == Some(1) && message.contains("--ratio 9"), "{message}");
}

#[test]
fn the_help_says_it_all() {
    for command in ["", "make", "scenario", "groove"] {
        let words = [command, "--help"].into_iter().filter(|word| !word.is_empty());
        let output = Command::cargo_bin("virtual-rig").unwrap().args(words).output().unwrap();
        let name = format!("help-{command}").trim_end_matches('-').to_string();
        insta::assert_snapshot!(name, String::from_utf8_lossy(&output.stdout));
    }
}
