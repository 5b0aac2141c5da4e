//! The binary: what it writes, and how it refuses.
#![allow(clippy::expect_used, reason = "a test may fail")]

use artifact::{FileRef, MeshRef, Unit, VertexSet, obj, write_document};
use assert_cmd::Command;
use mesh::Mesh;
use std::path::Path;
use tempfile::TempDir;
use testkit::shapes;

const COMMON: [&str; 6] = ["--mesh", "scan.obj", "--unit", "cm", "--out", "out.obj"];

fn command(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wrinkle-removal"));
    command.current_dir(folder);
    command
}

/// A folder with `scan.obj` (a dent of 0.5 mm, in cm), and `dent.json`, the vertices around it.
fn scene() -> TempDir {
    let folder = TempDir::new().expect("a folder");
    write(folder.path(), &shapes::bump_plane(40, 0.5, -0.5, 1.2));
    let row = |row: u32| (12..29).map(move |column| row * 41 + column);
    let mesh = reference(folder.path(), 41 * 41);
    write_set(
        folder.path(),
        &VertexSet { mesh, name: "dent".to_string(), vertices: (12..29).flat_map(row).collect() },
    );
    folder
}

fn write(folder: &Path, mesh: &Mesh) {
    obj::write(&folder.join("scan.obj"), mesh, Unit::Cm)
        .and_then(artifact::Staged::publish)
        .expect("the scan");
}

fn reference(folder: &Path, vertex_count: usize) -> MeshRef {
    let sha256 = artifact::sha256(&folder.join("scan.obj")).expect("a hash");
    MeshRef { file: FileRef { name: "scan.obj".to_string(), sha256 }, unit: Unit::Cm, vertex_count }
}

fn write_set(folder: &Path, set: &VertexSet) {
    write_document(&folder.join("dent.json"), set).and_then(artifact::Staged::publish).expect("the set");
}

/// A grey PNG, row after row.
fn paint(folder: &Path, [width, height]: [u32; 2], pixels: Vec<u8>) {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let picture = image::GrayImage::from_raw(width, height, pixels).expect("pixels");
    picture.write_to(&mut bytes, image::ImageFormat::Png).expect("a PNG");
    artifact::stage_bytes(&folder.join("mask.png"), bytes.get_ref())
        .and_then(artifact::Staged::publish)
        .expect("the mask");
}

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = command(folder).args(COMMON).args(arguments).output().expect("it runs");
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!folder.join("out.obj").exists() && !folder.join("show.png").exists(), "no output is left");
    String::from_utf8(output.stderr).expect("text")
}

#[test]
fn writes_the_scan_without_its_dent_and_says_how() {
    let folder = scene();
    let run = command(folder.path())
        .args(COMMON)
        .args(["--vertices", "dent.json", "--show", "show.png", "--json"])
        .output()
        .expect("it runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let read = |name: &str| artifact::read_text(&folder.path().join(name)).expect("text");
    let (before, after) = (read("scan.obj"), read("out.obj"));
    let other = |text: &str| {
        text.lines().filter(|line| !line.starts_with("v ")).map(str::to_string).collect::<Vec<_>>()
    };
    assert_eq!(other(&before), other(&after), "faces, UVs and groups stay");
    let moved = before.lines().zip(after.lines()).filter(|(a, b)| a != b).count();
    assert!((200..=17 * 17).contains(&moved), "{moved} lines differ");
    let deepest = |name: &str| {
        let mesh = obj::read(&folder.path().join(name), Unit::Cm).expect("a mesh");
        mesh.positions.iter().map(|point| -point.z).fold(0.0, f64::max)
    };
    assert!(deepest("scan.obj") > 0.49 && deepest("out.obj") < 0.05, "{}", deepest("out.obj"));
    let side_car = read("out.obj.prov.json");
    assert!(side_car.contains("moved_max_mm") && side_car.contains("dent.json"), "{side_car}");
    assert!(folder.path().join("show.png").exists() && folder.path().join("show.png.prov.json").exists());
}

#[test]
fn a_painted_mask_and_detection_are_regions_too() {
    let folder = scene();
    paint(folder.path(), [3, 3], vec![0, 0, 0, 0, 255, 0, 0, 0, 0]);
    command(folder.path()).args(COMMON).args(["--uv-mask", "mask.png"]).assert().success();
    paint(folder.path(), [1, 1], vec![255]);
    command(folder.path()).args(COMMON).args(["--detect", "--curvature-per-mm", "0.05"]).assert().code(1);
}

#[test]
fn a_mask_that_is_black_or_has_no_place_is_refused() {
    let folder = scene();
    paint(folder.path(), [2, 2], vec![0; 4]);
    let message = refused(folder.path(), &["--uv-mask", "mask.png"]);
    assert!(message.contains("mask.png") && message.contains("black"), "{message}");
    paint(folder.path(), [2, 2], vec![255; 4]);
    let message = refused(folder.path(), &["--uv-mask", "mask.png", "--show", "show.png"]);
    assert!(message.contains("scan.obj") && message.contains("covers a whole part"), "{message}");
    let bare = Mesh { corner_uvs: Vec::new(), uvs: Vec::new(), ..shapes::grid(40, 0.5) };
    write(folder.path(), &bare);
    let message = refused(folder.path(), &["--uv-mask", "mask.png"]);
    assert!(message.contains("mask.png") && message.contains("no texture coordinates"), "{message}");
}

#[test]
fn files_of_other_kinds_and_meshes_are_refused() {
    let folder = scene();
    let message = refused(folder.path(), &["--uv-mask", "dent.json"]);
    assert!(message.contains("dent.json") && message.contains("PNG"), "{message}");
    let message = refused(folder.path(), &["--valleys", "dent.json"]);
    assert!(message.contains("dent.json") && message.contains("valleys"), "{message}");
    write(folder.path(), &shapes::bump_plane(40, 0.5, -0.4, 1.2));
    let message = refused(folder.path(), &["--vertices", "dent.json"]);
    assert!(message.contains("dent.json") && message.contains("was made for mesh"), "{message}");
}

#[test]
fn an_empty_list_and_a_torn_surface_are_refused() {
    let folder = scene();
    let mesh = reference(folder.path(), 41 * 41);
    write_set(folder.path(), &VertexSet { mesh, name: "none".to_string(), vertices: Vec::new() });
    let message = refused(folder.path(), &["--vertices", "dent.json"]);
    assert!(message.contains("dent.json") && message.contains("list of vertices is empty"), "{message}");
    write(folder.path(), &shapes::open_book());
    let mesh = reference(folder.path(), 5);
    write_set(folder.path(), &VertexSet { mesh, name: "book".to_string(), vertices: vec![0] });
    let message = refused(folder.path(), &["--vertices", "dent.json"]);
    assert!(message.contains("between vertices 0 and 1") && message.contains("mesh-clip"), "{message}");
}

#[test]
fn nonsense_is_refused() {
    let folder = scene();
    command(folder.path()).args(COMMON).assert().code(2);
    command(folder.path()).args(COMMON).args(["--vertices", "dent.json", "--width-mm", "2"]).assert().code(2);
    let message = refused(folder.path(), &["--vertices", "dent.json", "--strength", "1.5"]);
    assert!(message.contains("strength is 1.5"), "{message}");
}

#[test]
fn help_reads_well() {
    let output = command(Path::new(".")).arg("--help").env("COLUMNS", "100").output().expect("it runs");
    insta::assert_snapshot!(String::from_utf8(output.stdout).expect("text"));
}
