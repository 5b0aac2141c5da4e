//! A mesh that moves along with another.

use crate::Error;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use mesh::{Around, Mesh};
use nalgebra::{Matrix3, Point3, Vector3};

/// Where the vertices of a mesh come to lie when the surface that they lie near moves from `rest` to `moved` (#V, mm): each keeps its
/// place beside the triangle that it is nearest to.
///
/// # Errors
/// If the surface has no triangles, or the counts differ.
pub fn follow(points: &[Point3<f64>], rest: &Mesh, moved: &[Point3<f64>]) -> Result<Vec<Point3<f64>>, Error> {
    let triangles = rest.triangles();
    if triangles.is_empty() {
        return Err(Error::Empty { which: "wrinkled" });
    }
    if moved.len() != rest.positions.len() {
        return Err(Error::VertexCount { rest: rest.positions.len(), moved: moved.len() });
    }
    let around = Around::of(rest.positions.len(), &triangles);
    // Vertices without triangles are no surface.
    let used: Vec<u32> = (0..rest.positions.len() as u32).filter(|&v| !around.at(v).is_empty()).collect();
    let entries: Vec<[f64; 3]> = used.iter().map(|&v| rest.positions[v as usize].into()).collect();
    let tree = ImmutableKdTree::<f64, 3>::new_from_slice(&entries)
        .map_err(|_| Error::Empty { which: "wrinkled" })?;
    let carry = |point: &Point3<f64>| {
        let query: [f64; 3] = (*point).into();
        let nearest = tree.query(&query).nearest_one::<SquaredEuclidean<f64>>().execute().item;
        let vertex = used[nearest as usize];
        let foot = |&face: &u32| {
            let corners = triangles[face as usize].map(|v| rest.positions[v as usize]);
            let shares = mesh::nearest_in_triangle(point, &corners);
            (face, shares, (point - mixed(&corners, &shares)).norm_squared())
        };
        let nearest = around.at(vertex).iter().map(foot).min_by(|one, other| one.2.total_cmp(&other.2));
        let (face, shares, _) = nearest.unwrap_or((0, [1.0, 0.0, 0.0], 0.0));
        let at = |points: &[Point3<f64>]| triangles[face as usize].map(|v| points[v as usize]);
        let (before, after) = (at(&rest.positions), at(moved));
        let turn = axes(&after) * axes(&before).transpose();
        mixed(&after, &shares) + turn * (point - mixed(&before, &shares))
    };
    Ok(points.iter().map(carry).collect())
}

fn mixed(corners: &[Point3<f64>; 3], shares: &[f64; 3]) -> Point3<f64> {
    Point3::from(
        corners.iter().zip(shares).map(|(corner, share)| corner.coords * *share).sum::<Vector3<f64>>(),
    )
}

/// Three unit axes that turn with a triangle; those of space where it has no area.
fn axes([a, b, c]: &[Point3<f64>; 3]) -> Matrix3<f64> {
    let along = (b - a).try_normalize(0.0);
    let normal = (b - a).cross(&(c - a)).try_normalize(0.0);
    match (along, normal) {
        (Some(along), Some(normal)) => Matrix3::from_columns(&[along, normal.cross(&along), normal]),
        _ => Matrix3::identity(),
    }
}
