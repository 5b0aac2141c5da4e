//! Laws of the shell, on irregular surfaces.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use linear_shell::{
    Basis, BowTies, Completion, Constraints, Error, FreeComponents, LeaveOneOut, Params, Shell, Surface,
    TearWatch,
};
use mesh::Mesh;
use nalgebra::Vector3;
use proptest::prelude::*;
use testkit::shapes;

fn surface(mesh: &Mesh, handles: &[u32]) -> (Surface, Constraints) {
    let constraints = Constraints { handles: handles.to_vec(), held: Vec::new() };
    (Surface::survey(mesh, &constraints, &Params::default()).unwrap(), constraints)
}

fn shell(mesh: &Mesh, handles: &[u32]) -> Shell {
    let (surface, constraints) = surface(mesh, handles);
    Shell::factor(&surface, &constraints, &surface.ordering()).unwrap()
}

const HANDLES: [u32; 9] = [0, 12, 60, 84, 90, 100, 130, 156, 168];

fn bump() -> Mesh {
    shapes::bump_plane(12, 5.0, 15.0, 14.0)
}

fn vector() -> impl Strategy<Value = Vector3<f64>> {
    prop::array::uniform3(-10.0..10.0f64).prop_map(Vector3::from)
}

fn displacements() -> impl Strategy<Value = Vec<Vector3<f64>>> {
    prop::collection::vec(vector(), HANDLES.len())
}

fn largest(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn handles_are_met(given in displacements()) {
        let field = shell(&bump(), &HANDLES).solve(&given);
        for (&vertex, displacement) in HANDLES.iter().zip(&given) {
            prop_assert!((field[vertex as usize] - displacement).norm() < 1e-9);
        }
    }

    #[test]
    fn the_field_is_linear_in_the_handles(a in displacements(), b in displacements(), s in -3.0..3.0f64) {
        let shell = shell(&bump(), &HANDLES);
        let sum: Vec<Vector3<f64>> = a.iter().zip(&b).map(|(a, b)| a + s * b).collect();
        let parts: Vec<Vector3<f64>> = shell.solve(&a).iter().zip(shell.solve(&b)).map(|(a, b)| a + s * b).collect();
        prop_assert!(largest(&shell.solve(&sum), &parts) < 1e-9);
    }

    #[test]
    fn a_constant_stays_constant(all in vector()) {
        let field = shell(&bump(), &HANDLES).solve(&[all; 9]);
        prop_assert!(field.iter().all(|d| (d - all).norm() < 1e-9));
    }

    /// The energy is at its minimum: any change that leaves the handles alone costs.
    #[test]
    fn perturbations_cost_energy(given in displacements(), change in prop::collection::vec(-1.0..1.0f64, 169)) {
        let mesh = bump();
        let (surface, _) = surface(&mesh, &HANDLES);
        let field = shell(&mesh, &HANDLES).solve(&given);
        let energy = |x: &[f64]| -> f64 {
            let applied = surface.system().outer_iterator().map(|row| row.iter().map(|(column, k)| k * x[column]).sum::<f64>());
            applied.zip(x).map(|(a, b)| a * b).sum()
        };
        let solved: Vec<f64> = field.iter().map(|d| d.x).collect();
        let moved: Vec<f64> = solved
            .iter()
            .enumerate()
            .map(|(vertex, x)| if HANDLES.contains(&(vertex as u32)) { *x } else { x + change[vertex] })
            .collect();
        prop_assert!(energy(&moved) > energy(&solved) - 1e-9 * energy(&solved).abs());
    }

    #[test]
    fn the_basis_gives_what_the_direct_solve_gives(given in displacements()) {
        let mesh = bump();
        let shell = shell(&mesh, &HANDLES);
        let rest: Vec<f32> = mesh.positions.iter().flat_map(|p| [p.x as f32, p.y as f32, p.z as f32]).collect();
        let frame = &shell.basis().0.deform(&rest, std::slice::from_ref(&given), 0.1)[0];
        for (vertex, d) in shell.solve(&given).iter().enumerate() {
            let direct = (mesh.positions[vertex] + d) * 0.1;
            let deformed = Vector3::from_fn(|axis, _| f64::from(frame[vertex * 3 + axis]));
            prop_assert!((direct.coords - deformed).norm() < 2e-5);
        }
    }

    /// Leaving handles out by the Schur complement is the same as a shell that was factored without them.
    #[test]
    fn missing_handles_go_where_a_shell_without_them_puts_them(given in displacements(), gone in prop::collection::hash_set(0usize..9, 1..8)) {
        let mesh = bump();
        let full = shell(&mesh, &HANDLES);
        let told: Vec<Option<Vector3<f64>>> = (0..9).map(|i| (!gone.contains(&i)).then_some(given[i])).collect();
        let completed = full.completion().complete(&told, &[None; 9]).unwrap();
        let kept: Vec<usize> = (0..9).filter(|i| !gone.contains(i)).collect();
        let fewer = shell(&mesh, &kept.iter().map(|&i| HANDLES[i]).collect::<Vec<_>>());
        let reference = fewer.solve(&kept.iter().map(|&i| given[i]).collect::<Vec<_>>());
        prop_assert!(largest(&full.solve(&completed), &reference) < 1e-8);
    }

    /// The closed form of the leave-one-out error is the distance that leaving the handle out really gives.
    #[test]
    fn leave_one_out_errors_are_those_of_leaving_out(given in displacements(), gone in prop::collection::hash_set(0usize..9, 0..6)) {
        let completion = shell(&bump(), &HANDLES).completion();
        let told: Vec<Option<Vector3<f64>>> = (0..9).map(|i| (!gone.contains(&i)).then_some(given[i])).collect();
        let mut statistics = LeaveOneOut::new(9);
        statistics.add(&completion, &told);
        for one in 0..9 {
            let error = statistics.errors()[one];
            if gone.contains(&one) {
                prop_assert_eq!(error, None);
                continue;
            }
            let mut without = told.clone();
            without[one] = None;
            let predicted = completion.complete(&without, &[None; 9]).unwrap()[one];
            prop_assert!((error.unwrap().rms_mm - (predicted - given[one]).norm()).abs() < 1e-8);
            prop_assert_eq!(error.unwrap().rms_mm, error.unwrap().worst_mm);
        }
    }

    /// A soft handle lies between where it is told to go and where it would go by itself; the stiffer, the nearer.
    #[test]
    fn soft_handles_give_way(given in displacements(), weight in 0.01..50.0f64) {
        let completion = shell(&bump(), &HANDLES).completion();
        let exact: Vec<Option<Vector3<f64>>> = given.iter().copied().map(Some).collect();
        let mut weights = [None; 9];
        let at = |weight: Option<f64>, weights: &mut [Option<f64>; 9]| {
            weights[4] = weight;
            completion.complete(&exact, weights).unwrap()[4]
        };
        let (soft, stiff) = (at(Some(weight), &mut weights), at(Some(2.0 * weight), &mut weights));
        let mut without = exact.clone();
        without[4] = None;
        let free = completion.complete(&without, &[None; 9]).unwrap()[4];
        // The spring is relative to the surface's stiffness at the handle: weight w carries w / (1 + w) of the way.
        let expected = free + (given[4] - free) * (weight / (1.0 + weight));
        prop_assert!((soft - expected).norm() < 1e-8);
        prop_assert!((stiff - given[4]).norm() <= (soft - given[4]).norm() + 1e-9);
    }
}

#[test]
fn zero_handles_give_zero() {
    let field = shell(&bump(), &HANDLES).solve(&[Vector3::zeros(); 9]);
    assert!(field.iter().all(|d| d.norm() == 0.0));
}

/// On a strip clamped along both short sides the solution is the known ramp where bending is negligible.
#[test]
fn without_bending_a_strip_is_a_ramp() {
    let mesh = shapes::grid(10, 1.0);
    let left: Vec<u32> = (0..11).map(|row| row * 11).collect();
    let right: Vec<u32> = left.iter().map(|vertex| vertex + 10).collect();
    let constraints = Constraints { handles: right, held: left };
    let params = Params { bending_mm2: 1e-9, ..Params::default() };
    let surface = Surface::survey(&mesh, &constraints, &params).unwrap();
    let shell = Shell::factor(&surface, &constraints, &surface.ordering()).unwrap();
    let field = shell.solve(&[Vector3::new(0.0, 0.0, 10.0); 11]);
    for (vertex, d) in field.iter().enumerate() {
        assert!((d.z - mesh.positions[vertex].x).abs() < 1e-6, "{vertex}: {}", d.z);
    }
}

/// The result does not depend on how many threads work on it.
#[test]
fn threads_change_nothing() {
    let mesh = shapes::bump_plane(80, 1.0, 15.0, 14.0);
    let handles: Vec<u32> = (0..40).map(|i| i * 160 + 7).collect();
    let shell = shell(&mesh, &handles);
    let rest = vec![0.25f32; mesh.positions.len() * 3];
    let frames: Vec<Vec<Vector3<f64>>> =
        (0..5).map(|f| (0..40).map(|i| Vector3::new(f64::from(i), f64::from(f), 0.3)).collect()).collect();
    let made = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let (basis, completion) = shell.basis();
            (basis.deform(&rest, &frames, 1.0), completion)
        })
    };
    assert!(made(1) == made(3));
}

fn refusal(mesh: &Mesh, handles: &[u32], params: &Params) -> Error {
    let constraints = Constraints { handles: handles.to_vec(), held: Vec::new() };
    Surface::survey(mesh, &constraints, params).err().unwrap()
}

#[test]
fn unsolvable_meshes_are_refused_by_name() {
    let grid = shapes::grid(4, 1.0);
    let params = Params::default();
    assert_eq!(refusal(&grid, &[], &params), Error::NoHandles);
    assert_eq!(refusal(&grid, &[3, 25], &params), Error::UnknownVertex { vertex: 25, vertex_count: 25 });
    assert_eq!(refusal(&grid, &[3, 7, 3], &params), Error::SharedVertex { vertex: 3 });
    assert!(matches!(refusal(&shapes::open_book(), &[0], &params), Error::NonManifold { count: 1, .. }));
    assert!(matches!(refusal(&shapes::bow_tie(), &[0], &params), Error::BowTies { count: 1, .. }));
    let two = shapes::two_components(4, 1.0);
    assert!(matches!(refusal(&two, &[0], &params), Error::FreeComponent { count: 1, .. }));
    let negative = Params { bending_mm2: -1.0, ..params };
    assert!(matches!(refusal(&grid, &[0], &negative), Error::Parameter { name: "bending", .. }));

    let mut loose = grid.clone();
    loose.positions.push([9.0, 9.0, 9.0].into());
    assert_eq!(refusal(&loose, &[25], &Params::default()), Error::LooseHandle { vertex: 25 });
    let mut flipped = grid;
    flipped.polygons.push(&[0, 1, 6]);
    assert!(matches!(
        refusal(&flipped, &[0], &Params::default()),
        Error::NonManifold { .. } | Error::Flipped { .. }
    ));
}

#[test]
fn flags_let_imperfect_meshes_pass() {
    let two = shapes::two_components(4, 1.0);
    let params = Params { free_components: FreeComponents::Hold, ..Params::default() };
    let constraints = Constraints { handles: vec![0, 4], held: Vec::new() };
    let held = Surface::survey(&two, &constraints, &params).unwrap();
    assert_eq!(held.report().held_components, 1);
    let shell = Shell::factor(&held, &constraints, &held.ordering()).unwrap();
    let field = shell.solve(&[Vector3::new(1.0, 2.0, 3.0); 2]);
    assert!(field[25..].iter().all(|d| d.norm() == 0.0) && field[..25].iter().all(|d| d.norm() > 3.0));

    let params = Params { bow_ties: BowTies::Join, ..Params::default() };
    let tie = shapes::bow_tie();
    let joined =
        Surface::survey(&tie, &Constraints { handles: vec![0, 1], held: Vec::new() }, &params).unwrap();
    assert_eq!(joined.report().bow_ties, 1);
}

/// Two handles on either side of a slit may part; on a closed surface that is a tear.
#[test]
fn tears_are_told_from_openings() {
    let closed = shapes::grid(20, 3.0);
    let mut open = closed.clone();
    let mut keep = vec![true; open.polygons.len()];
    // The middle row of faces, but for three at each end, is the mouth.
    for face in 0..keep.len() {
        let corner = open.polygons.face(face)[0];
        keep[face] = !(corner / 21 == 10 && (3..17).contains(&(corner % 21)));
    }
    open = Mesh { polygons: open.keep_faces(&keep).0.polygons, ..open.keep_faces(&keep).0 };
    let count_tears = |mesh: &Mesh| {
        let at = |x: f64, y: f64| {
            let near = |p: &nalgebra::Point3<f64>| (p.x - x).abs() + (p.y - y).abs() < 0.1;
            mesh.positions.iter().position(near).unwrap() as u32
        };
        let handles =
            [at(30.0, 30.0), at(30.0, 33.0), at(0.0, 0.0), at(60.0, 0.0), at(0.0, 60.0), at(60.0, 60.0)];
        let (surface, _) = surface(mesh, &handles);
        let mut watch = TearWatch::new(&surface, &handles);
        let mut moved = vec![Vector3::zeros(); 6];
        moved[1] = Vector3::new(0.0, 20.0, 0.0);
        watch.add(&moved);
        watch.tears(&surface, &handles).len()
    };
    assert_eq!(count_tears(&closed), 1);
    assert_eq!(count_tears(&open), 0);
}

#[test]
fn nothing_prescribed_is_an_error() {
    let completion = Completion::new(&[vec![2.0, -1.0], vec![-1.0, 2.0]]);
    assert_eq!(completion.complete(&[None, None], &[None, None]), Err(Error::NothingPrescribed));
    assert_eq!(completion.rows(), [[2.0, -1.0], [-1.0, 2.0]]);
    assert_eq!(Basis::new(vec![1.0; 6], 2).vertex_count(), 3);
}
