//! A plate of skin with valleys across it.
#![allow(dead_code, reason = "each test file takes what it needs")]

use artifact::{ValleyPoint, ValleysFrame};
use mesh::Mesh;
use nalgebra::Point3;

/// Vertices along x and along y.
pub(crate) const COUNTS: [u32; 2] = [61, 61];
/// Edge length, mm.
pub(crate) const EDGE_MM: f64 = 0.3;

/// A plate in the plane z = 0.
pub(crate) fn plate() -> Mesh {
    let [nx, ny] = COUNTS;
    let at = |i: u32| [f64::from(i % nx) * EDGE_MM, f64::from(i / nx) * EDGE_MM, 0.0];
    let cell = |i: u32| [[i, i + 1, i + nx + 1], [i, i + nx + 1, i + nx]];
    let triangles: Vec<[u32; 3]> = (0..nx * (ny - 1)).filter(|i| i % nx < nx - 1).flat_map(cell).collect();
    Mesh::from_triangles((0..nx * ny).map(at).collect(), &triangles)
}

/// A valley along x in row `row` of the plate, `shift` mm beyond it, from column 15 to column 45.
pub(crate) fn valley(row: u32, shift: f64, w_mm: f64, d_mm: f64) -> Vec<ValleyPoint> {
    let nx = COUNTS[0];
    let point = |k: u32| {
        // The second triangle of a cell: its corners are (0, 0), (1, 1), (0, 1).
        let up = shift / EDGE_MM;
        ValleyPoint {
            x_mm: f64::from(k) * EDGE_MM,
            face: 2 * (row * (nx - 1) + k + 15) + 1,
            barycentric: [1.0 - up, 0.0, up],
            at_mm: [0.0; 3],
            normal: [0.0, 0.0, 1.0],
            across: [0.0, -1.0, 0.0],
            w_mm,
            d_mm,
            epsilon: 0.2,
            kappa: 0.0,
        }
    };
    (0..31).map(point).collect()
}

pub(crate) fn frame(number: i64, valleys: &[(&str, Vec<ValleyPoint>)]) -> ValleysFrame {
    let valleys = valleys.iter().map(|(id, points)| ((*id).to_string(), points.clone())).collect();
    ValleysFrame { frame: number, valleys }
}

pub(crate) fn ids(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_string()).collect()
}

/// The plate, shortened along y to a share of its length.
pub(crate) fn pushed(share: f64) -> Vec<Point3<f64>> {
    plate().positions.iter().map(|p| Point3::new(p.x, share * p.y, p.z)).collect()
}

pub(crate) fn at(column: u32, row: u32) -> usize {
    (row * COUNTS[0] + column) as usize
}
