//! The film against scenes whose images are known.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests may")]

use camera::{BrownConrady, Camera, Lens};
use mesh::Mesh;
use nalgebra::{Isometry3, Point3, Vector2, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use testkit::shapes;
use virtual_rig::body::Body;
use virtual_rig::film::{Exposure, Film, Gloss, Grain, Moment, Scene, Sensor, Skin, Solid, develop, expose};
use virtual_rig::paint::{BLUE, Dot, GREEN, HalfWidth, Layers, Outline, Stroke, StrokeCoordinates};

/// A surface with everything that the film asks for.
struct Thing {
    open: Vec<Point3<f64>>,
    close: Option<Vec<Point3<f64>>>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<Vector3<f64>>,
    albedo: Vec<[f32; 3]>,
    irradiance: Vec<[f32; 3]>,
}

impl Thing {
    fn of(mesh: &Mesh) -> Self {
        let triangles = mesh.triangles();
        let count = mesh.positions.len();
        Self {
            open: mesh.positions.clone(),
            close: None,
            normals: mesh::vertex_normals(&mesh.positions, &triangles),
            triangles,
            albedo: vec![[1.0; 3]; count],
            irradiance: vec![[1.0; 3]; count],
        }
    }

    /// A rectangle of two triangles in the plane z = `z`, facing +z.
    fn plate([left, right]: [f64; 2], [bottom, top]: [f64; 2], z: f64) -> Self {
        let corners = [[left, bottom, z], [right, bottom, z], [right, top, z], [left, top, z]];
        Self::of(&Mesh::from_triangles(corners.to_vec(), &[[0, 1, 2], [0, 2, 3]]))
    }

    fn colored(mut self, color: [f32; 3]) -> Self {
        self.albedo.fill(color);
        self
    }

    fn moving(mut self, way: Vector3<f64>) -> Self {
        self.close = Some(self.open.iter().map(|point| point + way).collect());
        self
    }

    fn solid(&self) -> Solid<'_> {
        Solid {
            skin: Skin { triangles: &self.triangles, albedo: &self.albedo },
            moment: Moment {
                open: &self.open,
                close: self.close.as_deref(),
                middle: None,
                normals: &self.normals,
                irradiance: &self.irradiance,
            },
        }
    }

    fn paint(&self, dots: Vec<Dot>, strokes: Vec<(Stroke, StrokeCoordinates)>) -> Layers {
        Layers::build(&self.open, &self.normals, &self.triangles, dots, strokes)
    }

    fn unpainted(&self) -> Layers {
        self.paint(vec![], vec![])
    }

    /// A dot in the triangle whose middle is nearest to a point.
    fn dot_near(&self, point: Point3<f64>, outline: Outline) -> Dot {
        let off = |triangle: &[u32; 3]| {
            let sum: Vector3<f64> = triangle.iter().map(|&vertex| self.open[vertex as usize].coords).sum();
            (sum / 3.0 - point.coords).norm()
        };
        let nearest = (0..self.triangles.len())
            .min_by(|one, other| off(&self.triangles[*one]).total_cmp(&off(&self.triangles[*other])))
            .unwrap();
        self.dot((nearest as u32, [0.2, 0.3, 0.5]), outline)
    }

    fn dot(&self, place: (u32, [f64; 3]), outline: Outline) -> Dot {
        Dot::at(&format!("m{}", place.0), outline, place, &self.triangles, &self.open, &self.normals)
    }
}

fn film() -> Film {
    Film { background: [0.0; 3], ..Film::default() }
}

fn shot(camera: &Camera, face: &Thing, layers: &Layers, props: &[&Thing]) -> Exposure {
    let props: Vec<Solid<'_>> = props.iter().map(|thing| thing.solid()).collect();
    expose(camera, &Scene { face: face.solid(), layers, props: &props }, &film()).unwrap()
}

/// A camera without distortion, 1000 mm before the plane z = 0 of the world, where a pixel is a millimetre: the world's
/// (x, y, 0) lands on the pixel (20 + x, 15 − y).
fn ruler() -> Camera {
    let eye = Point3::new(0.0, 0.0, 1000.0);
    Camera {
        image_size: [41, 31],
        lens: Lens {
            focal_px: Vector2::repeat(1000.0),
            center_px: Vector2::new(20.0, 15.0),
            distortion: BrownConrady::default(),
        },
        cam_from_world: Camera::pose_looking_at(eye, Point3::origin(), Vector3::y()),
    }
}

/// A mocap camera as in the studio, somewhere before the face.
fn mocap(random: &mut ChaCha8Rng) -> Camera {
    let mut draw = |size: f64| random.random_range(-size..size);
    let eye = Point3::new(draw(500.0), draw(300.0), 750.0 + draw(80.0));
    let target = Point3::new(draw(15.0), draw(15.0), draw(15.0));
    Camera {
        image_size: [656, 490],
        lens: Lens {
            focal_px: Vector2::new(1750.0 + draw(30.0), 1750.0),
            center_px: Vector2::new(327.5 + draw(8.0), 244.5 + draw(8.0)),
            distortion: BrownConrady { k1: -0.18 + draw(0.05), k2: 0.12, p1: 6e-4, p2: -4e-4, k3: 0.0 },
        },
        cam_from_world: Camera::pose_looking_at(eye, target, Vector3::new(draw(0.2), 1.0, 0.0)),
    }
}

/// A ball as large as a head with dots of 2 to 4 mm on its front, out of round, none over another.
fn dotted_ball(random: &mut ChaCha8Rng) -> (Thing, Layers) {
    let ball = Thing::of(&shapes::sphere(80.0, 90));
    let front: Vec<u32> = (0..ball.triangles.len() as u32)
        .filter(|&index| ball.normals[ball.triangles[index as usize][0] as usize].z > 0.25)
        .collect();
    let mut dots: Vec<Dot> = Vec::new();
    while dots.len() < 60 {
        let triangle = front[random.random_range(0..front.len())];
        let [second, third] = [0, 1].map(|_| random.random_range(0.0..0.5));
        let outline = Outline::out_of_round(random.random_range(1.0..2.0), 0.15, dots.len() as u64);
        let dot = ball.dot((triangle, [1.0 - second - third, second, third]), outline);
        if dots.iter().all(|other| (other.center - dot.center).norm() > 5.0) {
            dots.push(dot);
        }
    }
    let layers = ball.paint(dots, vec![]);
    (ball, layers)
}

/// Centroid and area of a layer's paint in an image.
fn paint_in(exposure: &Exposure, layer: u32) -> (Vector2<f64>, f64) {
    let mut area = 0.0;
    let mut moment = Vector2::zeros();
    let width = exposure.size[0];
    for cover in exposure.covers.iter().filter(|cover| cover.layer == layer) {
        let share = f64::from(cover.share);
        area += share;
        let pixel = [cover.pixel % width, cover.pixel / width];
        let place = [0, 1].map(|axis| f64::from(pixel[axis]) + f64::from(cover.offset_px[axis]));
        moment += share * Vector2::from(place);
    }
    (moment / area, area)
}

/// Errors of the dots that a camera sees well: distances in px; and the painted area over the true one.
fn errors(camera: &Camera, thing: &Thing, layers: &Layers) -> (Vec<f64>, [f64; 2]) {
    let exposure = shot(camera, thing, layers, &[]);
    let middle = thing.solid().moment.mean();
    let (mut off, mut areas) = (Vec::new(), [0.0; 2]);
    for (dot, samples) in layers.dot_samples().iter().enumerate() {
        let view = samples.view(&middle, camera, |_, _| true);
        if view.angle_rad < 70_f64.to_radians() && view.share_seen == 1.0 {
            let (center, area) = paint_in(&exposure, layers.layer_of_dot(dot));
            off.push((center - view.centroid_px.unwrap()).norm());
            areas = [areas[0] + area, areas[1] + view.area_px];
        }
    }
    (off, areas)
}

fn assert_close_to_truth(name: &str, off: &[f64], areas: [f64; 2]) {
    let rms = (off.iter().map(|x| x * x).sum::<f64>() / off.len() as f64).sqrt();
    let worst = off.iter().copied().fold(0.0, f64::max);
    let area = areas[0] / areas[1];
    println!("{name}: {} dots, off {rms:.4} px RMS, {worst:.4} at most, area × {area:.5}", off.len());
    assert!(worst <= 0.02, "{name}: {worst} px");
    assert!((area - 1.0).abs() < 0.005, "{name}: area × {area}");
}

#[test]
fn dots_are_where_the_truth_says() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let (mut off, mut areas) = (Vec::new(), [0.0; 2]);
    for _ in 0..6 {
        let (ball, layers) = dotted_ball(&mut random);
        let (new, [seen, true_one]) = errors(&mocap(&mut random), &ball, &layers);
        off.extend(new);
        areas = [areas[0] + seen, areas[1] + true_one];
    }
    assert!(off.len() >= 200);
    assert_close_to_truth("still", &off, areas);
}

#[test]
fn motion_puts_dots_where_they_are_at_mid_exposure() {
    let mut random = ChaCha8Rng::seed_from_u64(12);
    let (ball, layers) = dotted_ball(&mut random);
    let ball = ball.moving(Vector3::new(0.5, -0.3, 0.2));
    let (off, areas) = errors(&mocap(&mut random), &ball, &layers);
    assert!(off.len() >= 30);
    assert_close_to_truth("moving by 1.3 px", &off, areas);
}

#[test]
fn perspective_bends_no_paint_on_a_large_triangle() {
    let mut plate = Thing::plate([-60.0, 60.0], [-60.0, 60.0], 0.0);
    let layers = plate.paint(vec![plate.dot((0, [0.3, 0.5, 0.2]), Outline::round(2.0))], vec![]);
    let tilt = Isometry3::rotation(Vector3::new(0.9, 0.5, 0.0));
    plate.open.iter_mut().for_each(|point| *point = tilt * *point);
    let mut camera = mocap(&mut ChaCha8Rng::seed_from_u64(3));
    camera.lens.distortion = BrownConrady::default();
    let near = Point3::new(0.0, 0.0, 160.0);
    camera.cam_from_world = Camera::pose_looking_at(near, Point3::origin(), Vector3::y());
    camera.lens.focal_px = Vector2::repeat(400.0);
    let (off, areas) = errors(&camera, &plate, &layers);
    assert_eq!(off.len(), 1);
    assert_close_to_truth("on a large triangle", &off, areas);
}

#[test]
fn the_truth_of_a_dot_on_a_plane_is_the_projection_of_its_outline() {
    let grid = Thing::of(&shapes::grid(20, 1.0));
    let outline = Outline::out_of_round(2.0, 0.15, 4);
    let layers = grid.paint(vec![grid.dot_near(Point3::new(10.0, 10.0, 0.0), outline)], vec![]);
    let dot = &layers.dots()[0];
    let mut camera = ruler();
    camera.lens.focal_px = Vector2::repeat(4000.0);
    camera.lens.center_px = Vector2::zeros();
    camera.image_size = [200, 200];
    camera.cam_from_world.translation.vector.y += 20.0;
    let view = layers.dot_samples()[0].view(&grid.open, &camera, |_, _| true);
    // Green's theorem on the outline in space; the plane is parallel to the image, so one scale serves all.
    let steps = 20_000;
    let point = |step: i32| {
        let angle = std::f64::consts::TAU * f64::from(step) / f64::from(steps);
        outline.radius(angle) * Vector2::new(angle.cos(), angle.sin())
    };
    let (mut area, mut moment) = (0.0, Vector2::zeros());
    for step in 0..steps {
        let (p, q) = (point(step), point(step + 1));
        area += 0.5 * p.perp(&q);
        moment += 0.5 * p.perp(&q) * (p + q) / 3.0;
    }
    let center = dot.center + Vector3::new(moment.x / area, moment.y / area, 0.0);
    assert!((view.center_in_world - center).norm() < 2e-3, "{}", (view.center_in_world - center).norm());
    assert!((view.area_mm2 / area - 1.0).abs() < 2e-3 && (view.area_px / (16.0 * area) - 1.0).abs() < 2e-3);
    assert!((view.centroid_px.unwrap() - camera.project(&center).unwrap()).norm() < 8e-3);
    let toward = camera.eye_in_world() - center;
    assert!((view.angle_rad - toward.angle(&Vector3::z())).abs() < 1e-5 && view.share_seen == 1.0);
}

#[test]
fn hidden_halves_are_left_out_of_the_truth() {
    let grid = Thing::of(&shapes::grid(20, 1.0));
    let layers = grid.paint(vec![grid.dot_near(Point3::new(10.0, 10.0, 0.0), Outline::round(2.0))], vec![]);
    let center = layers.dots()[0].center;
    let camera = Camera { image_size: [200, 200], ..ruler() };
    let left_half = |point: &Point3<f64>, _: Vector2<f64>| point.x < center.x;
    let view = layers.dot_samples()[0].view(&grid.open, &camera, left_half);
    assert!((view.share_seen - 0.5).abs() < 0.02);
    // The centroid of half a disc lies 4 r / 3 π from its middle.
    let expected = camera.project(&(center - Vector3::x() * 8.0 / (3.0 * std::f64::consts::PI))).unwrap();
    assert!((view.centroid_px.unwrap() - expected).norm() < 0.03);
    let nothing = layers.dot_samples()[0].view(&grid.open, &camera, |_, _| false);
    assert!(nothing.centroid_px.is_none() && nothing.share_seen == 0.0);
    let back = Camera {
        cam_from_world: Camera::pose_looking_at(
            Point3::new(10.0, 10.0, -900.0),
            Point3::new(10.0, 10.0, 0.0),
            Vector3::y(),
        ),
        ..camera
    };
    assert_eq!(layers.dot_samples()[0].view(&grid.open, &back, |_, _| true).share_seen, 0.0);
}

#[test]
fn an_edge_covers_its_share_of_a_pixel() {
    for (edge, share) in [(0.0, 0.5), (0.25, 0.75), (-0.375, 0.125), (0.5, 1.0), (-0.5, 0.0)] {
        let plate = Thing::plate([-30.0, edge], [-30.0, 30.0], 0.0);
        let exposure = shot(&ruler(), &plate, &plate.unpainted(), &[]);
        for row in [0, 15, 30] {
            let light = |column: usize| exposure.radiance[41 * row + column][1];
            let off = [light(19) - 1.0, light(20) - share, light(21)];
            assert!(off.iter().all(|x| x.abs() < 1e-6), "edge at {edge}: {off:?}");
        }
    }
}

#[test]
fn nothing_shines_through_a_closed_surface() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let ball = Thing::of(&shapes::sphere(80.0, 150));
    for _ in 0..3 {
        let camera = mocap(&mut random);
        let exposure = shot(&camera, &ball, &ball.unpainted(), &[]);
        let center = camera.project(&Point3::origin()).unwrap();
        let inner = |pixel: usize| {
            let place = Vector2::new((pixel % 656) as f64, (pixel / 656) as f64);
            (place - center).norm() < 120.0
        };
        let lights = exposure.radiance.iter().enumerate().filter(|(pixel, _)| inner(*pixel));
        assert!(lights.into_iter().all(|(_, light)| (light[0] - 1.0).abs() < 1e-4));
    }
}

#[test]
fn the_nearer_surface_hides_the_farther_whichever_comes_first() {
    let near = Thing::plate([-5.0, 5.0], [-5.0, 5.0], 100.0).colored([1.0, 0.0, 0.0]);
    let far = Thing::plate([-30.0, 30.0], [-30.0, 30.0], -50.0).colored([0.0, 1.0, 0.0]);
    let one = shot(&ruler(), &near, &near.unpainted(), &[&far]);
    let other = shot(&ruler(), &far, &far.unpainted(), &[&near]);
    assert_eq!(one, other);
    let [center, corner] = [15 * 41 + 20, 0].map(|pixel| (one.radiance[pixel], one.depth_mm[pixel]));
    assert!((center.1 - 900.0).abs() < 1e-2 && (corner.1 - 1050.0).abs() < 1e-2);
    let is = |light: [f32; 3], color: [f32; 3]| light.iter().zip(color).all(|(x, y)| (x - y).abs() < 1e-6);
    assert!(is(center.0, [1.0, 0.0, 0.0]) && is(corner.0, [0.0, 1.0, 0.0]));
    let camera = ruler();
    let sees = one.sees(&camera, 1.0);
    let asked = |x: f64, z: f64| {
        let point = Point3::new(x, 0.0, z);
        sees(&point, ruler().project(&point).unwrap())
    };
    assert!(asked(0.0, 100.0) && !asked(0.0, -50.0) && asked(15.0, -50.0));
}

#[test]
fn slanted_surfaces_have_their_depth() {
    let mut plate = Thing::plate([-60.0, 60.0], [-60.0, 60.0], 0.0);
    let tilt = Isometry3::rotation(Vector3::new(0.0, 1.0, 0.0));
    plate.open.iter_mut().for_each(|point| *point = tilt * *point);
    let exposure = shot(&ruler(), &plate, &plate.unpainted(), &[]);
    for column in [0, 10, 20, 33, 40] {
        // Where the ray of the column meets z = −x tan(1).
        let slope = (column as f64 - 20.0) / 1000.0;
        let depth = 1000.0 / (1.0 - slope * 1_f64.tan());
        let nearest = f64::from(exposure.depth_mm[15 * 41 + column]);
        // The nearest sample lies up to 7/32 px off the centre.
        let step = depth * depth / 1000.0 * 1_f64.tan() * 7.1 / 32_000.0;
        assert!(
            nearest <= depth + 0.01 && nearest >= depth - step - 0.01,
            "column {column}: {nearest} {depth}"
        );
    }
}

#[test]
fn backs_are_dark_and_nothing_is_drawn_behind_the_camera() {
    let plate = Thing::plate([-30.0, 30.0], [-30.0, 30.0], 0.0);
    let mut camera = ruler();
    let behind = Point3::new(0.0, 0.0, -1000.0);
    camera.cam_from_world = Camera::pose_looking_at(behind, Point3::origin(), Vector3::y());
    let exposure = shot(&camera, &plate, &plate.unpainted(), &[]);
    assert!(exposure.radiance.iter().all(|light| (light[0] - 0.03).abs() < 1e-5));
    camera.cam_from_world = Camera::pose_looking_at(behind, 2.0 * behind, Vector3::y());
    let exposure = shot(&camera, &plate, &plate.unpainted(), &[]);
    assert!(exposure.radiance.iter().all(|light| *light == [0.0; 3]));
    assert!(exposure.depth_mm.iter().all(|depth| *depth == f32::INFINITY));
}

#[test]
fn motion_smears_an_edge_over_its_way() {
    let plate = Thing::plate([-30.0, -2.0], [-30.0, 30.0], 0.0).moving(Vector3::x() * 4.0);
    let exposure = shot(&ruler(), &plate, &plate.unpainted(), &[]);
    let light: Vec<f32> = (17..24).map(|column| exposure.radiance[15 * 41 + column][0]).collect();
    // At the middles of the quarters, the edge stands at −1.5, −0.5, 0.5 and 1.5.
    let expected = [1.0, 1.0, 0.75, 0.5, 0.25, 0.0, 0.0];
    assert!(light.iter().zip(expected).all(|(x, y): (&f32, f32)| (x - y).abs() < 1e-6), "{light:?}");
}

/// A stroke along x in the middle of a grid of 40 mm, and a dot on it.
fn stroke_and_dot(grid: &Thing, missing: Vec<[f64; 2]>) -> Layers {
    let stroke = Stroke {
        id: "w1".to_string(),
        paint: GREEN,
        left: HalfWidth::through(vec![[5.0, 1.0], [35.0, 3.0]]),
        right: HalfWidth::through(vec![[5.0, 1.5]]),
        range: [5.0, 35.0],
        missing,
        smear_mm: 0.0,
    };
    let vertices: Vec<u32> = (0..grid.open.len() as u32).collect();
    let coordinates = grid.open.iter().map(|point| [point.x, point.y - 20.0]).collect();
    let dot = grid.dot_near(Point3::new(20.0, 19.5, 0.0), Outline::round(1.3));
    grid.paint(vec![dot], vec![(stroke, StrokeCoordinates { vertices, coordinates })])
}

/// Looks at the grid so that 4 px are a millimetre.
fn above_the_grid() -> Camera {
    let eye = Point3::new(20.0, 20.0, 1000.0);
    Camera {
        image_size: [200, 200],
        lens: Lens { focal_px: Vector2::repeat(4000.0), center_px: Vector2::repeat(99.5), ..ruler().lens },
        cam_from_world: Camera::pose_looking_at(eye, Point3::new(20.0, 20.0, 0.0), Vector3::y()),
    }
}

#[test]
fn strokes_have_their_area_and_lie_under_dots() {
    let grid = Thing::of(&shapes::grid(40, 1.0));
    let layers = stroke_and_dot(&grid, vec![[8.0, 10.0]]);
    let exposure = shot(&above_the_grid(), &grid, &layers, &[]);
    let (_, stroke) = paint_in(&exposure, 0);
    let (_, dot) = paint_in(&exposure, 1);
    let disc = std::f64::consts::PI * 1.3 * 1.3;
    // Left widths 1 to 3 mm, right 1.5, without the gap, without what the dot hides.
    let gap = 2.0 * (1.0 + 2.0 * 4.0 / 30.0 + 1.5);
    let expected = 30.0 * (2.0 + 1.5) - gap - disc;
    assert!((dot / 16.0 / disc - 1.0).abs() < 2e-3, "{}", dot / 16.0);
    assert!((stroke / 16.0 / expected - 1.0).abs() < 2e-3, "{} for {expected}", stroke / 16.0);
    for covers in exposure.covers.chunk_by(|one, next| one.pixel == next.pixel) {
        let sum: f32 = covers.iter().map(|cover| cover.share).sum();
        assert!(sum <= 1.0 + 1e-5 && covers.is_sorted_by_key(|cover| cover.layer));
        let skin = 1.0 - sum;
        let share = |layer: u32| covers.iter().find(|cover| cover.layer == layer).map_or(0.0, |c| c.share);
        for channel in 0..3 {
            let mixed = skin + share(0) * GREEN[channel] + share(1) * BLUE[channel];
            assert!((exposure.radiance[covers[0].pixel as usize][channel] - mixed).abs() < 1e-4);
        }
    }
}

#[test]
fn light_falls_on_skin_and_paint_alike() {
    let mut grid = Thing::of(&shapes::grid(40, 1.0)).colored([0.5, 0.4, 0.3]);
    grid.irradiance.iter_mut().zip(&grid.open).for_each(|(light, point)| *light = [0.02 * point.x as f32; 3]);
    let layers = stroke_and_dot(&grid, vec![]);
    let exposure = shot(&above_the_grid(), &grid, &layers, &[]);
    for (x, y, color) in [(30.0, 20.0, GREEN), (10.0, 35.0, [0.5, 0.4, 0.3])] {
        let pixel = above_the_grid().project(&Point3::new(x, y, 0.0)).unwrap();
        let (column, row) = (pixel.x.round(), pixel.y.round());
        let light = exposure.radiance[200 * row as usize + column as usize];
        let arrived = 0.02 * (20.0 + (column - 99.5) / 4.0) as f32;
        assert!(light.iter().zip(color).all(|(x, y)| (x - arrived * y).abs() < 1e-4), "{light:?}");
    }
}

#[test]
fn gloss_shines_on_skin_and_not_on_paint() {
    let ball = Thing::of(&shapes::sphere(10.0, 60)).colored([0.3; 3]);
    let gloss = Gloss { strength: 0.5, exponent: 8.0, rim: 0.0, toward_key: [0.0, 0.0, 1.0] };
    let layers = ball.unpainted();
    let scene = Scene { face: ball.solid(), layers: &layers, props: &[] };
    let exposure = expose(&ruler(), &scene, &Film { gloss: Some(gloss), ..film() }).unwrap();
    let light = |column: usize| exposure.radiance[15 * 41 + column][0];
    assert!((light(20) - 0.8).abs() < 0.01, "the camera is at the key light: {}", light(20));
    assert!((light(14) - 0.3 - 0.5 * 0.8_f32.powi(8)).abs() < 0.01);
}

fn with_threads<T: Send>(count: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap().install(work)
}

#[test]
fn the_bytes_do_not_depend_on_the_number_of_threads() {
    let mut random = ChaCha8Rng::seed_from_u64(21);
    let (ball, layers) = dotted_ball(&mut random);
    let ball = ball.moving(Vector3::new(1.0, 0.5, 0.0));
    let camera = mocap(&mut random);
    let take = || {
        let exposure = shot(&camera, &ball, &layers, &[]);
        let grain = Grain { seed: 1, camera: 0, frame: 1001 };
        let bytes = develop(&exposure, &Sensor::default(), grain).unwrap();
        (exposure, bytes)
    };
    let alone = with_threads(1, take);
    assert!(alone == with_threads(2, take) && alone == with_threads(3, take));
}

#[test]
fn eight_samples_a_side_agree_with_four() {
    let mut random = ChaCha8Rng::seed_from_u64(31);
    let (ball, layers) = dotted_ball(&mut random);
    let camera = mocap(&mut random);
    let scene = Scene { face: ball.solid(), layers: &layers, props: &[] };
    let [four, eight] =
        [4, 8].map(|samples_per_side| expose(&camera, &scene, &Film { samples_per_side, ..film() }).unwrap());
    let difference: f64 = four
        .radiance
        .iter()
        .zip(&eight.radiance)
        .map(|(one, other)| f64::from(one[0] - other[0]).powi(2))
        .sum::<f64>()
        / four.radiance.len() as f64;
    assert!(difference.sqrt() < 4e-3, "{}", difference.sqrt());
    let refused = expose(&camera, &scene, &Film { samples_per_side: 7, ..film() });
    assert!(refused.unwrap_err().to_string().contains("samples_per_side"));
}

/// A face with 85 dots and two strokes on its forehead, under a soft light from above.
fn painted_face(vertex_count: usize) -> (Thing, Layers) {
    let face = Body::parametric(1, vertex_count, &[], 0.0);
    let mut thing = Thing::of(&face.mesh).colored([0.55, 0.36, 0.27]);
    let up = Vector3::new(0.1, 0.6, 0.8).normalize();
    thing.irradiance = thing.normals.iter().map(|normal| [0.55 + 0.4 * normal.dot(&up) as f32; 3]).collect();
    let dots = face.markers().into_iter().enumerate().map(|(number, marker)| {
        let home = thing.triangles.iter().position(|corners| corners.contains(&marker.vertex)).unwrap();
        let weights = thing.triangles[home].map(|vertex| f64::from(u8::from(vertex == marker.vertex)));
        thing.dot(
            (home as u32, weights),
            Outline::out_of_round(1.0 + 0.01 * number as f64, 0.15, number as u64),
        )
    });
    let strokes =
        [(38.0, GREEN, 0.0), (46.0, virtual_rig::paint::VIOLET, 0.8)].map(|(height, paint, smear_mm)| {
            let stroke = Stroke {
                id: format!("w{height}"),
                paint,
                left: HalfWidth::through(vec![[-40.0, 0.7], [0.0, 2.5], [40.0, 1.0]]),
                right: HalfWidth::through(vec![[-40.0, 1.0], [40.0, 2.0]]),
                range: [-38.0, 38.0],
                missing: vec![[10.0, 13.0]],
                smear_mm,
            };
            let near = |vertex: &u32| (thing.open[*vertex as usize].y - height).abs() < 12.0;
            let vertices: Vec<u32> = (0..thing.open.len() as u32).filter(near).collect();
            let place = |vertex: &u32| {
                let point = thing.open[*vertex as usize];
                [point.x, point.y - height - 3.0 * (point.x / 25.0).cos()]
            };
            let coordinates = vertices.iter().map(place).collect();
            (stroke, StrokeCoordinates { vertices, coordinates })
        });
    let layers = thing.paint(dots.collect(), strokes.into());
    (thing, layers)
}

/// Before the face, so that it fills the image.
fn portrait(angle: f64) -> Camera {
    let eye = Point3::new(700.0 * angle.sin(), 30.0, 700.0 * angle.cos());
    Camera {
        image_size: [656, 490],
        lens: Lens {
            focal_px: Vector2::repeat(1700.0),
            center_px: Vector2::new(327.5, 244.5),
            distortion: BrownConrady { k1: -0.2, k2: 0.1, p1: 5e-4, p2: -3e-4, k3: 0.0 },
        },
        cam_from_world: Camera::pose_looking_at(eye, Point3::new(0.0, 10.0, 30.0), Vector3::y()),
    }
}

#[test]
#[ignore = "draws pictures to look at"]
fn pictures() {
    let (face, layers) = painted_face(150_000);
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let save = |name: &str, size: [u32; 2], bytes: Vec<u8>| {
        let path = folder.join(format!("film-{name}.png"));
        image::RgbImage::from_raw(size[0], size[1], bytes).unwrap().save(&path).unwrap();
        println!("{}", path.display());
    };
    let grain = Grain { seed: 1, camera: 0, frame: 0 };
    let gloss = Film { gloss: Some(Gloss::default()), ..Film::default() };
    let [still, fast] = [Vector3::zeros(), Vector3::new(3.0, 1.0, 0.0)].map(|way| Thing {
        close: Some(face.open.iter().map(|p| p + way).collect()),
        open: face.open.clone(),
        triangles: face.triangles.clone(),
        normals: face.normals.clone(),
        albedo: face.albedo.clone(),
        irradiance: face.irradiance.clone(),
    });
    for (name, thing, angle, film) in [
        ("front", &face, 0.0, &Film::default()),
        ("side", &still, 0.7, &Film::default()),
        ("fast", &fast, 0.2, &Film::default()),
        ("gloss", &face, -0.4, &gloss),
    ] {
        let camera = portrait(angle);
        let exposure =
            expose(&camera, &Scene { face: thing.solid(), layers: &layers, props: &[] }, film).unwrap();
        let seen = exposure.depth_mm.iter().filter(|depth| depth.is_finite()).count();
        println!("{name}: face fills {:.2}", seen as f64 / exposure.depth_mm.len() as f64);
        save(name, exposure.size, develop(&exposure, &Sensor::default(), grain).unwrap());
    }
    let mut close = portrait(0.1);
    close.lens.focal_px *= 6.0;
    close.cam_from_world =
        Camera::pose_looking_at(Point3::new(60.0, 60.0, 700.0), Point3::new(10.0, 42.0, 50.0), Vector3::y());
    let exposure =
        expose(&close, &Scene { face: face.solid(), layers: &layers, props: &[] }, &Film::default()).unwrap();
    save("close", exposure.size, develop(&exposure, &Sensor::default(), grain).unwrap());
}

/// A dome of 150 000 vertices, all facing the camera, with 85 dots; it fills 60 % of the image.
fn dome() -> (Thing, Layers, Camera) {
    let height = |x: f64, y: f64| 60.0 - ((x - 85.0).powi(2) + (y - 85.0).powi(2)) / 120.0;
    let thing = Thing::of(&shapes::relief(387, 170.0 / 387.0, height)).colored([0.5, 0.35, 0.25]);
    let dots = (0..85).map(|number| {
        let place =
            Point3::new(15.0 + 15.5 * f64::from(number % 10), 15.0 + 16.0 * f64::from(number / 10), 0.0);
        let place = Point3::new(place.x, place.y, height(place.x, place.y));
        thing.dot_near(place, Outline::out_of_round(1.5, 0.15, number as u64))
    });
    let layers = thing.paint(dots.collect(), vec![]);
    let eye = Point3::new(85.0, 85.0, 800.0);
    let mut camera = portrait(0.0);
    camera.cam_from_world = Camera::pose_looking_at(eye, Point3::new(85.0, 85.0, 30.0), Vector3::y());
    camera.lens.focal_px *= 1.3;
    (thing, layers, camera)
}

#[test]
#[ignore = "reports speed; run in release, alone"]
#[allow(clippy::disallowed_methods, reason = "a report of speed reads the clock")]
fn speed() {
    let (still, layers, camera) = dome();
    let way = Vector3::new(0.4, 0.2, 0.1);
    let moving = Thing { close: Some(still.open.iter().map(|p| p + way).collect()), ..dome().0 };
    let grain = Grain { seed: 1, camera: 0, frame: 0 };
    for (name, thing) in [("still", &still), ("moving", &moving)] {
        let mut times: Vec<[f64; 2]> = (0..30)
            .map(|_| {
                with_threads(1, || {
                    let start = std::time::Instant::now();
                    let exposure = shot(&camera, thing, &layers, &[]);
                    let exposed = start.elapsed().as_secs_f64();
                    let filled = exposure.depth_mm.iter().filter(|depth| depth.is_finite()).count();
                    let share = filled as f64 / exposure.depth_mm.len() as f64;
                    assert!((0.6..0.75).contains(&share), "{share}");
                    let start = std::time::Instant::now();
                    develop(&exposure, &Sensor::default(), grain).unwrap();
                    [1e3 * exposed, 1e3 * start.elapsed().as_secs_f64()]
                })
            })
            .collect();
        times.sort_by(|one, other| one[0].total_cmp(&other[0]));
        let sensor = times.iter().map(|time| time[1]).fold(f64::INFINITY, f64::min);
        println!(
            "{name}: exposed in {:.1} ms (median {:.1}), developed in {sensor:.1} ms, one thread",
            times[0][0], times[15][0]
        );
    }
}
