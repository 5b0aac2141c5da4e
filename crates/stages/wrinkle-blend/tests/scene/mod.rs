//! A face of two charts on three bones below a head.
#![allow(dead_code, reason = "each test file uses its own part")]

use artifact::gltf::{Animation, Channel, Character, Interpolation, Keys, Node, Placement, SkinnedMesh};
use nalgebra::{Matrix4, UnitQuaternion, Vector3};
use wrinkle_blend::{Blender, Modulation, NamedPose, Params, Pose, Setting, rest};

/// Where the bones stand in the head, m: left and right of a square face, and a jaw that turns about a far axis.
const BONES: [(&str, [f64; 3]); 3] =
    [("left", [-0.05, 0.05, 0.1]), ("right", [0.05, 0.05, 0.1]), ("jaw", [0.0, 0.0, 0.0])];

/// Nodes: neck, head, left, right, jaw; a grid of 5 × 5 vertices, 0.2 m wide, that covers the whole map.
pub(crate) fn character() -> Character {
    let placement = |at: [f64; 3]| Placement { translation: at.into(), ..Placement::default() };
    let node = |name: &str, parent, at| Node { name: name.into(), parent, rest: placement(at) };
    let mut nodes = vec![node("neck", None, [0.0, 1.5, 0.0]), node("head", Some(0), [0.0, 0.1, 0.0])];
    nodes.extend(BONES.iter().map(|(name, at)| node(name, Some(1), *at)));
    let bind = |at: [f64; 3]| Matrix4::new_translation(&-Vector3::new(at[0], at[1] + 1.6, at[2]));
    let inverse_bind = std::iter::once([0.0; 3]).chain(BONES.map(|bone| bone.1)).map(bind).collect();
    let grid = (0..25).map(|i| [f64::from(i % 5) / 4.0, f64::from(i / 5) / 4.0]);
    let point = |[u, v]: [f64; 2]| [0.2 * (u - 0.5), 1.6 + 0.2 * (0.5 - v), 0.1].into();
    let influence = |[u, v]: [f64; 2]| match (u, v) {
        (_, v) if v > 0.6 => vec![(0, 0.25), (3, 0.75)],
        (u, _) if u < 0.4 => vec![(0, 0.5), (1, 0.5)],
        (u, _) if u > 0.6 => vec![(0, 0.5), (2, 0.5)],
        _ => vec![(0, 1.0)],
    };
    let cells = (0..16u32).map(|cell| cell / 4 * 5 + cell % 4);
    let mesh = SkinnedMesh {
        name: "face".into(),
        positions: grid.clone().map(point).collect(),
        uvs: grid.clone().collect(),
        triangles: cells.flat_map(|a| [[a, a + 5, a + 1], [a + 1, a + 5, a + 6]]).collect(),
        joints: vec![1, 2, 3, 4],
        inverse_bind,
        influences: grid.map(influence).collect(),
    };
    let mut character = Character { nodes, meshes: vec![mesh], animations: vec![] };
    character.animations.push(clip(&character));
    character
}

/// At 0 s rest, then a pose of [`poses`] a second.
fn clip(character: &Character) -> Animation {
    let all: Vec<Pose> = std::iter::once(rest(&character.nodes))
        .chain(poses(character).into_iter().map(|pose| pose.1))
        .collect();
    let times: Vec<f64> = (0..all.len()).map(|second| second as f64).collect();
    let channels = (2..5).flat_map(|node| {
        let moves = Keys::Translation(all.iter().map(|pose| pose[node].translation.into()).collect());
        let turns = Keys::Rotation(all.iter().map(|pose| pose[node].rotation.coords.into()).collect());
        [moves, turns].map(|keys| Channel {
            node,
            times: times.clone(),
            interpolation: Interpolation::Linear,
            keys,
        })
    });
    Animation { name: "poses".into(), channels: channels.collect() }
}

/// The left side up; both sides down and in; the jaw open, which turns on the spot.
pub(crate) fn poses(character: &Character) -> Vec<NamedPose> {
    let rest = rest(&character.nodes);
    let moved = |change: &dyn Fn(&mut Pose)| {
        let mut pose = rest.clone();
        change(&mut pose);
        pose
    };
    vec![
        ("up".into(), moved(&|pose| pose[2].translation.y += 0.008)),
        (
            "in".into(),
            moved(&|pose| {
                pose[2].translation += Vector3::new(0.005, 0.003, 0.0);
                pose[3].translation += Vector3::new(-0.005, -0.002, 0.0);
            }),
        ),
        ("open".into(), moved(&|pose| pose[4].rotation = UnitQuaternion::from_euler_angles(0.2, 0.0, 0.0))),
    ]
}

pub(crate) fn setting<'a>(character: &'a Character, neutral: &'a Pose) -> Setting<'a> {
    Setting { character, mesh: 0, head_bone: None, mm_per_unit: 1000.0, neutral }
}

pub(crate) fn blender(character: &Character, params: &Params) -> Blender {
    let neutral = rest(&character.nodes);
    Blender::new(setting(character, &neutral), &poses(character), Modulation::Cosine, params).unwrap()
}
