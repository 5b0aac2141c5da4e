//! Skinned characters: what is written comes back, what others write is understood, broken files are named.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod support;

use artifact::gltf::{
    Animation, Channel, Character, Interpolation, Keys, Node, Placement, SkinnedMesh, read, write,
};
use nalgebra::{Matrix4, UnitQuaternion, Vector3};
use proptest::prelude::*;
use serde_json::{Value, json};
use support::Place;

fn node(name: &str, parent: Option<usize>, y: f64) -> Node {
    let rotation = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.25 * y);
    Node {
        name: name.into(),
        parent,
        rest: Placement { translation: Vector3::new(0.0, y, 0.5), rotation, scale: Vector3::repeat(1.0) },
    }
}

/// Three bones; a vertex with six influences, numbers that 32 bits hold.
fn character() -> Character {
    let nodes: Vec<Node> = std::iter::once(node("head", None, 0.0))
        .chain((1..7).map(|i| node(&format!("bone {i}"), Some(0), f64::from(i))))
        .collect();
    let six: Vec<(usize, f64)> = [0.5, 0.125, 0.125, 0.125, 0.0625, 0.0625].into_iter().enumerate().collect();
    let mesh = SkinnedMesh {
        name: "face".into(),
        positions: vec![
            [0., 0., 0.].into(),
            [1., 0., 0.25].into(),
            [0., 1., -0.5].into(),
            [1., 1., 0.].into(),
        ],
        uvs: vec![[0., 0.], [1., 0.], [0., 1.], [1., 1.]],
        triangles: vec![[0, 1, 2], [2, 1, 3]],
        joints: (0..7).collect(),
        inverse_bind: (0..7)
            .map(|i| Matrix4::new_translation(&Vector3::new(0.0, -f64::from(i), 0.0)))
            .collect(),
        influences: vec![vec![(0, 1.0)], six, vec![(1, 0.75), (6, 0.25)], vec![(3, 1.0)]],
    };
    let keys = Keys::Translation(vec![[0., 1., 0.5], [0., 2., 0.5]]);
    let channel = Channel { node: 1, times: vec![0.0, 1.5], interpolation: Interpolation::Linear, keys };
    let turn = Keys::Rotation(vec![[0., 0., 0., 1.], [0., 0.5, 0.5, 0.5]]);
    let other = Channel { node: 2, times: vec![0.0, 1.0], interpolation: Interpolation::Step, keys: turn };
    let animations = vec![Animation { name: "raise".into(), channels: vec![channel, other] }];
    Character { nodes, meshes: vec![mesh], animations }
}

#[test]
fn what_is_written_comes_back() {
    let place = Place::new();
    let path = place.path("head.glb");
    write(&path, &character()).unwrap().publish().unwrap();
    let (found, warnings) = read(&path).unwrap();
    let wanted = character();
    assert_eq!(warnings, Vec::<String>::new());
    assert_eq!(found.meshes, wanted.meshes);
    assert_eq!(found.animations, wanted.animations);
    // The mesh has a node of its own.
    assert_eq!(found.nodes.len(), 8);
    for (found, wanted) in found.nodes.iter().zip(&wanted.nodes) {
        assert_eq!((&found.name, found.parent), (&wanted.name, wanted.parent));
        assert!(found.rest.rotation.angle_to(&wanted.rest.rotation) < 1e-9);
        assert_eq!(found.rest.translation, wanted.rest.translation);
    }
}

/// A document with its bytes as base64, as some exporters write it: a triangle on one bone, 8-bit weights, its third vertex by a
/// sparse accessor.
fn foreign() -> Value {
    let mut bytes: Vec<u8> = Vec::new();
    for number in [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 9.0, 9.0, 9.0] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend([2, 0, 0, 0]);
    for number in [0.0f32, 1.0, 0.0] {
        bytes.extend(number.to_le_bytes());
    }
    // Bones and weights, four each; the second vertex names bone 1 twice.
    bytes.extend([0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0]);
    bytes.extend([255, 0, 0, 0, 51, 102, 102, 0, 255, 0, 0, 0]);
    json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": bytes.len(), "uri": format!("data:application/octet-stream;base64,{}", base64(&bytes)) }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 4 },
            { "buffer": 0, "byteOffset": 40, "byteLength": 12 },
            { "buffer": 0, "byteOffset": 52, "byteLength": 12 },
            { "buffer": 0, "byteOffset": 64, "byteLength": 12 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
              "sparse": { "count": 1, "indices": { "bufferView": 1, "componentType": 5121 }, "values": { "bufferView": 2 } } },
            { "bufferView": 3, "componentType": 5121, "count": 3, "type": "VEC4" },
            { "bufferView": 4, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4" },
        ],
        "nodes": [{ "name": "head", "children": [1] }, { "matrix": [0,2,0,0, -2,0,0,0, 0,0,2,0, 5,6,7,1] }, { "mesh": 0, "skin": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2 } }] }],
        "skins": [{ "joints": [0, 1] }],
    })
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |three: &[u8]| -> String {
        let word = (0..3).fold(0usize, |word, i| word << 8 | usize::from(three.get(i).copied().unwrap_or(0)));
        let letters = (0..4).map(|i| char::from(LETTERS[word >> (18 - 6 * i) & 63]));
        letters.enumerate().map(|(i, letter)| if i <= three.len() { letter } else { '=' }).collect()
    };
    bytes.chunks(3).map(group).collect()
}

fn read_value(value: &Value) -> artifact::Result<(Character, Vec<String>)> {
    let place = Place::new();
    read(&place.file("head.gltf", value.to_string()))
}

#[test]
fn what_others_write_is_understood() {
    let (character, _) = read_value(&foreign()).unwrap();
    let mesh = &character.meshes[0];
    assert_eq!(mesh.positions[2], [0.0, 1.0, 0.0].into(), "sparse");
    assert_eq!(mesh.influences[0], [(0, 1.0)]);
    assert_eq!(mesh.influences[1].iter().map(|pair| pair.0).collect::<Vec<_>>(), [0, 1]);
    assert!((mesh.influences[1][1].1 - 0.6).abs() < 1e-12, "the doubled bone counts with the sum");
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    let bone = &character.nodes[1];
    assert_eq!((bone.name.as_str(), bone.parent), ("node 1", Some(0)));
    assert!((bone.rest.scale - Vector3::repeat(2.0)).norm() < 1e-12);
    assert!((bone.rest.rotation.angle() - 90f64.to_radians()).abs() < 1e-12);
}

#[test]
fn faults_are_named_with_their_place() {
    type Change = fn(&mut Value);
    let cases: [(Change, &str); 10] = [
        (|v| v["asset"]["version"] = "1.0".into(), "no glTF 2"),
        (
            |v| v["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]),
            "export it without compression",
        ),
        (|v| v["nodes"][2] = json!({ "mesh": 0 }), "has no skinned mesh"),
        (|v| v["accessors"][1]["count"] = 4.into(), "accessor 1 (mesh mesh 0): reaches beyond its buffer"),
        (|v| v["accessors"][2]["count"] = 2.into(), "has 3 positions, but weights of 2 vertices"),
        (|v| v["skins"][0]["joints"] = json!([0]), "vertex 1: hangs on bone 1, but the skin has 1"),
        (|v| v["nodes"][0]["children"] = json!([0]), "is above itself"),
        (|v| v["nodes"][0]["children"] = json!([9]), "node 0: refers to node 9, but there are 3"),
        (|v| v["buffers"][0]["byteLength"] = 77.into(), "buffer 0: has 76 bytes instead of 77"),
        (
            |v| v["meshes"][0]["primitives"][0]["attributes"] = json!({ "POSITION": 0 }),
            "lacks JOINTS_0 or WEIGHTS_0",
        ),
    ];
    for (change, wanted) in cases {
        let mut value = foreign();
        change(&mut value);
        let said = read_value(&value).unwrap_err().to_string();
        assert!(said.contains(wanted), "{said}\nwanted: {wanted}");
    }
}

#[test]
fn weights_that_do_not_add_up_are_divided_by_their_sum() {
    let mut value = foreign();
    // As they stand, 255 is a weight of 255.
    value["accessors"][2]["normalized"] = false.into();
    let (character, warnings) = read_value(&value).unwrap();
    assert!(warnings[0].contains("do not add up to 1 (vertex 0: 255.000)"), "{warnings:?}");
    assert_eq!(character.meshes[0].influences[0], [(0, 1.0)]);
}

#[test]
fn real_data_reads() {
    let Some(folder) = testkit::data("skinned_face_makehuman") else { return };
    let (character, warnings) = read(&folder.join("head_base.glb")).unwrap();
    assert_eq!(warnings, Vec::<String>::new());
    let counts: Vec<usize> = character.meshes.iter().map(|mesh| mesh.positions.len()).collect();
    assert_eq!((counts[0], counts.iter().sum::<usize>(), character.nodes.len()), (4521, 5070, 64));
    assert_eq!(character.meshes[0].influences.iter().map(Vec::len).max(), Some(8));
    assert_eq!(character.animations[0].channels[0].times.len(), 60);
}

proptest! {
    /// Bytes that broke on the way are refused or read, never a panic.
    #[test]
    fn no_damage_stops_the_program(at in 0usize..20_000, byte: u8, cut in 0usize..20_000) {
        let place = Place::new();
        let path = place.path("head.glb");
        write(&path, &character()).unwrap().publish().unwrap();
        let mut bytes = support::bytes(&path);
        let count = bytes.len();
        bytes[at % count] = byte;
        if cut % 3 == 0 {
            bytes.truncate(cut % count);
        }
        let _ = read(&place.file("broken.glb", &bytes));
    }
}
