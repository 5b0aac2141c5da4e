//! Small meshes with known properties and known faults.

use mesh::{Label, LabelKind, Mesh, Polygons};
use nalgebra::Vector2;
use std::f64::consts::{PI, TAU};

/// A square grid of `cells` × `cells` quads of size `step` mm in the plane z = 0, with texture coordinates, its left
/// half in the group `left` and the rest in `right`. Vertex (column, row) has index row · (cells + 1) + column.
#[must_use]
pub fn grid(cells: u32, step: f64) -> Mesh {
    relief(cells, step, |_, _| 0.0)
}

/// The grid lifted to z = `height`(x, y) mm.
#[must_use]
pub fn relief(cells: u32, step: f64, height: impl Fn(f64, f64) -> f64) -> Mesh {
    let side = cells + 1;
    let mut mesh = Mesh::default();
    for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
        let (x, y) = (f64::from(column) * step, f64::from(row) * step);
        mesh.positions.push([x, y, height(x, y)].into());
        mesh.uvs.push(Vector2::new(f64::from(column), f64::from(row)) / f64::from(cells));
    }
    let half = cells / 2;
    for (name, columns) in [("left", 0..half), ("right", half..cells)] {
        let first_face = mesh.polygons.len();
        mesh.labels.push(Label { first_face, kind: LabelKind::Group, name: name.to_string() });
        for (row, column) in (0..cells).flat_map(|row| columns.clone().map(move |column| (row, column))) {
            let corner = row * side + column;
            mesh.polygons.push(&[corner, corner + 1, corner + side + 1, corner + side]);
        }
    }
    mesh.corner_uvs = mesh.polygons.corners().to_vec();
    mesh
}

/// A plane with a round bump of `height` mm and standard deviation `width` mm in its middle.
#[must_use]
pub fn bump_plane(cells: u32, step: f64, height: f64, width: f64) -> Mesh {
    let middle = 0.5 * f64::from(cells) * step;
    relief(cells, step, |x, y| {
        height * (-0.5 * ((x - middle).powi(2) + (y - middle).powi(2)) / (width * width)).exp()
    })
}

/// A closed sphere about the origin, radius in mm: `rings` bands of quads, triangles at the poles (±y).
#[must_use]
pub fn sphere(radius: f64, rings: u32) -> Mesh {
    let around = 2 * rings;
    let mut positions = vec![[0.0, radius, 0.0]];
    for (ring, segment) in (1..rings).flat_map(|ring| (0..around).map(move |segment| (ring, segment))) {
        let (polar, turn) =
            (PI * f64::from(ring) / f64::from(rings), TAU * f64::from(segment) / f64::from(around));
        positions.push([polar.sin() * turn.sin(), polar.cos(), polar.sin() * turn.cos()].map(|x| radius * x));
    }
    positions.push([0.0, -radius, 0.0]);
    let at = |ring: u32, segment: u32| 1 + (ring - 1) * around + segment % around;
    let south = positions.len() as u32 - 1;
    let mut polygons = Polygons::default();
    for segment in 0..around {
        polygons.push(&[0, at(1, segment), at(1, segment + 1)]);
        for ring in 1..rings - 1 {
            polygons.push(&[
                at(ring, segment),
                at(ring + 1, segment),
                at(ring + 1, segment + 1),
                at(ring, segment + 1),
            ]);
        }
        polygons.push(&[at(rings - 1, segment), south, at(rings - 1, segment + 1)]);
    }
    Mesh { positions: positions.into_iter().map(Into::into).collect(), polygons, ..Mesh::default() }
}

/// Two grids beside each other that share nothing: the first of `cells` × `cells` quads, the second of one quad less
/// each way.
#[must_use]
pub fn two_components(cells: u32, step: f64) -> Mesh {
    let mut both = grid(cells, step);
    let other = grid(cells - 1, step);
    let (vertex_offset, uv_offset) = (both.positions.len() as u32, both.uvs.len() as u32);
    let shift = nalgebra::Vector3::new(2.0 * f64::from(cells) * step, 0.0, 0.0);
    both.positions.extend(other.positions.iter().map(|point| point + shift));
    both.uvs.extend(other.uvs);
    both.corner_uvs.extend(other.corner_uvs.iter().map(|uv| uv + uv_offset));
    for polygon in other.polygons.iter() {
        let moved: Vec<u32> = polygon.iter().map(|vertex| vertex + vertex_offset).collect();
        both.polygons.push(&moved);
    }
    both
}

/// Two fans of triangles, three and two, that meet in vertex 0 only.
#[must_use]
pub fn bow_tie() -> Mesh {
    let positions = vec![
        [0., 0., 0.],
        [2., -2., 0.],
        [2., -0.5, 0.],
        [2., 0.5, 0.],
        [2., 2., 0.],
        [-2., 1., 0.],
        [-2., 0., 0.],
        [-2., -1., 0.],
    ];
    Mesh::from_triangles(positions, &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 5, 6], [0, 6, 7]])
}

/// Three triangles on the edge 0–1, the pages of a book; the third page is the smallest.
#[must_use]
pub fn open_book() -> Mesh {
    let positions = vec![[0., 0., 0.], [0., 2., 0.], [2., 1., 0.], [-2., 1., 0.], [0., 1., 1.]];
    Mesh::from_triangles(positions, &[[0, 2, 1], [0, 1, 3], [0, 1, 4]])
}
