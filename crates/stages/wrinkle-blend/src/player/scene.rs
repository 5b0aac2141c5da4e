//! The whole of what the page draws.

use super::COLORS;
use super::block::{Block, Span};
use super::expressions::{Expression, Mix, all};
use super::parts::{Part, Watched, part};
use crate::{Blender, Error, Mask, Modulation, NamedPose, Params, Pose, Setting, duration, sample};
use artifact::gltf::{Animation, Node, Placement};
use serde::Serialize;

/// More poses than a shader hands from vertices to pixels everywhere.
pub const MAX_POSES: usize = 32;
/// Frames per second of clips; the page goes straight between two.
const CLIP_HZ: f64 = 30.0;
/// Longest clip, s: longer ones are cut off.
const CLIP_S: f64 = 120.0;

/// What the page draws; lists of numbers stand in a block beside it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scene {
    /// Millimetres in a unit of the character's file.
    pub mm_per_unit: f64,
    /// The bones and what holds them; a parent may stand behind its children.
    pub nodes: Vec<SceneNode>,
    /// Per node ten numbers: where it stands in the neutral pose (translation, rotation x y z w, scale).
    pub neutral: Span,
    /// The node that defines the head's space.
    pub head: usize,
    /// The bones that are watched.
    pub bones: Vec<SceneBone>,
    /// The reference poses.
    pub poses: Vec<ScenePose>,
    /// Points of θ; none: the paper's cosine.
    pub modulation: Option<Vec<[f64; 2]>>,
    /// Whether poses share out a bone's move.
    pub dual: bool,
    /// Whether bones count smoothly for vertices; else wholly, as in the paper.
    pub smooth: bool,
    /// What the buttons show.
    pub expressions: Vec<Expression>,
    /// The animations of the file.
    pub clips: Vec<Clip>,
    /// The meshes; the first one wears the wrinkles.
    pub parts: Vec<Part>,
}

/// A node.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneNode {
    /// Its name.
    pub name: String,
    /// The node above.
    pub parent: Option<usize>,
}

/// A bone that is watched.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneBone {
    /// Its name.
    pub name: String,
    /// Its node.
    pub node: usize,
    /// The watched point, in the bone's own space, units of the file.
    pub probe: [f64; 3],
    /// Where that is in the neutral pose, in the head's space, mm.
    pub neutral: [f64; 3],
}

/// A reference pose.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScenePose {
    /// Its id.
    pub id: String,
    /// Its colour where influence is shown.
    pub color: [f32; 3],
    /// Placements of all nodes, like the neutral ones.
    pub placements: Span,
    /// Per watched bone how far it goes, mm; none where it is not of the pose.
    pub ways: Vec<Option<[f64; 3]>>,
}

/// An animation, frame by frame.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Clip {
    /// Its name.
    pub name: String,
    /// Frames per second.
    pub hz: f64,
    /// How many frames.
    pub frames: usize,
    /// Seconds that were cut off.
    pub cut_s: f64,
    /// The nodes that it moves.
    pub nodes: Vec<usize>,
    /// Frame after frame the placements of these nodes.
    pub placements: Span,
}

/// What the user wants beside the character and its poses.
#[derive(Debug, Clone, Copy)]
pub struct Wish<'a> {
    /// How poses are compared.
    pub params: &'a Params,
    /// θ.
    pub modulation: &'a Modulation,
    /// Expressions of the user's own.
    pub expressions: &'a [Mix],
}

/// The scene of a character, and its block of numbers.
///
/// # Errors
/// [`Error::NoUvs`] if no map can lie on the mesh, [`Error::ManyPoses`] if it has more than [`MAX_POSES`].
pub fn scene(
    setting: Setting<'_>,
    poses: &[NamedPose],
    blender: &Blender,
    wish: Wish<'_>,
) -> Result<(Scene, Vec<u8>), Error> {
    check(setting, poses)?;
    let nodes = &setting.character.nodes;
    let mut block = Block::default();
    let scene = Scene {
        mm_per_unit: setting.mm_per_unit,
        parts: parts(setting, blender, &mut block),
        nodes: nodes.iter().map(|node| SceneNode { name: node.name.clone(), parent: node.parent }).collect(),
        neutral: placements(setting.neutral, &mut block),
        head: blender.head(),
        bones: bones(blender),
        poses: scene_poses(poses, blender, &mut block),
        modulation: match wish.modulation {
            Modulation::Cosine => None,
            Modulation::Curve(points) => Some(points.clone()),
        },
        dual: wish.params.dual,
        smooth: wish.params.mask == Mask::Smooth,
        expressions: all(blender.poses(), wish.expressions),
        clips: setting.character.animations.iter().map(|clip| self::clip(nodes, clip, &mut block)).collect(),
    };
    Ok((scene, block.0))
}

fn check(setting: Setting<'_>, poses: &[NamedPose]) -> Result<(), Error> {
    let mesh = &setting.character.meshes[setting.mesh];
    if mesh.uvs.is_empty() {
        return Err(Error::NoUvs { mesh: mesh.name.clone() });
    }
    match poses.len() > MAX_POSES {
        true => Err(Error::ManyPoses { count: poses.len(), most: MAX_POSES }),
        false => Ok(()),
    }
}

/// The meshes, first the one that wears the wrinkles.
fn parts(setting: Setting<'_>, blender: &Blender, block: &mut Block) -> Vec<Part> {
    let character = setting.character;
    let watched = watched(blender, character.nodes.len());
    let others = (0..character.meshes.len()).filter(|other| *other != setting.mesh);
    let numbers = std::iter::once(setting.mesh).chain(others);
    numbers
        .map(|number| {
            let mesh = &character.meshes[number];
            part(mesh, &character.nodes, &watched, number == setting.mesh, block)
        })
        .collect()
}

fn scene_poses(poses: &[NamedPose], blender: &Blender, block: &mut Block) -> Vec<ScenePose> {
    let way = |pose: usize, bone: usize| blender.way(pose, bone).map(<[f64; 3]>::from);
    let pose = |(number, (id, pose)): (usize, &NamedPose)| ScenePose {
        id: id.clone(),
        color: COLORS[number % COLORS.len()],
        placements: placements(pose, block),
        ways: (0..blender.bones().len()).map(|bone| way(number, bone)).collect(),
    };
    poses.iter().enumerate().map(pose).collect()
}

fn bones(blender: &Blender) -> Vec<SceneBone> {
    let bone = |(bone, neutral): (&crate::Bone, &nalgebra::Point3<f64>)| SceneBone {
        name: bone.name.clone(),
        node: bone.node(),
        probe: bone.probe().coords.into(),
        neutral: neutral.coords.into(),
    };
    blender.bones().iter().zip(blender.neutral()).map(bone).collect()
}

/// Per node the watched bone on it, and which poses that is of.
fn watched(blender: &Blender, node_count: usize) -> Watched {
    let mut watched = vec![None; node_count];
    for (number, bone) in blender.bones().iter().enumerate() {
        let of = (0..blender.poses().len()).filter(|&pose| blender.way(pose, number).is_some());
        watched[bone.node()] = Some((number as u32, of.fold(0, |mask, pose| mask | 1 << pose)));
    }
    watched
}

fn numbers(placement: &Placement) -> impl Iterator<Item = f64> + use<> {
    let parts: [[f64; 3]; 2] = [placement.translation.into(), placement.scale.into()];
    let turn: [f64; 4] = placement.rotation.coords.into();
    parts[0].into_iter().chain(turn).chain(parts[1])
}

fn placements(pose: &Pose, block: &mut Block) -> Span {
    block.floats(pose.iter().flat_map(numbers))
}

fn clip(nodes: &[Node], animation: &Animation, block: &mut Block) -> Clip {
    let mut moved: Vec<usize> = animation.channels.iter().map(|channel| channel.node).collect();
    moved.sort_unstable();
    moved.dedup();
    let (whole, shown) = (duration(animation), duration(animation).min(CLIP_S));
    let frames = (shown * CLIP_HZ + 1e-6).floor() as usize + 1;
    let pose = |frame: usize| {
        let pose = sample(nodes, animation, frame as f64 / CLIP_HZ);
        moved.iter().flat_map(|&node| numbers(&pose[node])).collect::<Vec<_>>()
    };
    let placements = block.floats((0..frames).flat_map(pose));
    Clip { name: animation.name.clone(), hz: CLIP_HZ, frames, cut_s: whole - shown, nodes: moved, placements }
}
