//! Small meshes that the tests draw.

use mesh::Mesh;

/// A sphere of quads (triangles at the poles), radius mm, y up, closed, counter-clockwise from outside.
pub(crate) fn sphere(radius: f64, rings: u32) -> Mesh {
    let segments = rings * 2;
    let mut positions = vec![[0.0, radius, 0.0]];
    for ring in 1..rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for segment in 0..segments {
            let turn = std::f64::consts::TAU * f64::from(segment) / f64::from(segments);
            let level = radius * polar.sin();
            positions.push([level * turn.sin(), radius * polar.cos(), level * turn.cos()]);
        }
    }
    positions.push([0.0, -radius, 0.0]);
    let last = positions.len() as u32 - 1;
    let at = |ring: u32, segment: u32| 1 + (ring - 1) * segments + segment % segments;
    let mut mesh = Mesh::from_triangles(positions, &[]);
    for segment in 0..segments {
        mesh.polygons.push(&[0, at(1, segment), at(1, segment + 1)]);
        for ring in 1..rings - 1 {
            let (a, b) = (at(ring, segment), at(ring + 1, segment));
            mesh.polygons.push(&[a, b, at(ring + 1, segment + 1), at(ring, segment + 1)]);
        }
        mesh.polygons.push(&[at(rings - 1, segment), last, at(rings - 1, segment + 1)]);
    }
    mesh
}

#[allow(dead_code, reason = "each test file is a crate of its own, and not all draw it")]
/// A square in the plane z, half a side each way, seen from +z; one quad.
pub(crate) fn square(half: f64, z: f64) -> Mesh {
    let corners = vec![[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]];
    let mut mesh = Mesh::from_triangles(corners, &[]);
    mesh.polygons.push(&[0, 1, 2, 3]);
    mesh
}
