//! The binary: what it writes, and how it refuses.
#![allow(
    clippy::unwrap_used,
    clippy::disallowed_methods,
    reason = "tests plant files and read what was written"
)]

use artifact::{FrameReader, Frames, SyncFrame, TimeBase, picture};
use assert_cmd::Command;
use std::path::Path;
use tempfile::TempDir;

/// A take of two cameras of ten images of 16 × 12 pixels; the second one dropped its fourth.
fn take(folder: &TempDir) {
    let camera = |id: &str| {
        format!(
            r#"{{"id":"{id}","image_size":[16,12],"transfer":"srgb","bit_depth":8,"rate":{{"frames":50,"seconds":1}},
            "footage":{{"file":null,"images":"footage/{id}/{{frame:06}}.png","first":0,"timestamps":"footage/{id}.csv"}}}}"#
        )
    };
    let manifest = format!(
        r#"{{"schema":"take/2","data":{{"subject":"s","session":"d","take":"t","rate":{{"frames":50,"seconds":1}},
        "start_timecode":"10:00:00:00","first_frame":1001,"clock":"trigger","cameras":[{},{}],"mesh_unit":"mm","mesh_up":"y",
        "consent":{{"licence":"test","credit":null,"notes":null}}}}}}"#,
        camera("a"),
        camera("b")
    );
    std::fs::write(folder.path().join("take.json"), manifest).unwrap();
    for (id, exposures) in [("a", (0..10).collect::<Vec<u8>>()), ("b", (0..10).filter(|n| *n != 3).collect())]
    {
        let mut stamps = "index,time_s\n".to_string();
        for (index, exposure) in exposures.iter().enumerate() {
            let path = folder.path().join(format!("footage/{id}/{index:06}.png"));
            picture::write_rgb8(&path, 16, 12, &[10 * exposure; 16 * 12 * 3]).unwrap().publish().unwrap();
            stamps.push_str(&format!("{index},{}\n", f64::from(*exposure) / 50.0));
        }
        std::fs::write(folder.path().join(format!("footage/{id}.csv")), stamps).unwrap();
    }
}

fn call(folder: &TempDir, arguments: &[&str]) -> std::process::Output {
    Command::cargo_bin("capture-sync").unwrap().current_dir(folder.path()).args(arguments).output().unwrap()
}

fn sync(path: &Path) -> Vec<SyncFrame> {
    FrameReader::<TimeBase>::open(path).unwrap().map(Result::unwrap).collect()
}

#[test]
fn it_writes_the_time_base_and_the_images_by_frame() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder);
    let output = call(&folder, &["run", "take.json", "--out", "out", "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["results"]["cameras"]["b"]["dropped"], 1);
    assert_eq!(summary["results"]["last_timecode"], "10:00:00:09");
    let out = folder.path().join("out");
    let frames = sync(&out.join("sync.jsonl"));
    assert_eq!((frames.len(), frames[3].shows["b"], frames[4].shows["b"].unwrap().index), (10, None, 3));
    let images: Frames = artifact::read_document(&out.join("frames.json")).unwrap();
    assert_eq!(images.cameras["b"].image(1004), None, "a gap stays a gap");
    let shown = picture::read_rgb(&out.join(images.cameras["b"].image(1005).unwrap())).unwrap();
    assert_eq!(shown.to_8_bits()[0], 40);
    assert!(!out.join("b/001004.png").exists());
    assert!(call(&folder, &["run", "take.json", "--out", "out"]).status.success(), "it can be run again");
}

#[test]
fn only_what_is_asked_for_is_written() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder);
    let asked = ["run", "take.json", "--out", "out", "--frames", "1003-1004", "--camera", "a"];
    assert!(call(&folder, &asked).status.success());
    let images: Vec<_> = std::fs::read_dir(folder.path().join("out/a")).unwrap().collect();
    assert_eq!((images.len(), folder.path().join("out/b").exists()), (2, false));
    assert!(call(&folder, &["run", "take.json", "--out", "bare", "--no-extract"]).status.success());
    assert!(!folder.path().join("bare/frames.json").exists() && !folder.path().join("bare/a").exists());
}

#[test]
fn check_says_ms_and_mm() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder);
    let late = (0..10).map(|n| format!("{n},{}\n", f64::from(n) / 50.0 + 0.004)).collect::<String>();
    std::fs::write(folder.path().join("footage/a.csv"), format!("index,time_s\n{late}")).unwrap();
    assert!(call(&folder, &["run", "take.json", "--out", "out", "--no-extract"]).status.success());
    let output = call(&folder, &["check", "out/sync.jsonl", "--speed", "100", "--json"]);
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let camera = &summary["results"]["cameras"]["a"];
    assert!((camera["worst_ms"].as_f64().unwrap() - 4.0).abs() < 1e-3);
    assert!((camera["worst_mm"].as_f64().unwrap() - 0.4).abs() < 1e-3);
    assert_eq!(call(&folder, &["check", "out/sync.jsonl", "--max-ms", "1"]).status.code(), Some(1));
    assert_eq!(call(&folder, &["check", "out/sync.jsonl", "--max-ms", "5"]).status.code(), Some(0));
}

/// Exit 1, all parts in the message, and no output.
fn assert_refused(folder: &TempDir, arguments: &[&str], parts: &[&str]) {
    let output = call(folder, &[&["run", "take.json", "--out", "out"], arguments].concat());
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{message}");
    for part in parts {
        assert!(message.contains(part), "'{part}' is not said in: {message}");
    }
    assert!(!folder.path().join("out").exists(), "nothing may be left");
}

#[test]
fn bad_footage_is_refused_by_name() {
    let new = || {
        let folder = tempfile::tempdir().unwrap();
        take(&folder);
        folder
    };
    let folder = new();
    std::fs::write(folder.path().join("footage/b.csv"), "index,time_s\n0,1\n1,0.9\n").unwrap();
    assert_refused(&folder, &[], &["camera b", "footage/b.csv, line 3", "runs backwards"]);
    std::fs::remove_file(folder.path().join("footage/b.csv")).unwrap();
    assert_refused(&folder, &[], &["camera b", "footage/b.csv", "cannot read"]);

    let folder = new();
    picture::write_rgb8(&folder.path().join("footage/b/000000.png"), 8, 8, &[0; 192])
        .unwrap()
        .publish()
        .unwrap();
    assert_refused(&folder, &[], &["camera b", "000000.png", "8×8", "16×12"]);
    std::fs::write(folder.path().join("footage/b/000000.png"), "no picture").unwrap();
    assert_refused(&folder, &[], &["camera b", "000000.png", "is not a PNG"]);

    let folder = new();
    std::fs::remove_dir_all(folder.path().join("footage/b")).unwrap();
    assert_refused(&folder, &[], &["camera b", "footage/b", "no image", "check the path"]);

    let folder = new();
    picture::write_rgb8(&folder.path().join("footage/b/000020.png"), 16, 12, &[0; 576])
        .unwrap()
        .publish()
        .unwrap();
    assert_refused(&folder, &[], &["footage/b.csv", "camera b", "image 20 without a time stamp"]);
    assert_refused(&new(), &["--camera", "z"], &["take.json", "no camera z", "a, b"]);
    assert_refused(&new(), &["--frames", "5-7"], &["take.json", "5-7"]);
    assert_refused(&new(), &["--mode", "flash"], &["take.json", "camera a", "no flash"]);
}

#[cfg(not(feature = "video"))]
#[test]
fn a_video_asks_for_a_build_that_reads_it() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder);
    let path = folder.path().join("take.json");
    let text = std::fs::read_to_string(&path).unwrap();
    let text =
        text.replace(r#""file":null,"images":"footage/a/{frame:06}.png""#, r#""file":"a.avi","images":null"#);
    std::fs::write(&path, text).unwrap();
    assert_refused(&folder, &[], &["a.avi", "camera a", "--features video"]);
}

#[test]
fn the_help_says_it_all() {
    for (name, arguments) in
        [("help", &["--help"][..]), ("help-run", &["run", "--help"]), ("help-check", &["check", "--help"])]
    {
        let output = Command::cargo_bin("capture-sync").unwrap().args(arguments).output().unwrap();
        insta::assert_snapshot!(name, String::from_utf8_lossy(&output.stdout));
    }
}

#[test]
fn check_draws_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder);
    assert!(call(&folder, &["run", "take.json", "--out", "out", "--no-extract"]).status.success());
    assert!(call(&folder, &["check", "out/sync.jsonl", "--picture", "sync.png"]).status.success());
    let drawn = picture::read_rgb(&folder.path().join("sync.png")).unwrap();
    let red = drawn.to_8_bits().chunks_exact(3).filter(|pixel| *pixel == [206, 40, 40]).count();
    assert!(red > 100, "the lost image shows: {red} red pixels");
}

/// The bytes of all files below a folder, by path.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => found.extend(contents(&path)),
            false => found.push((path.display().to_string(), std::fs::read(&path).unwrap())),
        }
    }
    found.sort();
    found
}

/// Exit 1, all parts in the message, and everything as it was.
fn assert_untouched(folder: &TempDir, arguments: &[&str], parts: &[&str]) {
    let before = contents(folder.path());
    let output = call(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{message}");
    parts.iter().for_each(|part| assert!(message.contains(part), "'{part}' is not said in: {message}"));
    assert!(contents(folder.path()) == before, "something was changed");
}

#[test]
fn footage_is_never_written_over() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder);
    for out in ["footage", "./footage/../footage"] {
        assert_untouched(
            &folder,
            &["run", "take.json", "--out", out],
            &["footage of camera a", "another --out"],
        );
        // Also where another camera's footage lies beside.
        assert_untouched(
            &folder,
            &["run", "take.json", "--out", out, "--camera", "b"],
            &["footage of camera a"],
        );
    }
    #[cfg(unix)]
    {
        std::fs::create_dir(folder.path().join("out")).unwrap();
        std::os::unix::fs::symlink(folder.path().join("footage/b"), folder.path().join("out/a")).unwrap();
        assert_untouched(&folder, &["run", "take.json", "--out", "out"], &["footage of camera b"]);
    }
}

#[test]
fn images_of_an_earlier_run_go_and_those_of_others_stay() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder);
    let run = |frames: &str| call(&folder, &["run", "take.json", "--out", "out", "--frames", frames]);
    let images = || -> Vec<String> {
        let names = contents(&folder.path().join("out")).into_iter().map(|(path, _)| path);
        names.filter(|path| path.ends_with(".png")).map(|path| path[path.len() - 12..].to_string()).collect()
    };
    assert!(run("1001-1003").status.success());
    assert!(run("1007-1008").status.success());
    assert_eq!(images(), ["a/001007.png", "a/001008.png", "b/001007.png", "b/001008.png"]);
    // A camera that is no longer used leaves no folder.
    assert!(call(&folder, &["run", "take.json", "--out", "out", "--camera", "a"]).status.success());
    assert!(!folder.path().join("out/b").exists());
    std::fs::write(folder.path().join("out/a/999999.png"), "mine").unwrap();
    let again = ["run", "take.json", "--out", "out"];
    assert_untouched(&folder, &again, &["out/a", "999999.png", "another --out"]);
    // Nor is a list believed that this stage did not write.
    std::fs::remove_file(folder.path().join("out/a/999999.png")).unwrap();
    std::fs::write(folder.path().join("out/frames.json.prov.json"), r#"{"data":{"stage":"other"}}"#).unwrap();
    assert_untouched(&folder, &again, &["out/a", "001001.png"]);
}

#[test]
fn ids_that_are_names_of_outputs_are_refused() {
    for id in ["frames.json", "Sync.jsonl", "sync.jsonl.prov.json", "B"] {
        let folder = tempfile::tempdir().unwrap();
        take(&folder);
        let path = folder.path().join("take.json");
        let text = std::fs::read_to_string(&path).unwrap().replace(r#""id":"a""#, &format!(r#""id":"{id}""#));
        std::fs::write(&path, text).unwrap();
        assert_refused(&folder, &[], &["take.json", id, "another id"]);
    }
}

#[test]
fn a_folder_that_cannot_be_made_is_noticed_first() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder);
    // Reading the images would fail, later.
    std::fs::write(folder.path().join("footage/a/000005.png"), "").unwrap();
    let out = ["run", "take.json", "--out", "take.json/out"];
    assert_untouched(&folder, &out, &["take.json: is not a folder", "another --out"]);
}

#[test]
fn every_picture_is_looked_at_also_with_stamps() {
    let picture = |folder: &TempDir| folder.path().join("footage/b/000005.png");
    let folder = tempfile::tempdir().unwrap();
    take(&folder);
    let whole = std::fs::read(picture(&folder)).unwrap();
    for bytes in [&whole[..0], &whole[..40], &whole[..whole.len() - 5]] {
        std::fs::write(picture(&folder), bytes).unwrap();
        assert_refused(&folder, &[], &["camera b", "000005.png", "is not a PNG"]);
    }
    picture::write_rgb8(&picture(&folder), 12, 16, &[0; 576]).unwrap().publish().unwrap();
    assert_refused(&folder, &[], &["camera b", "000005.png", "12×16", "16×12"]);
    picture::write_rgb16(&picture(&folder), 16, 12, &[0; 576]).unwrap().publish().unwrap();
    assert_refused(&folder, &[], &["camera b", "000005.png", "16 bits", "says 8"]);
}

fn change(folder: &TempDir, from: &str, to: &str) {
    let path = folder.path().join("take.json");
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(from));
    std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
}

#[test]
fn odd_manifests_are_refused_or_pointed_out() {
    for (from, to, part) in [
        (r#""transfer":"srgb""#, r#""transfer":"blah""#, "'blah'"),
        (r#""bit_depth":8"#, r#""bit_depth":0"#, "bit_depth is 0"),
        (r#""bit_depth":8"#, r#""bit_depth":17"#, "bit_depth is 17"),
        (r#""first":0"#, r#""first":-1"#, "first is -1"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        take(&folder);
        change(&folder, from, to);
        assert_refused(&folder, &[], &["take.json", "camera a", part]);
    }
    let folder = tempfile::tempdir().unwrap();
    take(&folder);
    let depth = r#""bit_depth":8,"rate":{"frames":50"#;
    change(&folder, depth, r#""bit_depth":8,"rate":{"frames":150"#);
    let output = call(&folder, &["run", "take.json", "--out", "out"]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(
        message.contains("camera a: of 28 images most, 18, are missing; is its rate 150 Hz"),
        "{message}"
    );
}

#[test]
fn a_known_shift_is_stated_and_check_says_so() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder);
    let run = |late: &[&str]| {
        call(&folder, &[&["run", "take.json", "--out", "out", "--no-extract"], late].concat())
    };
    assert!(run(&["--mode", "stated", "--late", "b=2.25"]).status.success());
    let output = call(&folder, &["check", "out/sync.jsonl", "--json"]);
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let camera = &summary["results"]["cameras"]["b"];
    assert_eq!((camera["source"].as_str(), camera["mean_ms"].as_f64()), (Some("stated"), Some(5.0)));
    assert!(summary["warnings"][0].as_str().unwrap().contains("stated, not measured"));
    assert_eq!(run(&["--late", "b=1", "--late", "b=2"]).status.code(), Some(1));
    assert_eq!(run(&["--late", "z=1"]).status.code(), Some(1));
    assert_eq!(run(&["--late", "b"]).status.code(), Some(2));
}

#[test]
fn check_refuses_frames_out_of_order() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder);
    assert!(call(&folder, &["run", "take.json", "--out", "out", "--no-extract"]).status.success());
    let path = folder.path().join("out/sync.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    let mut lines: Vec<&str> = text.lines().collect();
    lines.swap(2, 5);
    std::fs::write(&path, lines.join("\n")).unwrap();
    assert_untouched(&folder, &["check", "out/sync.jsonl"], &["sync.jsonl", "frame numbers must rise"]);
}
