//! The binary: tables, verdicts, refusals.

#![allow(clippy::unwrap_used, reason = "a test may fail by panic")]

use artifact::{
    FileRef, FrameWriter, Handle, HandleFrame, Handles, HandlesHeader, LargeScale, MarkerFrame, MarkerHeader,
    MeshRef, SampleStatus, Trajectories3d, Unit, VertexSet, pc2,
};
use assert_cmd::Command;
use mesh::Mesh;
use nalgebra::{Point3, Vector3};
use std::path::Path;
use tempfile::TempDir;

fn diff(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let mut command: Command = assert_cmd::cargo::cargo_bin_cmd!("artifact-diff");
    let output = command.current_dir(folder).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

fn corner(z: f64) -> Mesh {
    Mesh::from_triangles(
        vec![[0., 0., 0.], [10., 0., 0.], [0., 10., z], [10., 10., 0.]],
        &[[0, 1, 2], [2, 1, 3]],
    )
}

fn markers(path: &Path, x: f64) {
    let ids = vec!["brow_l".to_string(), "lip_r".to_string()];
    let header = MarkerHeader { unit: Unit::Mm, rate: None, markers: ids, take: None };
    let mut writer = FrameWriter::<Trajectories3d>::create(path, header).unwrap();
    for frame in [1001, 1002] {
        let points = vec![Some(Point3::new(1.0, 2.0, 3.0)), Some(Point3::new(x, 0.0, 0.0))];
        writer.write(&MarkerFrame { frame, points, status: vec![SampleStatus::Measured; 2] }).unwrap();
    }
    writer.finish().unwrap().publish().unwrap();
}

/// The markers' frames, without a sample.
fn gap(path: &Path) {
    let ids = vec!["brow_l".to_string(), "lip_r".to_string()];
    let header = MarkerHeader { unit: Unit::Mm, rate: None, markers: ids, take: None };
    let mut writer = FrameWriter::<Trajectories3d>::create(path, header).unwrap();
    for frame in [1001, 1002] {
        let (points, status) = (vec![None; 2], vec![SampleStatus::Measured; 2]);
        writer.write(&MarkerFrame { frame, points, status }).unwrap();
    }
    writer.finish().unwrap().publish().unwrap();
}

fn handles(path: &Path, mesh: &MeshRef, vertex: u32, x: f64) {
    let handles = vec![Handle { marker: "lip_r".into(), vertex }];
    let header = HandlesHeader { mesh: mesh.clone(), rate: None, handles, take: None, warp: None };
    let mut writer = FrameWriter::<Handles>::create(path, header).unwrap();
    let displacements = vec![Some(Vector3::new(x, 0.0, 0.0))];
    writer.write(&HandleFrame { frame: 7, displacements, weights: vec![None] }).unwrap();
    writer.finish().unwrap().publish().unwrap();
}

/// Two of each kind, `a.*` and `b.*`.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for (name, z) in [("a", 0.0), ("b", 2.5)] {
        artifact::write_mesh(&at(&format!("{name}.obj")), &corner(z), Unit::Mm).unwrap().publish().unwrap();
        let mut cache = pc2::Writer::create(&at(&format!("{name}.pc2")), 4, 1001).unwrap();
        for frame in 0..3 {
            let mut sample = [0.0f32; 12];
            sample[11] = z as f32 * frame as f32;
            cache.write(&sample).unwrap();
        }
        cache.finish().unwrap().publish().unwrap();
        let file = FileRef { name: "a.obj".into(), sha256: artifact::sha256(&at("a.obj")).unwrap() };
        let mesh = MeshRef { file, unit: Unit::Cm, vertex_count: 4 };
        let frames = if name == "a" { vec![1, 2, 5] } else { vec![2, 5, 6] };
        let index = LargeScale {
            mesh: mesh.clone(),
            cache: format!("{name}.pc2"),
            form: artifact::SequenceForm::Pc2,
            rate: None,
            frames,
            take: None,
        };
        artifact::write_document(&at(&format!("{name}.json")), &index).unwrap().publish().unwrap();
        markers(&at(&format!("{name}-markers.jsonl")), z);
        handles(&at(&format!("{name}-handles.jsonl")), &mesh, if name == "a" { 1 } else { 2 }, z);
        let mut pixels = image::GrayImage::new(3, 2);
        pixels.put_pixel(1, 1, image::Luma([(z * 4.0) as u8]));
        pixels.save(at(&format!("{name}.png"))).unwrap();
        let set =
            VertexSet { mesh: MeshRef { unit: Unit::Mm, ..mesh }, name: "lip".into(), vertices: vec![0, 2] };
        artifact::write_document(&at("lip.json"), &set).unwrap().publish().unwrap();
        let none = VertexSet { name: "none".into(), vertices: Vec::new(), ..set };
        artifact::write_document(&at("none.json"), &none).unwrap().publish().unwrap();
    }
    gap(&at("gap.jsonl"));
    folder
}

#[test]
fn help() {
    insta::assert_snapshot!(diff(Path::new("."), &["--help"]).1);
}

#[test]
fn tables() {
    let folder = folder();
    let table = |arguments: &[&str]| {
        let (code, table, said) = diff(folder.path(), arguments);
        assert_eq!((code, said.as_str()), (0, ""), "{arguments:?}");
        format!("{}\n{table}\n", arguments.join(" "))
    };
    let text = [
        table(&["a.obj", "b.obj", "--unit", "mm", "--region", "lip.json"]),
        table(&["a.obj", "a.obj", "--unit", "mm"]),
        table(&["a.pc2", "b.pc2", "--unit", "mm"]),
        table(&["a.json", "b.json"]),
        table(&["a-markers.jsonl", "b-markers.jsonl"]),
        table(&["a-handles.jsonl", "b-handles.jsonl"]),
        table(&["a.png", "b.png"]),
    ];
    insta::assert_snapshot!(text.concat());
}

/// Arguments, exit code, and what the message must say.
const VERDICTS: [(&[&str], i32, &str); 20] = [
    (&["a.obj", "b.obj", "--unit", "mm", "--tolerance-mm", "2.5"], 0, ""),
    (
        &["a.obj", "b.obj", "--unit", "mm", "--tolerance-mm", "2"],
        1,
        "2.500 mm at vertex 2: 0.5000 mm more than the 2 mm allowed",
    ),
    (&["a.obj", "a.obj", "--unit", "mm", "--second-unit", "cm", "--tolerance-mm", "1"], 1, "at vertex 3"),
    (&["a.obj", "b.obj"], 1, "a.obj: its unit is not stated"),
    (&["a.pc2", "b.pc2"], 1, "a.pc2: its unit is not stated"),
    (&["a.pc2", "b.pc2", "--unit", "cm", "--tolerance-mm", "49"], 1, "50.00 mm at frame 1003, vertex 3"),
    (&["a.pc2", "b.pc2", "--unit", "cm", "--tolerance-mm", "49", "--frames", "1001-1002"], 0, ""),
    (
        &["a.json", "b.json", "--strict"],
        1,
        "frame 1 is only in the first\n  and: frame 6 is only in the second",
    ),
    (&["a.json", "b.json", "--unit", "mm"], 1, "a.json: was made with its mesh in cm, not in mm"),
    (&["a-markers.jsonl", "b-markers.jsonl", "--tolerance-mm", "1"], 1, "frame 1001, marker lip_r"),
    (&["a-handles.jsonl", "b-handles.jsonl", "--strict"], 1, "handle lip_r sits on vertex 1 against 2"),
    (&["a.png", "b.png", "--tolerance-levels", "9"], 1, "10.00 levels at pixel 1, 1, gray"),
    (&["a.png", "b.png", "--tolerance-mm", "9"], 1, "--tolerance-mm means nothing for an image"),
    (&["a.png", "b.obj"], 1, "a.png is an image, but b.obj is a mesh"),
    (&["a.obj", "none.obj", "--unit", "mm"], 1, "none.obj: cannot read"),
    (&["a.txt", "b.obj"], 1, "a.txt: has an ending that is not known"),
    (&["a.obj", "b.obj", "--tolerance-mm", "-1"], 2, "tolerance"),
    (
        &["a.obj", "a.obj", "--unit", "mm", "--region", "none.json", "--tolerance-mm", "9"],
        1,
        "they cannot be judged: nothing was compared in region none",
    ),
    (&["a-markers.jsonl", "gap.jsonl", "--tolerance-mm", "9"], 1, "nothing was compared"),
    (&["a-markers.jsonl", "gap.jsonl"], 0, ""),
];

#[test]
fn verdicts() {
    let folder = folder();
    for (arguments, code, message) in VERDICTS {
        let (found, _, said) = diff(folder.path(), arguments);
        assert_eq!(found, code, "{arguments:?}: {said}");
        assert!(said.contains(message), "{arguments:?} said: {said}");
    }
}

#[test]
fn json_is_printed_even_where_the_verdict_is_bad() {
    let folder = folder();
    let (code, printed, said) =
        diff(folder.path(), &["a.obj", "b.obj", "--unit", "mm", "--tolerance-mm", "1", "--json"]);
    assert_eq!(code, 1);
    assert!(said.contains("they differ"), "{said}");
    assert!(printed.starts_with('{') && printed.contains(r#""max":2.5,"max_at":"vertex 2""#), "{printed}");
    assert_eq!(printed.lines().count(), 1);
}
