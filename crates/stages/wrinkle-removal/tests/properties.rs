//! Laws: what is flat stays, what is outside stays bit for bit, wrinkles go, pores stay, and nothing depends on the place.
#![allow(clippy::expect_used, reason = "a test may fail")]

use mesh::Mesh;
use nalgebra::{Isometry3, Point3, Vector3};
use testkit::shapes;
use wrinkle_removal::{Detection, Error, Mask, Params, detect, draw, listed, painted, remove};

/// Weights 1 within `radius` of a place in the plane, 0 elsewhere.
fn disc(mesh: &Mesh, [x, y]: [f64; 2], radius: f64) -> Vec<f64> {
    let near = |point: &Point3<f64>| (point.x - x).hypot(point.y - y) < radius;
    mesh.positions.iter().map(|point| f64::from(u8::from(near(point)))).collect()
}

/// A plane of 24 × 24 mm in edges of 0.2 mm, with a wrinkle along y that fades at its ends, and waves of 0.9 mm on it, mm.
fn wrinkled(depth: f64, waves: f64) -> Mesh {
    shapes::relief(120, 0.2, |x, y| {
        let p = (x - 12.0).abs() / 1.2;
        let fade = (-((y - 12.0) / 6.0).powi(6)).exp();
        fade * depth * (p - 1.0) * (-p).exp() + pores(waves, x, y)
    })
}

fn pores(height: f64, x: f64, y: f64) -> f64 {
    height * (7.0 * x).sin() * (5.0 * y).sin()
}

fn stripe(mesh: &Mesh) -> Vec<f64> {
    let inside = |point: &Point3<f64>| (point.x - 12.0).abs() < 7.2 && (point.y - 12.0).abs() < 9.0;
    mesh.positions.iter().map(|point| f64::from(u8::from(inside(point)))).collect()
}

fn bits(point: &Point3<f64>) -> [u64; 3] {
    [point.x, point.y, point.z].map(f64::to_bits)
}

/// The height z in the middle of the stripe, minus the waves', root mean square.
fn left_over(points: &[Point3<f64>], waves: f64) -> f64 {
    let middle = points.iter().filter(|p| (p.x - 12.0).abs() < 6.0 && (p.y - 12.0).abs() < 5.0);
    let squares: Vec<f64> = middle.map(|p| (p.z - pores(waves, p.x, p.y)).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn a_flat_patch_stays_flat_and_still_also_at_the_boundary() {
    let mut flat = shapes::grid(30, 0.5);
    // Irregular inside its plane, and turned.
    for (i, point) in flat.positions.iter_mut().enumerate() {
        let inner = (0.1..14.9).contains(&point.x) && (0.1..14.9).contains(&point.y);
        let nudge = if inner { 0.15 * ((i * i % 17) as f64 / 17.0 - 0.5) } else { 0.0 };
        *point = Isometry3::rotation(Vector3::new(0.3, 0.7, -0.2))
            * Point3::new(point.x + nudge, point.y - nudge, 0.0);
    }
    for place in [[7.5, 7.5], [0.0, 7.5]] {
        let weights = disc(&shapes::grid(30, 0.5), place, 4.0);
        for params in [Params::default(), Params::paper()] {
            let smoothed = remove(&flat, &weights, &params).expect("a flat patch");
            let apart = flat.positions.iter().zip(&smoothed.positions).map(|(a, b)| (a - b).norm());
            let apart = apart.fold(0.0, f64::max);
            assert!(apart < 1e-9, "{apart} mm at {place:?} with {params:?}");
        }
    }
}

#[test]
fn nothing_outside_moves_by_a_bit_and_all_else_of_the_mesh_is_kept_by_its_caller() {
    let mesh = wrinkled(0.5, 0.02);
    let weights = stripe(&mesh);
    let smoothed = remove(&mesh, &weights, &Params::default()).expect("smooth");
    let mut moved = 0;
    for ((before, after), weight) in mesh.positions.iter().zip(&smoothed.positions).zip(&weights) {
        match *weight == 0.0 {
            true => assert_eq!(bits(before), bits(after)),
            false => moved += usize::from(bits(before) != bits(after)),
        }
    }
    assert!(moved > smoothed.report.region_vertices * 9 / 10);
}

#[test]
fn wrinkles_go_and_pores_stay() {
    let mesh = wrinkled(0.5, 0.02);
    let weights = stripe(&mesh);
    let before = left_over(&mesh.positions, 0.02);
    let smoothed = remove(&mesh, &weights, &Params::default()).expect("smooth");
    let after = left_over(&smoothed.positions, 0.02);
    assert!(before > 0.05 && after < 0.15 * before, "{before} to {after} mm");
    // The paper's split is softer: it works, and worse.
    let paper = remove(&mesh, &weights, &Params::paper()).expect("smooth");
    let paper = left_over(&paper.positions, 0.02);
    assert!(paper < 0.3 * before && paper > after, "{before} to {paper} mm");
}

#[test]
fn without_a_wrinkle_pores_are_all_there() {
    let mesh = wrinkled(0.0, 0.02);
    let smoothed = remove(&mesh, &stripe(&mesh), &Params::default()).expect("smooth");
    let lost = left_over(&smoothed.positions, 0.02) / (0.02 * 0.5);
    assert!(lost < 0.1, "{lost} of the pores");
}

#[test]
fn a_curved_surface_keeps_its_curvature() {
    let ball = shapes::sphere(60.0, 160);
    let cap: Vec<f64> = ball
        .positions
        .iter()
        .map(|p| f64::from(u8::from((p - Point3::new(0.0, 0.0, 60.0)).norm() < 12.0)))
        .collect();
    let smoothed = remove(&ball, &cap, &Params { detail_mm: 3.0, ..Params::default() }).expect("a cap");
    let off = smoothed.positions.iter().map(|point| (point.coords.norm() - 60.0).abs()).fold(0.0, f64::max);
    // A flat disc in its place would be 1.2 mm off.
    assert!(off < 0.02, "{off} mm");
}

#[test]
fn strength_is_a_share_of_the_way_and_so_are_grey_weights() {
    let mesh = wrinkled(0.4, 0.01);
    let weights = stripe(&mesh);
    let whole = remove(&mesh, &weights, &Params::default()).expect("all of it").positions;
    let half =
        remove(&mesh, &weights, &Params { strength: 0.5, ..Params::default() }).expect("half").positions;
    let grey: Vec<f64> = weights.iter().map(|weight| 0.5 * weight).collect();
    let grey = remove(&mesh, &grey, &Params::default()).expect("grey").positions;
    let none =
        remove(&mesh, &weights, &Params { strength: 0.0, ..Params::default() }).expect("none").positions;
    assert!(none == mesh.positions);
    for (i, start) in mesh.positions.iter().enumerate() {
        let expected = start + 0.5 * (whole[i] - start);
        assert!((half[i] - expected).norm() < 1e-12 && (grey[i] - expected).norm() < 1e-12);
    }
}

#[test]
fn a_feather_sets_in_at_the_rim() {
    let mesh = wrinkled(0.4, 0.0);
    let weights = stripe(&mesh);
    let hard = remove(&mesh, &weights, &Params::default()).expect("hard").positions;
    let soft =
        remove(&mesh, &weights, &Params { feather_mm: 3.0, ..Params::default() }).expect("soft").positions;
    let way = |points: &[Point3<f64>], i: usize| (points[i] - mesh.positions[i]).norm();
    let at = |x: f64, y: f64| (y / 0.2).round() as usize * 121 + (x / 0.2).round() as usize;
    let (rim, middle) = (at(12.0, 20.6), at(12.0, 12.0));
    assert!(way(&soft, rim) < 0.1 * way(&hard, rim) && way(&soft, middle) == way(&hard, middle));
}

#[test]
fn a_rigid_motion_moves_the_result_alike() {
    let mesh = wrinkled(0.5, 0.02);
    let weights = stripe(&mesh);
    let motion = Isometry3::new(Vector3::new(900.0, -40.0, 1500.0), Vector3::new(0.4, -1.1, 0.3));
    let moved = mesh.with_positions(mesh.positions.iter().map(|point| motion * point).collect());
    let here = remove(&mesh, &weights, &Params::default()).expect("here").positions;
    let there = remove(&moved, &weights, &Params::default()).expect("there").positions;
    let apart = here.iter().zip(&there).map(|(a, b)| (motion * a - b).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-6, "{apart} mm");
}

#[test]
fn what_is_wide_keeps_its_shape_where_that_is_wanted() {
    // A hill of 12 mm: shape, if waves above 40 mm are.
    let hill = shapes::bump_plane(100, 0.8, 3.0, 12.0);
    let weights = disc(&hill, [40.0, 40.0], 30.0);
    let top = |shape_mm: f64| {
        let params = Params { shape_mm, detail_mm: 3.0, ..Params::default() };
        let smoothed = remove(&hill, &weights, &params).expect("smooth");
        smoothed.positions.iter().map(|point| point.z).fold(0.0, f64::max)
    };
    assert!(top(0.0) < 1.5 && top(40.0) > 2.2, "{} and {}", top(0.0), top(40.0));
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let mesh = wrinkled(0.5, 0.02);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| remove(&mesh, &stripe(&mesh), &Params::default()).expect("smooth").positions)
    };
    assert!(with(1).iter().map(bits).eq(with(3).iter().map(bits)));
}

#[test]
fn masks_are_read_between_texels_and_across_seams() {
    let grid = shapes::grid(4, 1.0);
    // Bright in the upper right texel of 2 × 2.
    let mask = Mask { width: 2, height: 2, texels: vec![0.0, 1.0, 0.0, 0.0] };
    let weights = painted(&grid, &mask).expect("some");
    assert!((weights[3 * 5 + 3] - 1.0).abs() < 1e-12, "at its centre");
    assert!((weights[2 * 5 + 2] - 0.25).abs() < 1e-12, "in the middle of four");
    assert_eq!(weights[5 + 1], 0.0);
    let black = Mask { texels: vec![0.0; 4], ..mask.clone() };
    assert!(matches!(painted(&grid, &black), Err(Error::EmptyRegion { .. })));
    let torn = Mask { width: 3, ..mask.clone() };
    assert_eq!(painted(&grid, &torn), Err(Error::MaskSize { width: 3, height: 2, texels: 4 }));
    assert_eq!(painted(&shapes::sphere(1.0, 4), &mask), Err(Error::NoTextureCoordinates));
}

#[test]
fn detection_finds_the_groove_and_not_the_hill() {
    // A groove along y that ends inside, and a hill beside it.
    let mesh = shapes::relief(120, 0.5, |x, y| {
        let p = (x - 20.0) / 1.5;
        let ends = 1.0 / (1.0 + (-(y - 15.0)).exp()) / (1.0 + (y - 45.0).exp());
        -0.6 * ends * (-0.5 * p * p).exp() + 4.0 * (-((x - 45.0).powi(2) + (y - 30.0).powi(2)) / 60.0).exp()
    });
    let found = detect(&mesh, None, &Detection::default()).expect("a groove");
    let at = |x: f64, y: f64| found[(y / 0.5).round() as usize * 121 + (x / 0.5).round() as usize];
    assert!(at(20.0, 30.0) == 1.0 && at(14.0, 30.0) == 1.0, "the groove and its sides");
    assert!(at(45.0, 30.0) == 0.0 && at(20.0, 58.0) == 0.0, "not the hill, not beyond its end");
    // Elsewhere there is none.
    let elsewhere = disc(&mesh, [45.0, 30.0], 5.0);
    assert!(matches!(detect(&mesh, Some(&elsewhere), &Detection::default()), Err(Error::EmptyRegion { .. })));
    let ridge = mesh.with_positions(mesh.positions.iter().map(|p| Point3::new(p.x, p.y, -p.z)).collect());
    let ridge = detect(&ridge, None, &Detection::default());
    assert!(
        ridge.is_err() || ridge.is_ok_and(|weights| weights[60 * 121 + 40] == 0.0),
        "a ridge is no valley"
    );
}

#[test]
fn what_cannot_be_done_says_why() {
    let grid = shapes::grid(12, 0.5);
    let params = Params::default();
    assert!(matches!(remove(&grid, &[0.0; 169], &params), Err(Error::EmptyRegion { .. })));
    assert_eq!(remove(&grid, &[1.0; 169], &params), Err(Error::NothingHeld { vertex: 0, vertex_count: 169 }));
    let both = shapes::two_components(6, 0.5);
    let second: Vec<f64> =
        (0..both.positions.len()).map(|vertex| f64::from(u8::from(vertex >= 49))).collect();
    assert_eq!(remove(&both, &second, &params), Err(Error::NothingHeld { vertex: 49, vertex_count: 36 }));
    let book = shapes::open_book();
    let torn = Error::NonManifold { count: 1, vertices: [0, 1] };
    assert_eq!(remove(&book, &[1.0, 0.0, 0.0, 0.0, 0.0], &params), Err(torn));
    assert_eq!(listed(&grid, &[3, 169]), Err(Error::UnknownVertex { vertex: 169, vertex_count: 169 }));
    assert!(matches!(listed(&grid, &[]), Err(Error::EmptyRegion { .. })));
    for wrong in [
        Params { strength: 1.5, ..Params::default() },
        Params { detail_mm: 0.0, ..Params::default() },
        Params { shape_mm: f64::NAN, ..Params::default() },
    ] {
        assert!(matches!(remove(&grid, &[1.0; 169], &wrong), Err(Error::Parameter { .. })));
    }
    let mut loose = grid.clone();
    loose.positions.push(Point3::new(1.0, 1.0, 9.0));
    let mut weights = vec![0.0; 170];
    weights[169] = 1.0;
    assert!(matches!(
        remove(&loose, &weights, &params),
        Err(Error::NothingHeld { vertex: 169, vertex_count: 1 })
    ));
}

#[test]
fn a_wild_triangulation_is_borne() {
    let mut mesh = wrinkled(0.5, 0.0);
    // Two vertices nearly in one place: needles around them.
    let at = 60 * 121 + 60;
    mesh.positions[at] = mesh.positions[at + 1] + Vector3::new(-1e-6, 0.0, 0.0);
    let smoothed = remove(&mesh, &stripe(&mesh), &Params::default()).expect("smooth");
    let farthest =
        mesh.positions.iter().zip(&smoothed.positions).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(farthest < 1.0, "{farthest} mm");
}

#[test]
fn pictures_show_three_views() {
    let mesh = wrinkled(0.5, 0.0);
    let picture = draw(&mesh, &mesh.positions, &stripe(&mesh));
    assert_eq!(picture.rgb.len(), 3 * picture.width * picture.height);
    let view = picture.width / 3;
    let at = |column: usize| &picture.rgb[3 * (360 * picture.width + column)..][..3];
    assert_eq!(at(view / 2), at(view / 2 + 2 * view), "nothing moved");
    assert!(at(view / 2 + view)[2] > at(view / 2 + view)[0], "the region is blue");
}
