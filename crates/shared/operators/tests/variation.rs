//! Laws of the third-order energy.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use operators::{Variation, cotan_stiffness, weighted_cotan_stiffness};
use testkit::shapes;

fn energy(stretching: f64, weight: f64) -> (Variation, Vec<[f64; 3]>) {
    let mesh = shapes::bump_plane(14, 3.0, 9.0, 10.0);
    let triangles = mesh.triangles();
    let weights: Vec<f64> = (0..triangles.len()).map(|i| weight * (1.0 + (i % 7) as f64 / 7.0)).collect();
    let places = mesh.positions.iter().map(|p| [p.x, p.y, p.z]).collect();
    (Variation::new(&mesh.positions, &triangles, &weights, [stretching, 50.0], 1e4), places)
}

#[test]
fn the_matrix_and_its_factors_agree() {
    let (energy, places) = energy(2.0, 1.0);
    let field: Vec<f64> = places.iter().map(|[x, y, z]| (x / 5.0).sin() + 0.1 * y * z).collect();
    let matrix = energy.matrix();
    let by_matrix: Vec<f64> = matrix
        .outer_iterator()
        .map(|row| row.iter().map(|(column, value)| value * field[column]).sum())
        .collect();
    let by_factors = energy.apply(&field);
    let size = by_factors.iter().fold(0f64, |size, value| size.max(value.abs()));
    assert!(by_matrix.iter().zip(&by_factors).all(|(a, b)| (a - b).abs() < 1e-10 * size));
}

#[test]
fn constants_cost_nothing_and_all_else_something() {
    let (energy, places) = energy(1.0, 1.0);
    assert!(energy.apply(&vec![7.25; places.len()]).iter().all(|&force| force == 0.0));
    for seed in 0..20 {
        let field: Vec<f64> = (0..places.len()).map(|i| ((i * 37 + seed * 101) % 89) as f64 - 44.0).collect();
        let work: f64 = energy.apply(&field).iter().zip(&field).map(|(force, value)| force * value).sum();
        assert!(work > 0.0);
    }
}

/// A surface that is twice as stiff resists twice as much; without stretching nothing else is in the energy.
#[test]
fn the_energy_is_linear_in_its_stiffness() {
    let (one, places) = energy(0.0, 1.0);
    let (two, _) = energy(0.0, 2.0);
    let field: Vec<f64> = places.iter().map(|[x, y, _]| x * x * y).collect();
    let pairs: Vec<(f64, f64)> = one.apply(&field).into_iter().zip(two.apply(&field)).collect();
    assert!(pairs.iter().all(|(one, two)| (2.0 * one - two).abs() <= 1e-9 * two.abs() + 1e-12));
}

#[test]
fn equal_weights_give_the_plain_stiffness() {
    let mesh = shapes::bump_plane(10, 2.0, 6.0, 8.0);
    let triangles = mesh.triangles();
    let (plain, _) = cotan_stiffness(&mesh.positions, &triangles, 1e4);
    let weighted = weighted_cotan_stiffness(&mesh.positions, &triangles, &vec![3.0; triangles.len()], 1e4);
    for ((value, _), (tripled, _)) in plain.iter().zip(weighted.iter()) {
        assert!((3.0 * value - tripled).abs() < 1e-12);
    }
}
