//! Wrinkles on surfaces that can be reckoned by hand.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use nalgebra::{Point2, Point3, Vector3};
use virtual_rig::Error;
use virtual_rig::wrinkle::{Family, Fixed, Folded, Params, Shape, Style, WrinkleLine, Wrinkles, lines};

/// A rectangle of skin, its domain rolled onto a surface.
struct Patch {
    domain: Vec<Point2<f64>>,
    triangles: Vec<[u32; 3]>,
}

impl Patch {
    /// Half sizes and steps, mm; every second row is shifted, so that nothing lines up with the wrinkles.
    fn new(half: [f64; 2], step: [f64; 2]) -> Self {
        let [columns, rows] = [0, 1].map(|i| (2.0 * half[i] / step[i]).round() as u32);
        let at = |i: u32, j: u32| {
            let shift = if j % 2 == 1 && i > 0 && i < columns { 0.37 } else { 0.0 };
            Point2::new((f64::from(i) + shift) * step[0] - half[0], f64::from(j) * step[1] - half[1] + 0.013)
        };
        let domain = (0..=rows).flat_map(|j| (0..=columns).map(move |i| at(i, j))).collect();
        let row = columns + 1;
        let quad = |i: u32, j: u32| {
            let a = j * row + i;
            [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]
        };
        let triangles = (0..rows).flat_map(|j| (0..columns).flat_map(move |i| quad(i, j))).collect();
        Self { domain, triangles }
    }

    fn on(&self, surface: impl Fn(f64, f64) -> [f64; 3]) -> Vec<Point3<f64>> {
        self.domain.iter().map(|at| Point3::from(surface(at.x, at.y))).collect()
    }

    fn place(&self, rest: &[Point3<f64>], lines: &[WrinkleLine], params: &Params) -> Wrinkles {
        Wrinkles::place(rest, &self.triangles, &self.domain, lines, params).unwrap()
    }

    /// The length of the cut of a surface with the plane of points at `station` along `normal`.
    fn cut_length(&self, points: &[Point3<f64>], normal: Vector3<f64>, station: f64) -> f64 {
        let ahead = |vertex: u32| points[vertex as usize].coords.dot(&normal) - station;
        let crossing = |a: u32, b: u32| {
            let share = ahead(a) / (ahead(a) - ahead(b));
            points[a as usize] + (points[b as usize] - points[a as usize]) * share
        };
        let length = |triangle: &[u32; 3]| {
            let sides = [[0, 1], [1, 2], [2, 0]].map(|side| side.map(|i| triangle[i]));
            let ends: Vec<Point3<f64>> = sides
                .iter()
                .filter(|[a, b]| (ahead(*a) > 0.0) != (ahead(*b) > 0.0))
                .map(|[a, b]| crossing(*a, *b))
                .collect();
            if let [one, other] = ends[..] { (one - other).norm() } else { 0.0 }
        };
        self.triangles.iter().map(length).sum()
    }

    /// Triangles that look the other way than without wrinkles.
    fn turned_over(&self, large_scale: &[Point3<f64>], folded: &[Point3<f64>]) -> usize {
        let normal = |points: &[Point3<f64>], triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|vertex| points[vertex as usize]);
            (b - a).cross(&(c - a))
        };
        let turned =
            |triangle: &&[u32; 3]| normal(large_scale, triangle).dot(&normal(folded, triangle)) <= 0.0;
        self.triangles.iter().filter(turned).count()
    }
}

fn flat(s: f64, t: f64) -> [f64; 3] {
    [s, t, 0.0]
}

const RADIUS: f64 = 60.0;

/// The lines of the tests run along the axis: sections are arcs.
fn barrel(s: f64, t: f64) -> [f64; 3] {
    [s, RADIUS * (t / RADIUS).sin(), RADIUS * (t / RADIUS).cos()]
}

fn straight(id: &str, t: f64, width: f64) -> WrinkleLine {
    WrinkleLine::new(id, vec![Point2::new(-18.0, t), Point2::new(18.0, t)], width)
}

fn fine() -> Patch {
    Patch::new([20.0, 24.0], [1.0, 0.2])
}

fn depth(folded: &Folded, line: usize) -> f64 {
    let points = &folded.valleys[line].points;
    points[points.len() / 2].d_mm
}

const FAMILIES: [Family; 3] = [Family::S, Family::Rounded, Family::Foreign];

/// The largest relative difference in length, wrinkled against rest less what is reported as not taken up, over sections
/// of the core; and the least uptake reported.
fn length_error(patch: &Patch, surface: fn(f64, f64) -> [f64; 3], family: Family, keep: f64) -> (f64, f64) {
    let rest = patch.on(surface);
    let params = Params { family, ..Params::default() };
    // On a row of vertices, so that the mesh does not cut off the sharp crease of S.
    let line = straight("fold", 0.013, 2.0);
    let wrinkles = patch.place(&rest, &[line], &params);
    let folded = wrinkles.fold(&patch.on(|s, t| surface(s, keep * t)));
    let band = 2.0 * params.reach * 2.0;
    let core = folded.valleys[0].points.iter().filter(|point| (point.x_mm - 18.0).abs() < 7.1);
    let uptake = core.map(|point| point.uptake).fold(1.0, f64::min);
    let error = |x: f64| {
        // Beyond the band the skin stays as short as the pose made it.
        let outside = keep * (patch.cut_length(&rest, Vector3::x(), x) - band);
        let inside = patch.cut_length(&folded.positions, Vector3::x(), x) - outside;
        inside / band - 1.0 + (1.0 - uptake) * (1.0 - keep)
    };
    ([-6.03, -3.1, 0.21, 2.8, 7.05].into_iter().map(|x| error(x).abs()).fold(0.0, f64::max), uptake)
}

#[test]
fn sections_keep_their_length() {
    let patch = fine();
    let mut worst = 0.0f64;
    for surface in [flat, barrel] {
        for family in FAMILIES {
            for keep in [0.99, 0.97, 0.95, 0.94, 0.9] {
                let (error, uptake) = length_error(&patch, surface, family, keep);
                assert!(error < 0.003, "{family:?} at {keep}: {error}");
                // From 5 % on the fold may be as deep as it gets.
                assert!((uptake - 1.0).abs() < 1e-3 || keep < 0.95, "{family:?} at {keep}: {uptake}");
                worst = worst.max(error);
            }
        }
    }
    println!("arc length, worst relative error in the core: {worst:.5}");
}

#[test]
fn neighbors_share_the_length() {
    let patch = fine();
    for surface in [flat, barrel] {
        let rest = patch.on(surface);
        let rows = [straight("a", -9.0, 1.5), straight("b", 0.0, 2.0), straight("c", 9.0, 1.8)];
        let params = Params::default();
        let wrinkles = patch.place(&rest, &rows, &params);
        let keep = 0.92;
        let folded = wrinkles.fold(&patch.on(|s, t| surface(s, keep * t)));
        // From 7 widths below the lowest to 7 above the highest.
        let band = 18.0 + 7.0 * (1.5 + 1.8);
        for x in [-5.1, 0.3, 4.9] {
            let outside = keep * (patch.cut_length(&rest, Vector3::x(), x) - band);
            let error = (patch.cut_length(&folded.positions, Vector3::x(), x) - outside) / band - 1.0;
            assert!(error.abs() < 0.006, "{error}");
        }
        let middle = &folded.valleys[1].points[folded.valleys[1].points.len() / 2];
        assert!((middle.uptake - 1.0).abs() < 1e-3, "{}", middle.uptake);
    }
}

#[test]
fn the_skin_slides_with_its_arc_length() {
    let patch = Patch::new([20.0, 24.0], [2.0, 0.1]);
    let rest = patch.on(flat);
    let wrinkles = patch.place(&rest, &[straight("fold", 0.05, 2.0)], &Params::default());
    let folded = wrinkles.fold(&patch.on(|s, t| [s, 0.95 * t, 0.0]));
    // One column of vertices: the way along the skin between two of them is that at rest.
    let column: Vec<usize> =
        (0..rest.len()).filter(|&i| rest[i].x == 0.0 && rest[i].y.abs() < 13.0).collect();
    assert!(column.len() > 50);
    for pair in column.windows(2) {
        let now = (folded.positions[pair[1]] - folded.positions[pair[0]]).norm();
        let then = (rest[pair[1]] - rest[pair[0]]).norm();
        // A chord across the bend of the bottom is a little short.
        assert!((now / then - 1.0).abs() < 0.015, "at {}: {now} {then}", rest[pair[0]].y);
    }
    let whole = |points: &[Point3<f64>]| -> f64 {
        column.windows(2).map(|pair| (points[pair[1]] - points[pair[0]]).norm()).sum()
    };
    assert!((whole(&folded.positions) / whole(&rest) - 1.0).abs() < 0.003);
}

/// Height over the plane of the folded skin at a place, by looking for the triangle there.
fn height(patch: &Patch, points: &[Point3<f64>], x: f64, y: f64) -> f64 {
    let over = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| points[vertex as usize]);
        let area = (b - a).xy().perp(&(c - a).xy());
        let at = Point2::new(x, y) - a.xy();
        let (v, w) = (at.perp(&(c - a).xy()) / area, (b - a).xy().perp(&at) / area);
        (v >= -1e-9 && w >= -1e-9 && v + w <= 1.0 + 1e-9).then(|| a.z + v * (b.z - a.z) + w * (c.z - a.z))
    };
    patch.triangles.iter().find_map(over).unwrap()
}

#[test]
fn the_bottom_lies_as_deep_as_reported() {
    let patch = fine();
    let rest = patch.on(flat);
    for family in FAMILIES {
        let params = Params { family, ..Params::default() };
        let wrinkles = patch.place(&rest, &[straight("fold", 0.05, 2.0)], &params);
        let folded = wrinkles.fold(&patch.on(|s, t| [s, 0.96 * t, 0.0]));
        let points = &folded.valleys[0].points;
        for point in points.iter().skip(30).step_by(5).take(4) {
            assert!((point.at + point.normal * point.d_mm - point.surface_point).norm() < 1e-9);
            assert!((point.surface_point.z).abs() < 1e-9 && (point.at.z + point.d_mm).abs() < 1e-9);
            let found = height(&patch, &folded.positions, point.at.x, point.at.y);
            // The sharp crease falls between two rows of vertices.
            let slack = if family == Family::S { 0.2 } else { 0.02 };
            assert!((found + point.d_mm).abs() < slack * point.d_mm, "{family:?}: {found} {}", point.d_mm);
            for (side, sign) in [(0, -1.0), (1, 1.0)] {
                let wide = match point.profile.shape {
                    Shape::Rounded { kappa, .. } => 1.0 + sign * kappa,
                    _ => 1.0,
                };
                let rim = point.at + point.across * (sign * wide * point.w_mm);
                let at_rim = height(&patch, &folded.positions, rim.x, rim.y);
                assert!(at_rim.abs() < 0.02 * point.d_mm, "{family:?} side {side}: {at_rim}");
            }
        }
    }
}

#[test]
fn the_papers_section_is_exact() {
    let patch = fine();
    let rest = patch.on(flat);
    let (w_mm, d_over_w) = (2.0, 0.4);
    let params = Params { family: Family::S, fixed: Some(Fixed { w_mm, d_over_w }), ..Params::default() };
    let wrinkles = patch.place(&rest, &[straight("fold", 0.05, 1.0)], &params);
    let folded = wrinkles.fold(&rest);
    let mut checked = 0;
    for (before, after) in rest.iter().zip(&folded.positions) {
        let p = before.y - 0.05;
        if before.x.abs() < 7.0 && p.abs() < 5.0 * w_mm {
            let u = p.abs() / w_mm;
            let z = w_mm * d_over_w * (u - 1.0) * (-u).exp();
            assert!((after - (before + Vector3::z() * z)).norm() < 1e-9);
            checked += 1;
        }
    }
    assert!(checked > 1000);
    assert!((depth(&folded, 0) - 0.8).abs() < 1e-12);
}

#[test]
fn nothing_folds_without_compression_and_nothing_moves_beyond_the_band() {
    let patch = fine();
    let rest = patch.on(barrel);
    let wrinkles = patch.place(&rest, &[straight("fold", 0.05, 1.5)], &Params::default());
    for keep in [1.0, 1.02, 1.2] {
        let pose = patch.on(|s, t| barrel(s, keep * t));
        let folded = wrinkles.fold(&pose);
        assert!(folded.positions.iter().zip(&pose).all(|(a, b)| a == b), "moved at {keep}");
        assert!(folded.valleys[0].points.iter().all(|point| point.d_mm == 0.0));
    }
    let pose = patch.on(|s, t| barrel(s, 0.9 * t));
    let folded = wrinkles.fold(&pose);
    let moved = |i: &usize| folded.positions[*i] != pose[*i];
    let reach = |i: usize| (patch.domain[i].y - 0.05).abs();
    assert!((0..rest.len()).filter(moved).all(|i| reach(i) <= 7.0 * 1.5 + 1e-3));
    assert!((0..rest.len()).filter(moved).any(|i| reach(i) > 6.0 * 1.5));
    let bits = |point: &Point3<f64>| [point.x.to_bits(), point.y.to_bits(), point.z.to_bits()];
    let outside = (0..rest.len()).filter(|&i| reach(i) > 7.0 * 1.5 + 1e-3);
    outside.for_each(|i| assert_eq!(bits(&folded.positions[i]), bits(&pose[i])));
}

#[test]
fn folds_deepen_with_compression() {
    let patch = Patch::new([20.0, 24.0], [1.0, 0.5]);
    let rest = patch.on(barrel);
    for family in FAMILIES {
        let params = Params { family, ..Params::default() };
        let wrinkles = patch.place(&rest, &[straight("fold", 0.05, 1.5)], &params);
        let depth_at = |press: f64| depth(&wrinkles.fold(&patch.on(|s, t| barrel(s, (1.0 - press) * t))), 0);
        let depths: Vec<f64> = (0..40).map(|i| depth_at(0.004 * f64::from(i))).collect();
        assert!(depths.windows(2).all(|pair| pair[1] >= pair[0] - 1e-12), "{family:?}: {depths:?}");
        // Small steps of the pose are small steps of the fold.
        assert!(depths.windows(2).all(|pair| pair[1] - pair[0] < 0.35), "{family:?}: {depths:?}");
        assert!(depths[39] <= params.d_over_w_max * params.growth_max * 1.5 + 1e-9 && depths[39] > 1.2);
    }
}

#[test]
fn skin_stays_in_one_piece() {
    let patch = Patch::new([20.0, 24.0], [0.5, 0.25]);
    let rest = patch.on(barrel);
    let rows = [straight("a", -7.0, 2.0), straight("b", 0.0, 2.5), straight("c", 5.0, 1.2)];
    for family in FAMILIES {
        let params = Params { family, d_over_w_max: 1.0, growth_max: 1.0, ..Params::default() };
        let wrinkles = patch.place(&rest, &rows, &params);
        // Pressed by as much as there is, unevenly.
        let pose = patch.on(|s, t| barrel(s + 0.1 * t, 0.55 * t + 0.02 * s * (t / 9.0).sin()));
        let folded = wrinkles.fold(&pose);
        let deepest =
            folded.valleys.iter().flat_map(|valley| &valley.points).map(|point| point.d_mm / point.w_mm);
        assert!(deepest.fold(0.0, f64::max) > 0.99, "{family:?}");
        assert_eq!(patch.turned_over(&pose, &folded.positions), 0, "{family:?}");
        // As deep without any room made for it.
        let fixed = Some(Fixed { w_mm: 2.0, d_over_w: 1.0 });
        let wrinkles = patch.place(&rest, &rows, &Params { fixed, ..params });
        assert_eq!(patch.turned_over(&pose, &wrinkles.fold(&pose).positions), 0, "{family:?}");
        assert_eq!(patch.turned_over(&rest, &wrinkles.fold(&rest).positions), 0, "{family:?}");
    }
}

#[test]
fn displacements_are_continuous() {
    let patch = Patch::new([20.0, 24.0], [0.25, 0.25]);
    let rest = patch.on(barrel);
    let bent = (0..=60).map(|i| Point2::new(0.5 * f64::from(i) - 15.0, 2.0 * (0.1 * f64::from(i)).sin()));
    let mut curved = WrinkleLine::new("curved", bent.collect(), 1.6);
    (curved.variation, curved.seed) = (1.0, 5);
    let rows = [curved, straight("straight", 8.5, 1.4)];
    let wrinkles = patch.place(&rest, &rows, &Params::default());
    let pose = patch.on(|s, t| barrel(s, t * (0.9 + 0.05 * (s / 12.0).sin())));
    let folded = wrinkles.fold(&pose);
    let step = |i: usize| folded.positions[i] - pose[i];
    for triangle in &patch.triangles {
        let [a, b, c] = triangle.map(|vertex| vertex as usize);
        for (one, other) in [(a, b), (b, c), (c, a)] {
            let edge = (rest[one] - rest[other]).norm();
            // The walls of a valley are the steepest place.
            assert!((step(one) - step(other)).norm() < 1.3 * edge, "near {}", rest[one]);
        }
    }
    // A pose a little further on is folded a little further.
    let next = patch.on(|s, t| barrel(s, t * (0.8999 + 0.05 * (s / 12.0).sin())));
    let further = wrinkles.fold(&next);
    let moved = (0..rest.len()).map(|i| (further.positions[i] - folded.positions[i]).norm());
    assert!(moved.fold(0.0, f64::max) < 0.02);
}

#[test]
fn the_result_does_not_depend_on_threads() {
    let patch = Patch::new([20.0, 24.0], [1.0, 0.5]);
    let rest = patch.on(barrel);
    let rows = [straight("a", -6.0, 2.0), straight("b", 3.0, 2.5)];
    let pose = patch.on(|s, t| barrel(s, 0.93 * t));
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| patch.place(&rest, &rows, &Params::default()).fold(&pose))
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn coordinates_are_distances_on_the_skin() {
    let patch = fine();
    let rest = patch.on(barrel);
    let wrinkles = patch.place(&rest, &[straight("fold", 0.05, 1.5)], &Params::default());
    let beside = wrinkles.coordinates(0);
    assert!(beside.vertices.windows(2).all(|pair| pair[0] < pair[1]));
    for (i, &vertex) in beside.vertices.iter().enumerate() {
        let at = patch.domain[vertex as usize];
        assert!((beside.x_mm[i] - (at.x + 18.0)).abs() < 1e-6);
        assert!((beside.p_mm[i] - (at.y - 0.05)).abs() < 2e-3, "{} {}", beside.p_mm[i], at.y);
    }
    let is_middle = |at: &&Point2<f64>| at.x.abs() < 5.0 && (at.y - 0.05).abs() < 8.0 - 1e-3;
    let wanted = patch.domain.iter().filter(is_middle).count();
    let found = beside.vertices.iter().filter(|&&vertex| is_middle(&&patch.domain[vertex as usize])).count();
    assert_eq!(found, wanted);
}

#[test]
fn lines_are_cut_at_the_edge_of_the_skin_or_refused() {
    let patch = Patch::new([20.0, 12.0], [1.0, 0.5]);
    let rest = patch.on(flat);
    let long = WrinkleLine::new("long", vec![Point2::new(-60.0, 0.0), Point2::new(60.0, 0.0)], 1.5);
    let wrinkles = patch.place(&rest, &[long], &Params::default());
    let folded = wrinkles.fold(&patch.on(|s, t| [s, 0.95 * t, 0.0]));
    let points = &folded.valleys[0].points;
    assert!((points[points.len() - 1].x_mm - 40.0).abs() < 0.5 && depth(&folded, 0) > 0.5);
    // Near the edge a fold has half the room.
    let edge = patch.place(&rest, &[straight("edge", 8.0, 2.0)], &Params::default());
    let pose = patch.on(|s, t| [s, 0.95 * t, 0.0]);
    let folded = edge.fold(&pose);
    assert!(depth(&folded, 0) > 0.3);
    assert_eq!(patch.turned_over(&pose, &folded.positions), 0);

    let off = WrinkleLine::new("off", vec![Point2::new(30.0, 0.0), Point2::new(60.0, 0.0)], 1.5);
    let Err(Error::Parameter { place, what }) =
        Wrinkles::place(&rest, &patch.triangles, &patch.domain, &[off], &Params::default())
    else {
        panic!("a line off the mesh was laid onto it");
    };
    assert_eq!(place, "lines: off");
    assert!(what.contains("beyond the mesh"), "{what}");
}

#[test]
fn parameters_are_checked() {
    assert!(Params::default().check().is_ok() && Style::default().check().is_ok());
    let bad = [
        Params { reach: f64::NAN, ..Params::default() },
        Params { fade_from: 9.0, ..Params::default() },
        Params { d_over_w_max: 1.5, ..Params::default() },
        Params { station_mm: 0.0, ..Params::default() },
        Params { fixed: Some(Fixed { w_mm: -1.0, d_over_w: 0.5 }), ..Params::default() },
    ];
    bad.iter().for_each(|params| assert!(params.check().is_err(), "{params:?}"));
    assert!(Style { paints: Vec::new(), ..Style::default() }.check().is_err());
}

#[test]
fn people_fold_differently() {
    let patch = Patch::new([50.0, 20.0], [1.0, 0.5]);
    let rest = patch.on(flat);
    let deepest = |seed: u64| {
        let mut forehead = lines(seed, &Style::default());
        forehead.retain(|line| line.id == "forehead_2");
        let height = forehead[0].path.iter().map(|at| at.y).sum::<f64>() / forehead[0].path.len() as f64;
        forehead[0].path.iter_mut().for_each(|at| at.y -= height);
        let wrinkles = patch.place(&rest, &forehead, &Params::default());
        depth(&wrinkles.fold(&patch.on(|s, t| [s, 0.96 * t, 0.0])), 0)
    };
    assert!((deepest(1) - deepest(2)).abs() > 0.01);
    assert_eq!(deepest(3), deepest(3));
}

/// Skin with a second sheet 30 mm behind it, as the wall of a mouth is behind the lips, and a third that faces it, first
/// in the list of triangles; the two hind ones lie behind half of the skin only.
#[test]
fn lines_lie_on_the_outermost_sheet() {
    let patch = Patch::new([30.0, 20.0], [0.8, 0.8]);
    let sheet = |z: f64| patch.on(move |s, t| [s, t, z]);
    let rest: Vec<Point3<f64>> = [sheet(0.0), sheet(-30.0), sheet(-15.0)].concat();
    let domain = [&patch.domain[..]; 3].concat();
    let count = patch.domain.len() as u32;
    let half = |first: u32, turned: bool| {
        let behind = patch.triangles.iter().filter(|corners| patch.domain[corners[0] as usize].x > 0.0);
        let turn = move |[a, b, c]: [u32; 3]| if turned { [a, c, b] } else { [a, b, c] };
        behind.map(move |corners| turn(corners.map(|corner| first + corner)))
    };
    let triangles: Vec<[u32; 3]> =
        half(count, false).chain(half(2 * count, true)).chain(patch.triangles.iter().copied()).collect();
    let path = vec![Point2::new(-20.0, 0.0), Point2::new(20.0, 0.0)];
    let line = WrinkleLine::new("line", path, 1.5);
    let wrinkles = Wrinkles::place(&rest, &triangles, &domain, &[line], &Params::default()).unwrap();
    let valley = &wrinkles.fold(&rest).valleys[0];
    assert!(valley.points.iter().all(|point| point.at.z.abs() < 1e-9));
    let length = valley.points.last().unwrap().x_mm;
    assert!((length - 40.0).abs() < 1e-6, "{length}");
    let painted = wrinkles.coordinates(0);
    assert!(painted.vertices.iter().all(|vertex| *vertex < count) && painted.vertices.len() > 500);
}
