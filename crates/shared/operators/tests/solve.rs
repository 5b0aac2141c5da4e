//! Orderings and factorisations, also on graphs that break naive ones.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use nalgebra::{DMatrix, DVector, Point3};
use operators::{CsMat, Dirichlet, Factor, FactorError, Ordering, bilaplacian, cotan_stiffness, lumped_mass};
use proptest::prelude::*;
use testkit::shapes;

fn shell_matrix(mesh: &mesh::Mesh) -> CsMat<f64> {
    let triangles = mesh.triangles();
    let (stiffness, _) = cotan_stiffness(&mesh.positions, &triangles, 1e4);
    bilaplacian(&stiffness, &lumped_mass(&mesh.positions, &triangles), 1.0, 100.0)
}

fn is_a_permutation(ordering: &Ordering, count: usize) -> bool {
    Ordering::from_saved(ordering.vertices().to_vec(), count).is_ok()
}

/// A symmetric pattern from edges, with an empty diagonal where a vertex has none.
fn graph(count: usize, edges: &[(usize, usize)]) -> CsMat<f64> {
    let mut entries = sprs::TriMat::new((count, count));
    (0..count).for_each(|i| entries.add_triplet(i, i, 1.0));
    for &(a, b) in edges.iter().filter(|(a, b)| a != b) {
        entries.add_triplet(a, b, 1.0);
        entries.add_triplet(b, a, 1.0);
    }
    entries.to_csr()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any graph, any coordinates, all of them in one place or on a line too: every vertex is ordered once.
    #[test]
    fn every_vertex_is_ordered_once(
        edges in prop::collection::vec((0usize..150, 0usize..150), 0..500),
        spread in prop::sample::select(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 1.0]]),
        places in prop::collection::vec(prop::array::uniform3(-5i8..5), 150),
    ) {
        let points: Vec<Point3<f64>> = places.iter().map(|p| Point3::from(std::array::from_fn(|i| spread[i] * f64::from(p[i])))).collect();
        prop_assert!(is_a_permutation(&Ordering::nested_dissection(&graph(150, &edges), &points), 150));
    }

    /// The solution is that of a dense solve, whatever the order of elimination.
    #[test]
    fn solutions_are_those_of_a_dense_solve(values in prop::collection::vec(-2.0..2.0f64, 5), turn in 0usize..64) {
        let mesh = shapes::bump_plane(7, 3.0, 6.0, 5.0);
        let matrix = shell_matrix(&mesh);
        let (handles, held) = (vec![0, 7, 30, 56, 63], vec![20, 21]);
        let mut rotated: Vec<u32> = (0..64).collect();
        rotated.rotate_left(turn);
        let dense = dense_solution(&matrix, &handles, &held, &values);
        for ordering in [Ordering::nested_dissection(&matrix, &mesh.positions), Ordering::from_saved(rotated, 64).unwrap()] {
            let system = Dirichlet::factor(&matrix, &handles, &held, &ordering).unwrap();
            let solved = &system.solve(std::slice::from_ref(&values))[0];
            prop_assert!(solved.iter().zip(&dense).all(|(a, b)| (a - b).abs() < 1e-10));
        }
    }
}

fn dense_solution(matrix: &CsMat<f64>, handles: &[u32], held: &[u32], values: &[f64]) -> Vec<f64> {
    let count = matrix.rows();
    let full = DMatrix::from_fn(count, count, |row, column| matrix.get(row, column).copied().unwrap_or(0.0));
    let mut solution = DVector::zeros(count);
    handles.iter().zip(values).for_each(|(&vertex, &value)| solution[vertex as usize] = value);
    let prescribed = |vertex: &usize| handles.iter().chain(held).any(|&other| other as usize == *vertex);
    let free: Vec<usize> = (0..count).filter(|vertex| !prescribed(vertex)).collect();
    let rhs = -(full.select_rows(&free) * &solution);
    let part = full.select_rows(&free).select_columns(&free).cholesky().unwrap().solve(&rhs);
    free.iter().zip(part.iter()).for_each(|(&vertex, &value)| solution[vertex] = value);
    solution.iter().copied().collect()
}

/// On a large grid nested dissection needs far less fill than elimination row after row.
#[test]
fn nested_dissection_keeps_the_fill_low() {
    let mesh = shapes::grid(120, 1.0);
    let matrix = shell_matrix(&mesh);
    let count = mesh.positions.len();
    let entries = |ordering: &Ordering| {
        Dirichlet::factor(&matrix, &[0, 120], &[], ordering).unwrap().free_factor().entry_count()
    };
    let nested = entries(&Ordering::nested_dissection(&matrix, &mesh.positions));
    let row_by_row = entries(&Ordering::from_saved((0..count as u32).collect(), count).unwrap());
    // 31 n log₂ n / 4 is what theory gives for a nine-point stencil on a grid; a band costs n · 2 rows.
    assert!(nested * 2 < row_by_row, "{nested} entries, {row_by_row} row by row");
    assert!((nested as f64) < 12.0 * count as f64 * (count as f64).log2(), "{nested} entries for {count}");
}

/// Handles that carry a constant or a linear field: the surface follows it exactly.
#[test]
fn responses_add_up_to_one_and_the_schur_complement_is_the_energy() {
    let mesh = shapes::bump_plane(20, 2.0, 8.0, 9.0);
    let matrix = shell_matrix(&mesh);
    let handles = [0, 20, 210, 225, 420, 440, 100, 300, 333, 50];
    let ordering = Ordering::nested_dissection(&matrix, &mesh.positions);
    let system = Dirichlet::factor(&matrix, &handles, &[], &ordering).unwrap();
    let responses = system.responses(true);
    for row in responses.values.chunks_exact(handles.len()) {
        assert!((row.iter().sum::<f32>() - 1.0).abs() < 1e-5);
    }
    let values: Vec<f64> = (0..10).map(|i| f64::from(i * i % 7) - 3.0).collect();
    let field = &system.solve(std::slice::from_ref(&values))[0];
    let applied: Vec<f64> = matrix
        .outer_iterator()
        .map(|row| row.iter().map(|(column, value)| value * field[column]).sum())
        .collect();
    let energy: f64 = applied.iter().zip(field).map(|(a, b)| a * b).sum();
    let reduced: f64 = (0..10)
        .flat_map(|i| (0..10).map(move |j| (i, j)))
        .map(|(i, j)| values[i] * responses.schur[i][j] * values[j])
        .sum();
    assert!((energy - reduced).abs() < 1e-9 * energy);
    assert_eq!(system.responses(false).schur, responses.schur);
}

/// What is not positive definite is refused, and the vertex named is one that the system does not hold; so is a system
/// without unknowns.
#[test]
fn what_does_not_determine_the_rest_is_refused() {
    let mesh = shapes::grid(3, 1.0);
    let (mut matrix, _) = cotan_stiffness(&mesh.positions, &mesh.triangles(), 1e4);
    let ordering = Ordering::nested_dissection(&matrix, &mesh.positions);
    let everything: Vec<u32> = (0..16).collect();
    let factor =
        |matrix: &CsMat<f64>, handles: &[u32]| Dirichlet::factor(matrix, handles, &[], &ordering).err();
    assert_eq!(factor(&matrix, &everything), Some(FactorError::NothingFree));
    assert_eq!(factor(&matrix, &[0, 15]), None);
    // One vertex is pushed away instead of held.
    *matrix.get_mut(6, 6).unwrap() = -10.0;
    assert_eq!(factor(&matrix, &[0, 15, 1, 2, 5, 7, 9, 10]), Some(FactorError::NotPositive { vertex: 6 }));
}

/// The saved order is checked.
#[test]
fn a_saved_order_must_list_every_vertex_once() {
    assert!(Ordering::from_saved(vec![2, 0, 1], 3).is_ok());
    for wrong in [vec![0, 1], vec![0, 1, 1], vec![0, 1, 3], vec![0, 1, 2, 2]] {
        assert!(Ordering::from_saved(wrong, 3).is_err());
    }
}

/// Graph Laplacian plus identity: positive definite on any graph.
fn graph_matrix(count: usize, edges: &[(usize, usize)]) -> CsMat<f64> {
    let mut entries = sprs::TriMat::new((count, count));
    (0..count).for_each(|i| entries.add_triplet(i, i, 1.0));
    for &(a, b) in edges.iter().filter(|(a, b)| a != b) {
        entries.add_triplet(a, b, -1.0);
        entries.add_triplet(b, a, -1.0);
        entries.add_triplet(a, a, 1.0);
        entries.add_triplet(b, b, 1.0);
    }
    entries.to_csr()
}

/// Largest entry of `A x − b` for the x that the factor gives for a b of many values.
fn residual(matrix: &CsMat<f64>, factor: &Factor) -> f64 {
    let side: Vec<f64> = (0..matrix.rows()).map(|i| ((i * 37) % 101) as f64 - 50.0).collect();
    let mut column: Vec<f64> = factor.order().iter().map(|&vertex| side[vertex as usize]).collect();
    factor.solve_in_place(&mut column, 1);
    let mut solution = vec![0.0; side.len()];
    factor.order().iter().zip(column).for_each(|(&vertex, value)| solution[vertex as usize] = value);
    let row = |(row, b): (sprs::CsVecView<f64>, &f64)| {
        (row.iter().map(|(column, value)| value * solution[column]).sum::<f64>() - b).abs()
    };
    matrix.outer_iterator().zip(&side).map(row).fold(0.0, f64::max)
}

/// A name, a number of vertices, and edges.
type Graph = (&'static str, usize, Vec<(usize, usize)>);

/// Graphs that break naive orderings.
fn awkward_graphs() -> Vec<Graph> {
    let grid = |side: usize| -> Vec<(usize, usize)> {
        let across = (0..side * side).filter(|i| i % side + 1 < side).map(|i| (i, i + 1));
        across.chain((0..side * (side - 1)).map(|i| (i, i + side))).collect()
    };
    let comb =
        (0..400).flat_map(|i| [(i * 5, (i * 5 + 5) % 2000), (i * 5, i * 5 + 1), (i * 5 + 1, i * 5 + 2)]);
    vec![
        ("path", 3000, (1..3000).map(|i| (i - 1, i)).collect()),
        ("star", 3000, (1..3000).map(|i| (0, i)).collect()),
        ("two stars", 3000, (2..3000).map(|i| (i % 2, i)).chain([(0, 1)]).collect()),
        ("clique", 90, (0..90).flat_map(|i| (0..i).map(move |j| (j, i))).collect()),
        ("cliques", 600, (0..600).flat_map(|i| (i / 20 * 20..i).map(move |j| (j, i))).collect()),
        ("nothing", 500, Vec::new()),
        ("grid", 3600, grid(60)),
        ("comb", 2000, comb.collect()),
        ("binary tree", 2047, (1..2047).map(|i| ((i - 1) / 2, i)).collect()),
    ]
}

/// Without coordinates, or with useless ones, every graph is ordered, with no more fill than row after row, and solved.
#[test]
fn awkward_graphs_are_ordered_and_solved() {
    for (name, count, edges) in awkward_graphs() {
        let matrix = graph_matrix(count, &edges);
        let along = |i: usize| Point3::new(i as f64, 2.0 * i as f64, 0.0);
        let orders = [
            Ordering::of_graph(&matrix),
            Ordering::nested_dissection(&matrix, &vec![Point3::new(1.0, 2.0, 3.0); count]),
            Ordering::nested_dissection(&matrix, &(0..count).map(along).collect::<Vec<_>>()),
        ];
        let natural = Factor::new(&matrix, &(0..count as u32).collect::<Vec<_>>()).unwrap();
        for ordering in orders {
            assert!(is_a_permutation(&ordering, count), "{name}");
            let factor = Factor::new(&matrix, ordering.vertices()).unwrap();
            let bound = natural.entry_count() + natural.entry_count() / 2;
            assert!(
                factor.entry_count() <= bound,
                "{name}: {} {}",
                factor.entry_count(),
                natural.entry_count()
            );
            assert!(residual(&matrix, &factor) < 1e-9, "{name}");
        }
        assert!(residual(&matrix, &natural) < 1e-9, "{name}");
    }
}

/// Coordinates that are no numbers are not gone by.
#[test]
fn coordinates_that_are_no_numbers_are_left_aside() {
    let mesh = shapes::grid(20, 1.0);
    let matrix = shell_matrix(&mesh);
    for wrong in [f64::NAN, f64::INFINITY, 1e300] {
        let mut points = mesh.positions.clone();
        points[7].y = wrong;
        assert_eq!(Ordering::nested_dissection(&matrix, &points), Ordering::of_graph(&matrix));
    }
}

/// Three unknowns a vertex, analysed by their blocks: the same solution, whether the matrix has both triangles or only what is eliminated
/// later.
#[test]
fn blocks_are_factored_like_their_unknowns() {
    let mesh = shapes::grid(12, 1.0);
    let pattern = shell_matrix(&mesh);
    let ordering = Ordering::nested_dissection(&pattern, &mesh.positions);
    let mut place = vec![0; pattern.rows()];
    ordering.vertices().iter().enumerate().for_each(|(at, &vertex)| place[vertex as usize] = at);
    let entries = |half: bool| {
        let mut triplets = sprs::TriMat::new((3 * pattern.rows(), 3 * pattern.rows()));
        for (column, entries) in pattern.outer_iterator().enumerate() {
            for (row, value) in entries.iter().filter(|(row, _)| !half || place[*row] >= place[column]) {
                for (r, c) in (0..9).map(|i| (i / 3, i % 3)) {
                    // The shell alone says nothing of where it is.
                    let value = value + if row == column { 100.0 } else { 0.0 };
                    triplets.add_triplet(3 * row + r, 3 * column + c, value * if r == c { 1.0 } else { 0.2 });
                }
            }
        }
        triplets.to_csc::<usize>()
    };
    let unknowns: Vec<u32> = ordering.vertices().iter().flat_map(|v| [3 * v, 3 * v + 1, 3 * v + 2]).collect();
    let (whole, half) = (entries(false), entries(true));
    let plain = Factor::new(&whole, &unknowns).unwrap();
    for matrix in [&whole, &half] {
        let blocks = Factor::of_blocks(&pattern, ordering.vertices(), 3, matrix).unwrap();
        assert_eq!(blocks.entry_count(), plain.entry_count());
        assert!(residual(&whole, &blocks) < 1e-9);
    }
}

/// A long chain of fronts, each too heavy to be left to one thread with the rest.
#[test]
fn deep_trees_are_walked() {
    const COUNT: usize = 12_000;
    let edges: Vec<(usize, usize)> =
        (0..COUNT).flat_map(|i| (i.saturating_sub(40)..i).map(move |j| (j, i))).collect();
    let matrix = graph_matrix(COUNT, &edges);
    let factor = Factor::new(&matrix, &(0..COUNT as u32).collect::<Vec<_>>()).unwrap();
    assert!(residual(&matrix, &factor) < 1e-9);
    let path: Vec<(usize, usize)> = (1..100_000).map(|i| (i - 1, i)).collect();
    let matrix = graph_matrix(100_000, &path);
    let factor = Factor::new(&matrix, &(0..100_000).collect::<Vec<_>>()).unwrap();
    assert!(residual(&matrix, &factor) < 1e-9);
}

/// Same bytes for any number of threads: the order, the factor's solutions, the responses.
#[test]
fn threads_change_nothing() {
    let mesh = shapes::bump_plane(150, 1.0, 20.0, 30.0);
    let matrix = shell_matrix(&mesh);
    let handles = [0, 150, 11_000, 22_650, 22_800, 5_000, 17_017];
    let solve = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let ordering = Ordering::nested_dissection(&matrix, &mesh.positions);
            let system = Dirichlet::factor(&matrix, &handles, &[3, 4], &ordering).unwrap();
            let values: Vec<Vec<f64>> =
                (0..3).map(|axis| (0..7).map(|i| f64::from(i * axis) - 2.5).collect()).collect();
            let responses = system.responses(true);
            (ordering, system.solve(&values), responses.values, responses.schur)
        })
    };
    let one = solve(1);
    assert!([2, 3, 5].into_iter().all(|threads| solve(threads) == one));
}

/// Any number of columns gives what each gives alone.
#[test]
fn columns_do_not_touch_each_other() {
    let mesh = shapes::bump_plane(30, 2.0, 8.0, 9.0);
    let matrix = shell_matrix(&mesh);
    let ordering = Ordering::nested_dissection(&matrix, &mesh.positions);
    let system = Dirichlet::factor(&matrix, &[0, 30, 500, 930], &[], &ordering).unwrap();
    let column = |i: usize| -> Vec<f64> { (0..4).map(|j| ((i * 5 + j * 3) % 7) as f64 - 3.0).collect() };
    let columns: Vec<Vec<f64>> = (0..19).map(column).collect();
    let alone: Vec<Vec<f64>> =
        columns.iter().flat_map(|one| system.solve(std::slice::from_ref(one))).collect();
    for count in [2, 3, 4, 5, 8, 9, 19] {
        assert_eq!(system.solve(&columns[..count]), alone[..count]);
    }
}

/// A part that nothing holds is singular; rounding may leave its last pivot a little above zero, and it is refused all the
/// same, by a vertex of that part.
#[test]
fn parts_that_nothing_holds_are_refused() {
    let mesh = shapes::bump_plane(12, 2.0, 8.0, 9.0);
    let (one, _) = cotan_stiffness(&mesh.positions, &mesh.triangles(), 1e4);
    let part = one.rows();
    let far = |p: &Point3<f64>| Point3::new(p.x + 500.0, p.y, p.z);
    let points: Vec<Point3<f64>> =
        mesh.positions.iter().copied().chain(mesh.positions.iter().map(far)).collect();
    for stiffness in (1..20).map(|i| 0.37 * f64::from(i)) {
        let mut entries = sprs::TriMat::new((2 * part, 2 * part));
        for (&value, (row, column)) in &one {
            entries.add_triplet(row, column, value);
            entries.add_triplet(row + part, column + part, value * stiffness);
        }
        let matrix: CsMat<f64> = entries.to_csr();
        let ordering = Ordering::nested_dissection(&matrix, &points);
        match Dirichlet::factor(&matrix, &[0, 12], &[], &ordering).err() {
            Some(FactorError::NotPositive { vertex }) => assert!(vertex as usize >= part, "{vertex}"),
            other => panic!("{stiffness}: {other:?}"),
        }
        assert!(Dirichlet::factor(&matrix, &[0, 12, part as u32 + 5], &[], &ordering).is_ok());
    }
}

/// A grid with needles, its matrix on a lattice on which a field of whole numbers has an exact image.
fn needles() -> (CsMat<f64>, Vec<f64>, Ordering) {
    let mut mesh = shapes::grid(24, 1.0);
    let triangles = mesh.triangles();
    for [a, b, c] in triangles.iter().step_by(41).map(|triangle| triangle.map(|vertex| vertex as usize)) {
        let middle = nalgebra::center(&mesh.positions[b], &mesh.positions[c]);
        mesh.positions[a] = middle + (mesh.positions[a] - middle) * 1e-4;
    }
    let mut matrix = shell_matrix(&mesh);
    matrix.data_mut().iter_mut().for_each(|value| *value = (*value * 1024.0).round() / 1024.0);
    let field = (0..mesh.positions.len()).map(|vertex| f64::from(vertex as u32 * 7 % 16)).collect();
    let ordering = Ordering::nested_dissection(&matrix, &mesh.positions);
    (matrix, field, ordering)
}

/// Needles cost a plain substitution digits; a step of refinement brings them back, and mends a solution that was spoilt.
#[test]
fn refinement_brings_back_the_digits_that_needles_cost() {
    let (matrix, truth, ordering) = needles();
    let handles: Vec<u32> = (0..truth.len() as u32).step_by(13).collect();
    let system = Dirichlet::factor(&matrix, &handles, &[], &ordering).unwrap();
    let factor = system.free_factor();
    let free = |vertex: usize| !handles.contains(&(vertex as u32));
    let image = |&vertex: &u32| -> f64 {
        let row = matrix.outer_view(vertex as usize).unwrap();
        row.iter().filter(|(column, _)| free(*column)).map(|(column, value)| value * truth[column]).sum()
    };
    let right: Vec<f64> = factor.order().iter().map(image).collect();
    let error = |solution: &[f64]| {
        let off = |(&vertex, value): (&u32, &f64)| (value - truth[vertex as usize]).abs();
        factor.order().iter().zip(solution).map(off).fold(0.0, f64::max)
    };
    let mut solution = right.clone();
    factor.solve_in_place(&mut solution, 1);
    let plain = error(&solution);
    factor.refine_in_place(&matrix, &right, &mut solution, 1);
    assert!(error(&solution) < 0.01 * plain, "{} after {plain}", error(&solution));
    solution.iter_mut().step_by(3).for_each(|value| *value += 1e-3);
    factor.refine_in_place(&matrix, &right, &mut solution, 1);
    assert!(error(&solution) < 1e-8, "{}", error(&solution));
}

/// The refined minimum is the plain one where nothing needs refinement.
#[test]
fn refined_and_plain_minima_agree() {
    let mesh = shapes::bump_plane(20, 2.0, 8.0, 9.0);
    let matrix = shell_matrix(&mesh);
    let ordering = Ordering::nested_dissection(&matrix, &mesh.positions);
    let system = Dirichlet::factor(&matrix, &[0, 20, 225, 440], &[3, 7], &ordering).unwrap();
    let columns = [vec![1.0, -2.0, 5.0, 0.5], vec![0.0, 3.0, 1.0, -1.0]];
    let difference =
        system.solve(&columns).concat().into_iter().zip(system.solve_refined(&matrix, &columns).concat());
    assert!(difference.map(|(plain, refined)| (plain - refined).abs()).fold(0.0, f64::max) < 1e-9);
}
