//! The skin in a pose, to look at.

use crate::Pose;
use artifact::gltf::{Character, SkinnedMesh};
use nalgebra::{Matrix4, Point3, Vector3};

/// The vertices of a mesh in a pose, by linear blend skinning, in the file's unit; vertices that hang on nothing stay.
#[must_use]
pub fn skinned(character: &Character, mesh: &SkinnedMesh, pose: &Pose) -> Vec<Point3<f64>> {
    let moves: Vec<Matrix4<f64>> = mesh
        .joints
        .iter()
        .zip(&mesh.inverse_bind)
        .map(|(&joint, bind)| {
            let line = std::iter::successors(Some(joint), |&node| character.nodes[node].parent);
            line.fold(Matrix4::identity(), |below, node| pose[node].matrix() * below) * bind
        })
        .collect();
    let place = |(point, influences): (&Point3<f64>, &Vec<(usize, f64)>)| {
        if influences.is_empty() {
            return *point;
        }
        let moved = |(joint, weight): &(usize, f64)| moves[*joint].transform_point(point).coords * *weight;
        Point3::from(influences.iter().map(moved).sum::<Vector3<f64>>())
    };
    mesh.positions.iter().zip(&mesh.influences).map(place).collect()
}
