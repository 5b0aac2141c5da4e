//! The face is a sound mesh, and its expressions keep it one.

use mesh::{Connectivity, Mesh, loop_length};
use nalgebra::{Point3, Vector3};
use testkit::face::{Face, Weights};

fn corner_angles(points: &[Point3<f64>], triangle: [u32; 3]) -> [f64; 3] {
    let p = triangle.map(|vertex| points[vertex as usize]);
    std::array::from_fn(|i| (p[(i + 1) % 3] - p[i]).angle(&(p[(i + 2) % 3] - p[i])).to_degrees())
}

fn normal(points: &[Point3<f64>], triangle: [u32; 3]) -> Vector3<f64> {
    let p = triangle.map(|vertex| points[vertex as usize]);
    (p[1] - p[0]).cross(&(p[2] - p[0])).normalize()
}

/// Share of triangles with an angle under 5°.
fn sliver_share(mesh: &Mesh, points: &[Point3<f64>]) -> f64 {
    let triangles = mesh.triangles();
    let slivers = triangles.iter().filter(|&&t| corner_angles(points, t).iter().any(|&angle| angle < 5.0));
    slivers.count() as f64 / triangles.len() as f64
}

#[test]
fn is_one_manifold_piece_with_eyes_and_mouth_cut_out() {
    for (seed, count) in [(0, 500), (1, 3_000), (2, 30_000)] {
        let face = Face::new(seed, count);
        let mesh = face.mesh();
        let around = Connectivity::of(mesh.positions.len(), &mesh.triangles());
        assert!(around.non_manifold_edges().is_empty() && around.bow_ties().is_empty());
        assert!(around.flipped_edges().is_empty() && around.unreferenced().is_empty());
        assert_eq!(around.components().1, 1);
        let loops = around.boundary_loops();
        assert_eq!(loops.len(), 4, "seed {seed}: the rim, two eyes, a mouth");
        let mut lengths: Vec<f64> = loops.iter().map(|ring| loop_length(&mesh.positions, ring)).collect();
        lengths.sort_by(|a, b| b.total_cmp(a));
        assert!(lengths[0] > 400.0 && lengths[1] < 130.0 && lengths[3] > 55.0, "{lengths:?}");
        let off = (mesh.positions.len() as f64 / count as f64 - 1.0).abs();
        assert!(off < 0.1 || count == 500, "{count} wanted, {} made", mesh.positions.len());
    }
}

#[test]
fn looks_along_z_and_has_the_size_of_a_face() {
    let face = Face::new(0, 5_000);
    let (low, high) = mesh::bounding_box(&face.mesh().positions);
    let size = high - low;
    assert!((125.0..150.0).contains(&size.x) && (175.0..205.0).contains(&size.y), "{size}");
    let mean: Vector3<f64> =
        face.mesh().triangles().iter().map(|&t| normal(&face.mesh().positions, t)).sum::<Vector3<f64>>();
    assert!(mean.normalize().z > 0.95);
}

#[test]
fn has_no_slivers() {
    for seed in 0..3 {
        let face = Face::new(seed, 10_000);
        assert_eq!(sliver_share(face.mesh(), &face.mesh().positions), 0.0, "seed {seed}");
    }
}

#[test]
fn is_the_same_every_time_and_another_with_another_seed() {
    assert!(Face::new(5, 2_000).mesh() == Face::new(5, 2_000).mesh());
    assert_ne!(Face::new(5, 2_000).person(), Face::new(6, 2_000).person());
}

fn expressions() -> Vec<(&'static str, Weights)> {
    let none = Weights::default();
    vec![
        ("jaw open", Weights { jaw_open: 1.0, ..none }),
        ("smile", Weights { smile: 1.0, ..none }),
        ("brow raise", Weights { brow_raise: 1.0, ..none }),
        ("blink", Weights { blink: 1.0, ..none }),
        ("pucker", Weights { pucker: 1.0, ..none }),
        ("frown", Weights { frown: 1.0, ..none }),
        ("laugh", Weights { jaw_open: 0.5, smile: 0.5, brow_raise: 0.5, ..none }),
    ]
}

/// The sharpest fold between two neighbouring triangles, as the cosine between their normals.
fn sharpest_fold(mesh: &Mesh, points: &[Point3<f64>]) -> f64 {
    let triangles = mesh.triangles();
    let at = |triangle: u32| normal(points, triangles[triangle as usize]);
    let around = Connectivity::of(points.len(), &triangles);
    let inner = around.edges().filter(|edge| edge.triangles.len() == 2);
    inner.map(|edge| at(edge.triangles[0]).dot(&at(edge.triangles[1]))).fold(1.0, f64::min)
}

#[test]
fn no_expression_turns_a_triangle_over() {
    for (seed, count) in [(0, 3_000), (1, 3_000), (3, 10_000)] {
        let face = Face::new(seed, count);
        let rest = &face.mesh().positions;
        for (name, weights) in expressions() {
            let deformed = face.deform(&weights);
            let fold = sharpest_fold(face.mesh(), &deformed);
            assert!(fold > 0.0, "seed {seed}, {name}: a fold of {}°", fold.acos().to_degrees());
            // The corners of an open mouth stand upright; nothing turns farther than they do.
            let turns =
                face.mesh().triangles().into_iter().map(|t| normal(rest, t).dot(&normal(&deformed, t)));
            let turn = turns.fold(1.0, f64::min);
            assert!(turn > -0.2, "seed {seed}, {name}: a triangle turns by {}°", turn.acos().to_degrees());
            let slivers = sliver_share(face.mesh(), &deformed);
            assert!(slivers < 1e-3, "seed {seed}, {name}: {slivers} slivers");
        }
    }
}

/// The boundary loops of the two eyes and the mouth: the mouth is the lowest.
fn openings(face: &Face) -> Vec<Vec<u32>> {
    let mesh = face.mesh();
    let mut loops = Connectivity::of(mesh.positions.len(), &mesh.triangles()).boundary_loops();
    loops.sort_by(|a, b| loop_length(&mesh.positions, b).total_cmp(&loop_length(&mesh.positions, a)));
    let mut openings = loops.split_off(1);
    let mean_y =
        |ring: &Vec<u32>| ring.iter().map(|&v| mesh.positions[v as usize].y).sum::<f64>() / ring.len() as f64;
    openings.sort_by(|a, b| mean_y(a).total_cmp(&mean_y(b)));
    openings
}

/// How far the two edges of an opening are apart in its middle.
fn gap(points: &[Point3<f64>], rest: &[Point3<f64>], ring: &[u32]) -> f64 {
    let xs = || ring.iter().map(|&v| rest[v as usize].x);
    let middle = 0.5 * (xs().fold(f64::MAX, f64::min) + xs().fold(f64::MIN, f64::max));
    let mut order: Vec<usize> = (0..ring.len()).collect();
    order.sort_by(|&i, &j| {
        let off = |k: usize| (rest[ring[k] as usize].x - middle).abs();
        off(i).total_cmp(&off(j))
    });
    // The first is on one edge; the next one far along the ring is on the other.
    let apart = |i: usize| (i.abs_diff(order[0])).min(ring.len() - i.abs_diff(order[0])) > ring.len() / 4;
    let Some(&other) = order.iter().find(|&&i| apart(i)) else { return f64::NAN };
    (points[ring[order[0]] as usize] - points[ring[other] as usize]).norm()
}

#[test]
fn lips_and_lids_part_and_meet() {
    let face = Face::new(1, 20_000);
    let rest = &face.mesh().positions;
    let openings = openings(&face);
    let slit = gap(rest, rest, &openings[0]);
    assert!((1.0..2.0).contains(&slit), "the lips are {slit} mm apart at rest");
    let open = face.deform(&Weights { jaw_open: 1.0, ..Weights::default() });
    let mouth = gap(&open, rest, &openings[0]);
    assert!((22.0..30.0).contains(&mouth), "the mouth opens by {mouth} mm");
    let closed = face.deform(&Weights { blink: 1.0, ..Weights::default() });
    for eye in &openings[1..] {
        assert!(gap(rest, rest, eye) > 8.0, "eyes are open at rest");
        let slit = gap(&closed, rest, eye);
        assert!(slit < 1.6, "a blink leaves {slit} mm");
    }
}

#[test]
fn a_jaw_moves_no_forehead_and_rest_moves_nothing() {
    let face = Face::new(1, 5_000);
    let rest = &face.mesh().positions;
    assert!(&face.deform(&Weights::default()) == rest);
    let open = face.deform(&Weights { jaw_open: 1.0, ..Weights::default() });
    for (before, after) in rest.iter().zip(&open).filter(|(before, _)| before.y > 60.0) {
        assert!((after - before).norm() < 0.1, "{before} moves to {after}");
    }
}
