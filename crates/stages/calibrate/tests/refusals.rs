//! What does not fit together is refused by name, before long work, and nothing is written.
#![allow(clippy::disallowed_methods, clippy::unwrap_used, reason = "tests write and read files of their own")]

mod rig;

use artifact::{CameraRig, FrameWriter, Sample2d, Tracks2d, Tracks2dFrame, Tracks2dHeader, write_document};
use assert_cmd::Command;
use camera::Camera;
use nalgebra::Vector2;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tempfile::TempDir;

/// Runs the binary: exit code, standard error.
fn call(folder: &TempDir, line: &str) -> (i32, String) {
    let words = line.split_whitespace();
    let output =
        Command::cargo_bin("calibrate").unwrap().current_dir(folder.path()).args(words).output().unwrap();
    (output.status.code().unwrap(), String::from_utf8_lossy(&output.stderr).into_owned())
}

fn assert_refused(folder: &TempDir, line: &str, parts: &[&str]) {
    let (code, said) = call(folder, line);
    assert_eq!(code, 1, "{line}: {said}");
    assert!(parts.iter().all(|part| said.contains(part)), "{line}: {parts:?} in {said}");
    assert!(!folder.path().join("out.json").exists(), "{line}");
}

/// A take of the rig's cameras, their sizes multiplied.
fn take(folder: &TempDir, name: &str, factor: u32) {
    let camera = |(id, camera): (&&str, &Camera)| {
        let [width, height] = camera.image_size.map(|side| factor * side);
        format!(
            r#"{{"id":"{id}","image_size":[{width},{height}],"transfer":"srgb","bit_depth":8,"rate":{{"frames":50,"seconds":1}},
            "footage":{{"file":null,"images":"footage/{id}/{{frame:06}}.png","first":0,"timestamps":null}}}}"#
        )
    };
    let cameras: Vec<String> = rig::IDS.iter().zip(&rig::cameras(5)).map(camera).collect();
    let text = format!(
        r#"{{"schema":"take/2","data":{{"subject":"s","session":"d","take":"t","rate":{{"frames":50,"seconds":1}},
        "start_timecode":null,"first_frame":0,"clock":"trigger","cameras":[{}],"mesh_unit":"mm","mesh_up":"y",
        "consent":{{"licence":"test","credit":null,"notes":null}}}}}}"#,
        cameras.join(",")
    );
    std::fs::write(folder.path().join(name), text).unwrap();
}

/// Cameras, their sizes multiplied.
fn cameras(folder: &TempDir, name: &str, factor: u32) {
    let camera = |(id, camera): (&&str, Camera)| {
        let image_size = camera.image_size.map(|side| factor * side);
        (id.to_string(), Camera { image_size, ..camera }.into())
    };
    let rig = CameraRig { cameras: rig::IDS.iter().zip(rig::cameras(5)).map(camera).collect(), take: None };
    write_document(&folder.path().join(name), &rig).unwrap().publish().unwrap();
}

/// A wand's points as tracks.
fn wand(folder: &TempDir) {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (all, path) = (rig::cameras(5), rig::wand_path(120, 90.0, 5));
    let seen: Vec<_> = all.iter().map(|camera| rig::track(camera, &path, 0.05, &mut rng)).collect();
    let header = Tracks2dHeader {
        cameras: rig::IDS.iter().map(ToString::to_string).collect(),
        markers: vec!["wand".to_string()],
        rate: None,
        take: None,
    };
    let mut writer = FrameWriter::<Tracks2d>::create(&folder.path().join("wand.jsonl"), header).unwrap();
    for frame in 0..path.len() {
        let sample =
            |track: &Vec<Option<Vector2<f64>>>| Some(vec![track[frame].map(|at| Sample2d::seen(at.into()))]);
        let cameras = seen.iter().map(sample).collect();
        writer.write(&Tracks2dFrame { frame: frame as i64, cameras }).unwrap();
    }
    writer.finish().unwrap().publish().unwrap();
}

/// Corners of one camera in a view.
fn corners(folder: &TempDir, name: &str, camera: &str, size: [u32; 2], square: &str, at: f64) {
    let text = format!(
        "{{\"schema\":\"board-corners/1\",\"data\":{{\"board\":{{\"chessboard\":{{\"columns\":3,\"rows\":2,\"square_mm\":{square}}}}},\
         \"cameras\":{{\"{camera}\":{size:?}}},\"take\":null}}}}\n{{\"frame\":0,\"corners\":{{\"{camera}\":[[0,{at},4]]}}}}\n"
    );
    std::fs::write(folder.path().join(name), text).unwrap();
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

#[test]
fn corners_are_checked_against_the_take() {
    let folder = folder();
    corners(&folder, "c.jsonl", "m1", [64, 48], "10", 4.0);
    take(&folder, "take.json", 1);
    let line = "board --corners c.jsonl --take take.json --out out.json";
    assert_refused(&folder, line, &["camera m1", "64 × 48 px", "656 × 490 px"]);
    assert_refused(&folder, "board --corners c.jsonl --take no.json --out out.json", &["no.json"]);
    let line = "board --corners c.jsonl --without m9 --out out.json";
    assert_refused(&folder, line, &["--without m9", "no such camera"]);
    let line = "board --corners c.jsonl --without m1 --out out.json";
    assert_refused(&folder, line, &["no camera saw the board"]);
}

#[cfg(feature = "detect")]
#[test]
fn what_is_said_of_pictures_is_not_said_of_corners() {
    let folder = folder();
    corners(&folder, "c.jsonl", "m1", [64, 48], "10", 4.0);
    for more in ["--chessboard 3x3 --square-mm 9", "--board b.json", "--name x{frame}.png", "--every 2"] {
        let (code, said) = call(&folder, &format!("board --corners c.jsonl --out out.json {more}"));
        assert!(code == 2 && said.contains("cannot be used with"), "{more}: {code} {said}");
    }
}

#[test]
fn corners_outside_of_the_image_and_impossible_squares_are_named() {
    let folder = folder();
    corners(&folder, "c.jsonl", "m1", [64, 48], "10", 9999.0);
    let parts = ["line 2", "frame 0, camera m1, corner 0", "outside of the image of 64 × 48 px"];
    assert_refused(&folder, "board --corners c.jsonl --out out.json", &parts);
    corners(&folder, "c.jsonl", "m1", [64, 48], "1e-30", 9.0);
    assert_refused(&folder, "board --corners c.jsonl --out out.json", &["squares of 1e-30 mm"]);
}

#[test]
fn a_doctor_that_is_shown_nothing_says_so() {
    let folder = folder();
    cameras(&folder, "cameras.json", 1);
    assert_refused(&folder, "doctor cameras.json", &["nothing to examine", "--tracks"]);
    corners(&folder, "c.jsonl", "cam_0", [656, 490], "10", 4.0);
    assert_refused(&folder, "doctor cameras.json --corners c.jsonl", &["camera cam_0", "no such camera"]);
    wand(&folder);
    let line = "doctor cameras.json --tracks wand.jsonl --scale 0:100000=100";
    assert_refused(&folder, line, &["--scale 0:100000=100", "to do: name two markers"]);
}

#[test]
fn image_sizes_are_checked_by_refine_and_wand() {
    let folder = folder();
    wand(&folder);
    (1..=2).for_each(|factor| cameras(&folder, &format!("cameras{factor}.json"), factor));
    (1..=2).for_each(|factor| take(&folder, &format!("take{factor}.json"), factor));
    let line = "refine --cameras cameras2.json --tracks wand.jsonl --take take1.json --out out.json";
    assert_refused(&folder, line, &["cameras2.json", "camera m1", "1312 × 980 px"]);
    let (code, said) = call(&folder, "refine --cameras cameras2.json --tracks wand.jsonl --out some.json");
    assert!(code == 0 && said.contains("camera m1: all its points lie above and left"), "{code} {said}");
    let line = "wand wand.jsonl --take take2.json --scale unknown --intrinsics cameras1.json --out out.json";
    assert_refused(&folder, line, &["camera m1", "1312 × 980 px"]);
    let line = "wand wand.jsonl --name foo --take take1.json --scale unknown --out out.json";
    assert_refused(&folder, line, &["--name", "no folder"]);
}

#[test]
fn outputs_are_checked_before_long_work() {
    let folder = folder();
    wand(&folder);
    cameras(&folder, "cameras.json", 1);
    let under = "refine --cameras cameras.json --tracks wand.jsonl --out wand.jsonl/x.json";
    assert_refused(&folder, under, &["there is no folder wand.jsonl"]);
    let over = "refine --cameras cameras.json --tracks wand.jsonl --out cameras.json";
    assert_refused(&folder, over, &["would be written over an input"]);
    std::fs::create_dir(folder.path().join("full")).unwrap();
    let line = "wand wand.jsonl --intrinsics cameras.json --scale 850 --out full";
    assert_refused(&folder, line, &["full: is a folder"]);
}

#[test]
fn what_is_not_determined_and_not_in_millimetres_is_told() {
    let folder = folder();
    wand(&folder);
    cameras(&folder, "cameras.json", 1);
    let all = "distortion,focal,aspect,center,pose";
    let few = "refine --cameras cameras.json --tracks wand.jsonl --frames 0-24 --out free.json --free";
    let (code, said) = call(&folder, &format!("{few} {all}"));
    assert!(code == 0 && said.contains("the points hardly tell what was set free"), "{said}");
    let (code, said) = call(&folder, &format!("{few} pose"));
    assert!(code == 0 && !said.contains("hardly tell"), "{said}");
    let (code, said) = call(
        &folder,
        "wand wand.jsonl --intrinsics cameras.json --scale unknown --out w.json --out-tracks t.jsonl",
    );
    assert!(
        code == 0 && said.contains("the scale is not known") && said.contains("scale: unknown"),
        "{said}"
    );
    assert!(folder.path().join("t.jsonl").exists());
}
