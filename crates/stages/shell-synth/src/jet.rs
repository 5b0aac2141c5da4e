//! What elements measure at some points, and how that changes with their vertices.
//!
//! Every term of the energy is `k (q − q̄)²` of a measure q ([`crate::energy`]): it pulls a vertex with `2k (q − q̄) ∂q/∂x`, and its
//! Gauss–Newton matrix is `2k ∇q ∇qᵀ`.

use crate::energy::{area, dihedral, length, wrapped};
use crate::patch::{Joint, Tile};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Elements that one task works on; sums are per task, so that they do not depend on the number of threads.
const CHUNK: usize = 2048;

/// An edge's and its hinge's first derivatives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JointJet {
    /// Of the length at the second end.
    pub(crate) unit: Vector3<f64>,
    edge_pull: f64,
    pub(crate) edge_stiffness: f64,
    /// Of the angle.
    pub(crate) slopes: [Vector3<f64>; 4],
    bend_pull: f64,
    pub(crate) bend_stiffness: f64,
}

/// A triangle's first derivatives.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TileJet {
    /// Of the area.
    pub(crate) slopes: [Vector3<f64>; 3],
    pull: f64,
    pub(crate) stiffness: f64,
}

/// Energy, gradient (per free vertex), and the derivatives of all elements.
#[derive(Debug, Default)]
pub(crate) struct Jets {
    pub(crate) energy: f64,
    pub(crate) gradient: Vec<Vector3<f64>>,
    pub(crate) joints: Vec<JointJet>,
    pub(crate) tiles: Vec<TileJet>,
}

impl Jets {
    /// Derivatives and energy of all elements; the gradient is not touched.
    pub(crate) fn fill(&mut self, joints: &[Joint], tiles: &[Tile], points: &[Point3<f64>]) {
        self.joints.resize(joints.len(), JointJet::IDLE);
        self.tiles.resize(tiles.len(), TileJet::IDLE);
        let of_joints: Vec<f64> = (joints.par_chunks(CHUNK), self.joints.par_chunks_mut(CHUNK))
            .into_par_iter()
            .map(|(joints, jets)| energy_of(joints, jets, |joint| JointJet::of(joint, points)))
            .collect();
        let of_tiles: Vec<f64> = (tiles.par_chunks(CHUNK), self.tiles.par_chunks_mut(CHUNK))
            .into_par_iter()
            .map(|(tiles, jets)| energy_of(tiles, jets, |tile| TileJet::of(tile, points)))
            .collect();
        self.energy = of_joints.iter().sum::<f64>() + of_tiles.iter().sum::<f64>();
    }
}

fn energy_of<T, J>(elements: &[T], jets: &mut [J], of: impl Fn(&T) -> (f64, J)) -> f64 {
    let mut sum = 0.0;
    for (element, jet) in elements.iter().zip(jets) {
        let (energy, found) = of(element);
        sum += energy;
        *jet = found;
    }
    sum
}

impl JointJet {
    const IDLE: Self = Self {
        unit: Vector3::new(0.0, 0.0, 0.0),
        edge_pull: 0.0,
        edge_stiffness: 0.0,
        slopes: [Vector3::new(0.0, 0.0, 0.0); 4],
        bend_pull: 0.0,
        bend_stiffness: 0.0,
    };

    fn of(joint: &Joint, points: &[Point3<f64>]) -> (f64, Self) {
        let at = |vertex: u32| points[vertex as usize];
        let mut jet = Self::IDLE;
        let mut energy = 0.0;
        if joint.edge_weight > 0.0 {
            let (measure, unit) = length(&[at(joint.vertices[0]), at(joint.vertices[1])]);
            let cost = joint.length.cost(measure);
            energy += joint.edge_weight * cost.energy;
            jet.unit = unit;
            jet.edge_stiffness = joint.edge_weight * cost.curvature;
            jet.edge_pull = joint.edge_weight * cost.slope;
        }
        if joint.bend_weight > 0.0 {
            let (angle, slopes) = dihedral(&joint.vertices.map(at));
            let excess = wrapped(angle - joint.angle);
            energy += joint.bend_weight * excess * excess;
            jet.slopes = slopes;
            jet.bend_stiffness = 2.0 * joint.bend_weight;
            jet.bend_pull = jet.bend_stiffness * excess;
        }
        (energy, jet)
    }

    /// The energy's derivative at a corner.
    pub(crate) fn pull(&self, corner: usize) -> Vector3<f64> {
        let edge = match corner {
            0 => self.unit * -self.edge_pull,
            1 => self.unit * self.edge_pull,
            _ => Vector3::zeros(),
        };
        edge + self.slopes[corner] * self.bend_pull
    }
}

impl TileJet {
    const IDLE: Self = Self { slopes: [Vector3::new(0.0, 0.0, 0.0); 3], pull: 0.0, stiffness: 0.0 };

    fn of(tile: &Tile, points: &[Point3<f64>]) -> (f64, Self) {
        let (measure, slopes) = area(&tile.vertices.map(|vertex| points[vertex as usize]));
        let cost = tile.area.cost(measure);
        let jet = Self { slopes, pull: tile.weight * cost.slope, stiffness: tile.weight * cost.curvature };
        (tile.weight * cost.energy, jet)
    }

    /// The energy's derivative at a corner.
    pub(crate) fn pull(&self, corner: usize) -> Vector3<f64> {
        self.slopes[corner] * self.pull
    }
}
