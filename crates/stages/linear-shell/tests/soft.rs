//! Laws of the shell with soft openings, of its proxy, and of the affine reference.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use linear_shell::{
    AffineReference, Completion, Constraints, Keep, Model, Params, Proxy, Shell, SoftShell, Surface,
};
use mesh::{Connectivity, Mesh};
use nalgebra::{Matrix3, Point3, Rotation3, Vector3};
use proptest::prelude::*;
use testkit::shapes;

const CELLS: u32 = 40;
const STEP: f64 = 4.0;

/// A bulging patch of 160 mm with a mouth and two eyes.
fn face() -> Mesh {
    face_with(&[])
}

/// The same with more holes: middle and half width.
fn face_with(more: &[[f64; 3]]) -> Mesh {
    let closed = shapes::bump_plane(CELLS, STEP, 25.0, 50.0);
    let hole = |x: f64, y: f64| {
        let within =
            |cx: f64, cy: f64, rx: f64, ry: f64| ((x - cx) / rx).abs() < 1.0 && ((y - cy) / ry).abs() < 1.0;
        let another = more.iter().any(|&[cx, cy, r]| within(cx, cy, r, r));
        another
            || within(80.0, 50.0, 26.0, 5.0)
            || within(48.0, 110.0, 14.0, 7.0)
            || within(112.0, 110.0, 14.0, 7.0)
    };
    let keep: Vec<bool> = closed
        .polygons
        .iter()
        .map(|face| {
            let middle = face.iter().map(|&v| closed.positions[v as usize].coords).sum::<Vector3<f64>>()
                / face.len() as f64;
            !hole(middle.x, middle.y)
        })
        .collect();
    closed.keep_faces(&keep).0
}

/// The vertices nearest to an even pattern of places.
fn handles(mesh: &Mesh) -> Vec<u32> {
    let places = (0..16).map(|i| (15.0 + 43.0 * f64::from(i % 4), 15.0 + 43.0 * f64::from(i / 4)));
    let nearest = |(x, y): (f64, f64)| {
        let far = |v: &u32| {
            let p = mesh.positions[*v as usize];
            (p.x - x).hypot(p.y - y)
        };
        (0..mesh.positions.len() as u32).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap()
    };
    places.map(nearest).collect()
}

fn params(proxy_vertices: usize) -> Params {
    Params { model: Model::SoftOpenings, proxy_vertices, ..Params::default() }
}

fn shell(mesh: &Mesh, params: &Params) -> (SoftShell, Vec<u32>) {
    let constraints = Constraints { handles: handles(mesh), held: Vec::new() };
    let surface = Surface::survey(mesh, &constraints, params).unwrap();
    (SoftShell::factor(&surface, &constraints, &surface.ordering()).unwrap(), constraints.handles)
}

/// A smooth motion.
fn motion(p: &Point3<f64>) -> Vector3<f64> {
    Vector3::new((p.y / 40.0).sin(), 2.0 * (p.x / 50.0).cos(), 3.0 * ((p.x + p.y) / 45.0).sin())
}

fn largest(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

fn mean(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).sum::<f64>() / a.len() as f64
}

fn told(mesh: &Mesh, handles: &[u32]) -> Vec<Vector3<f64>> {
    handles.iter().map(|&handle| motion(&mesh.positions[handle as usize])).collect()
}

#[test]
fn the_face_has_a_mouth_two_eyes_and_a_rim() {
    let mesh = face();
    let constraints = Constraints { handles: handles(&mesh), held: Vec::new() };
    let survey = Surface::survey(&mesh, &constraints, &params(9999)).unwrap().report().clone();
    assert_eq!(survey.openings_mm.len(), 3);
    assert!(!survey.mouth_is_missing);
    // Without its rim's length among them: the mouth is the longest.
    assert!(survey.openings_mm[0] < 200.0 && survey.openings_mm[0] > survey.openings_mm[1]);
    // Neither a hole of the scan nor two nostrils are openings.
    let more = face_with(&[[30.0, 40.0, 5.0], [70.0, 82.0, 9.0], [92.0, 82.0, 9.0]]);
    let constraints_there = Constraints { handles: handles(&more), held: Vec::new() };
    let found =
        Surface::survey(&more, &constraints_there, &params(9999)).unwrap().report().openings_mm.clone();
    assert_eq!(found.len(), 3, "{found:?}");
    let small = Params { smallest_opening_mm: 90.0, ..params(9999) };
    assert_eq!(Surface::survey(&mesh, &constraints, &small).unwrap().report().openings_mm.len(), 1);
}

#[test]
fn handles_are_met_and_constants_stay_constant() {
    let mesh = face();
    for proxy_vertices in [9999, 500] {
        let (shell, handles) = shell(&mesh, &params(proxy_vertices));
        let told = told(&mesh, &handles);
        let field = shell.solve(&told);
        let met: Vec<Vector3<f64>> = handles.iter().map(|&handle| field[handle as usize]).collect();
        assert_eq!(largest(&met, &told), 0.0);
        let shift = Vector3::new(1.0, -2.0, 30.0);
        let still = shell.solve(&vec![shift; handles.len()]);
        assert!(still.iter().all(|d| (d - shift).norm() < 1e-8), "{proxy_vertices}");
    }
}

/// Turning the scan and all displacements turns the result, and nothing else.
#[test]
fn a_rigid_motion_of_everything_changes_nothing() {
    let mesh = face();
    let turn = Rotation3::from_euler_angles(0.3, -0.8, 1.9);
    let moved = mesh
        .with_positions(mesh.positions.iter().map(|p| turn * p + Vector3::new(7.0, -30.0, 400.0)).collect());
    // On a proxy, rounding decides between edges of the same length: then the results agree as two proxies do.
    for (proxy_vertices, tolerance) in [(9999, 1e-9), (700, 0.05)] {
        let (here, handles) = shell(&mesh, &params(proxy_vertices));
        let constraints = Constraints { handles: handles.clone(), held: Vec::new() };
        let surface = Surface::survey(&moved, &constraints, &params(proxy_vertices)).unwrap();
        let there = SoftShell::factor(&surface, &constraints, &surface.ordering()).unwrap();
        let told = told(&mesh, &handles);
        let turned = there.solve(&told.iter().map(|d| turn * d).collect::<Vec<_>>());
        let back: Vec<Vector3<f64>> = turned.iter().map(|d| turn.inverse() * d).collect();
        let apart = mean(&here.solve(&told), &back);
        assert!(apart < tolerance, "{apart}");
    }
}

#[test]
fn the_basis_gives_what_the_direct_solve_gives() {
    let mesh = face();
    let (shell, handles) = shell(&mesh, &params(600));
    let told = told(&mesh, &handles);
    let (basis, completion, change) = shell.basis();
    assert!(change < 1e-9, "{change}");
    assert_eq!(completion, shell.completion());
    let still = vec![0.0; mesh.positions.len() * 3];
    let frame = &basis.deform(&still, std::slice::from_ref(&told), 1.0)[0];
    let combined: Vec<Vector3<f64>> =
        frame.chunks(3).map(|d| Vector3::new(d[0], d[1], d[2]).cast()).collect();
    assert!(largest(&combined, &shell.solve(&told)) < 2e-5);
    // A handle that is missing goes where a shell without it puts it.
    let mut given: Vec<Option<Vector3<f64>>> = told.iter().copied().map(Some).collect();
    given[5] = None;
    let completed = completion.complete(&given, &[None; 16]).unwrap();
    let fewer = Constraints {
        handles: handles.iter().copied().filter(|&h| h != handles[5]).collect(),
        held: Vec::new(),
    };
    let whole = params(9999);
    let surface = Surface::survey(&mesh, &fewer, &whole).unwrap();
    let without = SoftShell::factor(&surface, &fewer, &surface.ordering()).unwrap();
    let known: Vec<Vector3<f64>> = given.iter().copied().flatten().collect();
    assert!((completed[5] - without.solve(&known)[handles[5] as usize]).norm() < 0.1);
}

/// A solve on a third of the vertices, continued, is near the solve on all of them.
#[test]
fn the_proxy_stands_for_the_scan() {
    let mesh = face();
    let (fine, handles) = shell(&mesh, &params(9999));
    let (coarse, _) = shell(&mesh, &params(550));
    assert_eq!(fine.proxy().vertices.len(), mesh.positions.len());
    assert!(coarse.proxy().vertices.len() <= 560);
    let told = told(&mesh, &handles);
    let apart = mean(&fine.solve(&told), &coarse.solve(&told));
    assert!(apart < 0.05, "{apart}");
}

/// The patch keeps its outline: its four corners stay as long as there is anything else to take.
#[test]
fn corners_of_the_boundary_stay() {
    let mesh = face();
    let even = vec![1.0; mesh.positions.len()];
    let keep = Keep { vertices: &[], still: &[] };
    let proxy = Proxy::of(&mesh.positions, &mesh.triangles(), 60, &even, keep);
    let side = f64::from(CELLS) * STEP;
    for (x, y) in [(0.0, 0.0), (side, 0.0), (0.0, side), (side, side)] {
        let is_corner = |v: &&u32| {
            let p = mesh.positions[**v as usize];
            (p.x - x).abs() + (p.y - y).abs() < 1e-9
        };
        assert!(proxy.vertices.iter().any(|v| is_corner(&v)), "{x}, {y}");
    }
}

/// Held vertices stay, on the proxy and on the scan.
#[test]
fn held_vertices_stand_still() {
    let mesh = face();
    let held: Vec<u32> =
        (0..mesh.positions.len() as u32).filter(|&v| mesh.positions[v as usize].y < 9.0).collect();
    let handles: Vec<u32> = handles(&mesh).into_iter().filter(|handle| !held.contains(handle)).collect();
    let constraints = Constraints { handles, held: held.clone() };
    let surface = Surface::survey(&mesh, &constraints, &params(500)).unwrap();
    let shell = SoftShell::factor(&surface, &constraints, &surface.ordering()).unwrap();
    let field = shell.solve(&vec![Vector3::new(5.0, 0.0, 0.0); constraints.handles.len()]);
    assert!(held.iter().all(|&vertex| field[vertex as usize].norm() == 0.0));
    assert!(shell.proxy().vertices.iter().filter(|vertex| held.contains(vertex)).count() > 5);
}

/// Softening lets the rim of an opening go further in the direction that its surroundings take.
#[test]
fn openings_are_soft() {
    let mesh = face();
    let field = |softening: f64| {
        let params = Params { softening, ..params(9999) };
        let (shell, handles) = shell(&mesh, &params);
        shell.solve(&told(&mesh, &handles))
    };
    let (soft, even, stiffer) = (field(0.97), field(0.0), field(0.5));
    let near =
        |v: &usize| (mesh.positions[*v].x - 80.0).abs() < 30.0 && (mesh.positions[*v].y - 50.0).abs() < 10.0;
    let change = |pick: &dyn Fn(&usize) -> bool, a: &[Vector3<f64>]| {
        let picked: Vec<usize> = (0..mesh.positions.len()).filter(pick).collect();
        picked.iter().map(|&v| (a[v] - even[v]).norm()).sum::<f64>() / picked.len() as f64
    };
    let far = |v: &usize| mesh.positions[*v].y > 150.0;
    assert!(change(&near, &soft) > 3.0 * change(&far, &soft));
    assert!(change(&near, &soft) > change(&near, &stiffer));
    assert!(change(&near, &stiffer) > 0.0);
}

fn euler(vertex_count: usize, triangles: &[[u32; 3]]) -> i64 {
    let around = Connectivity::of(vertex_count, triangles);
    (vertex_count - around.unreferenced().len()) as i64 - around.edge_count() as i64 + triangles.len() as i64
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// However far a mesh is shortened: still a manifold, facing the same way, with the same loops; and what is kept is there.
    #[test]
    fn the_proxy_keeps_the_topology(target in 60usize..1500, kept in prop::collection::vec(0u32..1500, 1..20), bump in 0.0..40.0f64) {
        let flat = face();
        let mesh = flat.with_positions(
            flat.positions.iter().map(|p| Point3::new(p.x, p.y, p.z + bump * ((p.x / 9.0).sin() * (p.y / 7.0).cos()) * 0.1)).collect(),
        );
        let triangles = mesh.triangles();
        // Two that stand still on their own: neither has one of its kind to go to.
        let still = [300u32, 1100];
        let even = vec![1.0; mesh.positions.len()];
        let keep = Keep { vertices: &kept, still: &still };
        let proxy = Proxy::of(&mesh.positions, &triangles, target, &even, keep);
        let around = Connectivity::of(proxy.vertices.len(), &proxy.triangles);
        prop_assert!(around.non_manifold_edges().is_empty() && around.flipped_edges().is_empty());
        prop_assert!(around.bow_ties().is_empty() && around.unreferenced().is_empty());
        prop_assert_eq!(around.boundary_loops().len(), 4);
        prop_assert_eq!(euler(proxy.vertices.len(), &proxy.triangles), euler(mesh.positions.len(), &triangles));
        prop_assert!(kept.iter().all(|vertex| proxy.vertices.binary_search(vertex).is_ok()));
        prop_assert!(still.iter().all(|vertex| proxy.vertices.binary_search(vertex).is_ok()));
        // Corners of the openings hold on to a few; otherwise it gets as small as it is told.
        prop_assert!(proxy.vertices.len() <= target.max(160) + kept.len() + still.len());
    }

    /// With an affine reference an affine motion of the handles is an affine motion of everything; without, it is not.
    #[test]
    fn affine_motions_are_reproduced(entries in prop::array::uniform9(-0.2..0.2f64), shift in prop::array::uniform3(-9.0..9.0f64)) {
        let mesh = face();
        let affine = |p: &Point3<f64>| Matrix3::from_row_slice(&entries) * p.coords + Vector3::from(shift);
        let truth: Vec<Vector3<f64>> = mesh.positions.iter().map(affine).collect();
        let constraints = Constraints { handles: handles(&mesh), held: Vec::new() };
        let told: Vec<Vector3<f64>> = constraints.handles.iter().map(|&handle| truth[handle as usize]).collect();
        let places: Vec<Point3<f64>> = constraints.handles.iter().map(|&handle| mesh.positions[handle as usize]).collect();
        let reference = AffineReference::new(&places);
        let surface = Surface::survey(&mesh, &constraints, &Params::default()).unwrap();
        let shell = Shell::factor(&surface, &constraints, &surface.ordering()).unwrap();

        let (left, motion) = reference.split(&told);
        prop_assert!(left.iter().all(|d| d.norm() < 1e-9));
        let mut field = shell.solve(&left);
        reference.add(&motion, &mesh.positions, &mut field);
        prop_assert!(largest(&field, &truth) < 1e-9);

        let (basis, completion) = shell.basis();
        let (basis, completion) = (reference.basis(&mesh.positions, &basis), reference.completion(&completion));
        let still = vec![0.0; mesh.positions.len() * 3];
        let frame = &basis.deform(&still, std::slice::from_ref(&told), 1.0)[0];
        let combined: Vec<Vector3<f64>> = frame.chunks(3).map(|d| Vector3::new(d[0], d[1], d[2]).cast()).collect();
        prop_assert!(largest(&combined, &truth) < 2e-4, "{}", largest(&combined, &truth));
        // A marker that is missing goes along, but for the thousandth that settles what is undetermined.
        let mut given: Vec<Option<Vector3<f64>>> = told.iter().copied().map(Some).collect();
        given[3] = None;
        let completed = completion.complete(&given, &[None; 16]).unwrap();
        prop_assert!((completed[3] - told[3]).norm() < 0.1);
        // Markers of which only a flat few are seen still go somewhere sensible.
        let few: Vec<Option<Vector3<f64>>> = told.iter().enumerate().map(|(i, &d)| (i < 3).then_some(d)).collect();
        let largest_told = told.iter().map(|d| d.norm()).fold(0.0, f64::max);
        let completed = completion.complete(&few, &[None; 16]).unwrap();
        prop_assert!(completed.iter().all(|d| d.norm() < 10.0 * largest_told + 10.0));
    }
}

/// Displacements that are no affine motion keep their values at the handles, in the basis too.
#[test]
fn the_reference_leaves_the_handles_where_they_are_told() {
    let mesh = face();
    let (shell, handles) = shell(&mesh, &params(600));
    let places: Vec<Point3<f64>> = handles.iter().map(|&handle| mesh.positions[handle as usize]).collect();
    let reference = AffineReference::new(&places);
    let told = told(&mesh, &handles);
    let basis = reference.basis(&mesh.positions, &shell.basis().0);
    let still = vec![0.0; mesh.positions.len() * 3];
    let frame = &basis.deform(&still, std::slice::from_ref(&told), 1.0)[0];
    for (&handle, told) in handles.iter().zip(&told) {
        let at = handle as usize * 3;
        assert!((Vector3::new(frame[at], frame[at + 1], frame[at + 2]).cast::<f64>() - told).norm() < 1e-5);
    }
    // Handles in a plane, and a single one, determine what they can.
    let flat: Vec<Point3<f64>> = places.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
    let (left, _) = AffineReference::new(&flat).split(&vec![Vector3::x(); flat.len()]);
    assert!(left.iter().all(|d| d.norm() < 1e-9));
    let (left, _) = AffineReference::new(&places[..1]).split(&[Vector3::y()]);
    assert!(left[0].norm() < 1e-12);
    assert_eq!(Completion::new(&[]).rows().len(), 0);
}

#[test]
fn a_softening_that_leaves_nothing_is_refused() {
    for softening in [1.0, -0.1, f64::NAN] {
        let wrong = Params { softening, ..Params::default() };
        assert!(wrong.check().unwrap_err().to_string().contains("softening"));
    }
    let wrong = Params { variation_mm4: 0.0, ..Params::default() };
    assert!(wrong.check().unwrap_err().to_string().contains("variation"));
}
