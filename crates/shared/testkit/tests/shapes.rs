//! The small shapes have the properties and the faults that their names promise.

use mesh::{Connectivity, Mesh, triangle_areas};
use testkit::shapes;

fn around(mesh: &Mesh) -> Connectivity {
    Connectivity::of(mesh.positions.len(), &mesh.triangles())
}

#[test]
fn a_sphere_is_closed_and_turned_outwards() {
    let sphere = shapes::sphere(10.0, 24);
    let triangles = sphere.triangles();
    assert!(around(&sphere).boundary_loops().is_empty() && around(&sphere).flipped_edges().is_empty());
    let area: f64 = triangle_areas(&sphere.positions, &triangles).iter().sum();
    assert!((area / (400.0 * std::f64::consts::PI) - 1.0).abs() < 0.01, "{area}");
    let normals = mesh::vertex_normals(&sphere.positions, &triangles);
    assert!(sphere.positions.iter().zip(&normals).all(|(point, normal)| point.coords.dot(normal) > 9.0));
}

#[test]
fn grids_are_flat_squares_with_two_groups() {
    let grid = shapes::grid(4, 2.5);
    assert_eq!((grid.positions.len(), grid.polygons.len(), grid.labels.len()), (25, 16, 2));
    let area: f64 = triangle_areas(&grid.positions, &grid.triangles()).iter().sum();
    assert!((area - 100.0).abs() < 1e-9);
    assert_eq!(around(&grid).boundary_loops().len(), 1);
    let bump = shapes::bump_plane(10, 1.0, 3.0, 2.0);
    assert!((mesh::bounding_box(&bump.positions).1.z - 3.0).abs() < 1e-12);
}

#[test]
fn faults_are_there() {
    assert_eq!(around(&shapes::two_components(4, 1.0)).components().1, 2);
    assert_eq!(around(&shapes::bow_tie()).bow_ties(), [0]);
    assert_eq!(around(&shapes::open_book()).non_manifold_edges().len(), 1);
}
