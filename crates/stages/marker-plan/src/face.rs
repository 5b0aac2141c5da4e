//! Mouth, eyes, and the frame of a face: which way is up, which is left.

use crate::{Error, Params};
use mesh::{Connectivity, loop_length};
use nalgebra::{Matrix3, Point3, Rotation3, Vector3};

/// The rims of mouth and eyes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rims {
    pub(crate) mouth: Vec<u32>,
    /// The face's own left eye first.
    pub(crate) eyes: [Vec<u32>; 2],
}

/// Coordinates of a face: x to its own left, y up, z out of it, origin between the eyes; mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    face_from_mesh: Rotation3<f64>,
    origin: Point3<f64>,
    /// Distance between the middles of the eyes' rims, mm.
    pub eye_distance_mm: f64,
}

impl Frame {
    /// A point of the mesh in the face's coordinates.
    #[must_use]
    pub fn place(&self, point: &Point3<f64>) -> Vector3<f64> {
        self.face_from_mesh * (point - self.origin)
    }

    /// A direction of the mesh in the face's coordinates.
    #[must_use]
    pub fn turn(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.face_from_mesh * direction
    }

    /// The frame whose plane x = 0 lies across `normal` (in coordinates of this one) at `offset` along it.
    pub(crate) fn with_mirror(&self, normal: Vector3<f64>, offset: f64) -> Self {
        let turn = Rotation3::rotation_between(&normal, &Vector3::x()).unwrap_or_else(Rotation3::identity);
        let origin = self.origin + self.face_from_mesh.inverse() * (normal * offset);
        Self { face_from_mesh: turn * self.face_from_mesh, origin, eye_distance_mm: self.eye_distance_mm }
    }
}

/// Finds mouth and eyes among the openings, and the frame that they span. `triangles` run counter-clockwise
/// seen from outside.
pub(crate) fn find(
    around: &Connectivity,
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    params: &Params,
) -> Result<(Rims, Frame), Error> {
    let openings = mesh::openings(around, points, params.smallest_opening_mm);
    let lengths_mm: Vec<f64> = openings.iter().map(|rim| loop_length(points, rim)).collect();
    let (mouth, eyes) = match (params.mouth, params.eyes) {
        (Some(mouth), Some([one, other])) => {
            let loops = around.boundary_loops();
            let named = |vertex: u32, what: &'static str| {
                let found = loops.iter().find(|rim| rim.contains(&vertex)).cloned();
                found.ok_or(Error::NotOnARim { vertex, what })
            };
            (named(mouth, "mouth")?, [named(one, "eye")?, named(other, "eye")?])
        }
        _ => roles(points, &openings, &lengths_mm).ok_or(Error::Openings { lengths_mm })?,
    };
    if mouth == eyes[0] || mouth == eyes[1] || eyes[0] == eyes[1] {
        return Err(Error::SharedRim);
    }
    let middle = |rim: &[u32]| middle(points, rim);
    let (low, one, other) = (middle(&mouth), middle(&eyes[0]), middle(&eyes[1]));
    let origin = nalgebra::center(&one, &other);
    let up = (origin - low).normalize();
    let across = other - one;
    // The skin around says where out is; the rims themselves may be turned in.
    let outward: Vector3<f64> = triangles
        .iter()
        .map(|triangle| triangle.map(|vertex| points[vertex as usize]))
        .filter(|[corner, ..]| [origin, low].iter().any(|middle| (corner - middle).norm() < across.norm()))
        .map(|[a, b, c]| (b - a).cross(&(c - a)))
        .sum();
    // The face's left is where up × out points.
    let left = if up.cross(&outward).dot(&across) > 0.0 { across } else { -across };
    let x = left.normalize();
    let y = (up - x * up.dot(&x)).normalize();
    let face_from_mesh = Rotation3::from_matrix_unchecked(Matrix3::from_rows(&[
        x.transpose(),
        y.transpose(),
        x.cross(&y).transpose(),
    ]));
    let [one, other] = eyes;
    let eyes = if left == across { [other, one] } else { [one, other] };
    Ok((Rims { mouth, eyes }, Frame { face_from_mesh, origin, eye_distance_mm: across.norm() }))
}

/// The mouth and the eyes among openings: of all triples the one whose mouth is as far from one eye as from the other,
/// and whose eyes are alike.
fn roles(
    points: &[Point3<f64>],
    openings: &[Vec<u32>],
    lengths: &[f64],
) -> Option<(Vec<u32>, [Vec<u32>; 2])> {
    let middles: Vec<Point3<f64>> = openings.iter().map(|rim| middle(points, rim)).collect();
    let count = openings.len();
    let mut best: Option<(f64, [usize; 3])> = None;
    for mouth in 0..count {
        for one in (0..count).filter(|&one| one != mouth) {
            for other in (one + 1..count).filter(|&other| other != mouth) {
                let [a, b] = [one, other].map(|eye| (middles[eye] - middles[mouth]).norm());
                let apart = (middles[one] - middles[other]).norm();
                let skew = (a / b).ln().abs() + (lengths[one] / lengths[other]).ln().abs();
                // Nostrils are alike, too, but much nearer to each other than to anything.
                let narrow = (0.5 * (a + b) / apart / 1.2).ln().abs();
                let cost = skew + narrow;
                if best.is_none_or(|best| cost < best.0) {
                    best = Some((cost, [mouth, one, other]));
                }
            }
        }
    }
    let [mouth, one, other] = best?.1;
    Some((openings[mouth].clone(), [openings[one].clone(), openings[other].clone()]))
}

fn middle(points: &[Point3<f64>], rim: &[u32]) -> Point3<f64> {
    (rim.iter().map(|&vertex| points[vertex as usize].coords).sum::<Vector3<f64>>() / rim.len() as f64).into()
}
