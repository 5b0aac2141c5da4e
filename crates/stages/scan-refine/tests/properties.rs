//! Laws: agreeing inputs change nothing, noise goes, sharp relief comes, bias does not, and nothing depends on the place.
#![allow(clippy::expect_used, reason = "a test may fail")]

use mesh::Mesh;
use nalgebra::{Isometry3, Point3, Rotation3, Vector3};
use scan_refine::{Error, Measured, Params, Refined, crossover_of_lambda, refine};
use testkit::shapes;

/// Noise of standard deviation about 1, the same everywhere.
fn noise(i: usize, salt: u64) -> f64 {
    let mut x = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ salt.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mut sum = 0.0;
    for _ in 0..4 {
        x ^= x >> 31;
        x = x.wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^= x >> 29;
        sum += (x >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
    }
    sum * 3f64.sqrt()
}

/// A hilly surface of 60 cells of 0.5 mm, and its true normals.
fn hills() -> (Mesh, Vec<Vector3<f64>>) {
    let slope = |x: f64, y: f64| (0.5 * (0.25 * x).cos(), -0.3 * (0.2 * y).sin());
    let mesh = shapes::relief(60, 0.5, |x, y| 2.0 * (0.25 * x).sin() + 1.5 * (0.2 * y).cos());
    let normal = |point: &Point3<f64>| {
        let (dx, dy) = slope(point.x, point.y);
        Vector3::new(-dx, -dy, 1.0).normalize()
    };
    let normals = mesh.positions.iter().map(normal).collect();
    (mesh, normals)
}

fn noisy(mesh: &Mesh, normals: &[Vector3<f64>], sigma: f64, salt: u64) -> Mesh {
    let points = mesh.positions.iter().zip(normals).enumerate();
    mesh.with_positions(points.map(|(i, (point, normal))| point + sigma * noise(i, salt) * normal).collect())
}

/// Root mean square distance from a surface along its normals, mm.
fn off(points: &[Point3<f64>], mesh: &Mesh, normals: &[Vector3<f64>]) -> f64 {
    let squares = points.iter().zip(&mesh.positions).zip(normals).map(|((p, q), n)| n.dot(&(p - q)).powi(2));
    (squares.sum::<f64>() / points.len() as f64).sqrt()
}

fn refined(mesh: &Mesh, normals: Vec<Vector3<f64>>, params: &Params) -> Refined {
    let measured = Measured::per_vertex(normals).expect("normals");
    refine(mesh, &measured, params).expect("refined")
}

#[test]
fn inputs_that_agree_change_next_to_nothing() {
    let (mesh, normals) = hills();
    let result = refined(&mesh, normals, &Params::default());
    assert!(result.report.moved_max_mm < 0.01, "{}", result.report.moved_max_mm);
    // On a sphere chords and mean normals agree to rounding.
    let ball = shapes::sphere(40.0, 20);
    let outward = ball.positions.iter().map(|point| point.coords.normalize()).collect();
    let still = refined(&ball, outward, &Params { bias_mm: 0.0, ..Params::default() });
    assert!(still.report.moved_max_mm < 1e-9, "{}", still.report.moved_max_mm);
}

#[test]
fn noise_of_positions_goes() {
    let (mesh, normals) = hills();
    for (salt, sigma) in [(1, 0.05), (2, 0.1), (3, 0.2)] {
        let scan = noisy(&mesh, &normals, sigma, salt);
        let result = refined(&scan, normals.clone(), &Params::default());
        let ratio = off(&result.positions, &mesh, &normals) / off(&scan.positions, &mesh, &normals);
        assert!(ratio < 0.2, "{ratio} of {sigma} mm");
        assert!(result.report.after_degrees < 0.3 * result.report.before_degrees);
    }
}

#[test]
fn relief_that_only_the_normals_saw_comes() {
    // Waves of 3 mm in the normals of a plane.
    let flat = shapes::grid(120, 0.25);
    let height = |p: &Point3<f64>| 0.1 * (2.0 * p.x).sin();
    let normals: Vec<Vector3<f64>> =
        flat.positions.iter().map(|p| Vector3::new(-0.2 * (2.0 * p.x).cos(), 0.0, 1.0).normalize()).collect();
    let result = refined(&flat, normals, &Params::default());
    for (before, after) in
        flat.positions.iter().zip(&result.positions).filter(|(p, _)| (5.0..25.0).contains(&p.x))
    {
        assert!((after.z - height(after)).abs() < 0.02, "{} at {before}", after.z);
    }
}

#[test]
fn bias_at_large_does_not_bend_the_scan() {
    let (mesh, normals) = hills();
    // Normals that lean by up to 6° more and more across the surface, as a near light makes them.
    let lean = |(point, normal): (&Point3<f64>, &Vector3<f64>)| {
        Rotation3::from_axis_angle(&Vector3::y_axis(), 0.1 * (point.x - 15.0) / 15.0) * normal
    };
    let biased: Vec<Vector3<f64>> = mesh.positions.iter().zip(&normals).map(lean).collect();
    let off_with = |bias_mm: f64| {
        let result = refined(&mesh, biased.clone(), &Params { bias_mm, ..Params::default() });
        off(&result.positions, &mesh, &normals)
    };
    let (corrected, believed) = (off_with(40.0), off_with(0.0));
    assert!(corrected < 0.6 * believed, "{corrected} mm, believed {believed} mm");
}

#[test]
fn a_rigid_motion_moves_the_result_alike() {
    let (mesh, normals) = hills();
    let scan = noisy(&mesh, &normals, 0.1, 5);
    let motion = Isometry3::new(Vector3::new(300.0, -900.0, 50.0), Vector3::new(0.5, 0.9, -0.7));
    let moved = scan.with_positions(scan.positions.iter().map(|point| motion * point).collect());
    let here = refined(&scan, normals.clone(), &Params::default());
    let there = refined(&moved, normals.iter().map(|normal| motion * normal).collect(), &Params::default());
    let apart =
        here.positions.iter().zip(&there.positions).map(|(a, b)| (motion * a - b).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-7, "{apart} mm");
}

#[test]
fn untrusted_normals_move_nothing() {
    let (mesh, normals) = hills();
    let scan = noisy(&mesh, &normals, 0.1, 6);
    let mut measured = Measured::per_vertex(normals).expect("normals");
    // Trust only the left half.
    let trust: Vec<f64> = mesh.positions.iter().map(|p| f64::from(u8::from(p.x < 15.0))).collect();
    measured.weigh(&trust).expect("trust");
    let result = refine(&scan, &measured, &Params::default()).expect("refined");
    let moved = |i: usize| (result.positions[i] - scan.positions[i]).norm();
    let right = (0..trust.len()).filter(|&i| mesh.positions[i].x > 15.0).map(moved).fold(0.0, f64::max);
    let left = (0..trust.len()).filter(|&i| mesh.positions[i].x < 14.0).map(moved).fold(0.0, f64::max);
    assert!(right < 1e-12 && left > 0.05, "{right} and {left} mm");
    // A hole in the normals is bridged by the scan.
    let mut holed = measured.clone();
    let all = vec![0.0; trust.len()];
    assert!(matches!(holed.weigh(&all), Err(Error::NothingMeasured { .. })));
}

#[test]
fn lambda_is_the_crossover_in_other_words() {
    let (mesh, normals) = hills();
    let scan = noisy(&mesh, &normals, 0.1, 7);
    // Of a wave of the crossover's length in the positions, half is left: λ E_p + (1 − λ) E_n weighs them alike.
    let length = std::f64::consts::TAU * (0.75f64 / 0.25).sqrt();
    assert!((crossover_of_lambda(0.25) - length).abs() < 1e-12);
    let tight = refined(&scan, normals.clone(), &Params { crossover_mm: 0.01, ..Params::default() });
    assert!(tight.report.moved_max_mm < 1e-3, "positions alone: {}", tight.report.moved_max_mm);
}

#[test]
fn a_second_pass_is_no_worse_and_threads_change_no_bit() {
    let (mesh, normals) = hills();
    let scan = noisy(&mesh, &normals, 0.2, 8);
    let once = refined(&scan, normals.clone(), &Params::default());
    let params = Params { iterations: 3, ..Params::default() };
    let thrice = refined(&scan, normals.clone(), &params);
    let (one, three) = (off(&once.positions, &mesh, &normals), off(&thrice.positions, &mesh, &normals));
    assert!(three < 1.05 * one, "{one} to {three} mm");
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| refined(&scan, normals.clone(), &params).positions)
    };
    assert!(with(1) == with(3));
}

#[test]
fn what_cannot_be_done_says_why() {
    let grid = shapes::grid(4, 1.0);
    let up = |count: usize| Measured::per_vertex(vec![Vector3::z(); count]).expect("normals");
    let params = Params::default();
    let count = Error::Count { what: "normals", count: 24, vertex_count: 25 };
    assert_eq!(refine(&grid, &up(24), &params), Err(count));
    let inside_out = Measured::per_vertex(vec![-Vector3::z(); 25]).expect("normals");
    assert!(
        matches!(refine(&grid, &inside_out, &params), Err(Error::Disagree { degrees }) if degrees > 179.0)
    );
    let book = shapes::open_book();
    assert_eq!(refine(&book, &up(5), &params), Err(Error::NonManifold { count: 1, vertices: [0, 1] }));
    assert_eq!(
        Measured::per_vertex(vec![Vector3::new(0.0, f64::NAN, 1.0)]),
        Err(Error::NotFinite { vertex: 0 })
    );
    assert!(matches!(Measured::per_vertex(vec![Vector3::zeros()]), Err(Error::NothingMeasured { .. })));
    let mut trusted = up(2);
    assert_eq!(trusted.weigh(&[1.0, 1.5]), Err(Error::Confidence { vertex: 1, value: 1.5 }));
    for wrong in [
        Params { crossover_mm: 0.0, ..params.clone() },
        Params { bias_mm: -1.0, ..params.clone() },
        Params { iterations: 0, ..params.clone() },
    ] {
        assert!(matches!(refine(&grid, &up(25), &wrong), Err(Error::Parameter { .. })));
    }
}
