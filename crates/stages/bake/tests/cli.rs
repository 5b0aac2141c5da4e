//! The binary: what it writes, and how it refuses.
#![allow(clippy::expect_used, reason = "a test may fail")]

use artifact::{
    BakedMaps, FileRef, LargeScale, MeshRef, SequenceForm, Staged, Unit, Wrinkled, npy, obj, pc2, picture,
    read_document, write_document,
};
use assert_cmd::Command;
use mesh::Mesh;
use std::path::Path;
use tempfile::TempDir;
use testkit::shapes;

fn command(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_bake"));
    command.current_dir(folder);
    command
}

/// 20 mm wide.
fn patch(cells: u32, height: impl Fn(f64, f64) -> f64) -> Mesh {
    shapes::relief(cells, 20.0 / f64::from(cells), height)
}

/// The patch as a character whose only bone moves nothing, in metres.
fn character(path: &Path, mesh: &Mesh) {
    use artifact::gltf::{Character, Node, Placement, SkinnedMesh, write};
    let triangles: Vec<[u32; 3]> = mesh.triangles();
    let mut uvs = vec![[0.0; 2]; mesh.positions.len()];
    for (vertex, uv) in mesh.polygons.corners().iter().zip(&mesh.corner_uvs) {
        let uv = mesh.uvs[*uv as usize];
        uvs[*vertex as usize] = [uv.x, 1.0 - uv.y];
    }
    let skin = SkinnedMesh {
        name: "skin".into(),
        positions: mesh.positions.iter().map(|point| point * 1e-3).collect(),
        uvs,
        triangles,
        joints: vec![0],
        inverse_bind: vec![nalgebra::Matrix4::identity()],
        influences: vec![vec![(0, 1.0)]; mesh.positions.len()],
    };
    let nodes = vec![Node { name: "head".into(), parent: None, rest: Placement::default() }];
    let character = Character { nodes, meshes: vec![skin], animations: Vec::new() };
    write(path, &character).and_then(Staged::publish).expect("a character");
}

fn groove(x: f64, _: f64) -> f64 {
    -0.4 * (-0.5 * (x - 10.0).powi(2)).exp()
}

/// A folder with `low.obj` and `high.obj` in cm; and a sequence over `rest.obj` that moves up by 5 mm in frame 1002.
fn scene() -> TempDir {
    let folder = TempDir::new().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let save = |name: &str, mesh: &Mesh| {
        obj::write(&at(name), mesh, Unit::Cm).and_then(Staged::publish).expect("a mesh");
    };
    let rest = patch(40, |_, _| 0.0);
    save("low.obj", &patch(4, |_, _| 0.0));
    save("high.obj", &patch(40, groove));
    save("rest.obj", &rest);
    let file =
        FileRef { name: "rest.obj".to_string(), sha256: artifact::sha256(&at("rest.obj")).expect("a hash") };
    let mesh = MeshRef { file, unit: Unit::Cm, vertex_count: rest.positions.len() };
    for (name, wrinkled) in [("large", false), ("wrinkled", true)] {
        let cache = format!("{name}.pc2");
        let mut writer = pc2::Writer::create(&at(&cache), rest.positions.len(), 1001).expect("a cache");
        for lift in [0.0, 5.0] {
            let height = |x: f64, y: f64| lift + if wrinkled { groove(x, y) } else { 0.0 };
            let coordinates: Vec<f32> = patch(40, height)
                .positions
                .iter()
                .flat_map(|point| [point.x, point.y, point.z].map(|x| (x / 10.0) as f32))
                .collect();
            writer.write(&coordinates).expect("a frame");
        }
        writer.finish().and_then(Staged::publish).expect("the cache");
        let index = LargeScale {
            mesh: mesh.clone(),
            cache,
            form: SequenceForm::Pc2,
            rate: None,
            frames: vec![1001, 1002],
            take: None,
        };
        let path = at(&format!("{name}.json"));
        let staged =
            if wrinkled { write_document(&path, &Wrinkled(index)) } else { write_document(&path, &index) };
        staged.and_then(Staged::publish).expect("the index");
    }
    folder
}

const SINGLE: [&str; 8] = ["--low", "low.obj", "--high", "high.obj", "--unit", "cm", "--size", "32"];

fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = command(folder).args(arguments).args(["--out", "maps"]).output().expect("it runs");
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!folder.join("maps/maps.json").exists(), "no output is left");
    String::from_utf8(output.stderr).expect("text")
}

#[test]
fn writes_maps_that_say_how_they_are_read() {
    let folder = scene();
    let at = |name: &str| folder.path().join("maps").join(name);
    let output = command(folder.path())
        .args(SINGLE)
        .args(["--out", "maps", "--tangents", "maps/tangents.npy", "--json"])
        .output()
        .expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let maps: BakedMaps = read_document(&at("maps.json")).expect("the index");
    assert_eq!((maps.mesh.vertex_count, maps.size, maps.tiles.len()), (25, 32, 1));
    assert_eq!((maps.black_mm, maps.white_mm), (-0.4, 0.4));
    let depth = picture::read_gray(&at(&maps.tiles[0].displacement)).expect("the displacement");
    let deepest = depth.pixels.iter().copied().fold(1.0, f64::min) * 0.8 - 0.4;
    assert!((-0.4..-0.35).contains(&deepest), "{deepest}");
    let normals = picture::read_rgb(&at(&maps.tiles[0].normal)).expect("the normals");
    // Left of the groove the surface falls to the right: it looks to the right.
    assert!(normals.at(14, 16)[0] > 0.6 && normals.at(17, 16)[0] < 0.4 && normals.at(2, 16)[2] > 0.999);
    let exr = artifact::read_bytes(&at(&maps.tiles[0].displacement_exr)).expect("the EXR");
    assert_eq!(exr[..4], [0x76, 0x2f, 0x31, 0x01], "the magic number of OpenEXR");
    assert_eq!(npy::read_f32(&at("tangents.npy")).expect("tangents").0, [96, 4]);
    assert!(at("maps.json.prov.json").exists());
}

#[test]
fn a_neutral_mesh_moves_along_with_the_frame() {
    let folder = scene();
    let sequence = ["--low", "low.obj", "--mesh", "rest.obj", "--wrinkled", "wrinkled.json", "--size", "32"];
    let run = |arguments: &[&str]| {
        let output = command(folder.path()).args(sequence).args(arguments).output().expect("it runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    run(&["--frame", "1001", "--out", "first"]);
    run(&["--frame", "1002", "--large-scale", "large.json", "--out", "second"]);
    let normals = |out: &str| picture::read_rgb(&folder.path().join(out).join("normal.png")).expect("a map");
    let (first, second) = (normals("first"), normals("second"));
    for at in 0..32 * 32 {
        let (one, other) = (first.at(at % 32, at / 32), second.at(at % 32, at / 32));
        assert!((0..3).all(|k| (one[k] - other[k]).abs() < 1e-4), "{one:?} {other:?}");
    }
    let message = refused(folder.path(), &[&sequence[..], &["--frame", "1002"]].concat());
    assert!(message.contains("low.obj") && message.contains("--large-scale"), "{message}");
    let message = refused(folder.path(), &[&sequence[..], &["--frame", "1003"]].concat());
    assert!(message.contains("wrinkled.json") && message.contains("frame 1003"), "{message}");
}

#[test]
fn green_and_bits_are_as_asked() {
    let folder = scene();
    let turned = patch(40, |x, y| groove(y, x));
    obj::write(&folder.path().join("high.obj"), &turned, Unit::Cm).and_then(Staged::publish).expect("a mesh");
    let green = |out: &str, arguments: &[&str]| {
        let run = command(folder.path()).args(SINGLE).args(arguments).args(["--out", out]).output();
        assert!(run.expect("it runs").status.success());
        let picture = picture::read_rgb(&folder.path().join(out).join("normal.png")).expect("a map");
        (picture.at(16, 14)[1], matches!(picture.codes, picture::Codes::Bits8(_)))
    };
    let ((up, deep), (down, shallow)) =
        (green("up", &["--bits", "16"]), green("down", &["--bits", "8", "--green", "directx"]));
    assert!(!deep && shallow);
    // Above the groove the surface falls downwards in the picture: it looks down.
    assert!(up < 0.4 && (up + down - 1.0).abs() < 0.01, "{up} {down}");
}

#[test]
fn refuses_what_does_not_fit() {
    let folder = scene();
    let of = |arguments: &[&str]| refused(folder.path(), arguments);
    let message = of(&["--low", "low.obj", "--high", "high.obj"]);
    assert!(message.contains("high.obj") && message.contains("--unit"), "{message}");
    let message = of(&["--low", "low.obj", "--high", "high.obj", "--unit", "cm", "--low-unit", "m"]);
    assert!(message.contains("low.obj") && message.contains("--reach-mm"), "{message}");
    let bare = Mesh { uvs: Vec::new(), corner_uvs: Vec::new(), ..patch(2, |_, _| 0.0) };
    obj::write(&folder.path().join("bare.obj"), &bare, Unit::Cm).and_then(Staged::publish).expect("a mesh");
    let message = of(&["--low", "bare.obj", "--high", "high.obj", "--unit", "cm"]);
    assert!(message.contains("bare.obj") && message.contains("texture coordinates"), "{message}");
    let message = of(&[&SINGLE[..], &["--samples", "0"]].concat());
    assert!(message.contains("--samples"), "{message}");
    let sequence =
        ["--low", "low.obj", "--mesh", "high.obj", "--wrinkled", "wrinkled.json", "--frame", "1001"];
    let message = of(&sequence);
    assert!(message.contains("wrinkled.json") && message.contains("high.obj"), "{message}");
}

#[test]
fn help_reads_well() {
    let output = command(Path::new(".")).arg("--help").env("COLUMNS", "100").output().expect("it runs");
    insta::assert_snapshot!(String::from_utf8(output.stdout).expect("text"));
}

#[test]
fn a_character_takes_the_same_maps_as_its_mesh() {
    let folder = scene();
    character(&folder.path().join("low.glb"), &patch(4, |_, _| 0.0));
    let normals = |low: &str, out: &str| {
        let words = ["--low", low, "--high", "high.obj", "--unit", "cm", "--size", "64", "--out", out];
        command(folder.path()).args(words).assert().success();
        let map = picture::read_rgb(&folder.path().join(out).join("normal.png")).expect("a map");
        (0..64 * 64).map(|i| map.at(i % 64, i / 64)).collect::<Vec<[f64; 3]>>()
    };
    let (mesh, character) = (normals("low.obj", "by-mesh"), normals("low.glb", "by-character"));
    // A GLB holds single precision.
    let apart = mesh.iter().zip(&character).flat_map(|(a, b)| [0, 1, 2].map(|k| (a[k] - b[k]).abs()));
    assert!(apart.fold(0.0, f64::max) < 1e-3);
    let words =
        ["--low", "low.glb", "--low-mesh", "hand", "--high", "high.obj", "--unit", "cm", "--out", "no"];
    let said = command(folder.path()).args(words).output().expect("it ran");
    let said = String::from_utf8_lossy(&said.stderr).into_owned();
    assert!(said.contains("low.glb") && said.contains("--low-mesh knows skin"), "{said}");
    assert!(!folder.path().join("no").exists());
}
