//! Light on shapes whose light is known.

use nalgebra::{Point3, Rotation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;
use virtual_rig::light::ambient::rays;
use virtual_rig::light::groove::{Groove, groove_table};
use virtual_rig::light::{Ambient, Interreflection, Plan, Scene, Surface, irradiance, shade};

type Shape = (Vec<Point3<f64>>, Vec<[u32; 3]>);

fn sky(rays: u32) -> Ambient {
    Ambient { rays, ..Ambient::default() }
}

/// Points over rows and columns, and triangles that look along (row direction) × (column direction).
fn grid(rows: usize, columns: usize, point: impl Fn(usize, usize) -> Point3<f64>) -> Shape {
    let positions = (0..rows * columns).map(|at| point(at / columns, at % columns)).collect();
    let width = columns as u32;
    let triangles = (0..rows as u32 - 1)
        .flat_map(|row| (0..width - 1).map(move |column| row * width + column))
        .flat_map(|a| [[a, a + width, a + width + 1], [a, a + width + 1, a + 1]])
        .collect();
    (positions, triangles)
}

/// A square of side 2 · `half` about a centre; it looks along `u × v`.
fn square(center: Point3<f64>, u: Vector3<f64>, v: Vector3<f64>, half: f64, cells: usize) -> Shape {
    let at = |i: usize| half * (2.0 * i as f64 / cells as f64 - 1.0);
    grid(cells + 1, cells + 1, |i, j| center + at(i) * u + at(j) * v)
}

/// A sphere about the origin, looking outwards. Its poles are small holes.
fn sphere(rows: usize, radius: f64) -> Shape {
    grid(rows + 1, 2 * rows + 1, |i, j| {
        let theta = PI * (i as f64 / rows as f64).clamp(1e-6, 1.0 - 1e-6);
        let phi = PI * (j % (2 * rows)) as f64 / rows as f64;
        Point3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()) * radius
    })
}

fn joined(shapes: &[Shape]) -> Shape {
    let mut all: Shape = (vec![], vec![]);
    for (positions, triangles) in shapes {
        let first = all.0.len() as u32;
        all.0.extend(positions);
        all.1.extend(triangles.iter().map(|triangle| triangle.map(|vertex| vertex + first)));
    }
    all
}

/// The light on every vertex, all looked at closely, first channel.
fn light(shape: &Shape, normals: &[Vector3<f64>], ambient: &Ambient) -> Vec<f32> {
    let surface = Surface { positions: &shape.0, normals, triangles: &shape.1 };
    let scene = Scene::build(&shape.0, &shape.1, &[]);
    let plan = Plan::new(&vec![true; shape.0.len()], &shape.1);
    shade(&scene, &surface, &plan, &vec![[0.5; 3]; shape.0.len()], ambient)
        .iter()
        .map(|light| light[0])
        .collect()
}

fn normals(shape: &Shape) -> Vec<Vector3<f64>> {
    mesh::vertex_normals(&shape.0, &shape.1)
}

fn worst(values: &[f32], truth: f32) -> f32 {
    values.iter().map(|value| (value - truth).abs()).fold(0.0, f32::max)
}

/// The light on the floor at `distance` from the foot of a wall that is as good as endless in length.
fn by_the_wall(distance: f64, height: f64, ambient: &Ambient) -> f64 {
    let wall = grid(2, 2, |i, j| Point3::new(0.0, 5000.0 * (2.0 * i as f64 - 1.0), height * j as f64));
    let scene = Scene::build(&wall.0, &wall.1, &[]);
    f64::from(irradiance(&scene, &[Point3::new(distance, 0.0, 0.0)], &[Vector3::z()], ambient)[0])
}

#[test]
fn a_plane_sees_the_whole_sky() {
    for turn in [Vector3::zeros(), Vector3::new(0.3, -0.8, 0.1), Vector3::new(1.0, 2.0, 3.0)] {
        let turn = Rotation3::new(turn);
        let plane =
            square(Point3::new(30.0, -60.0, 80.0), turn * Vector3::x(), turn * Vector3::y(), 50.0, 20);
        assert!(worst(&light(&plane, &normals(&plane), &sky(64)), 1.0) < 1e-6);
    }
}

#[test]
fn a_sphere_does_not_shade_itself() {
    // The second as large and as finely cut as a head, and away from the origin.
    for (rows, radius, away) in [(60, 1.0, Vector3::zeros()), (300, 100.0, Vector3::new(5.0, 900.0, -40.0))] {
        let mut ball = sphere(rows, radius);
        let normals: Vec<Vector3<f64>> = ball.0.iter().map(|p| p.coords.normalize()).collect();
        ball.0.iter_mut().for_each(|p| *p += away);
        let light = light(&ball, &normals, &sky(32));
        assert!(worst(&light, 1.0) < 1e-6, "{}", worst(&light, 1.0));
    }
}

#[test]
fn the_foot_of_a_wall_sees_half_the_sky() {
    assert!((by_the_wall(1e-3, 5000.0, &sky(4096)) - 0.5).abs() < 2e-3);
    // A wall of height h at a distance a hides (1 − a/√(a² + h²)) / 2.
    for height in [0.5f64, 1.0, 3.0] {
        let truth = 0.5 + 0.5 / (1.0 + height * height).sqrt();
        assert!((by_the_wall(1.0, height, &sky(4096)) - truth).abs() < 2e-3);
    }
}

#[test]
fn the_middle_of_a_box_sees_the_opening_by_its_form_factor() {
    let side = |x: f64, y: f64| {
        let out = Vector3::new(x, y, 0.0);
        square(Point3::new(x, y, 1.0), Vector3::z().cross(&out), Vector3::z(), 1.0, 4)
    };
    let floor = square(Point3::origin(), Vector3::x(), Vector3::y(), 1.0, 4);
    let open_box = joined(&[floor, side(1.0, 0.0), side(-1.0, 0.0), side(0.0, 1.0), side(0.0, -1.0)]);
    let scene = Scene::build(&open_box.0, &open_box.1, &[]);
    // A square of half-width s, seen from a height h under its middle: 4 quarters of s/√(s²+h²) · atan(s/√(s²+h²)) / π · ... with
    // both terms equal, s = 1 and h = 2.
    let root = 5f64.sqrt();
    let truth = 4.0 / PI * (1.0 / root) * (1.0 / root).atan();
    let traced = irradiance(&scene, &[Point3::origin()], &[Vector3::z()], &sky(4096))[0];
    assert!((f64::from(traced) - truth).abs() < 2e-3, "{traced} for {truth}");
}

#[test]
fn the_bottom_of_a_groove_is_lit_as_known() {
    let ratios: Vec<f64> = (1..=10).map(|tenth| f64::from(tenth) / 10.0).collect();
    for (rays, limit) in [(512, 0.01), (8192, 0.005)] {
        let mut previous = 1.0;
        for (ratio, traced) in groove_table(&ratios, rays) {
            let known = 1.0 / (1.0 + 4.0 * ratio * ratio);
            println!(
                "{rays} rays, d/w {ratio}: {traced:.5}, known {known:.5}, {:+.3} %",
                100.0 * (traced / known - 1.0)
            );
            assert!((traced / known - 1.0).abs() < limit, "d/w {ratio}, {rays} rays: {traced} for {known}");
            assert!(traced < previous, "deeper is darker");
            previous = traced;
        }
    }
}

#[test]
fn a_groove_is_lit_alike_whichever_way_it_runs() {
    for (rays, limit) in [(512, 0.02), (8192, 0.005)] {
        let mut worst = 0f64;
        for turn in 0..8 {
            let turn = Rotation3::new(Vector3::new(0.4, -0.7, 1.1) * f64::from(turn));
            for ratio in [0.2, 0.5, 1.0] {
                let mut groove = Groove::new(ratio);
                groove.positions.iter_mut().for_each(|point| *point = turn * *point);
                let known = 1.0 / (1.0 + 4.0 * ratio * ratio);
                worst = worst.max((groove.bottom_light(rays) / known - 1.0).abs());
            }
        }
        println!("{rays} rays, worst of 8 ways: {:.3} %", 100.0 * worst);
        assert!(worst < limit, "{rays} rays: {worst}");
    }
}

#[test]
fn a_gradient_turns_with_the_sky() {
    let turn = UnitQuaternion::from_euler_angles(0.4, -1.1, 2.0);
    let nothing = Scene::build(&[], &[], &[]);
    let gradient = Vector3::new(0.06, -0.03, 0.05);
    for normal in [Vector3::z(), Vector3::x(), Vector3::new(1.0, 2.0, 2.0) / 3.0] {
        for rotation in [UnitQuaternion::identity(), turn] {
            let ambient = Ambient { gradient: (rotation * gradient).into(), ..sky(1024) };
            let known = 1.0 + 2.0 / 3.0 * gradient.dot(&normal);
            let traced = irradiance(&nothing, &[Point3::origin()], &[rotation * normal], &ambient)[0];
            assert!((f64::from(traced) - known).abs() < 2e-4, "{traced} for {known}");
        }
    }
    // What a wall at x < 0 hides is missing: more of it where that side is bright.
    let [dark, bright] =
        [0.5, -0.5].map(|x| by_the_wall(1e-3, 5000.0, &Ambient { gradient: [x, 0.0, 0.0], ..sky(1024) }));
    assert!((dark + bright - 1.0).abs() < 2e-2 && dark > bright + 0.2, "{dark} {bright}");
}

#[test]
fn occluders_hide_and_their_triangles_count_on() {
    let plane = square(Point3::origin(), Vector3::x(), Vector3::y(), 1.0, 2);
    let lid = square(Point3::new(0.0, 0.0, 0.5), Vector3::x(), Vector3::y(), 100.0, 1);
    let scene = Scene::build(&plane.0, &plane.1, &[(&lid.0, &lid.1)]);
    assert!(irradiance(&scene, &[Point3::origin()], &[Vector3::z()], &sky(256))[0] < 0.01);
    let from = Point3::new(0.1, 0.2, 0.3);
    let hit = scene.hit(&from, &Vector3::z()).unwrap();
    assert!(hit.triangle >= plane.1.len() as u32 && (hit.t - 0.2).abs() < 1e-5);
    let corners = lid.1[hit.triangle as usize - plane.1.len()].map(|vertex| lid.0[vertex as usize].coords);
    let place = (1.0 - hit.u - hit.v) * corners[0] + hit.u * corners[1] + hit.v * corners[2];
    assert!((place - Vector3::new(0.1, 0.2, 0.5)).norm() < 1e-4, "{place}");
    assert!(scene.occluded(&from, &Vector3::z(), 0.3));
    assert!(!scene.occluded(&from, &Vector3::z(), 0.1));
    assert!(scene.hit(&Point3::new(0.1, 0.2, 0.7), &Vector3::z()).is_none());
}

#[test]
fn single_rays_and_beams_agree() {
    // The library walks its own tree with its own triangle test.
    let groove = Groove::new(0.7);
    let shape = (groove.positions, groove.triangles);
    let scene = Scene::build(&shape.0, &shape.1, &[]);
    let normals = normals(&shape);
    let ambient = Ambient { epsilon_mm: 1e-3, ..sky(64) };
    for at in (0..shape.0.len()).step_by(97) {
        let (point, normal) = ([shape.0[at]], [normals[at]]);
        let beam = f64::from(irradiance(&scene, &point, &normal, &ambient)[0]);
        let (mut open, mut all) = (0.0, 0.0);
        for [_, direction] in rays(&scene, &point, &normal, &ambient) {
            let direction = Vector3::from(direction).cast::<f64>();
            let cosine = normal[0].dot(&direction);
            all += cosine;
            let blocked = scene.occluded(&(point[0] + normal[0] * 1e-3), &direction, f64::INFINITY);
            open += if blocked { 0.0 } else { cosine };
        }
        assert!((beam - open / all).abs() < 0.02, "{} {} {beam} and {}", point[0], normal[0], open / all);
    }
}

#[test]
fn one_bounce_in_a_closed_room_is_the_albedo() {
    // Inside a sphere every point sees only the surface: under an even light B on it, a point gets ρ B. The sky gets in
    // nowhere, so the light of the others is given.
    let (positions, mut triangles) = sphere(24, 10.0);
    triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    let normals: Vec<Vector3<f64>> = positions.iter().map(|p| -p.coords.normalize()).collect();
    let surface = Surface { positions: &positions, normals: &normals, triangles: &triangles };
    let scene = Scene::build(&positions, &triangles, &[]);
    let full: Vec<bool> = (0..positions.len()).map(|at| at == 500).collect();
    let plan = Plan::new(&full, &triangles).with_baked(vec![[1.0, 2.0, 0.5]; positions.len()]);
    let once = Some(Interreflection { bounces: 1 });
    let ambient = Ambient { crease_deg: 60.0, interreflection: once, ..sky(64) };
    let albedo = vec![[0.3, 0.6, 0.9]; positions.len()];
    let light = shade(&scene, &surface, &plan, &albedo, &ambient);
    for (light, truth) in light[500].iter().zip([0.3, 1.2, 0.45]) {
        assert!((light - truth).abs() < 0.01, "{light} for {truth}");
    }
}

#[test]
fn bounces_approach_the_solution_of_the_radiosity_equation() {
    // Two walls that meet in a right angle, as good as endless: each point sees half the sky and half the other wall, so
    // that B = ½ + ½ ρ B everywhere.
    let side: Vec<f64> =
        (0..=20).map(|step| 400.0 * (f64::from(step) * 0.5).exp_m1() / 10f64.exp_m1()).collect();
    let at = |i: usize| if i < 20 { (side[20 - i], -1.0) } else { (side[i - 20], 1.0) };
    let shape = grid(41, 41, |row, column| {
        let ((y, sign), (s, up)) = (at(row), at(column));
        Point3::new(if up > 0.0 { 0.0 } else { s }, y * sign, if up > 0.0 { s } else { 0.0 })
    });
    let normals = normals(&shape);
    let bottom = 20 * 41 + 20;
    assert!(normals[bottom].x > 0.5 && normals[bottom].z > 0.5);
    let surface = Surface { positions: &shape.0, normals: &normals, triangles: &shape.1 };
    let scene = Scene::build(&shape.0, &shape.1, &[]);
    let plan = Plan::new(&vec![true; shape.0.len()], &shape.1);
    let light = Some(Interreflection { bounces: 6 });
    let ambient = Ambient { epsilon_mm: 1e-4, interreflection: light, ..sky(512) };
    let light = shade(&scene, &surface, &plan, &vec![[0.0, 0.3, 0.6]; shape.0.len()], &ambient);
    for place in [bottom, bottom + 8] {
        for (light, albedo) in light[place].iter().zip([0.0, 0.3, 0.6]) {
            let truth = 0.5 / (1.0 - 0.5 * albedo);
            assert!((light / truth - 1.0).abs() < 0.02, "{light} for {truth}");
        }
    }
}

#[test]
fn close_looks_do_not_hang_on_the_others() {
    let groove = Groove::new(0.4);
    let shape = (groove.positions, groove.triangles);
    let normals = normals(&shape);
    let surface = Surface { positions: &shape.0, normals: &normals, triangles: &shape.1 };
    let scene = Scene::build(&shape.0, &shape.1, &[]);
    let full: Vec<bool> = shape.0.iter().map(|p| p.y.abs() < 1.0).collect();
    let ambient = sky(64);
    let glanced = shade(&scene, &surface, &Plan::new(&full, &shape.1), &[], &ambient);
    let baked = Plan::new(&full, &shape.1).with_baked(vec![[7.0; 3]; full.len()]);
    let baked = shade(&scene, &surface, &baked, &[], &ambient);
    for (vertex, full) in full.iter().enumerate() {
        if *full {
            assert_eq!(glanced[vertex], baked[vertex]);
        } else {
            assert_eq!(baked[vertex], [7.0; 3]);
            assert!(glanced[vertex][0] > 0.4);
        }
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let groove = Groove::new(0.5);
    let shape = (groove.positions, groove.triangles);
    let normals = normals(&shape);
    let ambient = Ambient { interreflection: Some(Interreflection { bounces: 1 }), ..sky(16) };
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| light(&shape, &normals, &ambient)).into_iter().map(f32::to_bits).collect::<Vec<u32>>()
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(5));
}

#[test]
fn without_shadows_a_ball_in_a_bowl_is_lit_alike_everywhere() {
    let shape =
        joined(&[sphere(12, 4.0), square(Point3::new(0.0, 0.0, -5.0), Vector3::x(), Vector3::y(), 20.0, 8)]);
    let normals = mesh::vertex_normals(&shape.0, &shape.1);
    let range = |ambient: &Ambient| {
        let light = light(&shape, &normals, ambient);
        light.iter().fold([f32::MAX, f32::MIN], |[low, high], &x| [low.min(x), high.max(x)])
    };
    assert_eq!(range(&Ambient { shadows: false, gradient: [0.1, 0.0, 0.0], ..sky(64) }), [1.0, 1.0]);
    assert!(range(&sky(64))[0] < 0.6);
}
