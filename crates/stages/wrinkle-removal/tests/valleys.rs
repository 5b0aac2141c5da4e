//! Regions along measured valleys.
#![allow(clippy::expect_used, reason = "a test may fail")]

use artifact::{ValleyPoint, ValleysFrame};
use mesh::Mesh;
use std::collections::BTreeMap;
use testkit::shapes;
use wrinkle_removal::{Error, along_valleys};

fn point(face: u32, x_mm: f64, d_mm: f64) -> ValleyPoint {
    ValleyPoint {
        x_mm,
        face,
        barycentric: [1.0, 0.0, 0.0],
        at_mm: [0.0; 3],
        normal: [0.0, 0.0, 1.0],
        across: [0.0, 1.0, 0.0],
        w_mm: 0.5,
        d_mm,
        epsilon: 0.0,
        kappa: 0.0,
    }
}

fn frame(points: Vec<ValleyPoint>) -> ValleysFrame {
    ValleysFrame { frame: 1001, valleys: BTreeMap::from([("brow".to_string(), points)]) }
}

/// The first triangle with its first corner at (column, row) of a grid of 20 cells.
fn face_at(mesh: &Mesh, vertex: u32) -> u32 {
    mesh.triangles().iter().position(|triangle| triangle[0] == vertex).expect("a face") as u32
}

#[test]
fn the_region_reaches_some_widths_from_the_curve() {
    let grid = shapes::grid(20, 0.5);
    let from = |column: u32| point(face_at(&grid, 10 * 21 + column), f64::from(column), 0.2);
    let weights = along_valleys(&grid, &frame(vec![from(5), from(8), from(14)]), 3.0).expect("a region");
    for (vertex, place) in grid.positions.iter().enumerate() {
        let past = (2.5 - place.x).max(place.x - 7.0).max(0.0);
        let inside = past.hypot(place.y - 5.0) < 1.5;
        assert_eq!(weights[vertex], f64::from(u8::from(inside)), "{place}");
    }
}

#[test]
fn what_is_near_but_not_joined_is_left_alone() {
    // A second sheet 0.4 mm above the first, as the other lip.
    let mut both = shapes::two_components(20, 0.5);
    let sheet = 21 * 21;
    let shift = nalgebra::Vector3::new(20.0, 0.0, -0.4);
    both.positions[sheet..].iter_mut().for_each(|place| *place -= shift);
    let from = |column: u32| point(face_at(&both, 10 * 21 + column), f64::from(column), 0.2);
    let weights = along_valleys(&both, &frame(vec![from(5), from(14)]), 3.0).expect("a region");
    assert!(weights[..sheet].iter().any(|&weight| weight > 0.0));
    assert!(weights[sheet..].iter().all(|&weight| weight == 0.0));
}

#[test]
fn points_of_no_depth_part_the_curve_and_other_meshes_are_refused() {
    let grid = shapes::grid(20, 0.5);
    let from = |column: u32, depth: f64| point(face_at(&grid, 10 * 21 + column), f64::from(column), depth);
    let gap =
        along_valleys(&grid, &frame(vec![from(3, 0.2), from(10, 0.0), from(17, 0.2)]), 3.0).expect("two");
    assert!(gap[10 * 21 + 10] == 0.0 && gap[10 * 21 + 3] == 1.0 && gap[10 * 21 + 17] == 1.0);
    let none = along_valleys(&grid, &frame(vec![from(3, 0.0)]), 3.0);
    assert!(matches!(none, Err(Error::EmptyRegion { .. })));
    let beyond = along_valleys(&grid, &frame(vec![point(800, 0.0, 0.2)]), 3.0);
    assert_eq!(beyond, Err(Error::UnknownFace { wrinkle: "brow".to_string(), face: 800, face_count: 800 }));
    assert!(matches!(along_valleys(&grid, &frame(Vec::new()), -1.0), Err(Error::Parameter { .. })));
}
