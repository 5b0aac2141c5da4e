//! The program: a small take from files to curves, and bad input.
#![allow(clippy::unwrap_used, clippy::panic, clippy::disallowed_methods, reason = "tests may")]

mod scene;

use artifact::picture::{read_rgb, write_rgb8};
use artifact::{
    CameraFrames, Clock, FrameReader, FrameRun, FrameWriter, Frames, PaintModel, Rate, Shown, SyncCamera,
    SyncFrame, SyncHeader, SyncSource, TimeBase, Wrinkles2d, Wrinkles2dFrame, read_document, write_document,
};
use assert_cmd::Command;
use scene::{GREEN, Look, SIZE, Stroke, draw, mask, mask_codes, strokes};
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;

/// Every second frame of 1001–1011 has an image; that of 1007 is missing.
const FRAMES: [i64; 6] = [1001, 1003, 1005, 1007, 1009, 1011];
const MISSING: i64 = 1007;

fn at_frame(frame: i64) -> Vec<Stroke> {
    let by = 1.5 * (frame - 1001) as f64;
    strokes().iter().map(|stroke| stroke.moved([by, 0.5 * by])).collect()
}

fn write_image(path: &Path, codes: &[u8]) {
    write_rgb8(path, SIZE[0], SIZE[1], codes).unwrap().publish().unwrap();
}

fn write_frames(folder: &Path, transfer: &str) {
    let camera = CameraFrames {
        images: "w1/{frame:06}.png".into(),
        image_size: SIZE.map(|side| side as u32),
        transfer: transfer.into(),
        bit_depth: 8,
        frames: FrameRun::runs(&FRAMES.into_iter().filter(|frame| *frame != MISSING).collect::<Vec<_>>()),
    };
    let frames = Frames { take: None, cameras: [("w1".to_string(), camera)].into() };
    write_document(&folder.join("frames.json"), &frames).unwrap().publish().unwrap();
}

fn take_of(look: Look) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for frame in FRAMES.into_iter().filter(|frame| *frame != MISSING) {
        let codes = draw(&at_frame(frame), Look { seed: frame as u64, ..look });
        write_image(&folder.path().join(format!("w1/{frame:06}.png")), &codes);
    }
    write_frames(folder.path(), "srgb");
    let rate = Rate::per_second(50);
    let source = SyncSource::Stated;
    let sync = SyncCamera { rate, every: 2, phase: 1001, offset_frames: 0.0, drift_ppm: 0.0, source };
    let header =
        SyncHeader { rate, clock: Clock::Trigger, cameras: [("w1".to_string(), sync)].into(), take: None };
    let mut writer = FrameWriter::<TimeBase>::create(&folder.path().join("sync.jsonl"), header).unwrap();
    for frame in 1001..=1011 {
        let shown = Shown { index: (frame - 1001) / 2, time_s: None, doubled: false };
        let shown = Some(shown).filter(|_| frame != MISSING);
        let shows = if frame % 2 == 1 { [("w1".to_string(), shown)].into() } else { Default::default() };
        writer.write(&SyncFrame { frame, shows }).unwrap();
    }
    writer.finish().unwrap().publish().unwrap();
    write_image(&folder.path().join("masks/w1.png"), &mask_codes(&mask(&strokes())));
    folder
}

fn take() -> TempDir {
    take_of(Look::default())
}

fn call(folder: &TempDir, words: &[&str]) -> Output {
    let source = ["--frames", "frames.json", "--sync", "sync.jsonl"];
    let mut command = Command::cargo_bin("wrinkle-track").unwrap();
    command.current_dir(folder.path()).arg(words[0]).args(source).args(&words[1..]).output().unwrap()
}

#[track_caller]
fn done(folder: &TempDir, words: &[&str]) -> String {
    let output = call(folder, words);
    let said = String::from_utf8_lossy(&output.stderr).to_string();
    assert!(output.status.success(), "{said}");
    said
}

#[track_caller]
fn refused(folder: &TempDir, words: &[&str], parts: &[&str]) {
    let output = call(folder, words);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    for part in parts {
        assert!(said.contains(part), "'{part}' is missing in: {said}");
    }
    for name in ["new.json", "wrinkles.jsonl"] {
        assert!(!folder.path().join(name).exists(), "{name} was left");
    }
}

const TRAIN: [&str; 5] = ["train", "--masks", "masks", "--out", "model.json"];
const TRAIN_NEW: [&str; 5] = ["train", "--masks", "masks", "--out", "new.json"];
const TRACK: [&str; 7] = ["track", "--masks", "masks", "--model", "model.json", "--out", "wrinkles.jsonl"];

fn frames(folder: &TempDir) -> Vec<Wrinkles2dFrame> {
    let reader = FrameReader::<Wrinkles2d>::open(&folder.path().join("wrinkles.jsonl")).unwrap();
    assert_eq!(reader.header().cameras, ["w1"]);
    reader.map(Result::unwrap).collect()
}

#[test]
fn a_take_from_marked_paint_to_curves() {
    let folder = take();
    let said =
        done(&folder, &[&TRAIN[..], &["--picture", "p.png", "--table", "t.csv", "--samples", "s"]].concat());
    assert!(said.contains("green: tells") && said.contains("violet: tells"), "{said}");
    let model: PaintModel = read_document(&folder.path().join("model.json")).unwrap();
    assert!(model.paints.iter().all(|paint| paint.score > 0.99), "{model:?}");
    assert_eq!(read_rgb(&folder.path().join("p.png")).unwrap().height, SIZE[1]);
    assert!(std::fs::read_to_string(folder.path().join("s/green.csv")).unwrap().lines().count() > 200);
    // The table as it stands names the wrinkles as they would be named without one.
    done(&folder, &[&TRACK[..], &["--names", "t.csv"]].concat());
    let named = std::fs::read(folder.path().join("wrinkles.jsonl")).unwrap();
    done(&folder, &TRACK);
    assert_eq!(std::fs::read(folder.path().join("wrinkles.jsonl")).unwrap(), named);
    let frames = frames(&folder);
    let numbers: Vec<i64> = frames.iter().map(|frame| frame.frame).collect();
    assert_eq!(numbers, [1001, 1003, 1005, 1009, 1011], "no line without an image");
    for frame in &frames {
        let ids: Vec<&String> = frame.curves["w1"].keys().collect();
        assert_eq!(ids, ["w1_green_1", "w1_green_2", "w1_violet_1"], "frame {}", frame.frame);
        let control = frame.curves["w1"]["w1_green_1"].controls[3];
        assert!(at_frame(frame.frame)[0].distance(control) < 3.0);
    }
    done(
        &folder,
        &[
            "show",
            "--curves",
            "wrinkles.jsonl",
            "--model",
            "model.json",
            "--sheet",
            "sheet.png",
            "--columns",
            "3",
        ],
    );
    assert_eq!(read_rgb(&folder.path().join("sheet.png")).unwrap().width, 3 * SIZE[0]);
}

#[test]
fn masks_are_written_in_the_colours_they_were_marked_in() {
    let folder = take();
    done(&folder, &TRAIN);
    done(&folder, &["apply", "--model", "model.json", "--out", "found", "--range", "1001-1004"]);
    let files: Vec<_> = std::fs::read_dir(folder.path().join("found/w1")).unwrap().collect();
    assert_eq!(files.len(), 4, "two masks, each with its side-car");
    let record = std::fs::read_to_string(folder.path().join("found/w1/001003.png.prov.json")).unwrap();
    assert!(record.contains("wrinkle-track apply") && record.contains("model.json"), "{record}");
    let found = read_rgb(&folder.path().join("found/w1/000001.png").with_file_name("001001.png"))
        .unwrap()
        .to_8_bits();
    let wanted = mask_codes(&mask(&strokes()));
    let wrong = found.chunks(3).zip(wanted.chunks(3)).filter(|(a, b)| a != b).count();
    assert!(wrong < 150, "{wrong}");
    assert!(found.chunks(3).filter(|pixel| *pixel == GREEN).count() > 1000);
    // What was written can be learnt from.
    std::fs::create_dir(folder.path().join("again")).unwrap();
    std::fs::copy(folder.path().join("found/w1/001001.png"), folder.path().join("again/w1.png")).unwrap();
    done(&folder, &["train", "--masks", "again", "--out", "again.json"]);
}

#[test]
fn the_same_bytes_come_out_of_any_number_of_threads() {
    let folder = take();
    let bytes = |threads: &str| {
        done(&folder, &[&TRAIN[..], &["--threads", threads]].concat());
        done(&folder, &[&TRACK[..], &["--threads", threads]].concat());
        ["model.json", "wrinkles.jsonl"].map(|name| std::fs::read(folder.path().join(name)).unwrap())
    };
    assert_eq!(bytes("1"), bytes("3"));
}

#[test]
fn tracks_run_both_ways_from_the_marked_frame() {
    let folder = take();
    write_image(&folder.path().join("masks/w1.png"), &mask_codes(&mask(&at_frame(1005))));
    done(&folder, &[&TRAIN[..], &["--mask-frame", "1005"]].concat());
    done(&folder, &[&TRACK[..], &["--mask-frame", "1005"]].concat());
    assert!(frames(&folder).iter().all(|frame| frame.curves["w1"].len() == 3));
}

#[test]
fn masks_that_do_not_fit_are_refused() {
    let folder = take();
    let path = folder.path().join("masks/w1.png");
    write_rgb8(&path, 100, 80, &[0; 24000]).unwrap().publish().unwrap();
    refused(&folder, &TRAIN_NEW, &["masks/w1.png", "100 × 80 px", "240 × 180", "without scaling"]);
    write_image(&path, &vec![0; 3 * SIZE[0] * SIZE[1]]);
    refused(&folder, &TRAIN_NEW, &["masks/w1.png", "nothing is painted"]);
    write_image(&path, &GREEN.repeat(SIZE[0] * SIZE[1]));
    refused(&folder, &TRAIN_NEW, &["masks", "are marked as green", "bare skin"]);
    let soft: Vec<u8> = (0..SIZE[0] * SIZE[1]).flat_map(|i| [(i % 251) as u8, 1, (i / 251) as u8]).collect();
    write_image(&path, &soft);
    refused(&folder, &TRAIN_NEW, &["masks", "soft brushes"]);
    std::fs::rename(&path, folder.path().join("masks/m9.png")).unwrap();
    refused(&folder, &TRAIN_NEW, &["masks/m9.png", "no camera", "w1"]);
    std::fs::remove_file(folder.path().join("masks/m9.png")).unwrap();
    refused(&folder, &TRAIN_NEW, &["masks", "no <camera>.png"]);
}

#[test]
fn a_paint_that_looks_like_skin_is_refused_with_its_score() {
    let folder = take();
    // Marked where bare skin is.
    let elsewhere: Vec<Stroke> = vec![Stroke::new(&[[40.0, 165.0], [200.0, 165.0]], 0)];
    write_image(&folder.path().join("masks/w1.png"), &mask_codes(&mask(&elsewhere)));
    refused(&folder, &TRAIN_NEW, &["green cannot be told", "% are told rightly", "50 % is chance"]);
}

#[test]
fn subsampled_footage_is_warned_about() {
    let folder = take_of(Look { subsampled: true, ..Look::default() });
    assert!(done(&folder, &TRAIN).contains("4:2:0"));
    assert!(!done(&take(), &TRAIN).contains("4:2:0"));
}

#[test]
fn clipped_paint_is_refused_by_the_number_of_its_pixels() {
    let folder = take();
    for level in [255, 0] {
        write_image(&folder.path().join("w1/001001.png"), &vec![level; 3 * SIZE[0] * SIZE[1]]);
        refused(&folder, &TRAIN_NEW, &["masks", "green", "are black or saturated", "expose"]);
    }
}

#[test]
fn a_wrinkle_that_leaves_the_image_is_followed_to_its_edge() {
    let folder = take();
    for (index, frame) in FRAMES.into_iter().enumerate().filter(|(_, frame)| *frame != MISSING) {
        let gone: Vec<Stroke> =
            strokes().iter().map(|stroke| stroke.moved([60.0 * index as f64, 0.0])).collect();
        let codes = draw(&gone, Look { seed: frame as u64, ..Look::default() });
        write_image(&folder.path().join(format!("w1/{frame:06}.png")), &codes);
    }
    done(&folder, &TRAIN);
    done(&folder, &[&TRACK[..], &["--gate-px", "90", "--hold", "0"]].concat());
    let frames = frames(&folder);
    let first = &frames[0].curves["w1"];
    assert!(first.len() == 3 && frames[4].curves["w1"].is_empty(), "all are out of the image at last");
    for curve in frames.iter().flat_map(|frame| frame.curves["w1"].values()) {
        assert!((0..=20).all(|i| curve.at(curve.end() * f64::from(i) / 20.0)[0] < SIZE[0] as f64 + 2.0));
    }
    assert!(frames[1].curves["w1"].values().any(|curve| curve.confidence < 0.95), "less of it is to be seen");
}

#[test]
fn an_image_that_is_not_there_is_named_and_so_is_an_unknown_response() {
    let folder = take();
    done(&folder, &TRAIN);
    std::fs::remove_file(folder.path().join("w1/001009.png")).unwrap();
    refused(&folder, &TRACK, &["w1/001009.png", "cannot"]);
    write_frames(folder.path(), "log-c");
    refused(&folder, &TRACK, &["frames.json", "camera w1", "'log-c' is not known"]);
}

#[test]
fn names_that_do_not_fit_are_refused_by_line() {
    let folder = take();
    done(&folder, &TRAIN);
    let words = [&TRACK[..], &["--names", "names.csv"]].concat();
    for (table, parts) in [
        ("camera,x,y\nw1,3,4\n", &["names.csv", "no column wrinkle"][..]),
        ("camera,x,y,wrinkle\nw1,110,37,\n", &["names no wrinkle"]),
        (
            "camera,x,y,wrinkle\nw1,110,37,brow\nw1,5,170,lid\n",
            &["line 3", "nothing is marked at 5, 170", "lid"],
        ),
        ("camera,x,y,wrinkle\nw9,110,37,brow\n", &["line 2", "no mask is given for camera w9"]),
        ("camera,x,y,wrinkle,frame\nw1,110,37,brow,1500\n", &["line 2", "no frame 1500"]),
        ("camera,x,y,wrinkle\nw1,110,wide,brow\n", &["line 2", "'wide' is no place"]),
        (
            "camera,x,y,wrinkle\nw1,110,37,brow\nw1,110,72,brow\n",
            &["brow lies on paint green and on paint violet"],
        ),
    ] {
        std::fs::write(folder.path().join("names.csv"), table).unwrap();
        refused(&folder, &words, parts);
    }
    // One wrinkle of three is named; another appears later.
    std::fs::write(
        folder.path().join("names.csv"),
        "camera,x,y,wrinkle,frame\nw1,110,37,brow,\nw1,118,75,lid,1005\n",
    )
    .unwrap();
    let said = done(&folder, &words);
    assert!(said.contains("without a name"), "{said}");
    let seen: Vec<usize> = frames(&folder).iter().map(|frame| frame.curves["w1"].len()).collect();
    assert_eq!(seen, [1, 1, 2, 2, 2]);
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    let folder = take();
    refused(&folder, &[&TRAIN_NEW[..], &["--c", "0"]].concat(), &["--c is 0"]);
    refused(&folder, &[&TRAIN_NEW[..], &["--pixels", "9"]].concat(), &["--pixels is 9", "100 and 8000"]);
    done(&folder, &TRAIN);
    refused(&folder, &[&TRACK[..], &["--bent-deg", "120"]].concat(), &["--bent-deg is 120"]);
    let other = std::fs::read_to_string(folder.path().join("frames.json")).unwrap();
    std::fs::write(folder.path().join("model.json"), other).unwrap();
    refused(&folder, &TRACK, &["model.json", "frames/1"]);
}

#[test]
fn help_is_as_it_was() {
    for name in ["train", "apply", "track", "show"] {
        let mut command = Command::cargo_bin("wrinkle-track").unwrap();
        let output = command.args([name, "--help"]).env("COLUMNS", "120").output().unwrap();
        insta::assert_snapshot!(name, String::from_utf8(output.stdout).unwrap());
    }
}
