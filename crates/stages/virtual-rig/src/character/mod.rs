//! A skinned character for games: the rig's face on 21 bones, its reference poses and their wrinkle maps.
//!
//! The wrinkles of a game come from a few reference poses, each with a normal map [DutreveMeyer2011]. The bones' moves are fitted to the
//! face's own motion; the maps show the person's own lines as analytic grooves, so that every normal is known.

mod bones;
mod fit;
mod maps;

pub use bones::BONE_COUNT;
pub use maps::{Map, neutral_map, wrinkle_map};

use crate::body::{Body, MUSCLES};
use artifact::gltf::{Animation, Channel, Character, Interpolation, Keys, Node, Placement, SkinnedMesh};
use artifact::{BonePlacement, Poses, ReferencePose};
use bones::{Bones, HEAD};
use nalgebra::{Isometry3, Matrix4, Point3, Vector3};

/// glTF counts in metres.
const METRES: f64 = 1e-3;

/// A pose by what its muscles do.
struct Acted {
    name: &'static str,
    muscles: &'static [(&'static str, f64)],
}

const fn acted(name: &'static str, muscles: &'static [(&'static str, f64)]) -> Acted {
    Acted { name, muscles }
}

/// The reference poses.
const REFERENCES: [Acted; 4] = [
    acted("brows-up", &[("brow_raise_l", 1.0), ("brow_raise_r", 1.0)]),
    acted("frown", &[("frown", 1.0)]),
    acted("smile", &[("smile_l", 1.0), ("smile_r", 1.0), ("squint", 0.6)]),
    acted("snarl", &[("nose_wrinkle", 1.0)]),
];

/// The six basis expressions [DutreveMeyer2011, Fig. 7].
const EXPRESSIONS: [Acted; 6] = [
    acted("joy", &[("smile_l", 0.9), ("smile_r", 0.9), ("squint", 0.5)]),
    acted("sad", &[("frown", 0.5), ("brow_raise_l", 0.3), ("brow_raise_r", 0.3), ("lips_press", 0.5)]),
    acted("disgust", &[("nose_wrinkle", 0.9), ("frown", 0.4), ("squint", 0.4)]),
    acted("surprise", &[("brow_raise_l", 1.0), ("brow_raise_r", 1.0), ("jaw_open", 0.6)]),
    acted("fear", &[("brow_raise_l", 0.8), ("brow_raise_r", 0.8), ("frown", 0.6), ("mouth_stretch", 0.7)]),
    acted("angry", &[("frown", 1.0), ("lips_press", 0.6), ("squint", 0.5)]),
];

/// The ids of the reference poses, in their order.
#[must_use]
pub fn reference_names() -> [&'static str; 4] {
    REFERENCES.each_ref().map(|pose| pose.name)
}

/// What each muscle does in a reference pose or a basis expression, by its name; nothing of an unknown one.
#[must_use]
pub fn muscles_of(name: &str) -> Option<std::collections::BTreeMap<String, f64>> {
    let pose = REFERENCES.iter().chain(&EXPRESSIONS).find(|pose| pose.name == name)?;
    Some(pose.muscles.iter().map(|(muscle, weight)| ((*muscle).to_string(), *weight)).collect())
}

/// The names that [`muscles_of`] knows.
pub fn pose_names() -> impl Iterator<Item = &'static str> {
    REFERENCES.iter().chain(&EXPRESSIONS).map(|pose| pose.name)
}

/// A body on bones, in metres, with an animation `reference-poses` (the neutral face at 0 s, then a pose a second) and one
/// `expressions` (from the neutral face to each basis expression and back, two seconds each).
#[must_use]
pub fn character(body: &Body) -> Character {
    let bones = Bones::of(body);
    let rest: Vec<Placement> = (0..BONE_COUNT).map(|bone| bones.rest(bone, METRES)).collect();
    let nodes: Vec<Node> = bones
        .names()
        .zip(&rest)
        .enumerate()
        .map(|(bone, (name, rest))| Node { name, parent: (bone != HEAD).then_some(HEAD), rest: *rest })
        .collect();
    let mesh = SkinnedMesh {
        name: "face".into(),
        positions: body.mesh.positions.iter().map(|point| point * METRES).collect(),
        uvs: texture_coordinates(body),
        triangles: body.triangles.clone(),
        joints: (0..BONE_COUNT).collect(),
        inverse_bind: (0..BONE_COUNT)
            .map(|bone| Matrix4::new_translation(&(-bones.place(bone).coords * METRES)))
            .collect(),
        influences: bones.influences.clone(),
    };
    let posed = |pose: &Acted| fit::moves(body, &bones, &body.large_scale(&weights(pose)));
    let references: Vec<_> = REFERENCES.iter().map(posed).collect();
    let expressions: Vec<_> = EXPRESSIONS.iter().map(posed).collect();
    let still = vec![Isometry3::identity(); BONE_COUNT];
    let steps: Vec<_> = std::iter::once(still.clone()).chain(references).collect();
    let there_and_back: Vec<_> =
        expressions.into_iter().flat_map(|pose| [still.clone(), pose]).chain([still.clone()]).collect();
    let animations = vec![
        animation("reference-poses", &bones, &steps, Interpolation::Step),
        animation("expressions", &bones, &there_and_back, Interpolation::Linear),
    ];
    Character { nodes, meshes: vec![mesh], animations }
}

/// The reference poses as a file says them; maps are added by whoever writes them.
#[must_use]
pub fn reference_poses(character: &Character) -> Poses {
    let pose = |(number, pose): (usize, &Acted)| {
        let mut bones = std::collections::BTreeMap::<String, BonePlacement>::new();
        for channel in &character.animations[0].channels {
            let bone = bones.entry(character.nodes[channel.node].name.clone()).or_default();
            match &channel.keys {
                Keys::Translation(keys) => bone.translation = Some(keys[number + 1]),
                Keys::Rotation(keys) => {
                    let [x, y, z, w] = keys[number + 1];
                    bone.rotation_wxyz = Some([w, x, y, z]);
                }
                Keys::Scale(keys) => bone.scale = Some(keys[number + 1]),
            }
        }
        ReferencePose { id: pose.name.into(), bones, map: None }
    };
    Poses { model: None, poses: REFERENCES.iter().enumerate().map(pose).collect(), modulation: None }
}

/// Per muscle its weight in a pose.
fn weights(pose: &Acted) -> Vec<f64> {
    let weight =
        |muscle: &&str| pose.muscles.iter().find(|(name, _)| name == muscle).map_or(0.0, |pair| pair.1);
    MUSCLES.iter().map(weight).collect()
}

/// Per vertex, v down, as glTF has it.
fn texture_coordinates(body: &Body) -> Vec<[f64; 2]> {
    let mut uvs = vec![[0.0; 2]; body.mesh.positions.len()];
    for (vertex, uv) in body.mesh.polygons.corners().iter().zip(&body.mesh.corner_uvs) {
        let uv = body.mesh.uvs[*uv as usize];
        uvs[*vertex as usize] = [uv.x, 1.0 - uv.y];
    }
    uvs
}

/// A key a second; only bones that move have channels.
fn animation(
    name: &str,
    bones: &Bones,
    poses: &[Vec<Isometry3<f64>>],
    interpolation: Interpolation,
) -> Animation {
    let times: Vec<f64> = (0..poses.len()).map(|second| second as f64).collect();
    let moving = (0..BONE_COUNT).filter(|&bone| poses.iter().any(|pose| pose[bone] != Isometry3::identity()));
    let channels = moving.flat_map(|bone| {
        let placed = |pose: &Vec<Isometry3<f64>>| {
            let from_head = Point3::from(bones.rest(bone, METRES).translation);
            (from_head + pose[bone].translation.vector * METRES, pose[bone].rotation)
        };
        let translations: Vec<[f64; 3]> = poses.iter().map(|pose| placed(pose).0.into()).collect();
        let rotations: Vec<[f64; 4]> = poses.iter().map(|pose| placed(pose).1.coords.into()).collect();
        [Keys::Translation(translations), Keys::Rotation(rotations)].map(|keys| Channel {
            node: bone,
            times: times.clone(),
            interpolation,
            keys,
        })
    });
    Animation { name: name.into(), channels: channels.collect() }
}

/// Displacements from rest, mm.
fn displacements(body: &Body, posed: &[Point3<f64>]) -> Vec<Vector3<f64>> {
    posed.iter().zip(&body.mesh.positions).map(|(posed, rest)| posed - rest).collect()
}
