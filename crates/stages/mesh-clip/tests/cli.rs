//! The binary: what it writes, and how it refuses.
#![allow(clippy::expect_used, reason = "a test may fail")]

use artifact::{
    FileRef, MeshRef, Unit, VertexMapping, VertexPath, VertexSet, obj, read_document, write_document,
};
use assert_cmd::Command;
use std::path::Path;
use tempfile::TempDir;
use testkit::shapes;

fn command(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mesh-clip"));
    command.current_dir(folder);
    command
}

/// A folder with `grid.obj` (4 × 4 quads of 1 mm, in cm) and a reference to it.
fn scene() -> (TempDir, MeshRef) {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("grid.obj");
    obj::write(&path, &shapes::grid(4, 1.0), Unit::Cm).and_then(artifact::Staged::publish).expect("the grid");
    let file = FileRef { name: "grid.obj".to_string(), sha256: artifact::sha256(&path).expect("a hash") };
    (folder, MeshRef { file, unit: Unit::Cm, vertex_count: 25 })
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let common = ["--mesh", "grid.obj", "--out", "out.obj", "--map", "map.json"];
    let output = command(folder).args(common).args(arguments).output().expect("it runs");
    assert_eq!(output.status.code(), Some(1));
    assert!(!folder.join("out.obj").exists() && !folder.join("map.json").exists(), "no output is left");
    String::from_utf8(output.stderr).expect("text")
}

#[test]
fn writes_mesh_map_and_side_cars_in_the_unit_of_the_input() {
    let (folder, old) = scene();
    let line = VertexPath { mesh: old.clone(), name: "slit".to_string(), vertices: vec![11, 13] };
    write_document(&folder.path().join("slit.json"), &line)
        .and_then(artifact::Staged::publish)
        .expect("the path");
    let run = command(folder.path())
        .args(["--mesh", "grid.obj", "--unit", "cm", "--out", "out.obj", "--map", "map.json", "--json"])
        .args(["--cut-along", "slit.json", "--keep-above", "y=1"])
        .output()
        .expect("it runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let map: VertexMapping = read_document(&folder.path().join("map.json")).expect("a map");
    assert_eq!(map.old, old);
    assert_eq!(map.new.file.sha256, artifact::sha256(&folder.path().join("out.obj")).expect("a hash"));
    assert_eq!((map.new.vertex_count, map.old_from_new.last()), (21, Some(&12)));
    let clipped = obj::read(&folder.path().join("out.obj"), Unit::Cm).expect("the mesh");
    let grid = obj::read(&folder.path().join("grid.obj"), Unit::Cm).expect("the grid");
    for (new, &old) in map.old_from_new.iter().enumerate() {
        assert!(clipped.positions[new] == grid.positions[old as usize]);
    }
    assert!(folder.path().join("map.json.prov.json").exists());
    let side_car = artifact::read_text(&folder.path().join("out.obj.prov.json")).expect("a side-car");
    assert!(side_car.contains("\"cut 1\"") && side_car.contains("slit.json"), "{side_car}");
}

#[test]
fn a_cut_named_on_the_command_line_is_recorded() {
    let (folder, _) = scene();
    command(folder.path())
        .args(["--mesh", "grid.obj", "--unit", "cm", "--out", "out.obj", "--map", "map.json"])
        .args(["--cut", "11,13"])
        .assert()
        .success();
    let side_car = artifact::read_text(&folder.path().join("out.obj.prov.json")).expect("a side-car");
    assert!(side_car.replace([' ', '\n'], "").contains("[11,13]"), "{side_car}");
}

#[test]
fn a_picture_masks() {
    let (folder, _) = scene();
    let dark_left = image_of(&[0, 255, 0, 255]);
    artifact::stage_bytes(&folder.path().join("mask.png"), &dark_left)
        .and_then(artifact::Staged::publish)
        .expect("the picture");
    let run = ["--mesh", "grid.obj", "--unit", "cm", "--out", "out.obj", "--map", "map.json"];
    command(folder.path()).args(run).args(["--uv-mask", "mask.png"]).assert().success();
    let clipped = obj::read(&folder.path().join("out.obj"), Unit::Mm).expect("the mesh");
    assert_eq!(clipped.polygons.len(), 8);
}

/// A grey PNG of 2 × 2 pixels.
fn image_of(pixels: &[u8; 4]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let picture = image::GrayImage::from_raw(2, 2, pixels.to_vec()).expect("four pixels");
    picture.write_to(&mut bytes, image::ImageFormat::Png).expect("a PNG");
    bytes.into_inner()
}

#[test]
fn a_missing_unit_is_refused() {
    let (folder, _) = scene();
    let message = refused(folder.path(), &["--drop-non-manifold"]);
    assert!(message.contains("grid.obj: its unit is not stated") && message.contains("--unit"), "{message}");
}

#[test]
fn an_empty_result_is_refused() {
    let (folder, _) = scene();
    let message = refused(folder.path(), &["--unit", "cm", "--keep-above", "z=5"]);
    assert!(message.contains("grid.obj") && message.contains("no face is left of 16"), "{message}");
}

#[test]
fn a_set_of_another_mesh_is_refused_with_both_hashes() {
    let (folder, old) = scene();
    let mut other = old.clone();
    other.file.sha256 = "ab".repeat(32);
    let set = VertexSet { mesh: other, name: "neck".to_string(), vertices: vec![0, 1] };
    write_document(&folder.path().join("neck.json"), &set)
        .and_then(artifact::Staged::publish)
        .expect("the set");
    let message = refused(folder.path(), &["--unit", "cm", "--remove", "neck.json"]);
    let hash = old.file.sha256.get(..12).expect("a hash");
    assert!(
        message.contains("neck.json") && message.contains("abababababab") && message.contains(hash),
        "{message}"
    );
}

#[test]
fn a_pick_out_of_range_is_refused() {
    let (folder, _) = scene();
    let message = refused(folder.path(), &["--unit", "cm", "--cut", "3,99"]);
    assert!(message.contains("vertex 99") && message.contains("25"), "{message}");
}

#[test]
fn nonsense_is_a_usage_error() {
    let (folder, _) = scene();
    let common = ["--mesh", "grid.obj", "--unit", "cm", "--out", "out.obj", "--map", "map.json"];
    for wrong in [&["--keep-sphere", "1,2,3"][..], &["--keep-above", "w=3"], &["--cut", "7"], &[]] {
        command(folder.path()).args(common).args(wrong).assert().code(2);
    }
}

#[test]
fn help_reads_well() {
    let output = command(Path::new(".")).arg("--help").env("COLUMNS", "100").output().expect("it runs");
    insta::assert_snapshot!(String::from_utf8(output.stdout).expect("text"));
}
