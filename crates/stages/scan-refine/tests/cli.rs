//! The binary: what it writes, and how it refuses.
#![allow(clippy::expect_used, reason = "a test may fail")]

use artifact::{Staged, Unit, npy, obj, picture};
use assert_cmd::Command;
use mesh::Mesh;
use std::path::Path;
use tempfile::TempDir;
use testkit::shapes;

const COMMON: [&str; 6] = ["--mesh", "scan.obj", "--unit", "cm", "--out", "out.obj"];

fn command(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_scan-refine"));
    command.current_dir(folder);
    command
}

/// A folder with `scan.obj`, a plane with 0.1 mm of ripples from vertex to vertex, in cm.
fn scene() -> TempDir {
    let folder = TempDir::new().expect("a folder");
    write(folder.path(), &shapes::relief(20, 0.5, |x, y| 0.1 * (31.7 * x).sin() * (27.1 * y).cos()));
    folder
}

fn write(folder: &Path, mesh: &Mesh) {
    obj::write(&folder.join("scan.obj"), mesh, Unit::Cm).and_then(Staged::publish).expect("the scan");
}

fn write_rows(folder: &Path, name: &str, columns: usize, rows: &[f32]) {
    npy::write(&folder.join(name), [rows.len() / columns, columns], rows)
        .and_then(Staged::publish)
        .expect("the array");
}

fn paint(folder: &Path, codes: impl Fn(usize, usize) -> [u8; 3]) {
    let rgb: Vec<u8> = (0..64 * 64).flat_map(|texel| codes(texel % 64, texel / 64)).collect();
    picture::write_rgb8(&folder.join("map.png"), 64, 64, &rgb).and_then(Staged::publish).expect("the map");
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = command(folder).args(COMMON).args(arguments).output().expect("it runs");
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!folder.join("out.obj").exists(), "no output is left");
    String::from_utf8(output.stderr).expect("text")
}

fn roughness(folder: &Path, name: &str) -> f64 {
    let mesh = obj::read(&folder.join(name), Unit::Cm).expect("a mesh");
    mesh.positions.iter().map(|point| point.z.abs()).fold(0.0, f64::max)
}

#[test]
fn normals_per_vertex_flatten_ripples_and_all_else_stays() {
    let folder = scene();
    write_rows(folder.path(), "normals.npy", 3, &[0.0, 0.0, 1.0].repeat(441));
    write_rows(folder.path(), "trust.npy", 1, &[1.0; 441]);
    let run = command(folder.path())
        .args(COMMON)
        .args(["--vertex-normals", "normals.npy", "--confidence", "trust.npy", "--json"])
        .output()
        .expect("it runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    assert!(roughness(folder.path(), "out.obj") < 0.3 * roughness(folder.path(), "scan.obj"));
    let other = |name: &str| {
        let text = artifact::read_text(&folder.path().join(name)).expect("text");
        text.lines().filter(|line| !line.starts_with("v ")).map(str::to_string).collect::<Vec<_>>()
    };
    assert_eq!(other("scan.obj"), other("out.obj"), "faces, UVs and groups stay");
    let side_car = artifact::read_text(&folder.path().join("out.obj.prov.json")).expect("a side-car");
    assert!(side_car.contains("after_degrees") && side_car.contains("trust.npy"), "{side_car}");
}

#[test]
fn a_map_works_and_lambda_and_crossover_exclude_each_other() {
    let folder = scene();
    paint(folder.path(), |column, _| [if column % 16 < 8 { 148 } else { 108 }, 128, 254]);
    let map = ["--tangent-map", "map.png"];
    command(folder.path()).args(COMMON).args(map).args(["--lambda", "0.05", "--directx"]).assert().success();
    let both = ["--lambda", "0.05", "--crossover-mm", "3"];
    command(folder.path()).args(COMMON).args(map).args(both).assert().code(2);
    command(folder.path()).args(COMMON).assert().code(2);
    command(folder.path()).args(COMMON).args(["--object-map", "map.png", "--directx"]).assert().code(2);
}

#[test]
fn flat_black_and_foreign_maps_are_refused() {
    let folder = scene();
    paint(folder.path(), |_, _| [128, 128, 255]);
    let message = refused(folder.path(), &["--tangent-map", "map.png"]);
    assert!(message.contains("map.png") && message.contains("flat"), "{message}");
    paint(folder.path(), |_, _| [0, 0, 0]);
    let message = refused(folder.path(), &["--object-map", "map.png"]);
    assert!(message.contains("map.png") && message.contains("black"), "{message}");
    paint(folder.path(), |column, row| [200, (column + 100) as u8, (row + 90) as u8]);
    let message = refused(folder.path(), &["--object-map", "map.png"]);
    assert!(message.contains("map.png"), "{message}");
    let message = refused(folder.path(), &["--object-map", "scan.obj"]);
    assert!(message.contains("scan.obj") && message.contains("PNG"), "{message}");
}

#[test]
fn arrays_of_another_mesh_and_bad_numbers_are_refused() {
    let folder = scene();
    write_rows(folder.path(), "normals.npy", 3, &[0.0, 0.0, 1.0].repeat(440));
    let message = refused(folder.path(), &["--vertex-normals", "normals.npy"]);
    assert!(
        message.contains("normals.npy") && message.contains("440") && message.contains("441"),
        "{message}"
    );
    write_rows(folder.path(), "normals.npy", 3, &[0.0, 0.0, -1.0].repeat(441));
    let message = refused(folder.path(), &["--vertex-normals", "normals.npy"]);
    assert!(message.contains("inside out"), "{message}");
    write_rows(folder.path(), "normals.npy", 3, &[0.0, 0.0, 1.0].repeat(441));
    write_rows(folder.path(), "trust.npy", 1, &[2.0; 441]);
    let message = refused(folder.path(), &["--vertex-normals", "normals.npy", "--confidence", "trust.npy"]);
    assert!(message.contains("trust.npy") && message.contains("vertex 0 is 2"), "{message}");
    write(folder.path(), &shapes::open_book());
    write_rows(folder.path(), "normals.npy", 3, &[0.0, 0.0, 1.0].repeat(5));
    let message = refused(folder.path(), &["--vertex-normals", "normals.npy"]);
    assert!(message.contains("scan.obj"), "{message}");
}

#[test]
fn help_reads_well() {
    let output = command(Path::new(".")).arg("--help").env("COLUMNS", "100").output().expect("it runs");
    insta::assert_snapshot!(String::from_utf8(output.stdout).expect("text"));
}
