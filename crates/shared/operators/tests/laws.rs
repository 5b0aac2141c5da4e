//! Identities that hold whatever the mesh.

use nalgebra::Point3;
use operators::{CsMat, bilaplacian, cotan_stiffness, lumped_mass};
use proptest::prelude::*;
use testkit::shapes;

const LIMIT: f64 = 1e4;

fn apply(matrix: &CsMat<f64>, field: &[f64]) -> Vec<f64> {
    let row = |row: sprs::CsVecView<f64>| row.iter().map(|(column, value)| value * field[column]).sum();
    matrix.outer_iterator().map(row).collect()
}

fn energy(matrix: &CsMat<f64>, field: &[f64]) -> f64 {
    apply(matrix, field).iter().zip(field).map(|(a, b)| a * b).sum()
}

/// An irregular mesh: the bump with its vertices pushed about.
fn rough(seed: &[f64]) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
    let mut mesh = shapes::bump_plane(8, 2.0, 5.0, 4.0);
    for (i, point) in mesh.positions.iter_mut().enumerate() {
        (0..3).for_each(|axis| point[axis] += 0.6 * seed[(i * 3 + axis) % seed.len()]);
    }
    (mesh.positions.clone(), mesh.triangles())
}

proptest! {
    #[test]
    fn the_stiffness_is_symmetric_positive_and_blind_to_constants(seed in prop::collection::vec(-1.0..1.0f64, 61), field in prop::collection::vec(-1.0..1.0f64, 81)) {
        let (points, triangles) = rough(&seed);
        let (stiffness, _) = cotan_stiffness(&points, &triangles, LIMIT);
        for (row, entries) in stiffness.outer_iterator().enumerate() {
            for (column, value) in entries.iter() {
                let mirrored = stiffness.get(column, row).copied().unwrap_or(0.0);
                prop_assert!((value - mirrored).abs() <= 1e-12 * (1.0 + value.abs()));
            }
        }
        prop_assert!(apply(&stiffness, &[1.0; 81]).iter().all(|sum| sum.abs() < 1e-10));
        prop_assert!(energy(&stiffness, &field) >= -1e-10);
    }

    #[test]
    fn vertex_areas_add_up_to_the_surface(seed in prop::collection::vec(-1.0..1.0f64, 61)) {
        let (points, triangles) = rough(&seed);
        let total: f64 = mesh::triangle_areas(&points, &triangles).iter().sum();
        let lumped: f64 = lumped_mass(&points, &triangles).iter().sum();
        prop_assert!((total - lumped).abs() < 1e-9 * total);
    }

    /// In the plane the Dirichlet energy of a linear function is its squared gradient times the area.
    #[test]
    fn linear_functions_have_their_energy(a in -3.0..3.0f64, b in -3.0..3.0f64) {
        let mesh = shapes::grid(6, 2.5);
        let (stiffness, _) = cotan_stiffness(&mesh.positions, &mesh.triangles(), LIMIT);
        let field: Vec<f64> = mesh.positions.iter().map(|p| a * p.x + b * p.y + 7.0).collect();
        let area = (6.0 * 2.5f64).powi(2);
        prop_assert!((energy(&stiffness, &field) - (a * a + b * b) * area).abs() < 1e-9 * area);
    }

    /// However flat a triangle: no field has negative energy.
    #[test]
    fn slivers_leave_the_stiffness_positive(height in -12.0..0.0f64, along in -0.5..1.5f64, field in prop::array::uniform3(-1.0..1.0f64)) {
        let points = [[0., 0., 0.], [1., 0., 0.], [along, 10f64.powf(height), 0.]].map(Point3::from);
        let (stiffness, _) = cotan_stiffness(&points, &[[0, 1, 2]], LIMIT);
        let scale: f64 = stiffness.data().iter().map(|value| value.abs()).sum();
        prop_assert!(energy(&stiffness, &field) >= -1e-12 * scale);
    }

    /// The stiffness does not change with the mesh's size; the bending part falls with its square.
    #[test]
    fn sizes_scale_as_the_units_say(size in 0.1..10.0f64, field in prop::collection::vec(-1.0..1.0f64, 81)) {
        let (points, triangles) = rough(&[0.3, -0.7, 0.5]);
        let scaled: Vec<Point3<f64>> = points.iter().map(|point| point * size).collect();
        let energies = |points: &[Point3<f64>]| {
            let (stiffness, _) = cotan_stiffness(points, &triangles, LIMIT);
            let mass = lumped_mass(points, &triangles);
            (energy(&stiffness, &field), energy(&bilaplacian(&stiffness, &mass, 0.0, 1.0), &field))
        };
        let (small, large) = (energies(&points), energies(&scaled));
        prop_assert!((small.0 - large.0).abs() < 1e-9 * small.0);
        prop_assert!((small.1 - large.1 * size * size).abs() < 1e-8 * small.1);
    }
}

/// On a regular right-triangle grid of step h the stiffness is the five-point stencil: 4 on the diagonal, −1 across
/// sides, 0 along diagonals; and the area of an inner vertex is h².
#[test]
fn the_regular_grid_gives_the_five_point_stencil() {
    let mesh = shapes::grid(4, 3.0);
    let triangles = mesh.triangles();
    let (stiffness, slivers) = cotan_stiffness(&mesh.positions, &triangles, LIMIT);
    let at = |column: usize| stiffness.get(12, column).copied().unwrap_or(0.0);
    assert!((at(12) - 4.0).abs() < 1e-12);
    assert!([7, 11, 13, 17].iter().all(|&side| (at(side) + 1.0).abs() < 1e-12));
    assert!([6, 8, 16, 18].iter().all(|&diagonal| at(diagonal).abs() < 1e-12));
    assert!((lumped_mass(&mesh.positions, &triangles)[12] - 9.0).abs() < 1e-12);
    assert_eq!(slivers, operators::Slivers::default());
}

/// Needles and caps are tempered, triangles that are points left out, both counted.
#[test]
fn slivers_are_counted() {
    let points = [[0., 0., 0.], [1., 0., 0.], [0.5, 1e-7, 0.], [2., 0., 0.], [0., 0., 0.], [0., 0., 0.]]
        .map(Point3::from);
    let (stiffness, slivers) = cotan_stiffness(&points, &[[0, 1, 2], [0, 3, 1], [0, 4, 5]], LIMIT);
    assert_eq!((slivers.collapsed, slivers.tempered), (1, 2));
    assert!(stiffness.data().iter().all(|value| value.is_finite() && value.abs() <= 2.0 * LIMIT));
    assert!(lumped_mass(&points, &[[0, 1, 2]]).iter().all(|&area| area > 0.0));
}
