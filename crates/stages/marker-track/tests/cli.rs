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
    let wrong = |places: &mut BTreeMap<String, [f64; 2]>| {
        for (i, at) in places.values_mut().enumerate() {
            *at = match i {
                0..6 => [at[0] + 300.0, at[1]],
                6 => [at[0] + 15.0, at[1] + 15.0],
                _ => *at,
            };
        }
        places.insert("d11".into(), [3.0, 1e300]);
    };
    write_labels(folder.path(), wrong);
    let said =
        ["labels.json, camera m1", "8 of 12", "marker d06: no dot", "nearest", "(3.0e0, 1.0e300)", "to do"];
    assert_refused(&folder, &TRACK, &said);
    write_labels(folder.path(), |places| _ = places.insert("nose tip".into(), [60.0, 60.0]));
    assert_refused(&folder, &TRACK, &["labels.json", "marker nose tip", "blank"]);
    write_labels(folder.path(), |_| {});
    write_rgb8(&folder.path().join("m1/001002.png"), 4, 4, &[9; 48]).unwrap().publish().unwrap();
    assert_refused(&folder, &TRACK, &["001002.png", "4 × 4 px", "160 × 120"]);
    std::fs::remove_file(folder.path().join("m1/001002.png")).unwrap();
    assert_refused(&folder, &TRACK, &["001002.png", "cannot read"]);
}

/// A few labels that cannot be used are left out; all are named.
#[test]
fn a_bad_label_does_not_stop_the_take() {
    let folder = take();
    write_labels(folder.path(), |places| {
        places.insert("d04".into(), [3.0, 300.0]);
        places.insert("d06".into(), [38.0, 40.0]);
        let [x, y] = dots_at(LABELLED)[0].at;
        places.insert("d12".into(), [x + 1.5, y]);
    });
    let output = call(&folder, &TRACK);
    let said = String::from_utf8_lossy(&output.stderr).to_string();
    assert!(output.status.success(), "{said}");
    for part in ["marker d04", "outside the image", "marker d06: no dot", "marker d12", "on the dot of d00"] {
        assert!(said.contains(part), "'{part}' is missing in: {said}");
    }
    let frames = tracks(&folder);
    let samples = frames[3].cameras[0].as_ref().unwrap();
    assert!(samples[0].is_some() && samples[4].is_none() && samples[6].is_none() && samples[12].is_none());
}

/// A pinhole camera that looks along z from the world's origin, and the markers on a plane before it.
fn write_guide(folder: &Path, off: f64, id: &str) {
    let lens = camera::Lens {
        focal_px: nalgebra::Vector2::repeat(100.0),
        center_px: nalgebra::Vector2::new(80.0, 60.0),
        distortion: camera::BrownConrady::default(),
    };
    let image_size = SIZE.map(|side| side as u32);
    let camera = camera::Camera { image_size, lens, cam_from_world: nalgebra::Isometry3::identity() };
    let cameras = [("m1", camera.clone()), ("m2", camera)]
        .map(|(id, camera)| (id.to_string(), artifact::RigCamera::from(camera)));
    let rig = artifact::CameraRig { cameras: cameras.into(), take: None };
    let point = |dot: &Dot| Some(nalgebra::Point3::new(dot.at[0] + off - 80.0, dot.at[1] - 60.0, 100.0));
    let frame = |frame: i64| {
        let points: Vec<_> = dots_at(frame).iter().map(point).collect();
        artifact::MarkerFrame { frame, status: vec![artifact::SampleStatus::Measured; points.len()], points }
    };
    let take = id.to_string();
    let take = Some(artifact::TakeRef { take, session: "s".into(), sha256: "0".repeat(64) });
    let unit = artifact::Unit::Mm;
    let header = artifact::MarkerHeader { unit, markers: scene::names(&grid()), rate: None, take };
    let guide = artifact::Trajectories { header, frames: (1001..1001 + FRAMES).map(frame).collect() };
    let path = folder.join("guide.jsonl");
    guide.write::<artifact::Trajectories3d>(&path).unwrap().publish().unwrap();
    write_document(&folder.join("cameras.json"), &rig).unwrap().publish().unwrap();
}

#[test]
fn a_guide_is_held_against_the_labels() {
    let folder = take();
    let guided = [&TRACK[..], &["--guide", "guide.jsonl", "--cameras", "cameras.json"]].concat();
    for (off, said) in [(8.0, "m1: 8."), (500.0, "m1: outside the image")] {
        write_guide(folder.path(), off, "t");
        assert_refused(&folder, &guided, &["guide.jsonl", "the labels of frame 1004", said, "to do"]);
    }
    let said = |off: f64| {
        write_guide(folder.path(), off, "t");
        let output = call(&folder, &guided);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stderr).to_string()
    };
    assert!(said(3.0).contains("median distance, m1: 3.") && said(3.0).contains("have no dot there"));
    let good = said(0.3);
    assert!(good.contains("guide found: 60") && !good.contains("warning"), "{good}");
}

/// A marker without a label is found by the guide; where the guide has it from this camera alone, only for a moment.
#[test]
fn what_only_the_camera_itself_told_the_guide_is_not_kept_for_a_moment() {
    let folder = take();
    write_labels(folder.path(), |places| {
        places.remove("d05");
    });
    let path = folder.path().join("guide.jsonl");
    // At the ends of so short a take too few images are around.
    for (status, seen) in [(artifact::SampleStatus::Measured, 3), (artifact::SampleStatus::SingleCamera, 0)] {
        write_guide(folder.path(), 0.3, "t");
        let mut guide = artifact::Trajectories::read::<artifact::Trajectories3d>(&path).unwrap();
        guide.frames.iter_mut().for_each(|frame| frame.status[5] = status);
        guide.write::<artifact::Trajectories3d>(&path).unwrap().publish().unwrap();
        let guided = [&TRACK[..], &["--guide", "guide.jsonl", "--cameras", "cameras.json"]].concat();
        assert!(call(&folder, &guided).status.success());
        let count = |marker: usize| {
            let sample = |frame: &Tracks2dFrame| frame.cameras[0].as_ref()?[marker];
            let found = tracks(&folder).iter().filter_map(sample).collect::<Vec<_>>();
            found.iter().filter(|sample| sample.state == TrackState::Seen).count()
        };
        assert_eq!((count(5), count(6)), (seen, 6), "{status:?}");
    }
}

/// A second camera that has no labels: named without a guide, tracked with one.
#[test]
fn the_guide_labels_a_camera_without_labels() {
    let folder = take();
    let path = folder.path().join("frames.json");
    let mut frames: Frames = artifact::read_document(&path).unwrap();
    frames.cameras.insert("m2".into(), frames.cameras["m1"].clone());
    write_document(&path, &frames).unwrap().publish().unwrap();
    let output = call(&folder, &TRACK);
    assert!(
        String::from_utf8_lossy(&output.stderr)
            .contains("not tracked, with no labels in their image of frame 1004: m2")
    );
    write_guide(folder.path(), 0.3, "t");
    let guided = [&TRACK[..], &["--guide", "guide.jsonl", "--cameras", "cameras.json"]].concat();
    assert!(call(&folder, &guided).status.success());
    let reader = FrameReader::<Tracks2d>::open(&folder.path().join("tracks.jsonl")).unwrap();
    assert_eq!(reader.header().cameras, ["m1", "m2"]);
    let last = reader.last().unwrap().unwrap();
    let samples = |camera: usize| last.cameras[camera].iter().flatten().map(|sample| sample.unwrap());
    assert_eq!(samples(0).count(), 12);
    for (a, b) in samples(0).zip(samples(1)) {
        // Labels a little apart teach a little other paint.
        assert!((a.at - b.at).norm() < 1e-4 && a.state == b.state, "{a:?} {b:?}");
    }
}

/// Files of another take are refused; of the same take, before its manifest was changed, they are used with a warning.
#[test]
fn a_changed_manifest_is_a_warning() {
    let folder = take();
    let stamp = |file: &str, take: &str, sha256: String| {
        let path = folder.path().join(file);
        let take = Some(artifact::TakeRef { take: take.into(), session: "s".into(), sha256 });
        match file {
            "labels.json" => {
                let labels: Labels = artifact::read_document(&path).unwrap();
                write_document(&path, &Labels { take, ..labels }).unwrap().publish().unwrap();
            }
            _ => {
                let frames: Frames = artifact::read_document(&path).unwrap();
                write_document(&path, &Frames { take, ..frames }).unwrap().publish().unwrap();
            }
        }
    };
    stamp("frames.json", "t", "0".repeat(64));
    stamp("labels.json", "u", "0".repeat(64));
    assert_refused(&folder, &TRACK, &["labels.json", "is of take u", "of take t", "to do"]);
    stamp("labels.json", "t", "1".repeat(64));
    let output = call(&folder, &TRACK);
    let said = String::from_utf8_lossy(&output.stderr).to_string();
    assert!(output.status.success() && said.contains("the manifest of take t was changed"), "{said}");
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
    let words = [
        "detect", "--camera", "m1", "--frame", "1004", "--color", "1c3d86", "--out", "n.png", "--csv",
        "n.csv",
    ];
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
