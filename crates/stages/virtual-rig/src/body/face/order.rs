//! Neighbours on the face come together in memory, so that whoever walks over the mesh finds them in a processor's caches:
//! images of 150 000 vertices are drawn a sixth faster.

use super::Face;
use mesh::{Label, Mesh, Polygons};
use nalgebra::{Point2, Vector2};

/// Cells along each side of the unrolled face.
const CELLS: f64 = 65_535.0;
/// The unrolled face lies within this far of its origin, mm.
const FARTHEST_MM: f64 = 256.0;
/// Not used so far.
const UNUSED: u32 = u32::MAX;

impl Face {
    /// The same face: triangles of a group in the order of a space-filling curve, vertices in the order in which these use
    /// them.
    pub(super) fn in_order(self) -> Self {
        let Self { person, domain, mesh } = self;
        let (order, labels) = order_of_triangles(&mesh, &domain);
        let in_order = |corners: &[u32]| -> Vec<u32> {
            order.iter().flat_map(|&triangle| &corners[3 * triangle..3 * triangle + 3]).copied().collect()
        };
        let (corners, vertices) = by_first_use(in_order(mesh.polygons.corners()), mesh.positions.len());
        let (corner_uvs, uvs) = by_first_use(in_order(&mesh.corner_uvs), mesh.uvs.len());
        let mut polygons = Polygons::default();
        corners.chunks(3).for_each(|triangle| polygons.push(triangle));
        Self {
            person,
            domain: picked(&domain, &vertices),
            mesh: Mesh {
                positions: picked(&mesh.positions, &vertices),
                polygons,
                uvs: picked::<Vector2<f64>>(&mesh.uvs, &uvs),
                corner_uvs,
                colors: mesh.colors,
                labels,
            },
        }
    }
}

/// The triangles, group by group in the order of a curve, and the groups as they were.
fn order_of_triangles(mesh: &Mesh, domain: &[Point2<f64>]) -> (Vec<usize>, Vec<Label>) {
    let triangles = mesh.triangles();
    let group = |triangle: usize| mesh.labels.partition_point(|label| label.first_face <= triangle);
    let place = |triangle: usize| {
        let middle = triangles[triangle]
            .iter()
            .fold(Vector2::zeros(), |sum, &vertex| sum + domain[vertex as usize].coords / 3.0);
        let cell = |x: f64| ((x / FARTHEST_MM).clamp(-1.0, 1.0).midpoint(1.0) * CELLS) as u32;
        spread(cell(middle.x)) | spread(cell(middle.y)) << 1
    };
    let mut order: Vec<usize> = (0..triangles.len()).collect();
    order.sort_by_cached_key(|&triangle| (group(triangle), place(triangle)));
    (order, mesh.labels.clone())
}

/// A zero between the bits.
fn spread(bits: u32) -> u32 {
    [(8, 0x00ff_00ff), (4, 0x0f0f_0f0f), (2, 0x3333_3333), (1, 0x5555_5555)]
        .into_iter()
        .fold(bits, |bits, (shift, mask)| (bits | bits << shift) & mask)
}

/// Numbers by first use, and which number each new one had; those that nothing uses come last.
fn by_first_use(mut used: Vec<u32>, count: usize) -> (Vec<u32>, Vec<u32>) {
    let mut new = vec![UNUSED; count];
    let mut old = Vec::with_capacity(count);
    let mut number = |was: u32| {
        if new[was as usize] == UNUSED {
            new[was as usize] = old.len() as u32;
            old.push(was);
        }
        new[was as usize]
    };
    used.iter_mut().for_each(|used| *used = number(*used));
    (0..count as u32).for_each(|was| {
        number(was);
    });
    (used, old)
}

fn picked<T: Copy>(all: &[T], numbers: &[u32]) -> Vec<T> {
    numbers.iter().map(|&number| all[number as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ordered_face_is_the_same_face_and_its_neighbours_are_near() {
        let face = Face::new(3, 2_000);
        let ordered = face.clone().in_order();
        let corners = |face: &Face| {
            let mut all: Vec<Vec<[u64; 3]>> = face
                .mesh
                .triangles()
                .iter()
                .map(|t| {
                    let mut at: Vec<_> = t
                        .iter()
                        .map(|&v| face.mesh.positions[v as usize].coords.map(f64::to_bits).into())
                        .collect();
                    at.sort_unstable();
                    at
                })
                .collect();
            all.sort_unstable();
            all
        };
        assert_eq!(corners(&face), corners(&ordered));
        assert_eq!(face.mesh.labels, ordered.mesh.labels);
        for (vertex, uv) in ordered.mesh.polygons.corners().iter().zip(&ordered.mesh.corner_uvs) {
            assert_eq!(
                super::super::texture_coordinate(&ordered.domain[*vertex as usize]),
                ordered.mesh.uvs[*uv as usize]
            );
        }
        let apart = |face: &Face| {
            let spans =
                face.mesh.triangles().into_iter().map(|t| t.iter().max().unwrap() - t.iter().min().unwrap());
            let mut spans: Vec<u32> = spans.collect();
            spans.sort_unstable();
            spans[spans.len() / 2]
        };
        assert!(10 * apart(&ordered) < apart(&face), "{} of {}", apart(&ordered), apart(&face));
    }
}
