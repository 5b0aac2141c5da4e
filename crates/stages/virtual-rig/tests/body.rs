//! The body is a sound mesh, and what it does keeps it one.

use mesh::{Connectivity, Mesh, Polygons, loop_length};
use nalgebra::{Point2, Point3, Similarity3, Vector3};
use virtual_rig::body::{Body, Fineness, MUSCLES};

fn plain(seed: u64, count: usize) -> Body {
    Body::parametric(seed, count, &[], 0.0)
}

/// Two arcs over the forehead.
fn lines() -> Vec<Vec<Point2<f64>>> {
    let arc =
        |t: f64| (-6..=6).map(|i| Point2::new(7.0 * f64::from(i), t + 0.1 * f64::from(i * i))).collect();
    vec![arc(72.0), arc(84.0)]
}

/// The surface with the named shapes on; a name without a side means both.
fn pose(body: &Body, active: &[(&str, f64)]) -> Vec<Point3<f64>> {
    let weight = |shape: &String| {
        let is = |name: &str| shape == name || shape.trim_end_matches(['l', 'r']) == format!("{name}_");
        active.iter().find(|(name, _)| is(name)).map_or(0.0, |(_, weight)| *weight)
    };
    body.large_scale(&body.shape_names().iter().map(weight).collect::<Vec<_>>())
}

fn corner_angles(points: &[Point3<f64>], triangle: [u32; 3]) -> [f64; 3] {
    let p = triangle.map(|vertex| points[vertex as usize]);
    std::array::from_fn(|i| (p[(i + 1) % 3] - p[i]).angle(&(p[(i + 2) % 3] - p[i])).to_degrees())
}

fn normal(points: &[Point3<f64>], triangle: [u32; 3]) -> Vector3<f64> {
    let p = triangle.map(|vertex| points[vertex as usize]);
    (p[1] - p[0]).cross(&(p[2] - p[0])).normalize()
}

/// Share of triangles with an angle under 5°.
fn sliver_share(body: &Body, points: &[Point3<f64>]) -> f64 {
    let slivers =
        body.triangles.iter().filter(|&&t| corner_angles(points, t).iter().any(|&angle| angle < 5.0));
    slivers.count() as f64 / body.triangles.len() as f64
}

fn assert_sound(mesh: &Mesh) {
    let around = Connectivity::of(mesh.positions.len(), &mesh.triangles());
    assert!(around.non_manifold_edges().is_empty() && around.bow_ties().is_empty());
    assert!(around.flipped_edges().is_empty() && around.unreferenced().is_empty());
    assert_eq!(around.components().1, 1);
    let loops = around.boundary_loops();
    assert_eq!(loops.len(), 4, "the rim, two eyes, a mouth");
    let mut lengths: Vec<f64> = loops.iter().map(|ring| loop_length(&mesh.positions, ring)).collect();
    lengths.sort_by(|a, b| b.total_cmp(a));
    assert!(lengths[0] > 400.0 && lengths[1] < 130.0 && lengths[3] > 55.0, "{lengths:?}");
}

#[test]
fn is_one_manifold_piece_with_eyes_and_mouth_cut_out() {
    for (seed, count) in [(0, 500), (1, 3_000), (2, 30_000), (3, 60_000)] {
        let body = plain(seed, count);
        assert_sound(&body.mesh);
        let off = (body.mesh.positions.len() as f64 / count as f64 - 1.0).abs();
        assert!(off < 0.1 || count == 500, "{count} wanted, {} made", body.mesh.positions.len());
        assert_eq!(body.triangles, body.mesh.triangles());
        assert_eq!(body.domain.len(), body.mesh.positions.len());
        assert_eq!(body.albedo.len(), body.mesh.positions.len());
    }
}

#[test]
fn creases_have_edges_as_short_as_is_wanted() {
    let fineness = Fineness { reach_mm: 6.0, crease_mm: 0.25 };
    let body = Body::parametric(1, 60_000, &lines(), fineness);
    assert_sound(&body.mesh);
    let off = (body.mesh.positions.len() as f64 / 60_000.0 - 1.0).abs();
    assert!(off < 0.1, "{} made", body.mesh.positions.len());
    let on_line = |at: Point2<f64>| {
        let near = |pair: &[Point2<f64>]| (at - pair[0]).norm().min((at - pair[1]).norm()) < 0.3;
        lines().iter().any(|line| line.windows(2).any(near))
    };
    let edges = body.triangles.iter().flat_map(|t| (0..3).map(move |i| [t[i], t[(i + 1) % 3]]));
    let at_creases = edges.filter(|edge| edge.iter().all(|&vertex| on_line(body.domain[vertex as usize])));
    let lengths: Vec<f64> = at_creases
        .map(|[a, b]| (body.mesh.positions[a as usize] - body.mesh.positions[b as usize]).norm())
        .collect();
    assert!(lengths.len() > 100 && lengths.iter().all(|length| *length < 0.3), "{}", lengths.len());
}

#[test]
fn is_finer_near_the_lines_and_keeps_the_count() {
    for count in [30_000, 60_000] {
        let body = Body::parametric(1, count, &lines(), 6.0);
        assert_sound(&body.mesh);
        let off = (body.mesh.positions.len() as f64 / count as f64 - 1.0).abs();
        assert!(off < 0.1, "{count} wanted, {} made", body.mesh.positions.len());
        let areas = mesh::triangle_areas(&body.mesh.positions, &body.triangles);
        let mean_area = |inside: &dyn Fn(Point2<f64>) -> bool| {
            let chosen =
                areas.iter().zip(&body.triangles).filter(|(_, t)| inside(body.domain[t[0] as usize]));
            let (sum, count) = chosen.fold((0.0, 0.0), |(sum, count), (area, _)| (sum + area, count + 1.0));
            sum / count
        };
        let near = mean_area(&|at| at.x.abs() < 5.0 && (at.y - 72.0).abs() < 2.0);
        let far = mean_area(&|at| (at.x.abs() - 55.0).abs() < 10.0 && (at.y + 10.0).abs() < 12.0);
        let finer = (far / near).sqrt();
        assert!((2.8..4.5).contains(&finer), "{finer} times finer near the lines");
        assert_eq!(sliver_share(&body, &body.mesh.positions), 0.0);
    }
}

#[test]
fn no_facet_of_the_coarse_mesh_shows() {
    let body = plain(0, 60_000);
    let around = Connectivity::of(body.mesh.positions.len(), &body.triangles);
    let on_forehead = |v: u32| {
        let at = body.domain[v as usize];
        at.x.abs() < 20.0 && (70.0..95.0).contains(&at.y)
    };
    let turns: Vec<f64> = around
        .edges()
        .filter(|edge| edge.triangles.len() == 2 && edge.vertices.iter().all(|&v| on_forehead(v)))
        .map(|edge| {
            let [a, b] =
                [0, 1].map(|i| normal(&body.mesh.positions, body.triangles[edge.triangles[i] as usize]));
            a.angle(&b).to_degrees()
        })
        .collect();
    let mean = turns.iter().sum::<f64>() / turns.len() as f64;
    let largest = turns.iter().fold(0.0, |most: f64, turn| most.max(*turn));
    assert!(largest < 6.0 * mean && largest < 2.0, "mean {mean}°, largest {largest}°");
}

#[test]
fn looks_along_z_and_has_the_size_of_a_face() {
    let body = plain(0, 5_000);
    let (low, high) = mesh::bounding_box(&body.mesh.positions);
    let size = high - low;
    assert!((125.0..150.0).contains(&size.x) && (175.0..205.0).contains(&size.y), "{size}");
    let mean: Vector3<f64> = body.triangles.iter().map(|&t| normal(&body.mesh.positions, t)).sum();
    assert!(mean.normalize().z > 0.9);
}

#[test]
fn has_no_slivers() {
    for seed in 0..3 {
        let body = plain(seed, 10_000);
        assert_eq!(sliver_share(&body, &body.mesh.positions), 0.0, "seed {seed}");
    }
}

#[test]
fn is_the_same_every_time_and_another_with_another_seed() {
    let made = |seed| Body::parametric(seed, 8_000, &lines(), 6.0);
    let (one, again, other) = (made(5), made(5), made(6));
    assert!(one.mesh == again.mesh && one.albedo == again.albedo && one.props == again.props);
    assert_ne!(one.mesh.positions[0], other.mesh.positions[0]);
    assert_ne!(one.albedo[0], other.albedo[0]);
}

#[test]
fn any_number_of_threads_makes_the_same_body() {
    let made = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let body = Body::parametric(2, 30_000, &lines(), 6.0).with_pores(0.02);
            let posed = pose(&body, &[("smile", 0.7), ("blink", 0.4), ("jaw_open", 0.3)]);
            (body.mesh, body.albedo, posed)
        })
    };
    assert!(made(1) == made(3));
}

fn expressions() -> Vec<Vec<(&'static str, f64)>> {
    let mut all: Vec<Vec<(&str, f64)>> = MUSCLES.iter().map(|&name| vec![(name, 1.0)]).collect();
    all.extend(["smile", "brow_raise", "blink"].map(|name| vec![(name, 1.0)]));
    all.push(vec![("jaw_open", 0.5), ("smile", 0.5), ("brow_raise", 0.5)]);
    all.push(vec![("smile", 1.0), ("squint", 1.0), ("nose_wrinkle", 1.0)]);
    all.push(vec![("frown", 1.0), ("brow_raise", 1.0), ("blink", 1.0)]);
    all.push(vec![("smile", 1.0), ("mouth_stretch", 1.0), ("lips_press", 1.0)]);
    all.push(vec![("pucker", 1.0), ("lips_funnel", 1.0), ("frown", 1.0)]);
    all.push(vec![("jaw_open", 1.0), ("smile", 1.0), ("squint", 1.0), ("frown", 1.0)]);
    all
}

fn pairs() -> Vec<Vec<(&'static str, f64)>> {
    let below = |i: usize| MUSCLES[..i].iter().map(move |other| vec![(MUSCLES[i], 1.0), (*other, 1.0)]);
    (0..MUSCLES.len()).flat_map(below).collect()
}

/// Pairs of triangles that share an edge.
fn neighbours(body: &Body) -> Vec<[usize; 2]> {
    let around = Connectivity::of(body.domain.len(), &body.triangles);
    let inner = around.edges().filter(|edge| edge.triangles.len() == 2);
    inner.map(|edge| [edge.triangles[0] as usize, edge.triangles[1] as usize]).collect()
}

#[test]
fn no_expression_turns_a_triangle_over() {
    let mut faults = Vec::new();
    for (seed, count) in [(0, 3_000), (1, 3_000), (3, 10_000), (4, 40_000)] {
        let body = plain(seed, count);
        let normals = |points: &[Point3<f64>]| -> Vec<_> {
            body.triangles.iter().map(|&t| normal(points, t)).collect()
        };
        let (neighbours, rest) = (neighbours(&body), normals(&body.mesh.positions));
        for active in expressions().into_iter().chain(if count < 5_000 { pairs() } else { Vec::new() }) {
            let deformed = pose(&body, &active);
            let turned = normals(&deformed);
            let fold = neighbours.iter().map(|&[a, b]| turned[a].dot(&turned[b])).fold(1.0, f64::min);
            // The corners of an open mouth stand upright; nothing turns farther than they do.
            let turn = rest.iter().zip(&turned).map(|(a, b)| a.dot(b)).fold(1.0, f64::min);
            let slivers = sliver_share(&body, &deformed);
            if fold < 0.0 || turn < -0.2 || slivers > 1e-3 {
                let [fold, turn] = [fold, turn].map(|cos| cos.acos().to_degrees());
                faults.push(format!(
                    "{seed}, {active:?}: fold {fold:.0}°, turn {turn:.0}°, slivers {slivers:.1e}"
                ));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// The boundary loops of the two eyes and the mouth: the mouth is the lowest.
fn openings(body: &Body) -> Vec<Vec<u32>> {
    let mesh = &body.mesh;
    let mut loops = Connectivity::of(mesh.positions.len(), &mesh.triangles()).boundary_loops();
    loops.sort_by(|a, b| loop_length(&mesh.positions, b).total_cmp(&loop_length(&mesh.positions, a)));
    let mut openings = loops.split_off(1);
    let mean_y =
        |ring: &Vec<u32>| ring.iter().map(|&v| mesh.positions[v as usize].y).sum::<f64>() / ring.len() as f64;
    openings.sort_by(|a, b| mean_y(a).total_cmp(&mean_y(b)));
    openings
}

/// How far the two edges of an opening are apart in its middle; negative where the upper one has passed the lower.
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
    let [one, other] = [order[0], other].map(|i| ring[i] as usize);
    let (upper, lower) = if rest[one].y > rest[other].y { (one, other) } else { (other, one) };
    let apart = points[upper] - points[lower];
    apart.norm().copysign(apart.y)
}

#[test]
fn lips_and_lids_part_and_meet() {
    let body = plain(1, 20_000);
    let rest = &body.mesh.positions;
    let openings = openings(&body);
    let lips = |name: &str| gap(&pose(&body, &[(name, 1.0)]), rest, &openings[0]);
    let slit = lips("nothing");
    assert!((1.0..2.0).contains(&slit), "the lips are {slit} mm apart at rest");
    assert!((22.0..30.0).contains(&lips("jaw_open")), "the mouth opens by {} mm", lips("jaw_open"));
    assert!((0.0..0.6).contains(&lips("lips_press")), "pressed lips are {} mm apart", lips("lips_press"));
    for name in ["smile", "pucker", "mouth_stretch", "nose_wrinkle"] {
        assert!((0.0..6.0).contains(&lips(name)), "{name}: the lips are {} mm apart", lips(name));
    }
    let closed = pose(&body, &[("blink", 1.0)]);
    let squinted = pose(&body, &[("squint", 1.0)]);
    for eye in &openings[1..] {
        let open = gap(rest, rest, eye);
        assert!(open > 8.0, "eyes are open at rest");
        let slit = gap(&closed, rest, eye).abs();
        assert!(slit < 1.6, "a blink leaves {slit} mm");
        let narrow = gap(&squinted, rest, eye);
        assert!((0.3 * open..0.8 * open).contains(&narrow), "a squint leaves {narrow} of {open} mm");
    }
}

#[test]
fn left_shapes_leave_the_right_side_alone() {
    let body = plain(0, 5_000);
    let rest = &body.mesh.positions;
    for name in ["smile_l", "brow_raise_l", "blink_l"] {
        let posed = pose(&body, &[(name, 1.0)]);
        let moved = |side: f64| {
            let far = (0..rest.len()).filter(|&v| side * rest[v].x > 20.0);
            far.map(|v| (posed[v] - rest[v]).norm()).fold(0.0, f64::max)
        };
        assert!(moved(1.0) > 3.0 && moved(-1.0) < 0.2, "{name}: {} and {}", moved(1.0), moved(-1.0));
    }
}

#[test]
fn a_jaw_moves_no_forehead_and_rest_moves_nothing() {
    let body = plain(1, 5_000);
    let rest = &body.mesh.positions;
    assert!(&body.large_scale(&[0.0; MUSCLES.len()]) == rest);
    assert!(&body.large_scale(&[]) == rest);
    let open = pose(&body, &[("jaw_open", 1.0)]);
    for (before, after) in rest.iter().zip(&open).filter(|(before, _)| before.y > 60.0) {
        assert!((after - before).norm() < 0.1, "{before} moves to {after}");
    }
}

#[test]
fn markers_have_the_same_places_on_any_mesh_of_a_person() {
    let (coarse, fine) = (plain(2, 8_000), plain(2, 20_000));
    let (few, many) = (coarse.markers(), fine.markers());
    assert_eq!(few.len(), 85);
    for (one, other) in few.iter().zip(&many) {
        assert_eq!((&one.name, one.at), (&other.name, other.at));
        for (body, marker) in [(&coarse, one), (&fine, other)] {
            assert!((body.domain[marker.vertex as usize] - marker.at).norm() < 2.5, "{}", marker.name);
        }
    }
    let mut names: Vec<&String> = few.iter().map(|marker| &marker.name).collect();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), 85);
    for (i, one) in many.iter().enumerate() {
        for other in &many[..i] {
            let [a, b] = [one, other].map(|marker| fine.mesh.positions[marker.vertex as usize]);
            assert!((a - b).norm() > 5.0, "{} and {}", one.name, other.name);
        }
    }
    assert_eq!(fine.headband().len(), 5);
}

#[test]
fn people_differ_in_colour_and_lips_are_redder_than_cheeks() {
    let mut cheeks = Vec::new();
    for seed in 0..6 {
        let body = plain(seed, 10_000);
        assert!(body.albedo.iter().flatten().all(|channel| (0.0..=1.0).contains(channel)));
        let mean = |inside: &dyn Fn(Point2<f64>) -> bool| {
            let chosen: Vec<[f32; 3]> =
                (0..body.domain.len()).filter(|&v| inside(body.domain[v])).map(|v| body.albedo[v]).collect();
            let sum = |channel: usize| chosen.iter().map(|color| f64::from(color[channel])).sum::<f64>();
            [0, 1, 2].map(|channel| sum(channel) / chosen.len() as f64)
        };
        let cheek = mean(&|at| (at.x.abs() - 45.0).abs() < 8.0 && at.y.abs() < 8.0);
        let lips = mean(&|at| at.x.abs() < 12.0 && (-35.0..-31.0).contains(&at.y));
        let forehead = mean(&|at| at.x.abs() < 20.0 && (70.0..90.0).contains(&at.y));
        assert!(lips[1] < 0.8 * cheek[1] && lips[0] / lips[1] > 1.1 * cheek[0] / cheek[1], "seed {seed}");
        assert!(forehead[0] > forehead[1] && forehead[1] > forehead[2], "seed {seed}");
        cheeks.push(cheek[1]);
    }
    let (low, high) = cheeks.iter().fold((1.0, 0.0), |(low, high): (f64, f64), &c| (low.min(c), high.max(c)));
    assert!(high > 1.4 * low, "{cheeks:?}");
}

#[test]
fn no_lid_cuts_into_an_eyeball() {
    let body = plain(0, 20_000);
    for name in ["nothing", "blink", "squint"] {
        let posed = pose(&body, &[(name, 1.0)]);
        for ball in &body.props[..2] {
            let (low, high) = mesh::bounding_box(&ball.mesh.positions);
            let (center, half) = (nalgebra::center(&low, &high), 0.5 * (high - low));
            let is_inside = |point: &&Point3<f64>| {
                let off = *point - center;
                off.z > 0.0 && off.component_div(&half).norm() < 0.97
            };
            let inside = posed.iter().filter(is_inside).count();
            assert_eq!(inside, 0, "{name}");
        }
    }
}

#[test]
fn eyeballs_and_mouth_stay_behind_the_skin() {
    for seed in 0..9 {
        let body = plain(seed, 6_000);
        for name in ["nothing", "jaw_open"] {
            let posed = pose(&body, &[(name, 1.0)]);
            // The front of the skin around a point, in columns of 4 mm; nothing beyond its rim.
            let column = |point: &Point3<f64>| [point.x, point.y].map(|c| (c / 4.0).round() as i32);
            let mut front: std::collections::BTreeMap<[i32; 2], f64> = std::collections::BTreeMap::new();
            for point in &posed {
                let z = front.entry(column(point)).or_insert(point.z);
                *z = z.max(point.z);
            }
            let covers = |point: &Point3<f64>| front.get(&column(point)).is_none_or(|z| point.z < z + 0.5);
            for (index, prop) in body.props[..3].iter().enumerate() {
                let (low, high) = mesh::bounding_box(&prop.mesh.positions);
                let middle = nalgebra::center(&low, &high);
                let seen = |point: &Point3<f64>| {
                    index < 2 && (point.x - middle.x).abs() < 11.0 && (point.y - middle.y).abs() < 8.0
                };
                let out = prop.mesh.positions.iter().filter(|&point| !seen(point) && !covers(point)).count();
                assert_eq!(out, 0, "seed {seed}, {name}, prop {index}");
            }
        }
    }
}

/// 9 × 9 vertices, 10 mm apart, over the middle of the face.
fn patch() -> (Mesh, Vec<Point2<f64>>) {
    let places = (0..9).flat_map(|j| (0..9).map(move |i| (f64::from(i), f64::from(j))));
    let domain: Vec<Point2<f64>> =
        places.map(|(i, j)| Point2::new(10.0 * i - 40.0, 10.0 * j - 40.0)).collect();
    let mut polygons = Polygons::default();
    for at in (0..72u32).filter(|at| at % 9 != 8) {
        polygons.push(&[at, at + 1, at + 10]);
        polygons.push(&[at, at + 10, at + 9]);
    }
    let positions = domain.iter().map(|at| Point3::new(at.x, at.y, 70.0)).collect();
    (Mesh { positions, polygons, ..Mesh::default() }, domain)
}

#[test]
fn shapes_add_up() {
    let (mesh, domain) = patch();
    let albedo = vec![[0.5; 3]; domain.len()];
    let up = vec![Vector3::y(); domain.len()];
    let mut one = vec![Vector3::zeros(); domain.len()];
    one[7] = Vector3::x() * 3.0;
    let names = vec!["up".to_string(), "one".to_string()];
    let body = Body::from_shapes(mesh.clone(), domain, albedo, names, vec![up, one]);
    let posed = body.large_scale(&[2.0, 0.5]);
    for (v, (posed, rest)) in posed.iter().zip(&mesh.positions).enumerate() {
        let expected = Vector3::new(if v == 7 { 1.5 } else { 0.0 }, 2.0, 0.0);
        assert!((posed - rest - expected).norm() < 1e-12);
    }
}

#[test]
fn muscles_work_on_a_scan() {
    let (mesh, domain) = patch();
    let albedo = vec![[0.5; 3]; domain.len()];
    let scan = Body::from_muscles(mesh.clone(), domain, albedo, Similarity3::identity());
    assert_eq!(scan.shape_names(), MUSCLES);
    let smiling = pose(&scan, &[("smile", 1.0)]);
    let corner = scan.domain.iter().position(|at| *at == Point2::new(30.0, -30.0)).unwrap();
    assert!((smiling[corner] - mesh.positions[corner]).y > 2.0);
    // Only the markers that the scan covers.
    let count = scan.markers().len();
    assert!((10..85).contains(&count), "{count} markers");
}

#[test]
fn pores_are_shallow() {
    let smooth = plain(0, 3_000);
    let rough = smooth.clone().with_pores(0.02);
    let depths = smooth.mesh.positions.iter().zip(&rough.mesh.positions).map(|(a, b)| (a - b).norm());
    let deepest = depths.fold(0.0, f64::max);
    assert!((0.01..=0.0201).contains(&deepest), "{deepest} mm");
}
