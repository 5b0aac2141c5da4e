//! The binary: pictures, side-cars, refusals.

#![allow(clippy::unwrap_used, reason = "a test may fail by panic")]

mod scene;

use artifact::{FileRef, LargeScale, MeshRef, Unit, pc2};
use assert_cmd::Command;
use mesh::Mesh;
use scene::sphere;
use std::path::Path;
use tempfile::TempDir;

fn preview(folder: &Path) -> Command {
    let mut command = assert_cmd::cargo::cargo_bin_cmd!("preview");
    command.current_dir(folder);
    command
}

/// A folder with `rest.obj` (cm), `bulged.obj`, and `take.json` + `take.pc2`: frames 1001, 1002, 1005, 1006.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let rest = sphere(80.0, 12);
    let bulged = |by: f64| {
        let moved =
            rest.positions.iter().map(|p| if p.z > 40.0 { p + p.coords.normalize() * by } else { *p });
        rest.with_positions(moved.collect())
    };
    let write =
        |name: &str, mesh: &Mesh| artifact::write_mesh(&at(name), mesh, Unit::Cm).unwrap().publish().unwrap();
    write("rest.obj", &rest);
    write("bulged.obj", &bulged(4.0));
    write("other.obj", &sphere(80.0, 10));
    let mut cache = pc2::Writer::create(&at("take.pc2"), rest.positions.len(), 1001).unwrap();
    for by in [0.0, 1.0, 2.0, 3.0] {
        let mesh = bulged(by);
        let coordinates: Vec<f32> =
            mesh.positions.iter().flat_map(|p| [p.x, p.y, p.z]).map(|x| (x / 10.0) as f32).collect();
        cache.write(&coordinates).unwrap();
    }
    cache.finish().unwrap().publish().unwrap();
    let file = FileRef { name: "rest.obj".into(), sha256: artifact::sha256(&at("rest.obj")).unwrap() };
    let index = LargeScale {
        mesh: MeshRef { file, unit: Unit::Cm, vertex_count: rest.positions.len() },
        cache: "take.pc2".into(),
        form: artifact::SequenceForm::Pc2,
        rate: None,
        frames: vec![1001, 1002, 1005, 1006],
        take: None,
    };
    artifact::write_document(&at("take.json"), &index).unwrap().publish().unwrap();
    folder
}

fn size_of(path: &Path) -> (u32, u32) {
    image::load_from_memory(&artifact::read_bytes(path).unwrap()).unwrap().to_rgb8().dimensions()
}

const SMALL: [&str; 8] = ["--mesh", "rest.obj", "--unit", "cm", "--size", "96", "--out", "sheet.png"];

#[test]
fn help() {
    let output = assert_cmd::cargo::cargo_bin_cmd!("preview").arg("--help").output().unwrap();
    insta::assert_snapshot!(String::from_utf8(output.stdout).unwrap());
    let output = assert_cmd::cargo::cargo_bin_cmd!("preview").args(["tile", "--help"]).output().unwrap();
    insta::assert_snapshot!("help_tile", String::from_utf8(output.stdout).unwrap());
}

#[test]
fn a_mesh_becomes_a_picture_with_a_side_car() {
    let folder = folder();
    preview(folder.path()).args(SMALL).assert().success();
    assert_eq!(size_of(&folder.path().join("sheet.png")), (96, 96));
    let side_car = artifact::read_text(&folder.path().join("sheet.png.prov.json")).unwrap();
    assert!(side_car.contains("rest.obj") && !side_car.contains(folder.path().to_str().unwrap()));
}

#[test]
fn the_side_car_says_which_frames_were_asked_for() {
    let folder = folder();
    let arguments = ["--sequence", "take.json", "--frames", "1002-", "--count", "2"];
    preview(folder.path()).args(SMALL).args(arguments).assert().success();
    let side_car = artifact::read_text(&folder.path().join("sheet.png.prov.json")).unwrap();
    let flat: String = side_car.split_whitespace().collect();
    assert!(flat.contains(r#""frames":["1002-"],"count":2,"format":"png""#), "{side_car}");
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let folder = folder();
    let bytes = |threads: &str| {
        preview(folder.path())
            .args(SMALL)
            .args(["--sequence", "take.json", "--color", "displacement", "--view", "front", "--view", "left"])
            .args(["--threads", threads])
            .assert()
            .success();
        artifact::read_bytes(&folder.path().join("sheet.png")).unwrap()
    };
    assert_eq!(bytes("1"), bytes("3"));
}

#[test]
fn a_sequence_becomes_a_sheet_with_numbers() {
    let folder = folder();
    let output = preview(folder.path())
        .args(SMALL)
        .args(["--sequence", "take.json", "--frames", "1002-1006", "--reference", "take.json", "--json"])
        .output()
        .unwrap();
    assert!(output.status.success());
    let summary = String::from_utf8(output.stdout).unwrap();
    assert!(summary.contains(r#"{"shot":"frame 1005","mean":0.0,"p95":0.0,"max":0.0}"#), "{summary}");
    assert!(!summary.contains("frame 1001"), "{summary}");

    let output = preview(folder.path())
        .args(SMALL)
        .args(["--sequence", "take.json", "--frames", "1001,1006", "--color", "displacement", "--json"])
        .output()
        .unwrap();
    let summary = String::from_utf8(output.stdout).unwrap();
    let max: f64 =
        summary.split(r#""max_mm":"#).nth(1).unwrap().split([',', '}']).next().unwrap().parse().unwrap();
    assert!((max - 3.0).abs() < 1e-5, "cm in the cache, mm in the numbers: {max}");
}

#[test]
fn a_bare_cache_is_numbered_from_its_start_frame() {
    let folder = folder();
    let run = |frames: &str| {
        preview(folder.path()).args(SMALL).args(["--sequence", "take.pc2", "--frames", frames]).assert()
    };
    run("1004").success();
    run("1006").failure().code(1);
}

#[test]
fn poses_are_drawn_side_by_side() {
    let folder = folder();
    preview(folder.path())
        .args(SMALL)
        .args(["--pose", "rest.obj", "bulged.obj", "--color", "displacement", "--title", "Two poses"])
        .assert()
        .success();
    let (width, height) = size_of(&folder.path().join("sheet.png"));
    assert!(width > 2 * 96 && height > 96 + 20, "{width} × {height}");
}

/// A picture of one colour.
fn paint(path: &Path, [width, height]: [u32; 2], color: [u8; 3]) {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let picture = image::RgbImage::from_pixel(width, height, image::Rgb(color));
    picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    artifact::stage_bytes(path, bytes.get_ref()).unwrap().publish().unwrap();
}

#[test]
fn pictures_are_fitted_into_the_cells_of_a_sheet() {
    let folder = tempfile::tempdir().unwrap();
    paint(&folder.path().join("wide.png"), [80, 40], [200, 0, 0]);
    paint(&folder.path().join("tall.png"), [30, 90], [0, 0, 200]);
    let pictures = ["wide.png", "tall.png", "wide.png@10,0,40,40"];
    let rest = ["--size", "40", "--columns", "2", "--name", "one", "--name", "two", "--out", "sheet.png"];
    preview(folder.path()).arg("tile").args(pictures).args(rest).assert().success();
    let sheet =
        image::load_from_memory(&artifact::read_bytes(&folder.path().join("sheet.png")).unwrap()).unwrap();
    let sheet = sheet.to_rgb8();
    let count = |color: [u8; 3]| sheet.pixels().filter(|pixel| pixel.0 == color).count();
    // Half as large: 40 × 20; the part keeps its pixels: 40 × 40. The tall one: 13 × 40.
    assert_eq!((count([200, 0, 0]), count([0, 0, 200])), (800 + 1600, 13 * 40));
    let side_car = artifact::read_text(&folder.path().join("sheet.png.prov.json")).unwrap();
    assert!(side_car.contains("preview tile") && side_car.contains("tall.png"), "{side_car}");
}

#[test]
fn a_sheet_of_what_is_no_picture_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    paint(&folder.path().join("a.png"), [8, 8], [1, 2, 3]);
    artifact::stage_bytes(&folder.path().join("b.png"), b"no picture").unwrap().publish().unwrap();
    let cases: [(&[&str], i32, &str); 5] = [
        (&["b.png"], 1, "b.png: is no PNG picture"),
        (&["none.png"], 1, "none.png: cannot read"),
        (&["a.png@4,0,5,5"], 1, "a.png: the part 4,0,5,5 is not within its 8 × 8 pixels"),
        (&["a.png@0,0,0,5"], 2, "empty part"),
        (&["a.png", "--name", "x", "--name", "y"], 1, "--name is given 2 times for 1 pictures"),
    ];
    for (arguments, code, message) in cases {
        let output =
            preview(folder.path()).arg("tile").args(arguments).args(["--out", "bad.png"]).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(message), "{arguments:?} said: {said}");
        assert!(!folder.path().join("bad.png").exists());
    }
}

/// Arguments, exit code, and what the message must say.
const REFUSALS: [(&[&str], i32, &str); 12] = [
    (&["--mesh", "rest.obj"], 1, "rest.obj: its unit is not stated"),
    (&["--mesh", "none.obj", "--unit", "cm"], 1, "none.obj: cannot read"),
    (
        &["--mesh", "rest.obj", "--unit", "cm", "--pose", "other.obj"],
        1,
        "other.obj: has 182 vertices, but rest.obj has 266",
    ),
    (
        &["--mesh", "rest.obj", "--unit", "cm", "--sequence", "take.json", "--frames", "1003"],
        1,
        "take.json: has no frame 1003",
    ),
    (
        &["--mesh", "rest.obj", "--unit", "mm", "--sequence", "take.json"],
        1,
        "take.json: was made with its mesh in cm, not in mm",
    ),
    (
        &["--mesh", "other.obj", "--unit", "cm", "--sequence", "take.json"],
        1,
        "take.json: has 266 vertices, but other.obj has 182",
    ),
    (&["--mesh", "rest.obj", "--unit", "cm", "--sequence", "cut.pc2"], 1, "cut.pc2, byte 28"),
    (&["--mesh", "rest.obj", "--unit", "cm", "--color", "error"], 1, "give --reference"),
    (&["--mesh", "rest.obj", "--unit", "cm", "--reference", "take.json"], 1, "needs a --sequence"),
    (
        &["--mesh", "rest.obj", "--unit", "cm", "--up", "y", "--front", "-y"],
        1,
        "up +y and front -y lie on the same axis",
    ),
    (&["--mesh", "rest.obj", "--unit", "cm", "--range-mm", "5-1"], 2, "above its low end"),
    (&["--mesh", "rest.obj", "--unit", "cm", "--zoom", "2"], 2, "--focus"),
];

#[test]
fn refusals_name_the_file_and_leave_nothing() {
    let folder = folder();
    let cut = artifact::read_bytes(&folder.path().join("take.pc2")).unwrap();
    artifact::stage_bytes(&folder.path().join("cut.pc2"), &cut[..cut.len() / 2]).unwrap().publish().unwrap();
    for (arguments, code, message) in REFUSALS {
        let output = preview(folder.path()).args(arguments).args(["--out", "bad.png"]).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        assert!(said.contains(message), "{arguments:?} said: {said}");
        assert!(!folder.path().join("bad.png").exists() && !folder.path().join("bad.png.prov.json").exists());
    }
}

#[test]
fn a_real_head_fills_its_picture() {
    let Some(head) = testkit::data("ict_facekit_dev/jaw_open.obj") else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut command = preview(folder.path());
    command
        .arg("--mesh")
        .arg(&head)
        .args(["--unit", "cm", "--size", "200", "--out", "head.png"])
        .assert()
        .success();
    let picture = image::load_from_memory(&artifact::read_bytes(&folder.path().join("head.png")).unwrap())
        .unwrap()
        .to_rgb8();
    let seen = picture.pixels().filter(|pixel| pixel.0 != [246, 246, 247]).count() as f64;
    let share = seen / f64::from(200 * 200);
    assert!((0.3..0.6).contains(&share), "the head covers {share} of the picture");
    let hole = picture.pixels().filter(|pixel| pixel.0.iter().all(|&level| level < 80)).count();
    assert!(hole > 100, "the open mouth is dark in {hole} pixels only");
}
