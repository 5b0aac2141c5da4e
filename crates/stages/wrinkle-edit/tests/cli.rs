//! The program as its users meet it: lists on files and streams, pictures, bad input.
#![allow(clippy::unwrap_used, clippy::panic, clippy::disallowed_methods, reason = "tests may")]

mod scene;

use artifact::picture::{read_rgb, write_rgb8};
use artifact::{
    CameraFrames, Clock, FrameReader, FrameRun, FrameWriter, Frames, Rate, Sections, SectionsFrame,
    SectionsHeader, Shown, SyncCamera, SyncFrame, SyncHeader, SyncSource, TimeBase, Wrinkles2d,
    Wrinkles2dFrame, Wrinkles2dHeader, write_document,
};
use assert_cmd::Command;
use scene::{FRAMES, head, moments};
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;

const SIZE: [usize; 2] = [160, 200];

fn write_measured(folder: &Path) {
    let (cameras, wrinkles, rate) = (head().cameras, head().wrinkles, Some(Rate::per_second(50)));
    let header = SectionsHeader {
        cameras: cameras.clone(),
        wrinkles: wrinkles.clone(),
        profile: head().profile,
        rate,
        take: None,
    };
    let mut sections = FrameWriter::<Sections>::create(&folder.join("sections.jsonl"), header).unwrap();
    let header = Wrinkles2dHeader { cameras, wrinkles, rate, take: None };
    let mut curves = FrameWriter::<Wrinkles2d>::create(&folder.join("wrinkles.jsonl"), header).unwrap();
    for moment in moments() {
        let frame = moment.frame;
        sections.write(&SectionsFrame { frame, sections: moment.sections.unwrap() }).unwrap();
        curves.write(&Wrinkles2dFrame { frame, curves: moment.curves.unwrap() }).unwrap();
    }
    sections.finish().unwrap().publish().unwrap();
    curves.finish().unwrap().publish().unwrap();
}

fn write_images(folder: &Path) {
    let camera = CameraFrames {
        images: "w1/{frame:06}.png".into(),
        image_size: SIZE.map(|side| side as u32),
        transfer: "srgb".into(),
        bit_depth: 8,
        frames: FrameRun::runs(&FRAMES),
    };
    let frames = Frames { take: None, cameras: [("w1".to_string(), camera)].into() };
    write_document(&folder.join("frames.json"), &frames).unwrap().publish().unwrap();
    let rate = Rate::per_second(50);
    let source = SyncSource::Stated;
    let sync = SyncCamera { rate, every: 4, phase: 1001, offset_frames: 0.0, drift_ppm: 0.0, source };
    let header =
        SyncHeader { rate, clock: Clock::Trigger, cameras: [("w1".to_string(), sync)].into(), take: None };
    let mut writer = FrameWriter::<TimeBase>::create(&folder.join("sync.jsonl"), header).unwrap();
    for (index, frame) in FRAMES.into_iter().enumerate() {
        let shown = Some(Shown { index: index as i64, time_s: None, doubled: false });
        writer.write(&SyncFrame { frame, shows: [("w1".to_string(), shown)].into() }).unwrap();
        let path = folder.join(format!("w1/{frame:06}.png"));
        write_rgb8(&path, SIZE[0], SIZE[1], &[90, 70, 60].repeat(SIZE[0] * SIZE[1]))
            .unwrap()
            .publish()
            .unwrap();
    }
    writer.finish().unwrap().publish().unwrap();
}

fn take(list: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write_measured(folder.path());
    std::fs::write(folder.path().join("edits.txt"), list).unwrap();
    folder
}

fn call(folder: &TempDir, words: &str) -> Output {
    let mut command = Command::cargo_bin("wrinkle-edit").unwrap();
    command.current_dir(folder.path()).args(words.split_whitespace()).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[track_caller]
fn done(folder: &TempDir, words: &str) -> String {
    let output = call(folder, words);
    assert!(output.status.success(), "{}", said(&output));
    said(&output)
}

#[track_caller]
fn refused(folder: &TempDir, words: &str, parts: &[&str]) {
    let output = call(folder, words);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    for part in parts {
        assert!(said(&output).contains(part), "'{part}' is missing in: {}", said(&output));
    }
    assert!(!folder.path().join("out.jsonl").exists() && !folder.path().join("out-wrinkles.jsonl").exists());
}

fn bytes(folder: &TempDir, name: &str) -> String {
    std::fs::read_to_string(folder.path().join(name)).unwrap()
}

const APPLY: &str = "apply --sections sections.jsonl --edits edits.txt --out out.jsonl";
const BOTH: &str = "apply --sections sections.jsonl --wrinkles wrinkles.jsonl --edits edits.txt --out out.jsonl \
                    --out-wrinkles out-wrinkles.jsonl";

#[test]
fn an_empty_list_returns_the_same_bytes() {
    for list in ["", "wrinkle-edits/1\n# nothing yet\n"] {
        let folder = take(list);
        // Also where somebody else's program wrote them.
        let spaced = bytes(&folder, "sections.jsonl").replace("\"u\":", "\"u\": ");
        std::fs::write(folder.path().join("sections.jsonl"), &spaced).unwrap();
        done(&folder, BOTH);
        assert_eq!(bytes(&folder, "out.jsonl"), spaced);
        assert_eq!(bytes(&folder, "out-wrinkles.jsonl"), bytes(&folder, "wrinkles.jsonl"));
        assert!(folder.path().join("out.jsonl.prov.json").exists());
        std::fs::write(folder.path().join("sections.jsonl"), &spaced[..spaced.len() - 9]).unwrap();
        std::fs::remove_file(folder.path().join("out.jsonl")).unwrap();
        std::fs::remove_file(folder.path().join("out-wrinkles.jsonl")).unwrap();
        refused(&folder, BOTH, &["sections.jsonl", "line 6", "cut short"]);
    }
}

#[test]
fn the_short_cut_equals_the_list_and_streams_equal_files() {
    let folder = take("wrinkle-edits/1\nscale depth 2\n");
    done(&folder, APPLY);
    let listed = bytes(&folder, "out.jsonl");
    assert_ne!(listed, bytes(&folder, "sections.jsonl"));
    done(&folder, "apply --sections sections.jsonl --scale-depth 2 --out short.jsonl");
    assert_eq!(bytes(&folder, "short.jsonl"), listed);
    let output = Command::cargo_bin("wrinkle-edit")
        .unwrap()
        .current_dir(folder.path())
        .args(["apply", "--sections", "-", "--edits", "edits.txt", "--out", "-", "--threads", "3"])
        .write_stdin(bytes(&folder, "sections.jsonl"))
        .output()
        .unwrap();
    assert_eq!(String::from_utf8(output.stdout).unwrap(), listed);
    std::fs::write(
        folder.path().join("edits.txt"),
        "wrinkle-edits/1\nscale depth 2\nscale depth 3\nscale width 0.5",
    )
    .unwrap();
    done(&folder, APPLY);
    done(&folder, "apply --sections short.jsonl --scale-depth 3 --scale-width 0.5 --out two.jsonl");
    assert_eq!(bytes(&folder, "two.jsonl"), bytes(&folder, "out.jsonl"));
}

#[test]
fn curves_go_with_their_sections() {
    let folder = take(
        "wrinkle-edits/1\nrename smile grin\ndelete brow_2\nscale depth 0.5 frames 1005-1013 ease 2 smooth\n\
         draw new in w1 at 1005 through 9,9 30,12 60,9 width 4 depth 2 follow brow_1\n",
    );
    let summary = done(&folder, BOTH);
    assert!(summary.contains("edits: 4") && !summary.contains("warning"), "{summary}");
    let sections = FrameReader::<Sections>::open(&folder.path().join("out.jsonl")).unwrap();
    let curves = FrameReader::<Wrinkles2d>::open(&folder.path().join("out-wrinkles.jsonl")).unwrap();
    let ids = |list: &[artifact::Wrinkle]| list.iter().map(|wrinkle| wrinkle.id.clone()).collect::<Vec<_>>();
    assert_eq!(ids(&sections.header().wrinkles), ["brow_1", "grin", "new"]);
    assert_eq!(sections.header().wrinkles, curves.header().wrinkles);
    for (sections, curves) in sections.map(Result::unwrap).zip(curves.map(Result::unwrap)) {
        let keys = |all: Vec<&String>| all.into_iter().cloned().collect::<Vec<_>>();
        assert_eq!(
            keys(sections.sections["w1"].keys().collect()),
            keys(curves.curves["w1"].keys().collect())
        );
    }
    let record = bytes(&folder, "out.jsonl.prov.json");
    assert!(record.contains("\"rename smile grin\"") && !record.contains('#'), "{record}");
}

#[test]
fn faults_name_the_file_and_the_line_and_leave_nothing() {
    for (list, parts) in [
        (
            "wrinkle-edits/1\n\nscale depth 2 of chin\n",
            &["edits.txt", "line 3", "no wrinkle 'chin'", "brow_1"][..],
        ),
        (
            "wrinkle-edits/1\nscale depth 2 frames 2000-2010\n",
            &["edits.txt", "line 2", "no frame in 2000-2010"],
        ),
        (
            "wrinkle-edits/1\nrename smile brow_2 frames 1001\n",
            &["edits.txt", "line 2", "frame 1001", "brow_2 already"],
        ),
        ("wrinkle-edits/7\n", &["edits.txt", "line 1", "wrinkle-edits/7"]),
    ] {
        refused(&take(list), BOTH, parts);
    }
    let folder = take("");
    refused(
        &folder,
        "apply --sections sections.jsonl --scale-depth -2 --out out.jsonl",
        &["--scale-depth", "-2"],
    );
    refused(
        &folder,
        "apply --sections wrinkles.jsonl --scale-depth 2 --out out.jsonl",
        &["wrinkles-2d/1", "sections/1"],
    );
    refused(
        &folder,
        "apply --sections sections.jsonl --scale-depth 2 --out sections.jsonl",
        &["written over an input"],
    );
    refused(&folder, "apply --sections - --edits - --out out.jsonl", &["two inputs"]);
    let renamed = bytes(&folder, "wrinkles.jsonl").replace("smile", "grin");
    std::fs::write(folder.path().join("wrinkles.jsonl"), renamed).unwrap();
    refused(&folder, BOTH, &["wrinkles.jsonl", "grin", "smile", "measured on"]);
    for words in [
        "apply --sections sections.jsonl --out out.jsonl",
        "apply --sections sections.jsonl --scale-depth two --out out.jsonl",
    ] {
        assert_eq!(call(&folder, words).status.code(), Some(2), "{words}");
    }
}

#[test]
fn a_frame_is_drawn_before_and_after() {
    let folder = take("wrinkle-edits/1\nscale depth 3 of brow_1\n");
    write_images(folder.path());
    done(&folder, APPLY);
    let source = "show --frames frames.json --sync sync.jsonl --camera w1 --scale 2 --out p.png --before sections.jsonl";
    done(&folder, &format!("{source} --after out.jsonl --frame 1005 --wrinkle brow_*"));
    let both = read_rgb(&folder.path().join("p.png")).unwrap();
    let blue = both.to_8_bits().chunks(3).filter(|pixel| pixel[2] > 200 && pixel[0] < 120).count();
    assert!(blue > 60, "{blue} pixels of an edited wrinkle");
    done(&folder, &format!("{source} --frame 1005 --wrinkle brow_*"));
    let one = read_rgb(&folder.path().join("p.png")).unwrap();
    assert!(one.width * one.height < both.width * both.height);
    for name in ["p.png", "out.jsonl"] {
        std::fs::remove_file(folder.path().join(name)).unwrap();
    }
    refused(&folder, &format!("{source} --frame 1006"), &["sections.jsonl", "no sections of frame 1006"]);
    refused(&folder, &format!("{} --frame 1005", source.replace("w1", "w7")), &["no camera w7", "w1, w2"]);
    assert!(!folder.path().join("p.png").exists());
}

#[test]
fn help_is_as_it_was() {
    for name in ["apply", "show"] {
        let mut command = Command::cargo_bin("wrinkle-edit").unwrap();
        let output = command.args([name, "--help"]).env("COLUMNS", "120").output().unwrap();
        insta::assert_snapshot!(name, String::from_utf8(output.stdout).unwrap());
    }
}
