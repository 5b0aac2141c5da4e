//! The tangent space that renderers share: MikkTSpace [Mikkelsen2008].

use crate::Error;
use crate::low::Corner;
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use nalgebra::{Matrix3, Vector3};

/// A tangent, and on which side the bitangent is: `bitangent = sign · normal × tangent`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tangent {
    /// Unit vector along growing u.
    pub along: Vector3<f64>,
    /// +1, or −1 where the texture is mirrored.
    pub sign: f64,
}

impl Default for Tangent {
    fn default() -> Self {
        Self { along: Vector3::x(), sign: 1.0 }
    }
}

/// The tangent frame within a triangle, as a pixel shader has it: normal and tangent interpolated and not made unit again, the
/// bitangent from them; its columns are tangent, bitangent, normal.
pub(crate) fn frame(corners: &[Corner; 3], shares: &[f64; 3]) -> Matrix3<f64> {
    let mixed = |of: fn(&Corner) -> Vector3<f64>| -> Vector3<f64> {
        corners.iter().zip(shares).map(|(corner, share)| of(corner) * *share).sum()
    };
    let (normal, tangent) = (mixed(|corner| corner.normal), mixed(|corner| corner.tangent.along));
    let bitangent = corners[0].tangent.sign * normal.cross(&tangent);
    Matrix3::from_columns(&[tangent, bitangent, normal])
}

/// Per triangle the tangents of its corners.
pub(crate) fn tangents(triangles: &[[Corner; 3]]) -> Result<Vec<[Tangent; 3]>, Error> {
    let mut adapter = Adapter { triangles, tangents: vec![[Tangent::default(); 3]; triangles.len()] };
    generate_tangents(&mut adapter).map_err(|_| Error::Tangents)?;
    Ok(adapter.tangents)
}

struct Adapter<'a> {
    triangles: &'a [[Corner; 3]],
    tangents: Vec<[Tangent; 3]>,
}

impl Geometry for Adapter<'_> {
    fn num_faces(&self) -> usize {
        self.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.triangles[face][corner].point.coords.map(|x| x as f32).into()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.triangles[face][corner].normal.map(|x| x as f32).into()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.triangles[face][corner].uv.map(|x| x as f32).into()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        // Where the texture has no area and no neighbour helps, what the original says.
        let (along, preserves) = space
            .map_or(([1.0, 0.0, 0.0], false), |space| (space.tangent(), space.is_orientation_preserving()));
        let sign = if preserves { 1.0 } else { -1.0 };
        self.tangents[face][corner] = Tangent { along: Vector3::from(along).cast(), sign };
    }
}
