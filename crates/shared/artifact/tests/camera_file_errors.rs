//! Cameras in the formats of others: what is malformed, and what a rig cannot hold.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod camera_texts;
mod support;

use artifact::{CameraFormat, CameraRig, Stated, Unit, colmap, read_cameras, write_cameras};
use camera_texts::*;
use std::path::{Path, PathBuf};
use support::{Place, refusal, says};

/// That the sample is refused with every change, with these parts of a message.
#[track_caller]
fn yaml_refuses(cases: &[(&str, &str, &[&str])]) {
    for (old, new, parts) in cases {
        let message = refusal(yaml(&changed(YAML, old, new)));
        assert!(parts.iter().all(|part| message.contains(part)), "{old} → {new}: {message}");
        assert!(message.starts_with("a.yml"), "{message}");
    }
}

#[test]
fn yaml_names_line_and_key() {
    yaml_refuses(&[
        ("0., 801.", "0.5, 801.", &["line 5, camera_matrix", "is no camera matrix"]),
        ("800., 0.,", "800., 0.5,", &["line 5, camera_matrix", "skew 0.5"]),
        ("800., 0., 320.,", "800., 320.,", &["line 5, camera_matrix", "8 numbers, not 3 × 3", "cut short"]),
        (
            "-0.1, 0.",
            "-0.1, .Nan",
            &["line 14, distortion_coefficients.data[1]", "'.Nan' is not a finite number"],
        ),
        ("-0.1, 0.", "-0,1, o.", &["is not a number", "'o.'"]),
        ("cols: 5", "cols: 6", &["line 10, distortion_coefficients", "5 numbers, not 1 × 6"]),
        (
            "cols: 5\n   dt: d\n   data: [ -0.1, 0., 0., 0., 0.02 ]",
            "cols: 3\n   data: [ 1., 2., 3. ]",
            &["has 1 × 3 coefficients", "4, 5, 8, 12 or 14"],
        ),
        (
            "cols: 5\n   dt: d\n   data: [ -0.1, 0., 0., 0., 0.02 ]",
            "cols: 8\n   data: [ 1., 2., 3., 4., 5., 0., 0.5, -6. ]",
            &["line 10, distortion_coefficients", "k5 = 0.5, k6 = -6", "k1, k2, p1, p2, k3 only", "to do"],
        ),
        ("distortion_coefficients", "dist_of_lens", &["lacks distortion_coefficients", "write zeros"]),
        ("camera_matrix", "camera_mat", &["holds no cameras"]),
        ("tvec", "shift", &["camera a lacks a translation"]),
        ("rvec: [ 0., 0.1, 0. ]", "rvec: [ 0., 0.1 ]", &["line 15, rvec", "is 2 × 1"]),
        ("rvec: [ 0., 0.1, 0. ]", "R: [[1, 0, 0], [0, -1, 0], [0, 0, 1]]", &["line 15, R", "mirrors"]),
        ("rvec: [ 0., 0.1, 0. ]", "R: [[1, 0, 0], [0, 1, 0], [0, 1, 1]]", &["line 15, R", "not orthonormal"]),
        (
            "rvec: [ 0., 0.1, 0. ]",
            "R: [[1, 0, 0], [0, 1], [0, 0, 1]]",
            &["line 15, R", "row 2 has 2 numbers"],
        ),
        ("tvec", "R: [0, 0, 0]\ntvec", &["line 16, R", "same thing as rvec"]),
        ("image_width: 640\n", "", &["image_height", "without the other side"]),
        ("image_width: 640", "image_width: 640.5", &["image_width", "not a whole number"]),
        ("image_width: 640\nimage_height: 480\n", "", &["how large the images are", "WIDTHxHEIGHT"]),
        ("image_width: 640", "image_width: 0", &["camera a", "no size: 0 × 480"]),
        ("800., 0.", "-800., 0.", &["focal length -800 px is not positive"]),
        ("image_width", "fisheye_model: 1\nimage_width", &["line 3, fisheye_model", "fisheye"]),
        ("image_width", "distortion_model: equidistant\nimage_width", &["line 3", "'equidistant'"]),
        ("image_width", "xi: 0.7\nimage_width", &["line 3, xi", "omnidirectional"]),
        ("image_width", "unit: m\nimage_width", &["line 3, unit", "is in m, but mm is stated"]),
    ]);
}

#[test]
fn yaml_that_is_none_names_the_line() {
    yaml_refuses(&[
        ("image_width", "image_height: 3\nimage_width", &["line 5", "'image_height' stands there twice"]),
        ("0., 0., 1. ]", "0., 0., 1.", &["line 10, column"]),
        (", 0., 0., 1. ]\n", ", 0., 0., 1.\n", &["line 10", "where a comma was expected"]),
        ("   cols: 3", "     cols: 3", &["line 7", "indentation"]),
        ("   cols: 3", "\tcols: 3", &["line 7", "tab"]),
        ("image_width: 640", "image_width", &["line 4, column 1", "is not understood here"]),
        ("image_width: 640", "image_width: \"640", &["line 3", "not closed in its line"]),
        (
            "image_width: 640",
            "image_width: *size",
            &["line 3", "'*size' is a part of YAML that is not read here"],
        ),
        ("[ 800.", "\"$base64$ZAAA\"\nx: [ 800.", &["base64", "FileStorage::BASE64"]),
        ("%YAML", "<?xml version=\"1.0\"?>\n%YAML", &["XML", ".yml or .json"]),
    ]);
    says(&refusal(yaml("")), &["a.yml: is empty"]);
    says(&refusal(yaml("%YAML:1.0\n---\n")), &["a.yml: is empty"]);
    says(&refusal(yaml(&"[".repeat(100_000))), &["line 1", "nested more than"]);
    says(&refusal(yaml(&YAML[..YAML.len() - 4])), &["line 16", "not closed", "cut short"]);
}

#[test]
fn toml_names_line_and_key() {
    let cases: &[(&str, &str, &[&str])] = &[
        (
            "[-0.1, 0.0, 0.0, 0.0]",
            "[-0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.25]",
            &["line 5, cam_0.distortions", "k6 = 0.25"],
        ),
        (
            "[-0.1, 0.0, 0.0, 0.0]",
            "[-0.1, nan]",
            &["line 5, cam_0.distortions[1]", "'nan' is not a finite number"],
        ),
        ("rotation", "fisheye = true\nrotation", &["line 6, cam_0.fisheye", "fisheye lens"]),
        ("rotation = [0.0, 0.1, 0.0]\n", "", &["line 1, cam_0", "lacks rotation"]),
        ("rotation = [0.0, 0.1, 0.0]", "rotation = [\n0.0, 0.1]", &["line 6, cam_0.rotation", "2 × 1"]),
        ("size = [640, 480]\n", "", &["line 1, cam_0", "how large"]),
        ("size = [640, 480]", "size = [640]", &["line 3, cam_0.size", "a width and a height"]),
        ("matrix", "matrices", &["line 1, cam_0", "lacks matrix"]),
        ("[metadata]\n", "[metadata]\nunit = \"m\"\n", &["line 10, metadata.unit", "is in m, but mm"]),
        ("480]", "480", &["line 4", "is not TOML: missing comma"]),
        ("name", "size = [640, 480]\nname", &["line 4", "is not TOML", "duplicate"]),
    ];
    for (old, new, parts) in cases {
        let message = refusal(toml(&changed(TOML, old, new)));
        assert!(parts.iter().all(|part| message.contains(part)), "{old} → {new}: {message}");
    }
    says(&refusal(toml("")), &["a.toml: holds no cameras"]);
    let twice = format!("{TOML}{}", TOML[..TOML.find("[metadata]").unwrap()].replace("cam_0", "cam_1"));
    says(&refusal(toml(&twice)), &["camera m1", "two cameras"]);
    let (_, warnings) = toml(&format!("{TOML}[charuco]\ncolumns = 4\n")).unwrap();
    says(&warnings[0], &["charuco is no camera"]);
    says(&refusal(toml(&changed(TOML, "rotation", "ignore = true\nrotation"))), &["holds no cameras"]);
}

#[test]
fn colmap_names_the_line() {
    let lenses: &[(&str, &str, &[&str])] = &[
        (
            "FULL_OPENCV",
            "OPENCV_FISHEYE",
            &["cameras.txt, line 2", "OPENCV_FISHEYE", "use one of SIMPLE_PINHOLE"],
        ),
        ("0.02 0 0 0", "0.02 0 0", &["line 2", "11 parameters; FULL_OPENCV has 12"]),
        ("0.02 0 0 0", "0.02 0.5 0 1", &["line 2", "k4 = 0.5, k6 = 1"]),
        ("640", "640.5", &["line 2", "'640.5' is not a whole number"]),
        ("800 801", "800 inf", &["line 2", "not a finite number"]),
        ("# lenses", "1 PINHOLE 640 480 800 801 320.5 240.5", &["line 2", "camera 1 stands there twice"]),
    ];
    for (old, new, parts) in lenses {
        says(&refusal(colmap_of(&changed(LENSES, old, new), IMAGES)), parts);
    }
    let images: &[(&str, &str, &[&str])] = &[
        ("m1.png\n\n2", "m1.png\n2", &["images.txt, line 4", "no list of points", "two lines"]),
        ("m1.png", "m 1.png", &["line 3", "11 words"]),
        ("1 m1", "7 m1", &["line 3", "camera 7 is not in cameras.txt"]),
        ("1 1 0 0 0 0", "1 1 0.5 0 0 0", &["line 3", "quaternion has length 1.118"]),
        ("side/m2", "m1", &["camera m1", "two cameras"]),
        ("700 1 m1", "x 1 m1", &["line 3", "'x' is not a number"]),
    ];
    for (old, new, parts) in images {
        says(&refusal(colmap_of(LENSES, &changed(IMAGES, old, new))), parts);
    }
    let stated = Stated { image_size: Some([480, 640]), ..STATED };
    says(&refusal(colmap::parse(Path::new("a"), LENSES, IMAGES, &stated)), &["line 2", "640 × 480"]);
}

#[test]
fn files_and_units_are_those_of_the_format() {
    let place = Place::new();
    let (yml, toml) = (place.file("a.yml", YAML), place.file("a.toml", TOML));
    let read = |paths: &[&PathBuf], format| {
        let paths: Vec<PathBuf> = paths.iter().map(|path| (*path).clone()).collect();
        refusal(read_cameras(&paths, format, &STATED))
    };
    says(&read(&[&toml, &yml], CameraFormat::Anipose), &["a.yml", "one file too many"]);
    says(&read(&[], CameraFormat::Opencv), &["no file of cameras"]);
    says(&read(&[&toml], CameraFormat::Colmap), &["a.toml: is a file", "name the folder"]);
    says(&read(&[&yml], CameraFormat::Anipose), &["a.yml, line 1", "is not TOML"]);
    says(&read(&[&place.path("none.yml")], CameraFormat::Opencv), &["none.yml: cannot read"]);
    let size = Stated { image_size: Some([640, 481]), ..STATED };
    says(
        &refusal(read_cameras(&[yml], CameraFormat::Opencv, &size)),
        &["line 3, image_width", "640 × 480 px, but 640 × 481"],
    );
    let metres = Stated { unit: Unit::M, ..STATED };
    let own = support::fixture("cameras-1/cameras.json");
    says(&refusal(read_cameras(&[own], CameraFormat::Furrow, &metres)), &["is in mm, but m is stated"]);
}

#[test]
fn what_cannot_be_written_leaves_nothing() {
    let (rig, _) = toml(TOML).unwrap();
    let named =
        |id: &str| CameraRig { cameras: [(id.to_string(), rig.cameras["m1"].clone())].into(), take: None };
    let place = Place::new();
    let write =
        |name: &str, rig: &CameraRig, format| refusal(write_cameras(&place.path(name), rig, format, Unit::M));
    says(&write("a.xml", &rig, CameraFormat::Opencv), &["a.xml", "use .yml, .yaml or .json"]);
    says(&write("a", &named("m 1"), CameraFormat::Colmap), &["camera 'm 1'", "no blanks"]);
    says(&write("a.toml", &named("m\n1"), CameraFormat::Anipose), &["camera 'm\\n1'", "control character"]);
    let none = CameraRig { cameras: [].into(), take: None };
    says(&write("a.yml", &none, CameraFormat::Opencv), &["no cameras to write"]);
    let mut broken = rig.clone();
    broken.cameras.get_mut("m1").unwrap().camera.lens.focal_px.x = f64::NAN;
    says(&write("a.yml", &broken, CameraFormat::Opencv), &["camera m1, focal_px", "NaN"]);
    assert!(place.names().is_empty(), "{:?}", place.names());
}
