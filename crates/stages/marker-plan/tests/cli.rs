//! The program as users run it.
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "a test may fail, and looks at files")]

use artifact::Unit;
use artifact::picks::{self, PickPlace};
use assert_cmd::Command;
use nalgebra::Point3;
use std::path::Path;
use std::process::Output;
use testkit::shapes;

fn run(folder: &Path, arguments: &str) -> Output {
    let mut command = Command::cargo_bin("marker-plan").unwrap();
    command.current_dir(folder).args(arguments.split_whitespace()).output().unwrap()
}

/// A mask with a mouth and two eyes, in cm.
fn write_mask(folder: &Path) {
    let flat = shapes::grid(60, 3.4);
    let vault = |p: &Point3<f64>| {
        let (x, y) = (p.x - 102.0, p.y - 102.0);
        Point3::new(x * 0.75, y, 60.0 - x * x / 160.0 - y * y / 260.0)
    };
    let mask = flat.with_positions(flat.positions.iter().map(vault).collect());
    let hole = |x: f64, y: f64| {
        let within =
            |cx: f64, cy: f64, rx: f64, ry: f64| ((x - cx) / rx).powi(2) + ((y - cy) / ry).powi(2) < 1.0;
        within(0.0, -40.0, 26.0, 5.0) || within(31.0, 32.0, 14.0, 7.0) || within(-31.0, 32.0, 14.0, 7.0)
    };
    let keep: Vec<bool> = mask
        .polygons
        .iter()
        .map(|face| {
            let sum = face.iter().fold([0.0; 2], |sum, &v| {
                let p = mask.positions[v as usize];
                [sum[0] + p.x, sum[1] + p.y]
            });
            let count = face.len() as f64;
            !hole(sum[0] / count, sum[1] / count)
        })
        .collect();
    let mesh = mask.keep_faces(&keep).0;
    artifact::obj::write(&folder.join("mask.obj"), &mesh, Unit::Cm).unwrap().publish().unwrap();
}

#[test]
fn a_scan_becomes_picks_and_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    write_mask(folder.path());
    let words = "--mesh mask.obj --unit cm --count 40 --out plan.csv --picture plan.png --json --quiet";
    let output = run(folder.path(), words);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["results"]["markers"], 40);
    // What rbf-warp reads: a vertex for every marker.
    let picks = picks::read(&folder.path().join("plan.csv"), Unit::Cm).unwrap();
    assert_eq!(picks.len(), 40);
    assert!(picks.iter().all(|pick| matches!(pick.place, PickPlace::Vertex(_))));
    assert_eq!(picks[0].marker, "lip_corner_l");
    let picture = artifact::picture::read_rgb(&folder.path().join("plan.png")).unwrap();
    let codes = picture.to_8_bits();
    let red = codes.chunks(3).filter(|c| c[0] > 180 && c[1] < 80).count();
    let blue = codes.chunks(3).filter(|c| c[2] > 150 && c[0] < 60).count();
    assert!(red > 12 * 30 && blue > 28 * 30, "{red} red and {blue} blue pixels");
    // The same again gives the same bytes.
    let first = std::fs::read(folder.path().join("plan.csv")).unwrap();
    assert!(run(folder.path(), &words.replace("plan.", "again.")).status.success());
    assert_eq!(first, std::fs::read(folder.path().join("again.csv")).unwrap());
}

#[test]
fn a_closed_mouth_is_refused_with_a_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = shapes::bump_plane(20, 8.0, 30.0, 50.0);
    artifact::obj::write(&folder.path().join("scan.obj"), &mesh, Unit::Mm).unwrap().publish().unwrap();
    for (words, says) in [
        ("", "mesh-clip --cut-along"),
        ("--mouth 215 --eyes 3,4", "vertex 215 is on no boundary loop"),
        ("--mouth 2 --eyes 3,4", "the same rim"),
        ("--lip-points 5", "lips may have 0, 2, 4 or 8"),
        ("--mouth 3 --eyes 4", "name two vertices"),
    ] {
        let output = run(folder.path(), &format!("--mesh scan.obj --unit mm --out plan.csv {words}"));
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{words}: {message}");
        assert!(message.contains(says), "'{says}' is not in: {message}");
        assert!(!folder.path().join("plan.csv").exists());
    }
}

#[test]
fn the_help_is_as_reviewed() {
    let folder = tempfile::tempdir().unwrap();
    let output = run(folder.path(), "--help");
    insta::assert_snapshot!("help", String::from_utf8_lossy(&output.stdout));
}
