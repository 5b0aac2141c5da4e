//! Small files of cameras in the formats of others, to be changed by tests.
#![allow(dead_code, reason = "each test file uses its own part")]

use artifact::{CameraRig, Stated, Unit, anipose, colmap, opencv};
use std::path::Path;

pub(crate) const STATED: Stated = Stated { unit: Unit::Mm, image_size: None };

pub(crate) const YAML: &str = "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   \
dt: d\n   data: [ 800., 0., 320., 0., 801., 240., 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 1\n   \
cols: 5\n   dt: d\n   data: [ -0.1, 0., 0., 0., 0.02 ]\nrvec: [ 0., 0.1, 0. ]\ntvec: [ 0., 0.,\n   700. ]\n";

pub(crate) const TOML: &str = "[cam_0]\nname = \"m1\"\nsize = [640, 480]\nmatrix = [[800.0, 0.0, 320.0], [0.0, 801.0, 240.0], [0.0, 0.0, 1.0]]\n\
distortions = [-0.1, 0.0, 0.0, 0.0]\nrotation = [0.0, 0.1, 0.0]\ntranslation = [0.0, 0.0, 700.0]\n\n[metadata]\nerror = 0.5\n";

pub(crate) const LENSES: &str =
    "# lenses\n1 FULL_OPENCV 640 480 800 801 320.5 240.5 -0.1 0.01 0.001 0.002 0.02 0 0 0\n";
pub(crate) const IMAGES: &str =
    "# images\n\n1 1 0 0 0 0 0 700 1 m1.png\n\n2 1 0 0 0 5 0 700 1 side/m2.png\n1.5 2.5 -1\n";

pub(crate) fn yaml(text: &str) -> artifact::Result<(CameraRig, Vec<String>)> {
    opencv::parse(&[(Path::new("a.yml"), text)], &STATED)
}

pub(crate) fn toml(text: &str) -> artifact::Result<(CameraRig, Vec<String>)> {
    anipose::parse(Path::new("a.toml"), text, &STATED)
}

pub(crate) fn colmap_of(lenses: &str, images: &str) -> artifact::Result<(CameraRig, Vec<String>)> {
    colmap::parse(Path::new("a"), lenses, images, &STATED)
}

/// What is said where `old` is replaced.
#[track_caller]
pub(crate) fn changed(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "{old}");
    text.replacen(old, new, 1)
}
