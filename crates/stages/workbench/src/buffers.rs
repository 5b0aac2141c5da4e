//! Meshes as graphics cards take them.
//!
//! A buffer is, in little-endian order: the numbers of vertices and of triangles (u32 each), three f32 per vertex (mm), three u32
//! per triangle. [`coarse`] makes the mesh that is drawn while it turns.

use crate::Error;
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;

/// The bytes of a mesh. `points`: #V, mm.
///
/// # Errors
/// [`Error::TooLarge`] for more vertices than 32 bits count.
pub fn encode(points: &[Point3<f64>], triangles: &[[u32; 3]]) -> Result<Vec<u8>, Error> {
    let too_large = || Error::TooLarge { vertices: points.len().max(triangles.len()) };
    let count = |length: usize| u32::try_from(length).map_err(|_| too_large());
    let mut bytes = Vec::with_capacity(8 + 12 * (points.len() + triangles.len()));
    bytes.extend(count(points.len())?.to_le_bytes());
    bytes.extend(count(triangles.len())?.to_le_bytes());
    for point in points {
        point.iter().for_each(|&coordinate| bytes.extend((coordinate as f32).to_le_bytes()));
    }
    triangles.iter().flatten().for_each(|vertex| bytes.extend(vertex.to_le_bytes()));
    Ok(bytes)
}

/// A coarse likeness of a mesh, to look at while it turns: vertices of one cell of a grid become one, at their mean
/// [RossignacBorrel1993]. Its vertices are none of the mesh's. `cell_mm`: edge of a cell.
#[must_use]
pub fn coarse(
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    cell_mm: f64,
) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
    let mut cells: HashMap<[i64; 3], u32> = HashMap::new();
    let (mut sums, mut counts): (Vec<Vector3<f64>>, Vec<f64>) = Default::default();
    let cell_of: Vec<u32> = points
        .iter()
        .map(|point| {
            let place = [0, 1, 2].map(|axis| (point[axis] / cell_mm).floor() as i64);
            // Cells are counted in the order in which vertices meet them, whatever the map's own order.
            let cell = *cells.entry(place).or_insert(sums.len() as u32);
            if cell as usize == sums.len() {
                sums.push(Vector3::zeros());
                counts.push(0.0);
            }
            sums[cell as usize] += point.coords;
            counts[cell as usize] += 1.0;
            cell
        })
        .collect();
    let means = sums.iter().zip(&counts).map(|(sum, count)| Point3::from(sum / *count)).collect();
    let kept = triangles.iter().map(|corners| corners.map(|vertex| cell_of[vertex as usize]));
    (means, kept.filter(|[a, b, c]| a != b && b != c && c != a).collect())
}

/// The edge of cells in which about `vertices` of a surface of this area lie, mm.
#[must_use]
pub fn cell_for(area_mm2: f64, vertices: usize) -> f64 {
    // A surface meets about 1.5 cells per cell's face of its area, whichever way it stands.
    (1.5 * area_mm2 / vertices.max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of `side`² vertices, 1 mm apart.
    fn sheet(side: u32) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
        let at = |index: u32| Point3::new(f64::from(index % side) + 0.5, f64::from(index / side) + 0.5, 0.5);
        let quads = (0..side - 1).flat_map(|row| (0..side - 1).map(move |column| row * side + column));
        let triangles = quads.flat_map(|first| {
            [[first, first + 1, first + side], [first + 1, first + side + 1, first + side]]
        });
        ((0..side * side).map(at).collect(), triangles.collect())
    }

    #[test]
    fn bytes_hold_counts_points_and_corners() {
        let points = [Point3::new(1.0, 2.0, 3.0), Point3::new(0.0, -1.0, 0.5), Point3::origin()];
        let bytes = encode(&points, &[[2, 0, 1]]).unwrap();
        assert_eq!(bytes.len(), 8 + 36 + 12);
        assert_eq!(bytes[..8], [3, 0, 0, 0, 1, 0, 0, 0]);
        assert_eq!(bytes[12..16], 2.0f32.to_le_bytes());
        assert_eq!(bytes[44..48], 2u32.to_le_bytes());
    }

    #[test]
    fn a_coarse_sheet_is_a_sheet() {
        let (points, triangles) = sheet(40);
        let (coarse_points, coarse_triangles) = coarse(&points, &triangles, 4.0);
        assert_eq!(coarse_points.len(), 100);
        assert_eq!(coarse_triangles.len(), 2 * 81);
        let area: f64 = mesh::triangle_areas(&coarse_points, &coarse_triangles).iter().sum();
        assert!((area - 36.0 * 36.0).abs() < 1e-9, "{area}");
    }

    #[test]
    fn a_cell_gives_about_as_many_vertices_as_wanted() {
        let (points, triangles) = sheet(200);
        let area: f64 = mesh::triangle_areas(&points, &triangles).iter().sum();
        let (found, _) = coarse(&points, &triangles, cell_for(area, 1000));
        assert!((500..2000).contains(&found.len()), "{}", found.len());
    }
}
