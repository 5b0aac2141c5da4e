//! From bones to the vertices that hang on them [DutreveMeyer2011, Eq. 5].

use crate::{Mask, Shares};
use nalgebra::Vector3;

/// Skin weight from which on a bone counts fully.
const FULL: f64 = 0.25;
/// Smaller weights of vertices are 0: what rounding leaves at rest shows nothing at all.
const LEAST: f32 = 1e-6;
/// Poses that are summed together, for wide instructions.
const LANES: usize = 4;

/// Per vertex the bones that count for it.
#[derive(Debug, Clone)]
pub(crate) struct VertexMask {
    starts: Vec<u32>,
    /// Bone and how much it counts, vertex after vertex.
    entries: Vec<(u32, f32)>,
    /// Per group of poses and vertex what the sums are divided by.
    shrink: Vec<Vec<[f32; LANES]>>,
    pose_count: usize,
}

impl VertexMask {
    /// `joints` are the watched bones among the skin's joints, `ways` tell which of them are of which pose.
    pub(crate) fn new(
        influences: &[Vec<(usize, f64)>],
        joints: &[usize],
        ways: &[Vec<Option<Vector3<f64>>>],
        mask: Mask,
    ) -> Self {
        let mut bone_of = vec![None; joints.iter().max().map_or(0, |most| most + 1)];
        joints.iter().enumerate().for_each(|(bone, &joint)| bone_of[joint] = Some(bone));
        let (mut starts, mut entries) = (vec![0], Vec::new());
        let mut shrink = vec![Vec::with_capacity(influences.len()); ways.len().div_ceil(LANES)];
        for vertex in influences {
            let first = entries.len();
            let watched =
                vertex.iter().filter_map(|&(joint, weight)| Some(((*bone_of.get(joint)?)?, weight)));
            entries.extend(watched.map(|(bone, weight)| (bone as u32, counts(mask, weight) as f32)));
            starts.push(entries.len() as u32);
            for (group, shrink) in shrink.iter_mut().enumerate() {
                shrink.push(std::array::from_fn(|lane| match (mask, ways.get(LANES * group + lane)) {
                    (Mask::Smooth, Some(way)) => {
                        let of_pose =
                            entries[first..].iter().filter(|(bone, _)| way[*bone as usize].is_some());
                        1.0 / of_pose.map(|(_, counts)| counts).sum::<f32>().max(1.0)
                    }
                    _ => 1.0,
                }));
            }
        }
        Self { starts, entries, shrink, pose_count: ways.len() }
    }

    pub(crate) fn vertex_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Per pose #V weights, pose after pose.
    pub(crate) fn weights(&self, modulated: &Shares, weights: &mut Vec<f32>) {
        let count = self.vertex_count();
        weights.clear();
        weights.resize(self.pose_count * count, 0.0);
        let bone_count = modulated.0.first().map_or(0, Vec::len);
        for (group, shrink) in self.shrink.iter().enumerate() {
            let poses: Vec<&Vec<f64>> = modulated.0.iter().skip(LANES * group).take(LANES).collect();
            let of_bone = |bone: usize| -> [f32; LANES] {
                std::array::from_fn(|lane| poses.get(lane).map_or(0.0, |shares| shares[bone] as f32))
            };
            let table: Vec<[f32; LANES]> = (0..bone_count).map(of_bone).collect();
            let mut rows: Vec<&mut [f32]> =
                weights.chunks_exact_mut(count.max(1)).skip(LANES * group).take(LANES).collect();
            for (vertex, shrink) in shrink.iter().enumerate() {
                let own = &self.entries[self.starts[vertex] as usize..self.starts[vertex + 1] as usize];
                let mut sum = [0.0f32; LANES];
                for (bone, counts) in own {
                    let shares = table[*bone as usize];
                    (0..LANES).for_each(|lane| sum[lane] += counts * shares[lane]);
                }
                for (lane, row) in rows.iter_mut().enumerate() {
                    let weight = (sum[lane] * shrink[lane]).min(1.0);
                    row[vertex] = if weight < LEAST { 0.0 } else { weight };
                }
            }
        }
    }
}

/// How much a bone of a skin weight counts.
fn counts(mask: Mask, weight: f64) -> f64 {
    match mask {
        Mask::Paper => f64::from(u8::from(weight > 0.0)),
        Mask::Smooth => {
            let x = (weight / FULL).min(1.0);
            x * x * (3.0 - 2.0 * x)
        }
    }
}
