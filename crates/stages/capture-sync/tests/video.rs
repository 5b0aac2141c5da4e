//! Videos as footage: the right frames come out, and what is wrong with a file is said.
#![cfg(feature = "video")]
#![allow(
    clippy::unwrap_used,
    clippy::disallowed_methods,
    reason = "tests plant files and read what was written"
)]

use artifact::{FrameReader, Frames, SyncFrame, TimeBase, picture};
use assert_cmd::Command;
use footage::{Codec, VideoWriter};
use tempfile::TempDir;

const SIZE: [u32; 2] = [64, 48];

/// A picture that shows a number: eight bright or dark stripes, which lossy codecs keep.
fn numbered(number: u32) -> Vec<u8> {
    let stripe = |x: u32| if number >> (x / 8) & 1 == 1 { 220 } else { 30 };
    (0..SIZE[1]).flat_map(|_| (0..SIZE[0]).flat_map(move |x| [stripe(x); 3])).collect()
}

fn number(rgb: &[u8]) -> u32 {
    let row = 3 * (SIZE[0] * SIZE[1] / 2) as usize;
    (0..8).filter(|bit| rgb[row + 3 * (8 * bit + 4) + 1] > 128).map(|bit| 1 << bit).sum()
}

/// A take of one camera whose video shows the numbers 0 to 59.
fn take(folder: &TempDir, file: &str, codec: Codec, rate: (u32, u32)) {
    let mut writer = VideoWriter::create(&folder.path().join(file), codec, SIZE, rate).unwrap();
    (0..60).for_each(|n| writer.write(&numbered(n)).unwrap());
    writer.finish().unwrap();
    let rate = format!(r#"{{"frames":{},"seconds":{}}}"#, rate.0, rate.1);
    let manifest = format!(
        r#"{{"schema":"take/2","data":{{"subject":"s","session":"d","take":"t","rate":{rate},
        "start_timecode":"00:00:59;25","first_frame":1001,"clock":"trigger","cameras":[{{"id":"a","image_size":[64,48],
        "transfer":"srgb","bit_depth":8,"rate":{rate},"footage":{{"file":"{file}","images":null,"first":0,"timestamps":null}}}}],
        "mesh_unit":"mm","mesh_up":"y","consent":{{"licence":"test","credit":null,"notes":null}}}}}}"#
    );
    let manifest = if rate.contains("1001") { manifest } else { manifest.replace(";25", ":05") };
    std::fs::write(folder.path().join("take.json"), manifest).unwrap();
}

fn change(folder: &TempDir, from: &str, to: &str) {
    let path = folder.path().join("take.json");
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(from));
    std::fs::write(&path, text.replace(from, to)).unwrap();
}

fn call(folder: &TempDir, arguments: &[&str]) -> std::process::Output {
    let words = [&["run", "take.json", "--out", "out"], arguments].concat();
    Command::cargo_bin("capture-sync").unwrap().current_dir(folder.path()).args(words).output().unwrap()
}

/// The images that were written: by frame the number that they show.
fn shown(folder: &TempDir) -> Vec<(i64, u32)> {
    let out = folder.path().join("out");
    let frames: Frames = artifact::read_document(&out.join("frames.json")).unwrap();
    assert_eq!(frames.cameras["a"].bit_depth, 8);
    let read = |path| number(&picture::read_rgb(&out.join(path)).unwrap().to_8_bits());
    frames.cameras["a"].images().map(|(frame, path)| (frame, read(path))).collect()
}

fn assert_refused(folder: &TempDir, arguments: &[&str], parts: &[&str]) {
    let output = call(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{message}");
    for part in parts {
        assert!(message.contains(part), "'{part}' is not said in: {message}");
    }
    assert!(!folder.path().join("out").exists(), "nothing may be left");
}

#[test]
fn the_frames_asked_for_are_the_right_ones() {
    for (file, codec) in [
        ("a.avi", Codec::Ffv1),
        ("a.mkv", Codec::Ffv1),
        ("a.mp4", Codec::H264),
        ("b.mkv", Codec::H264),
        ("b.avi", Codec::Mjpg),
    ] {
        let folder = tempfile::tempdir().unwrap();
        take(&folder, file, codec, (50, 1));
        let output = call(&folder, &["--frames", "1038-1043"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(shown(&folder), (37..43).map(|n| (1001 + i64::from(n), n)).collect::<Vec<_>>(), "{file}");
        let images = std::fs::read_dir(folder.path().join("out/a")).unwrap().count();
        assert_eq!(images, 6, "only those asked for");
    }
}

#[test]
fn lossless_frames_keep_every_bit() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder, "a.avi", Codec::Ffv1, (50, 1));
    assert!(call(&folder, &[]).status.success());
    for n in [0, 30, 59] {
        let picture = picture::read_rgb(&folder.path().join(format!("out/a/{:06}.png", 1001 + n))).unwrap();
        assert_eq!(picture.to_8_bits(), numbered(n));
    }
}

#[test]
fn rates_over_1001_and_their_time_codes_hold() {
    for (rate, code) in [((30_000, 1001), ";25"), ((60_000, 1001), ";25"), ((24_000, 1001), ":05")] {
        let folder = tempfile::tempdir().unwrap();
        take(&folder, "a.mp4", Codec::H264, rate);
        if rate.0 == 24_000 {
            change(&folder, ";25", code);
        }
        let output = call(&folder, &["--json"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let last = match rate.0 {
            // 59 frames on, over the labels that a new minute leaves out.
            30_000 => "00:01:01;26",
            60_000 => "00:01:00;28",
            _ => "00:01:01:16",
        };
        assert_eq!(summary["results"]["last_timecode"], last);
        assert_eq!(summary["warnings"].as_array().map_or(0, Vec::len), 0, "{}", summary["warnings"]);
    }
}

#[test]
fn time_codes_and_stamps_of_frames_that_are_not_there_are_noticed() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder, "a.avi", Codec::Ffv1, (30_000, 1001));
    change(&folder, r#""timestamps":null"#, r#""timestamps":"a.csv""#);
    // Ten frames after the minute: the labels ;00 and ;01 of it do not exist, and frame 20 was lost.
    let label = |n: u32| match n {
        0..5 => format!("00:00:59;{:02}", n + 25),
        _ => format!("00:01:{:02};{:02}", (n - 3) / 30, (n - 3) % 30),
    };
    let stamps = |count: u32| {
        let lost = |n: u32| if n < 20 { n } else { n + 1 };
        let lines = (0..count).map(|n| format!("{n},{}\n", label(lost(n)))).collect::<String>();
        std::fs::write(folder.path().join("a.csv"), format!("index,timecode\n{lines}")).unwrap();
    };
    stamps(60);
    let output = call(&folder, &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let frames: Vec<SyncFrame> = FrameReader::<TimeBase>::open(&folder.path().join("out/sync.jsonl"))
        .unwrap()
        .map(Result::unwrap)
        .collect();
    assert_eq!((frames[20].shows["a"], frames[21].shows["a"].unwrap().index), (None, 20));
    std::fs::remove_dir_all(folder.path().join("out")).unwrap();
    stamps(62);
    assert_refused(&folder, &[], &["a.avi", "camera a", "last frame is 59", "a.csv", "frame 61"]);
    assert!(call(&folder, &["--accept-short"]).status.success());
}

#[test]
fn videos_that_end_early_need_a_word() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder, "a.avi", Codec::Ffv1, (50, 1));
    let bytes = std::fs::read(folder.path().join("a.avi")).unwrap();
    std::fs::write(folder.path().join("a.avi"), &bytes[..bytes.len() / 2]).unwrap();
    assert_refused(&folder, &[], &["a.avi", "camera a", "ends early: frame", "of 60", "--accept-short"]);
    let output = call(&folder, &["--accept-short"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("warning"));
    let frames = shown(&folder);
    assert!((3..58).contains(&frames.len()));
    assert!(frames.iter().all(|(frame, n)| *frame == 1001 + i64::from(*n)));
}

#[test]
fn what_is_no_video_or_another_one_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder, "a.avi", Codec::Ffv1, (50, 1));
    change(&folder, "[64,48]", "[64,50]");
    assert_refused(&folder, &[], &["a.avi", "camera a", "64×48", "64×50"]);
    for bytes in [&b""[..], b"some text\n", &[7; 3000]] {
        std::fs::write(folder.path().join("a.avi"), bytes).unwrap();
        assert_refused(&folder, &[], &["a.avi", "camera a", "cannot be opened as a video", "to do"]);
    }
}

#[test]
fn a_rate_that_is_not_the_files_is_pointed_out() {
    let folder = tempfile::tempdir().unwrap();
    take(&folder, "a.avi", Codec::Ffv1, (50, 1));
    change(&folder, r#""frames":50"#, r#""frames":100"#);
    let output = call(&folder, &[]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("50.000 Hz") && message.contains("100 Hz"), "{message}");
}
