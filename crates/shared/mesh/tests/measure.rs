//! Lengths, areas and normals of shapes whose measures are known.

use mesh::{bounding_box, edge_length_median, loop_length, triangle_areas, vertex_normals};
use nalgebra::Point3;
use testkit::shapes;

#[test]
fn a_sphere_has_its_area_and_its_normals() {
    let sphere = shapes::sphere(10.0, 60);
    let triangles = sphere.triangles();
    let area: f64 = triangle_areas(&sphere.positions, &triangles).iter().sum();
    assert!((area / (400.0 * std::f64::consts::PI) - 1.0).abs() < 2e-3, "{area}");
    for (normal, point) in vertex_normals(&sphere.positions, &triangles).iter().zip(&sphere.positions) {
        assert!(normal.dot(&point.coords) / 10.0 > 0.999, "outwards");
    }
    let (low, high) = bounding_box(&sphere.positions);
    assert!((low.y + 10.0).abs() < 1e-12 && (high.y - 10.0).abs() < 1e-12);
}

/// Angle weights: a corner of a cube gets the diagonal, however its faces are split.
#[test]
fn normals_do_not_depend_on_how_a_polygon_is_split() {
    let points =
        [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [1., 1., 0.], [0., 1., 1.], [1., 0., 1.]]
            .map(Point3::from);
    let corner = |xy: &[[u32; 3]]| {
        let mut triangles = vec![[0, 3, 5], [0, 5, 2], [0, 1, 6], [0, 6, 3]];
        triangles.extend_from_slice(xy);
        vertex_normals(&points, &triangles)[0]
    };
    let (one, other) = (corner(&[[0, 2, 4], [0, 4, 1]]), corner(&[[0, 2, 1], [1, 2, 4]]));
    assert!((one - other).norm() < 1e-12);
    assert!(one.iter().all(|x| (x + 1.0 / 3f64.sqrt()).abs() < 1e-12), "{one}");
}

#[test]
fn edges_and_loops_have_their_length() {
    let grid = shapes::grid(4, 2.5);
    assert!((edge_length_median(&grid.positions, &grid.triangles()) - 2.5).abs() < 1e-12);
    assert_eq!(edge_length_median(&[], &[]), 0.0);
    assert!((loop_length(&grid.positions, &[0, 4, 24, 20]) - 40.0).abs() < 1e-12);
}

#[test]
fn polygons_split_as_fans_and_drop_what_has_no_area() {
    let mut mesh = shapes::grid(1, 1.0);
    mesh.polygons.push(&[0, 1, 1]);
    assert_eq!(mesh.triangles(), [[0, 1, 3], [0, 3, 2]]);
}
