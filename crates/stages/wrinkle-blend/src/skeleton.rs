//! Bones below the head, and where they stand in its space.

use crate::Error;
use artifact::gltf::{Node, Placement};
use nalgebra::Matrix4;

/// A placement per node of the character.
pub type Pose = Vec<Placement>;

/// The head's bone and all below it. What moves the head as a whole lies above and is not seen.
#[derive(Debug, Clone)]
pub struct Skeleton {
    head: usize,
    /// Nodes below the head with their parents, each behind its parent.
    below: Vec<(usize, usize)>,
    node_count: usize,
}

impl Skeleton {
    /// The skeleton whose head is the bone of this name, or, without a name, the one called `head` in whatever case, or else the
    /// lowest node above all `bones`.
    ///
    /// # Errors
    /// [`Error::HeadBone`] if there is no such bone.
    pub fn new(nodes: &[Node], bones: &[usize], head: Option<&str>) -> Result<Self, Error> {
        let found = match head {
            Some(name) => nodes.iter().position(|node| node.name == name),
            None => named_head(nodes, bones).or_else(|| common_root(nodes, bones)),
        };
        let head = found.ok_or_else(|| Error::HeadBone {
            what: head
                .map_or("the bones have no common root".to_string(), |name| format!("'{name}' is none")),
            known: bones.iter().take(8).map(|&bone| nodes[bone].name.as_str()).collect::<Vec<_>>().join(", "),
        })?;
        let mut below: Vec<(usize, usize)> = Vec::new();
        let (mut layer, mut next) = (vec![head], Vec::new());
        while !layer.is_empty() {
            for (number, node) in nodes.iter().enumerate() {
                if let Some(parent) = node.parent.filter(|parent| layer.contains(parent)) {
                    below.push((number, parent));
                    next.push(number);
                }
            }
            layer = std::mem::take(&mut next);
        }
        Ok(Self { head, below, node_count: nodes.len() })
    }

    /// The head's bone, as a node.
    #[must_use]
    pub fn head(&self) -> usize {
        self.head
    }

    /// Per node the head-from-node transform in a pose; none of nodes that are not below the head.
    #[must_use]
    pub fn head_from_nodes(&self, pose: &Pose) -> Vec<Option<Matrix4<f64>>> {
        let mut transforms = vec![None; self.node_count];
        transforms[self.head] = Some(Matrix4::identity());
        for &(node, parent) in &self.below {
            transforms[node] = transforms[parent].map(|above: Matrix4<f64>| above * pose[node].matrix());
        }
        transforms
    }
}

/// A bone that is called head, if only one is.
fn named_head(nodes: &[Node], bones: &[usize]) -> Option<usize> {
    let is_head = |&&bone: &&usize| {
        let name = nodes[bone].name.to_ascii_lowercase();
        name.rsplit([':', '_', '|', '-']).next() == Some("head")
    };
    let mut heads = bones.iter().filter(is_head);
    heads.next().copied().filter(|_| heads.next().is_none())
}

/// The lowest node that is above, or is, each of the bones.
fn common_root(nodes: &[Node], bones: &[usize]) -> Option<usize> {
    let line = |bone: usize| -> Vec<usize> {
        let mut line: Vec<usize> = std::iter::successors(Some(bone), |&at| nodes[at].parent).collect();
        line.reverse();
        line
    };
    let first = line(*bones.first()?);
    let shared = bones
        .iter()
        .map(|&bone| line(bone).iter().zip(&first).take_while(|(one, other)| one == other).count());
    shared.min()?.checked_sub(1).map(|at| first[at])
}
