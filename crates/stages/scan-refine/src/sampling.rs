//! A map's vectors, gathered at the vertices.

use crate::map::NormalMap;
use mesh::{Mesh, NO_UV};
use nalgebra::{Vector2, Vector3};

/// The triangles of a mesh with their texture coordinates, each polygon a fan from its first corner.
pub(crate) struct Corners {
    /// Per triangle its vertices …
    pub(crate) vertices: Vec<[u32; 3]>,
    /// … and their texture coordinates.
    pub(crate) uvs: Vec<[Vector2<f64>; 3]>,
}

/// The triangles of which every corner has a texture coordinate.
pub(crate) fn corners(mesh: &Mesh) -> Corners {
    let (mut vertices, mut uvs) = (Vec::new(), Vec::new());
    for face in 0..mesh.polygons.len() {
        let range = mesh.polygons.corner_range(face);
        for second in range.start + 1..range.end.saturating_sub(1) {
            let triangle = [range.start, second, second + 1];
            let indices = triangle.map(|corner| mesh.corner_uvs[corner]);
            if !indices.contains(&NO_UV) {
                vertices.push(triangle.map(|corner| mesh.polygons.corners()[corner]));
                uvs.push(indices.map(|uv| mesh.uvs[uv as usize]));
            }
        }
    }
    Corners { vertices, uvs }
}

/// Most samples along a triangle's side.
const MOST: usize = 16;

/// Per vertex the sum of the map's vectors around it, turned by `turn` (triangle, place in it, vector), and the share of the
/// samples that fell on set texels.
///
/// Triangles smaller than two texels are read at their corners; larger ones all over, a sample counting for a corner by the square
/// of its share, so that normals between the vertices do not turn into noise at them.
pub(crate) fn sample(
    map: &NormalMap,
    mesh: &Mesh,
    corners: &Corners,
    turn: impl Fn(usize, [f64; 3], Vector3<f64>) -> Vector3<f64>,
) -> (Vec<Vector3<f64>>, Vec<f64>) {
    let mut sums = vec![Vector3::zeros(); mesh.positions.len()];
    let (mut set, mut asked) = (vec![0.0; sums.len()], vec![0.0; sums.len()]);
    let [width, height] = map.size().map(|count| count as f64);
    for (triangle, (vertices, uvs)) in corners.vertices.iter().zip(&corners.uvs).enumerate() {
        let side = |i: usize| {
            let side = uvs[(i + 1) % 3] - uvs[i];
            (side.x * width).hypot(side.y * height)
        };
        let count = side(0).max(side(1)).max(side(2)).ceil().min(MOST as f64) as usize;
        let mut visit = |at: [f64; 3]| {
            let uv = at[0] * uvs[0] + at[1] * uvs[1] + at[2] * uvs[2];
            let vector = map.at(uv).map(|vector| turn(triangle, at, vector));
            for corner in 0..3 {
                let (vertex, weight) = (vertices[corner] as usize, at[corner] * at[corner]);
                asked[vertex] += weight;
                if let Some(vector) = vector {
                    sums[vertex] += weight * vector;
                    set[vertex] += weight;
                }
            }
        };
        match count {
            0..=2 => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].into_iter().for_each(&mut visit),
            _ => places(count).for_each(&mut visit),
        }
    }
    let shares = set.iter().zip(&asked).map(|(set, asked)| if *asked > 0.0 { set / asked } else { 0.0 });
    let shares = shares.map(|share: f64| share.min(1.0)).collect();
    (sums, shares)
}

/// The centres of the small triangles that a triangle is cut into, `count` along each side, as shares of its corners.
fn places(count: usize) -> impl Iterator<Item = [f64; 3]> {
    let place = move |i: usize, j: usize, third: f64| {
        let (a, b) = ((i as f64 + third) / count as f64, (j as f64 + third) / count as f64);
        [1.0 - a - b, a, b]
    };
    (0..count).flat_map(move |i| {
        (0..count - i).flat_map(move |j| {
            let upright = place(i, j, 1.0 / 3.0);
            let turned = (i + j + 2 <= count).then(|| place(i, j, 2.0 / 3.0));
            std::iter::once(upright).chain(turned)
        })
    })
}
