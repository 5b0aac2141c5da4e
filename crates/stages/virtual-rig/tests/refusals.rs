//! What `virtual-rig make` refuses: by exit code, with a message that names the place, and with nothing left behind.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod rig;

use rig::{call, plant, refused, succeed};
use serde_json::{Value, json};
use tempfile::TempDir;
use virtual_rig::body::Body;
use virtual_rig::body::place::LANDMARKS;

/// A scenario file with one change.
fn changed(folder: &TempDir, name: &str, pointer: &str, value: Value) {
    let printed = succeed(folder, "scenario --length tiny").stdout;
    let mut scenario: Value = serde_json::from_slice(&printed).unwrap();
    *scenario.pointer_mut(pointer).unwrap() = value;
    plant(folder, name, &scenario.to_string());
}

fn camera(change: &str, value: Value) -> Value {
    let mut camera = json!({"role": "mocap", "image_size": [320, 240], "focal_px": 700.0, "distance_mm": 720.0,
        "azimuth_deg": 0.0, "elevation_deg": 0.0, "target_mm": [0.0, 12.0, 45.0]});
    camera[change] = value;
    json!({ "m1": camera })
}

#[test]
fn broken_scenarios_are_refused_by_place() {
    let folder = tempfile::tempdir().unwrap();
    refused(&folder, 1, "--scenario nobody", &["--scenario nobody", "clean, standard, hard", "to do: "]);
    refused(&folder, 1, "--scenario nothing.json", &["nothing.json", "cannot read"]);
    plant(&folder, "s.json", "{\"schema\":\"scenario/1\",\"data\":{\n\"name\":\"a\",\n\"seeds\":1}}");
    refused(&folder, 1, "--scenario s.json", &["s.json, line 3, column", "`seeds`", "`seed`"]);
    for (pointer, value, place) in [
        ("/data/hands/radius_mm", json!(-1.0), "hands"),
        ("/data/paint/dot_radius_mm", json!([1.0, 500.0]), "paint.dot_radius_mm"),
        ("/data/extent/wrinkle_every", json!(0), "extent.wrinkle_every"),
        ("/data/head/shift_mm", json!(1e9), "head.shift_mm"),
        ("/data/cameras", camera("focal_px", json!(-700.0)), "cameras.m1.focal_px"),
        ("/data/cameras", camera("image_size", json!([0, 240])), "cameras.m1.image_size"),
        ("/data/light/gradient", json!([0.9, 0.9, 0.0]), "light.gradient"),
        ("/data/lines/paints", json!([]), "lines.paints"),
        ("/data/lines/width", json!(9.0), "lines.width"),
        ("/data/folds/reach", json!(1.0), "folds.reach"),
        ("/data/extent/wrinkle_phase", json!(4), "extent.wrinkle_phase"),
        ("/data/events", json!([event(0.0)]), "events[0].rise_s"),
        (
            "/data/performance",
            json!({"events": {"events": [event(0.0)]}}),
            "performance.events.events[0].rise_s",
        ),
        ("/data/performance", json!({"recording": {"speed": -1.0}}), "performance.recording."),
        ("/data/paint/texture", json!(0.5), "paint.texture: is a share from 0 to 0.2"),
        ("/data/crease_mm", json!(0.001), "crease_mm: must lie between 0.02 and 5 mm, or be 0"),
        ("/data/sensor/bits", json!(16), "sensor.bits: is 16"),
        ("/data/flash", flash(1, -3.0), "flash.factor"),
        ("/data/flash", flash(1, 1e300), "flash.factor"),
    ] {
        changed(&folder, "s.json", pointer, value);
        refused(&folder, 1, "--scenario s.json", &["s.json", place]);
    }
    changed(&folder, "s.json", "/data/cameras", camera("target_mm", json!([0.0, 5000.0, 45.0])));
    refused(&folder, 1, "--scenario s.json", &["cameras.m1: sees 0 % of the face", "move it"]);
}

fn event(rise_s: f64) -> Value {
    json!({"action": "smile", "start_s": 0.0, "rise_s": rise_s, "hold_s": 0.1, "fall_s": 0.1, "strength": 1.0})
}

fn flash(mocap_frame: i64, factor: f64) -> Value {
    json!({"mocap_frame": mocap_frame, "length_s": 0.1, "factor": factor})
}

/// Ids of cameras are names of folders: no take may write beside its own.
#[test]
fn ids_that_are_paths_are_refused() {
    for id in ["../../evil", "a/b", "..", "", "m 1", "C:"] {
        let folder = tempfile::tempdir().unwrap();
        let cameras = json!({ id: camera("roll_deg", json!(0.0))["m1"] });
        changed(&folder, "s.json", "/data/cameras", cameras);
        refused(&folder, 1, "--scenario s.json", &["s.json", "cameras", "is no id of a camera"]);
        assert_eq!(rig::files(folder.path()).len(), 1, "{id}");
    }
}

/// What is wrong only once all is put together is said before the first file is written, and where it can be mended.
#[test]
fn what_cannot_be_filmed_leaves_no_folder() {
    let folder = tempfile::tempdir().unwrap();
    let thrice = "--fault defocused=20 --fault defocused=20@m1";
    refused(
        &folder,
        1,
        thrice,
        &["--scenario standard", "faults[1]", "camera m1", "defocused=40", "to do: "],
    );
    refused(&folder, 1, "--fault focal=-0.5 --fault focal=-0.5@m2", &["faults[1]", "camera m2", "focal=-1"]);
    for (pointer, value, words) in [
        ("/data/sensor/lens_blur_px", json!(49.0), ["sensor.lens_blur_px", "faults of camera m1"]),
        ("/data/flash", flash(500, 3.0), ["flash.mocap_frame", "camera m1 has no picture of it"]),
        (
            "/data/events",
            json!([{"action": "wink", "start_s": 0.0}]),
            ["events[0].action", "'wink' is no shape"],
        ),
    ] {
        changed(&folder, "s.json", pointer, value);
        let words = [&["--scenario s.json", "to do: "], words.as_slice()].concat();
        refused(&folder, 1, "--scenario s.json --fault defocused=20@m1", &words);
    }
    let output = call(&folder, "make --image-scale 0.01 --out out");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("image_scale: makes images of 7 × 5 px for camera m1"), "{message}");
    assert!(output.status.code() == Some(1) && !folder.path().join("out").exists(), "{message}");
    let board = json!({"chessboard": {"columns": 8, "rows": 6, "square_mm": 400.0}});
    changed(&folder, "s.json", "/data/calibration/boards", json!({"board": board, "count": 1}));
    let output = call(&folder, "make --scenario s.json --out out");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("calibration.boards: camera m1 sees the board whole nowhere"), "{message}");
    assert!(output.status.code() == Some(1) && !folder.path().join("out").exists(), "{message}");
}

#[test]
fn cameras_that_show_no_face_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (change, value, word) in [
        ("azimuth_deg", 180.0, "2 % of the markers face it"),
        ("focal_px", 1e-300, "shows the face 0.0 px large"),
        ("distance_mm", 1e7, "px large"),
    ] {
        changed(&folder, "s.json", "/data/cameras", camera(change, json!(value)));
        refused(&folder, 1, "--scenario s.json", &["cameras.m1: ", word, "to do: "]);
    }
}

#[test]
fn broken_options_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    refused(&folder, 2, "--fault wobbly=1", &["'wobbly' is no fault", "rotated (degrees)"]);
    refused(&folder, 2, "--fault rotated=90", &["rotated=90", "±45 degrees"]);
    refused(&folder, 2, "--count 0", &["--count"]);
    refused(&folder, 1, "--fault rotated=1@m9", &["faults[0]", "no camera m9", "m1, m2"]);
    refused(&folder, 1, "--frames 7-9", &["--frames 7-9", "1001-1003", "to do: "]);
    plant(&folder, "there", "a file");
    let output = call(&folder, "make --out there");
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    let output = call(&folder, "make --length tiny --vertices 3 --out out");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && message.contains("vertices: must lie between"), "{message}");
}

#[test]
fn a_folder_in_use_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    #[allow(clippy::disallowed_methods, reason = "the test needs a folder in use")]
    std::fs::create_dir(folder.path().join("used")).unwrap();
    plant(&folder, "used/notes.txt", "mine");
    let output = call(&folder, "make --length tiny --out used");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && message.contains("used: holds files already"), "{message}");
    assert_eq!(rig::files(&folder.path().join("used")).len(), 1);
}

/// The average face as a scan: its OBJ in millimetres times `scale`, and its landmarks by vertex.
fn scan(folder: &TempDir, name: &str, scale: f64) {
    let body = Body::parametric(0, 2000, &[], 1.0);
    let mut text = String::new();
    for point in &body.mesh.positions {
        text += &format!("v {} {} {}\n", scale * point.x, scale * point.y, scale * point.z);
    }
    for [a, b, c] in &body.triangles {
        text += &format!("f {} {} {}\n", a + 1, b + 1, c + 1);
    }
    plant(folder, name, &text);
    let nearest = |[s, t]: [f64; 2]| {
        let distance = |vertex: &usize| (body.domain[*vertex].x - s).hypot(body.domain[*vertex].y - t);
        (0..body.domain.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap()
    };
    let inside = |name: &str| !name.contains("lid_") && !name.contains("inner") && name != "lip_line";
    let rows = LANDMARKS.iter().filter(|landmark| inside(landmark.name));
    let rows: Vec<String> =
        rows.map(|landmark| format!("{},{}\n", landmark.name, nearest(landmark.at))).collect();
    plant(folder, "marks.csv", &format!("marker,vertex\n{}", rows.concat()));
    plant(folder, "few.csv", &format!("marker,vertex\n{}", rows[..2].concat()));
    plant(folder, "odd.csv", &format!("marker,vertex\n{}elbow,7\n", rows.concat()));
}

#[test]
fn scans_are_taken_or_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    scan(&folder, "m.obj", 1e-3);
    scan(&folder, "mm.obj", 1.0);
    refused(&folder, 1, "--mesh m.obj --unit mm --landmarks marks.csv", &["m.obj", "is its unit m?"]);
    refused(&folder, 1, "--mesh mm.obj --unit m --landmarks marks.csv", &["mm.obj", "is its unit mm?"]);
    refused(&folder, 1, "--mesh mm.obj --unit mm --landmarks few.csv", &["2 landmarks", "at least"]);
    refused(&folder, 1, "--mesh mm.obj --unit mm --landmarks odd.csv", &["landmark elbow is not known"]);
    refused(&folder, 1, "--mesh mm.obj --unit mm --landmarks none.csv", &["none.csv", "cannot read"]);
    refused(&folder, 2, "--mesh mm.obj --unit mm", &["--landmarks"]);
    refused(&folder, 2, "--unit mm", &["--mesh"]);
    refused(&folder, 2, "--landmarks marks.csv", &["--mesh"]);
    plant(&folder, "smile.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let given = "--mesh mm.obj --unit mm --landmarks marks.csv";
    refused(&folder, 1, &format!("{given} --shape smile=smile.obj"), &["smile.obj: 3 vertices"]);
    // The synthetic face is open at its rim: no reason to refuse it.
    rig::make(&folder, "open", &format!("{given} --no-footage"));
}

#[test]
fn recordings_are_refused_by_line() {
    let folder = tempfile::tempdir().unwrap();
    let text = "Timecode,BlendShapeCount,JawOpen\n00:00:00:00.000,1,0.1\n00:00:00:01.000,1,wide\n";
    plant(&folder, "weights.csv", text);
    refused(&folder, 1, "--weights weights.csv", &["weights.csv", "line 3", "'wide' is not a number"]);
    changed(&folder, "s.json", "/data/performance", json!({ "recording": {} }));
    refused(&folder, 1, "--scenario s.json", &["performance", "recorded weights"]);
}
