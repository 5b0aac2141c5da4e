//! Cameras in the formats of others: the habits of writers, and text that is none of the formats.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod camera_texts;
mod support;

use camera_texts::*;
use proptest::prelude::*;
use support::{refusal, says};

#[test]
fn the_samples_are_read() {
    assert_eq!(yaml(YAML).unwrap().0.cameras["a"].camera.lens.distortion.k3, 0.02);
    assert_eq!(toml(TOML).unwrap().0.cameras["m1"].camera.lens.focal_px.y, 801.0);
    let (rig, _) = colmap_of(LENSES, IMAGES).unwrap();
    assert_eq!(rig.cameras.keys().collect::<Vec<_>>(), ["m1", "side/m2"]);
    // (0.5, 0.5) is the first pixel's centre there.
    assert_eq!(rig.cameras["m1"].camera.lens.center_px, nalgebra::Vector2::new(320.0, 240.0));
    assert_eq!(rig.cameras["m1"].camera.lens.distortion.k3, 0.02);
}

#[test]
fn habits_of_other_writers_are_read() {
    let same = |text: String| assert_eq!(yaml(&text).unwrap(), yaml(YAML).unwrap(), "{text}");
    same(YAML.replace('\n', "\r\n"));
    same(YAML.replace("%YAML:1.0\n---\n", "\u{feff}"));
    same(format!("{YAML}...\n"));
    same(YAML.replace("image_width: 640\nimage_height: 480", "imageSize: [ 640,\n  480 ] # px"));
    same(YAML.replace("camera_matrix: !!opencv-matrix", "cameraMatrix:"));
    let same = |text: String| assert_eq!(toml(&text).unwrap(), toml(TOML).unwrap(), "{text}");
    same(TOML.replace('\n', "\r\n"));
    // Pose2Sim: sizes as reals, fisheye stated.
    same(
        TOML.replace("[640, 480]", "[ 640.0, 480.0]").replace("[metadata]", "fisheye = false\n\n[metadata]"),
    );
    same(TOML.replace("name = \"m1\"\n", "").replace("cam_0", "m1"));
    let (caliscope, _) =
        toml(&TOML.replace("name = \"m1\"", "cam_id = 1").replace("[cam_0]", "[cameras.0]")).unwrap();
    assert_eq!(caliscope.cameras["cam_1"], toml(TOML).unwrap().0.cameras["m1"]);
    let (lenses, images) = (LENSES.replace('\n', "\r\n"), IMAGES.replace('\n', "\r\n"));
    assert_eq!(colmap_of(&lenses, &images).unwrap(), colmap_of(LENSES, IMAGES).unwrap());
}

proptest! {
    #[test]
    fn nothing_panics(pieces in proptest::collection::vec(proptest::sample::select(PIECES), 0..40)) {
        let text = pieces.concat();
        let _ = (yaml(&text), toml(&text), colmap_of(&text, IMAGES), colmap_of(LENSES, &text));
    }
}

/// What the formats are made of, and what does not belong there.
const PIECES: &[&str] = &[
    "camera_matrix",
    "K",
    "R",
    "T",
    "D",
    "cameras",
    ":",
    ": ",
    "- ",
    "-",
    "\n",
    "\n  ",
    "\n\t",
    "[",
    "]",
    "{",
    "}",
    ",",
    "\"",
    "'",
    "\\",
    "#",
    "//",
    "1",
    "0.5",
    "-1e9",
    ".nan",
    "1e999",
    "!!opencv-matrix",
    "rows: 3\n",
    "data",
    "ä",
    "\u{a0}",
    "%",
    "---",
    "...",
    "=",
    "[cam_0]\n",
    "matrix = ",
    "size",
    "PINHOLE",
    " ",
];

#[test]
fn every_cut_of_a_file_is_refused_or_read_without_panic() {
    for end in (0..YAML.len()).filter(|&end| YAML.is_char_boundary(end)) {
        if let Ok((rig, warnings)) = yaml(&YAML[..end]) {
            // Only the line end, or the whole pose, may be lost.
            assert!(end == YAML.len() - 1 || !warnings.is_empty(), "{end}: {rig:?}");
        }
    }
    for end in 0..TOML.len() {
        let _ = toml(&TOML[..end]);
    }
    for end in 0..LENSES.len() {
        assert!(colmap_of(&LENSES[..end], IMAGES).is_err() || end >= LENSES.len() - 1, "{end}");
    }
}

#[test]
fn several_cameras_need_poses_and_matrices() {
    let camera = |name: &str| {
        format!(
            "   - name: {name}\n     K: [[8, 0, 3], [0, 8, 2], [0, 0, 1]]\n     D: []\n     image_size: [6, 4]\n     R: [0, 0, 0]\n     T: [0, 0, 1]\n"
        )
    };
    let text = format!("cameras:\n{}{}", camera("a"), camera("b"));
    assert_eq!(yaml(&text).unwrap().0.cameras.len(), 2);
    says(
        &refusal(yaml(&text.replacen("name: b", "name: a", 1))),
        &["camera a", "two cameras have this name"],
    );
    says(
        &refusal(yaml(&text.replacen("     R: [0, 0, 0]\n     T: [0, 0, 1]\n", "", 1))),
        &["cameras[0]", "lacks a rotation"],
    );
    says(&refusal(yaml(&text.replacen("K:", "Kx:", 1))), &["line 2, cameras[0]", "lacks camera_matrix"]);
}

#[test]
fn simple_models_of_colmap_are_held() {
    for (model, parameters, coefficients) in [
        ("SIMPLE_PINHOLE", "800 320.5 240.5", [0.0, 0.0]),
        ("PINHOLE", "800 800 320.5 240.5", [0.0, 0.0]),
        ("SIMPLE_RADIAL", "800 320.5 240.5 0.1", [0.1, 0.0]),
        ("RADIAL", "800 320.5 240.5 0.1 0.2", [0.1, 0.2]),
        ("OPENCV", "800 800 320.5 240.5 0.1 0.2 0 0", [0.1, 0.2]),
    ] {
        let (rig, _) = colmap_of(&format!("1 {model} 640 480 {parameters}"), IMAGES).unwrap();
        let lens = rig.cameras["m1"].camera.lens;
        assert_eq!((lens.focal_px.x, lens.focal_px.y, lens.center_px.x), (800.0, 800.0, 320.0), "{model}");
        assert_eq!([lens.distortion.k1, lens.distortion.k2], coefficients, "{model}");
    }
}
