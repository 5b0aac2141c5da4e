//! The program: a small take from files to tracks, and bad input.

#![allow(clippy::unwrap_used, clippy::panic, clippy::disallowed_methods, reason = "tests may")]

mod scene;

use artifact::picture::write_rgb8;
use artifact::{
    CameraFrames, Clock, FrameReader, FrameRun, FrameWriter, Frames, Labels, Rate, Shown, SyncCamera,
    SyncFrame, SyncHeader, SyncSource, TimeBase, TrackState, Tracks2d, Tracks2dFrame, write_document,
};
use assert_cmd::Command;
use scene::{Dot, Look, SIZE, draw, grid, labels};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;

const FRAMES: i64 = 7;
const LABELLED: i64 = 1004;

fn dots_at(frame: i64) -> Vec<Dot> {
    let by = 0.9 * (frame - LABELLED) as f64;
    grid().iter().map(|dot| Dot { at: [dot.at[0] + by, dot.at[1]], ..*dot }).collect()
}

fn write_labels(folder: &Path, change: impl Fn(&mut BTreeMap<String, [f64; 2]>)) {
    let mut places = labels(&dots_at(LABELLED));
    change(&mut places);
    let cameras = [("m1".to_string(), places)].into();
    let document = Labels { take: None, frame: LABELLED, cameras };
    write_document(&folder.join("labels.json"), &document).unwrap().publish().unwrap();
}

/// A take of one camera, 1001–1007, labelled in the middle; 1006 is missing.
fn take() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for frame in (1001..1001 + FRAMES).filter(|frame| *frame != 1006) {
        let image = draw(&dots_at(frame), Look { seed: frame as u64, ..Look::default() });
        let path = folder.path().join(format!("m1/{frame:06}.png"));
        write_rgb8(&path, SIZE[0], SIZE[1], &image).unwrap().publish().unwrap();
    }
    let camera = CameraFrames {
        images: "m1/{frame:06}.png".into(),
        image_size: SIZE.map(|side| side as u32),
        transfer: "srgb".into(),
        bit_depth: 8,
        frames: FrameRun::runs(&[1001, 1002, 1003, 1004, 1005, 1007]),
    };
    let frames = Frames { take: None, cameras: [("m1".to_string(), camera)].into() };
    write_document(&folder.path().join("frames.json"), &frames).unwrap().publish().unwrap();
    let rate = Rate::per_second(50);
    let source = SyncSource::Stated;
    let sync = SyncCamera { rate, every: 1, phase: 1001, offset_frames: 0.0, drift_ppm: 0.0, source };
    let header =
        SyncHeader { rate, clock: Clock::Trigger, cameras: [("m1".to_string(), sync)].into(), take: None };
    let mut writer = FrameWriter::<TimeBase>::create(&folder.path().join("sync.jsonl"), header).unwrap();
    for frame in 1001..1001 + FRAMES {
        let shown = Shown { index: frame - 1001, time_s: None, doubled: false };
        let shown = Some(shown).filter(|_| frame != 1006);
        writer.write(&SyncFrame { frame, shows: [("m1".to_string(), shown)].into() }).unwrap();
    }
    writer.finish().unwrap().publish().unwrap();
    write_labels(folder.path(), |_| {});
    folder
}

fn call(folder: &TempDir, words: &[&str]) -> Output {
    let source = ["--frames", "frames.json", "--sync", "sync.jsonl"];
    let mut command = Command::cargo_bin("marker-track").unwrap();
    command.current_dir(folder.path()).arg(words[0]).args(source).args(&words[1..]).output().unwrap()
}

const TRACK: [&str; 5] = ["track", "--labels", "labels.json", "--out", "tracks.jsonl"];

fn tracks(folder: &TempDir) -> Vec<Tracks2dFrame> {
    let reader = FrameReader::<Tracks2d>::open(&folder.path().join("tracks.jsonl")).unwrap();
    assert_eq!(reader.header().cameras, ["m1"]);
    reader.map(Result::unwrap).collect()
}

fn assert_refused(folder: &TempDir, words: &[&str], parts: &[&str]) {
    let output = call(folder, words);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    for part in parts {
        assert!(message.contains(part), "'{part}' is missing in: {message}");
    }
    assert!(!folder.path().join("tracks.jsonl").exists());
}

#[test]
fn tracks_run_both_ways_from_the_labelled_frame() {
    let folder = take();
    let output = call(&folder, &TRACK);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let frames = tracks(&folder);
    assert_eq!(frames.len(), FRAMES as usize);
    for frame in &frames {
        let Some(samples) = &frame.cameras[0] else {
            assert_eq!(frame.frame, 1006);
            continue;
        };
        for (sample, dot) in samples.iter().zip(dots_at(frame.frame)) {
            let sample = sample.unwrap();
            let off = (sample.at.x - dot.at[0]).hypot(sample.at.y - dot.at[1]);
            assert!(off < 0.2 && sample.state == TrackState::Seen, "frame {}: {off}", frame.frame);
        }
    }
}

#[test]
fn the_same_bytes_come_out_of_any_number_of_threads() {
    let folder = take();
    let bytes = |threads: &str| {
        assert!(call(&folder, &[&TRACK[..], &["--threads", threads]].concat()).status.success());
        std::fs::read(folder.path().join("tracks.jsonl")).unwrap()
    };
    assert_eq!(bytes("1"), bytes("3"));
}

#[test]
fn edits_are_replayed_and_their_faults_named_by_line() {
    let folder = take();
    std::fs::write(folder.path().join("edits.txt"), "relabel 1003 m1 d00 d11\nfill 1002 m1 d05 9 8\n")
        .unwrap();
    let with_edits = [&TRACK[..], &["--edits", "edits.txt"]].concat();
    assert!(call(&folder, &with_edits).status.success());
    let frames = tracks(&folder);
    let place = |frame: usize, marker: usize| frames[frame].cameras[0].as_ref().unwrap()[marker].unwrap();
    assert!((place(3, 0).at.x - dots_at(1004)[11].at[0]).abs() < 0.2);
    assert!((place(1, 0).at.x - dots_at(1002)[0].at[0]).abs() < 0.2);
    assert_eq!((place(1, 5).at.x, place(1, 5).state), (9.0, TrackState::Edited));
    std::fs::remove_file(folder.path().join("tracks.jsonl")).unwrap();
    std::fs::write(folder.path().join("edits.txt"), "\nsplit 1003 m1 nose\n").unwrap();
    assert_refused(&folder, &with_edits, &["edits.txt", "line 2", "marker 'nose'"]);
}

#[test]
fn bad_labels_and_images_are_refused_by_name() {
    let folder = take();
    write_labels(folder.path(), |places| _ = places.insert("d04".into(), [3.0, 300.0]));
    assert_refused(&folder, &TRACK, &["labels.json", "camera m1", "marker d04", "outside the image"]);
    write_labels(folder.path(), |places| _ = places.insert("d04".into(), [38.0, 40.0]));
    assert_refused(&folder, &TRACK, &["labels.json", "camera m1", "marker d04", "no dot", "nearest"]);
    write_labels(folder.path(), |_| {});
    write_rgb8(&folder.path().join("m1/001002.png"), 4, 4, &[9; 48]).unwrap().publish().unwrap();
    assert_refused(&folder, &TRACK, &["001002.png", "4 × 4 px", "160 × 120"]);
    std::fs::remove_file(folder.path().join("m1/001002.png")).unwrap();
    assert_refused(&folder, &TRACK, &["001002.png", "cannot read"]);
}

#[test]
fn dots_are_numbered_and_tracks_drawn() {
    let folder = take();
    for how in [["--at", "20.5,22.5"], ["--color", "1c3d86"]] {
        let words = ["detect", "--camera", "m1", "--frame", "1004", "--out", "n.png", "--csv", "n.csv"];
        let output = call(&folder, &[&words[..], &how].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let table = std::fs::read_to_string(folder.path().join("n.csv")).unwrap();
        assert_eq!(table.lines().next(), Some("camera,frame,number,x,y,area,marker"));
        assert_eq!(table.lines().count(), 13, "{how:?}");
    }
    assert!(call(&folder, &TRACK).status.success());
    let show =
        ["show", "--tracks", "tracks.jsonl", "--camera", "m1", "--range", "1003-1007", "--out", "seen"];
    let sheet = ["--sheet", "sheet.png", "--columns", "2"];
    assert!(call(&folder, &[&show[..], &sheet].concat()).status.success());
    assert_eq!(std::fs::read_dir(folder.path().join("seen/m1")).unwrap().count(), 4);
    // Two of the frames beside each other, as large as the camera's images.
    let size = |name: &str| {
        let picture = artifact::picture::read_rgb(&folder.path().join(name)).unwrap();
        [picture.width, picture.height]
    };
    let page = size("seen/m1/001003.png");
    assert_eq!(size("sheet.png"), [page[0], page[1] / 2]);
    assert_eq!(call(&folder, &show).status.code(), Some(1), "the folder is not empty");
}

/// Names in the tables of `detect` are labels.
#[test]
fn tables_with_names_are_labels() {
    let folder = take();
    let words =
        ["detect", "--camera", "m1", "--frame", "1004", "--color", "1c3d86", "--out", "n.png", "--csv", "n.csv"];
    assert!(call(&folder, &words).status.success());
    let path = folder.path().join("n.csv");
    let rows = std::fs::read_to_string(&path).unwrap();
    let named = |name: fn(usize) -> String| {
        let lines = rows.lines().enumerate().map(|(i, row)| match i {
            0 | 3 => row.to_string(),
            _ => format!("{row}{}", name(i)),
        });
        std::fs::write(&path, lines.collect::<Vec<_>>().join("\n")).unwrap();
        let words = ["label", "n.csv", "--out", "named.json"];
        Command::cargo_bin("marker-track").unwrap().current_dir(&folder).args(words).output().unwrap()
    };
    assert!(named(|i| format!("dot_{i}")).status.success());
    let labels: Labels = artifact::read_document(&folder.path().join("named.json")).unwrap();
    let camera = &labels.cameras["m1"];
    assert_eq!((labels.frame, camera.len()), (1004, 11), "twelve dots, one without a name");
    let distance = |at: &[f64; 2]| {
        let truth = dots_at(LABELLED);
        truth.iter().map(|dot| (dot.at[0] - at[0]).hypot(dot.at[1] - at[1])).fold(f64::INFINITY, f64::min)
    };
    assert!(camera.values().all(|at| distance(at) < 0.1));
    for (name, said) in [
        ((|_| "nose".into()) as fn(usize) -> String, "n.csv, line 3: nose stands twice in camera m1"),
        (|_| String::new(), "names no marker"),
    ] {
        let output = named(name);
        let text = String::from_utf8_lossy(&output.stderr).to_string();
        assert!(output.status.code() == Some(1) && text.contains(said), "{text}");
    }
}

#[test]
fn the_help_says_it_all() {
    for command in ["track", "detect", "label", "show"] {
        let output = Command::cargo_bin("marker-track").unwrap().args([command, "--help"]).output().unwrap();
        insta::assert_snapshot!(command, String::from_utf8_lossy(&output.stdout));
    }
}
