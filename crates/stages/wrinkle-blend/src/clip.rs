//! Poses out of animations.

use crate::{Error, Pose};
use artifact::BonePlacement;
use artifact::gltf::{Animation, Channel, Character, Interpolation, Keys, Node, Placement};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use std::collections::BTreeMap;

/// The pose in which the file leaves the character.
#[must_use]
pub fn rest(nodes: &[Node]) -> Pose {
    nodes.iter().map(|node| node.rest).collect()
}

/// The pose at a time of an animation, s; before its first key and after its last one it stands still.
#[must_use]
pub fn sample(nodes: &[Node], animation: &Animation, time: f64) -> Pose {
    let mut pose = rest(nodes);
    for channel in &animation.channels {
        let placement = &mut pose[channel.node];
        let moment = Moment::of(channel, time);
        match &channel.keys {
            Keys::Translation(keys) => placement.translation = Vector3::from(moment.value(keys)),
            Keys::Scale(keys) => placement.scale = Vector3::from(moment.value(keys)),
            Keys::Rotation(keys) => placement.rotation = moment.rotation(keys),
        }
    }
    pose
}

/// When the last key of an animation comes, s.
#[must_use]
pub fn duration(animation: &Animation) -> f64 {
    animation.channels.iter().filter_map(|channel| channel.times.last()).copied().fold(0.0, f64::max)
}

/// Several poses at once: each bone turns and moves by what each of them adds to rest, in their order. For sets of small poses
/// that rigs are driven by (a left and a right brow).
#[must_use]
pub fn combined(rest: &Pose, poses: &[Pose]) -> Pose {
    let add = |node: usize, start: &Placement| {
        poses.iter().fold(*start, |sum, pose| Placement {
            translation: sum.translation + pose[node].translation - start.translation,
            rotation: sum.rotation * (start.rotation.inverse() * pose[node].rotation),
            scale: sum.scale.component_mul(&pose[node].scale.component_div(&start.scale)),
        })
    };
    rest.iter().enumerate().map(|(node, start)| add(node, start)).collect()
}

/// A pose of a file on a character's bones.
///
/// # Errors
/// [`Error::UnknownBone`] if the character has no bone of a name.
pub fn placed(id: &str, bones: &BTreeMap<String, BonePlacement>, nodes: &[Node]) -> Result<Pose, Error> {
    let mut pose = rest(nodes);
    for (name, bone) in bones {
        let node = nodes.iter().position(|node| node.name == *name).ok_or_else(|| Error::UnknownBone {
            pose: id.to_string(),
            bone: name.clone(),
            near: near(name, nodes),
        })?;
        let placement = &mut pose[node];
        if let Some(translation) = bone.translation {
            placement.translation = translation.into();
        }
        if let Some([w, x, y, z]) = bone.rotation_wxyz {
            placement.rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        }
        if let Some(scale) = bone.scale {
            placement.scale = scale.into();
        }
    }
    Ok(pose)
}

/// Smaller differences from rest are those of 32-bit files: as a share of the length, or rad.
const ROUNDING: f64 = 1e-6;

/// The bones that do not rest in a pose, as a file says it.
#[must_use]
pub fn written(pose: &Pose, nodes: &[Node]) -> BTreeMap<String, BonePlacement> {
    let mut bones = BTreeMap::new();
    let apart = |a: &Vector3<f64>, b: &Vector3<f64>| (a - b).norm() > ROUNDING * a.norm().max(b.norm());
    for (node, placement) in nodes.iter().zip(pose) {
        let rest = &node.rest;
        let turned = rest.rotation.angle_to(&placement.rotation) > ROUNDING;
        let [x, y, z, w]: [f64; 4] = placement.rotation.coords.into();
        let moved = apart(&rest.translation, &placement.translation);
        let bone = BonePlacement {
            translation: moved.then(|| placement.translation.into()),
            rotation_wxyz: turned.then_some([w, x, y, z]),
            scale: apart(&rest.scale, &placement.scale).then(|| placement.scale.into()),
        };
        if bone != BonePlacement::default() {
            bones.insert(node.name.clone(), bone);
        }
    }
    bones
}

/// Bones of another file's motion on this character: by name. Names that this character lacks are returned.
#[must_use]
pub fn retargeted(motion: &Character, animation: &Animation, nodes: &[Node]) -> (Animation, Vec<String>) {
    let (mut channels, mut strangers) = (Vec::new(), Vec::new());
    for channel in &animation.channels {
        let name = &motion.nodes[channel.node].name;
        match nodes.iter().position(|node| node.name == *name) {
            Some(node) => channels.push(Channel { node, ..channel.clone() }),
            None if !strangers.contains(name) => strangers.push(name.clone()),
            None => {}
        }
    }
    (Animation { name: animation.name.clone(), channels }, strangers)
}

/// Up to five names that begin like this one or contain it.
fn near(name: &str, nodes: &[Node]) -> String {
    let name = name.to_lowercase();
    let start: String = name.chars().take(3).collect();
    let like = |node: &&Node| {
        let other = node.name.to_lowercase();
        other.contains(&start) || name.contains(&other)
    };
    let mut names: Vec<&str> = nodes.iter().filter(like).map(|node| node.name.as_str()).collect();
    if names.is_empty() {
        names = nodes.iter().map(|node| node.name.as_str()).collect();
    }
    names.truncate(5);
    names.join(", ")
}

/// A place between two keys.
struct Moment {
    before: usize,
    after: usize,
    /// From 0 at the one to 1 at the other.
    share: f64,
    /// From the one to the other, s.
    span: f64,
    interpolation: Interpolation,
}

impl Moment {
    fn of(channel: &Channel, time: f64) -> Self {
        let times = &channel.times;
        let after = times.partition_point(|key| *key <= time).min(times.len() - 1);
        let before = times.partition_point(|key| *key <= time).saturating_sub(1);
        let span = times[after] - times[before];
        let share = if span > 0.0 { (time - times[before]) / span } else { 0.0 };
        Self { before, after, share, span, interpolation: channel.interpolation }
    }

    fn value<const N: usize>(&self, keys: &[[f64; N]]) -> [f64; N] {
        let (a, b, t) = (self.before, self.after, self.share);
        match self.interpolation {
            Interpolation::Step => keys[a],
            Interpolation::Linear => {
                std::array::from_fn(|axis| keys[a][axis] + t * (keys[b][axis] - keys[a][axis]))
            }
            // Hermite's cubic, as the format's appendix C writes it.
            Interpolation::Cubic => {
                let (t2, t3) = (t * t, t * t * t);
                let weights = [
                    2.0 * t3 - 3.0 * t2 + 1.0,
                    self.span * (t3 - 2.0 * t2 + t),
                    3.0 * t2 - 2.0 * t3,
                    self.span * (t3 - t2),
                ];
                let terms = [3 * a + 1, 3 * a + 2, 3 * b + 1, 3 * b];
                std::array::from_fn(|axis| {
                    weights.iter().zip(terms).map(|(weight, term)| weight * keys[term][axis]).sum()
                })
            }
        }
    }

    fn rotation(&self, keys: &[[f64; 4]]) -> UnitQuaternion<f64> {
        let turn = |[x, y, z, w]: [f64; 4]| UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        match self.interpolation {
            Interpolation::Linear => {
                let (from, to) = (turn(keys[self.before]), turn(keys[self.after]));
                // Opposite rotations have no great circle between them.
                from.try_slerp(&to, self.share, 1e-9).unwrap_or(from)
            }
            _ => turn(self.value(keys)),
        }
    }
}
