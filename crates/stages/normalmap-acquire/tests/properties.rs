//! Laws that the stage keeps. Two at least; docs/CONTRIBUTING.md says what makes a good one.

use mesh::Mesh;
use normalmap_acquire::{Error, Params, offset};

fn tent() -> Mesh {
    let points = vec![[0., 0., 3.], [10., 0., 0.], [0., 10., 0.], [-10., 0., 0.], [0., -10., 0.]];
    Mesh::from_triangles(points, &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]])
}

#[test]
fn no_offset_moves_nothing() {
    assert_eq!(offset(&tent(), &Params { offset_mm: 0.0 }), Ok(tent()));
}

#[test]
fn every_vertex_moves_by_the_offset() {
    let moved = offset(&tent(), &Params { offset_mm: -2.5 }).unwrap();
    for (after, before) in moved.positions.iter().zip(&tent().positions) {
        assert!(((after - before).norm() - 2.5).abs() < 1e-12);
    }
}

#[test]
fn a_shifted_mesh_moves_alike() {
    let mut shifted = tent();
    shifted.positions.iter_mut().for_each(|point| point.x += 7.0);
    let params = Params::default();
    let (here, there) = (offset(&tent(), &params).unwrap(), offset(&shifted, &params).unwrap());
    for (a, b) in here.positions.iter().zip(&there.positions) {
        assert!((b.x - a.x - 7.0).abs() < 1e-12 && (b.y - a.y).abs() < 1e-12 && (b.z - a.z).abs() < 1e-12);
    }
}

#[test]
fn an_offset_that_is_no_number_is_refused() {
    let refused = offset(&tent(), &Params { offset_mm: f64::INFINITY });
    assert_eq!(refused, Err(Error::OffsetNotFinite(f64::INFINITY)));
}
