//! Laws of the pictures: coverage, visibility, sameness, framing, colours.

#![allow(clippy::unwrap_used, reason = "a test may fail by panic")]

mod scene;

use camera::Pinhole;
use image::{Rgb, RgbImage};
use mesh::Mesh;
use nalgebra::Point3;
use preview::{
    Axes, Backdrop, CloseUp, ColorMap, Error, Frame, Look, Spread, Surface, ValueRange, View, render,
};
use proptest::prelude::*;
use scene::{sphere, square};

const SIZE: [u32; 2] = [160, 120];

fn camera_of(mesh: &Mesh, view: View, axes: Axes, size: [u32; 2]) -> Pinhole {
    let mut frame = Frame::around(view, axes, &mesh.positions);
    frame.include(&mesh.positions);
    frame.camera(size, &CloseUp::None)
}

fn picture(mesh: &Mesh, look: &Look) -> RgbImage {
    render(&Surface::of(mesh), &camera_of(mesh, View::FRONT, Axes::default(), SIZE), SIZE, look)
}

fn plain() -> Look {
    Look { occlusion: 0.0, ..Look::default() }
}

fn is_backdrop(pixel: &Rgb<u8>) -> bool {
    pixel.0 == Backdrop::Light.color()
}

fn joined(meshes: &[Mesh]) -> Mesh {
    let mut all = Mesh::default();
    for mesh in meshes {
        let first = all.positions.len() as u32;
        all.positions.extend(&mesh.positions);
        for polygon in mesh.polygons.iter() {
            all.polygons.push(&polygon.iter().map(|vertex| vertex + first).collect::<Vec<_>>());
        }
    }
    all
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let mesh = sphere(90.0, 24);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| picture(&mesh, &Look { wireframe: true, ..Look::default() })).into_raw()
    };
    let one = with(1);
    assert_eq!(one, with(2));
    assert_eq!(one, with(7));
}

#[test]
fn a_sphere_covers_its_disc_without_cracks() {
    let mesh = sphere(80.0, 60);
    let camera = camera_of(&mesh, View::FRONT, Axes::default(), SIZE);
    let picture = picture(&mesh, &plain());
    for row in 0..SIZE[1] {
        let seen: Vec<u32> = (0..SIZE[0]).filter(|&x| !is_backdrop(picture.get_pixel(x, row))).collect();
        assert!(seen.windows(2).all(|pair| pair[1] == pair[0] + 1), "a crack in row {row}");
    }
    // Seen from d, the outline of a sphere of radius r is a circle of radius f r / √(d² − r²).
    let distance = camera.cam_from_world.translation.vector.norm();
    let radius = camera.focal_px * 80.0 / (distance * distance - 80.0 * 80.0).sqrt();
    let seen = picture.pixels().filter(|pixel| !is_backdrop(pixel)).count() as f64;
    let area = std::f64::consts::PI * radius * radius;
    // Pixels that are covered in part count as a whole: half a pixel along the outline, on average.
    let outline = std::f64::consts::TAU * radius;
    assert!((seen - area - 0.5 * outline).abs() < 0.25 * outline, "{seen} pixels for an area of {area}");
}

#[test]
fn triangles_of_a_pixel_and_less_leave_no_crack() {
    let mesh = sphere(80.0, 220);
    let picture = picture(&mesh, &plain());
    for row in 0..SIZE[1] {
        let seen: Vec<u32> = (0..SIZE[0]).filter(|&x| !is_backdrop(picture.get_pixel(x, row))).collect();
        assert!(seen.windows(2).all(|pair| pair[1] == pair[0] + 1), "a crack in row {row}");
    }
}

#[test]
fn a_shared_edge_through_the_middle_of_pixels_leaves_no_gap() {
    let fan = Mesh::from_triangles(
        vec![[-50., 0., 0.], [0., -50., 0.], [0., 50., 0.], [50., 0., 0.]],
        &[[0, 1, 2], [1, 3, 2]],
    );
    let size = [161, 121];
    let camera = camera_of(&fan, View::FRONT, Axes::default(), size);
    assert_eq!(camera.project(&fan.positions[1]).0.x, 80.0, "the edge runs through pixel centres");
    let picture = render(&Surface::of(&fan), &camera, size, &Look { supersampling: 1, ..plain() });
    assert!((20..100).all(|row| !is_backdrop(picture.get_pixel(80, row))));
}

#[test]
fn the_nearer_surface_is_seen_whatever_comes_first() {
    let (near, far) = (square(20.0, 30.0), sphere(60.0, 20));
    let camera = camera_of(&far, View::FRONT, Axes::default(), SIZE);
    let draw = |mesh: &Mesh| {
        let mut surface = Surface::of(mesh);
        surface.values =
            surface.positions.iter().map(|point| if point.z == 30.0 { 1.0 } else { 0.0 }).collect();
        render(&surface, &camera, SIZE, &plain())
    };
    let behind = draw(&joined(&[near.clone(), far.clone()]));
    assert_eq!(behind, draw(&joined(&[far.clone(), near])), "the order of faces shows");
    // The square lies inside the sphere (front at 60): it must not shine through.
    let middle = behind.get_pixel(80, 60).0;
    assert!(middle[2] > 120, "the hidden dark red shows: {middle:?}");
    let before = draw(&joined(&[square(20.0, 30.0), square(60.0, -10.0)]));
    assert!(before.get_pixel(80, 60).0[2] < 90 && before.get_pixel(110, 60).0[2] > 120);
}

#[test]
fn the_inside_of_a_surface_is_dark() {
    let mut outside = square(50.0, 0.0);
    let bright = picture(&outside, &plain()).get_pixel(80, 60).0;
    outside.polygons = mesh::Polygons::default();
    outside.polygons.push(&[0, 3, 2, 1]);
    let dark = picture(&outside, &plain()).get_pixel(80, 60).0;
    assert!(dark[0] < bright[0] / 2, "{dark:?} against {bright:?}");
}

#[test]
fn renaming_the_axes_changes_no_pixel() {
    let mut mesh = sphere(70.0, 16);
    mesh.positions.iter_mut().for_each(|point| point.x *= if point.y > 0.0 { 0.6 } else { 1.0 });
    // y up, z front becomes z up, −y front: (x, y, z) → (x, −z, y).
    let turned = mesh.with_positions(mesh.positions.iter().map(|p| Point3::new(p.x, -p.z, p.y)).collect());
    let axes = Axes::new("z".parse().unwrap(), "-y".parse().unwrap()).unwrap();
    let view: View = "35,10".parse().unwrap();
    let draw = |mesh: &Mesh, axes: Axes| {
        render(&Surface::of(mesh), &camera_of(mesh, view, axes, SIZE), SIZE, &Look::default())
    };
    let (one, two) = (draw(&mesh, Axes::default()), draw(&turned, axes));
    let apart =
        one.pixels().zip(two.pixels()).filter(|(a, b)| a.0.iter().zip(b.0).any(|(x, y)| x.abs_diff(y) > 2));
    assert!(apart.count() < 20, "only rounding may differ");
}

#[test]
fn edges_are_smooth() {
    let picture = picture(&square(50.0, 0.0), &plain());
    let levels: std::collections::BTreeSet<u8> = {
        let turned = {
            let mut mesh = square(50.0, 0.0);
            let turn = nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), 0.05);
            mesh.positions.iter_mut().for_each(|point| *point = turn * *point);
            mesh
        };
        render(&Surface::of(&turned), &camera_of(&turned, View::FRONT, Axes::default(), SIZE), SIZE, &plain())
            .pixels()
            .map(|pixel| pixel.0[1])
            .collect()
    };
    assert!(levels.len() >= 9, "a slanted edge shows {} levels", levels.len());
    assert!(picture.pixels().any(|pixel| !is_backdrop(pixel)));
}

#[test]
fn wireframes_show_sides_of_polygons_but_no_diagonals() {
    let mesh = square(50.0, 0.0);
    let [bare, wired] = [false, true].map(|wireframe| picture(&mesh, &Look { wireframe, ..plain() }));
    let changed = |x: u32, y: u32| bare.get_pixel(x, y) != wired.get_pixel(x, y);
    assert!((20..140).any(|x| changed(x, 60)), "the upright sides show");
    let camera = camera_of(&mesh, View::FRONT, Axes::default(), SIZE);
    let middle = camera.project(&Point3::new(0.0, 0.0, 0.0)).0;
    let around = |x: i64, y: i64| changed((middle.x as i64 + x) as u32, (middle.y as i64 + y) as u32);
    assert!(!(-20..20).any(|x| (-20..20).any(|y| around(x, y))), "a diagonal shows");
}

#[test]
fn dots_show_on_the_near_side_only() {
    let mesh = sphere(60.0, 16);
    let camera = camera_of(&mesh, View::FRONT, Axes::default(), SIZE);
    let vertex_at = |z: f64| {
        let distance = |p: &Point3<f64>| (p - Point3::new(0.0, 0.0, z)).norm();
        let by =
            |a: &usize, b: &usize| distance(&mesh.positions[*a]).total_cmp(&distance(&mesh.positions[*b]));
        (0..mesh.positions.len()).min_by(by).unwrap() as u32
    };
    let with = |dots: Vec<u32>| {
        let surface = Surface { dots, ..Surface::of(&mesh) };
        render(&surface, &camera, SIZE, &plain())
    };
    let bare = with(Vec::new());
    assert_ne!(with(vec![vertex_at(60.0)]), bare, "in front");
    assert_eq!(with(vec![vertex_at(-60.0)]), bare, "behind");
}

#[test]
fn hollows_are_darker_than_ridges() {
    let fold = |depth: f64| {
        Mesh::from_triangles(
            vec![
                [-60., -50., 0.],
                [0., -50., depth],
                [60., -50., 0.],
                [-60., 50., 0.],
                [0., 50., depth],
                [60., 50., 0.],
            ],
            &[[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]],
        )
    };
    let darkening = |mesh: &Mesh| {
        let level = |occlusion| {
            i32::from(picture(mesh, &Look { occlusion, ..Look::default() }).get_pixel(80, 60).0[1])
        };
        level(0.0) - level(1.0)
    };
    let [valley, ridge, plane] = [-60.0, 60.0, 0.0].map(|depth| darkening(&fold(depth)));
    assert!(valley > 30 && ridge * 2 < valley && plane == 0, "valley {valley}, ridge {ridge}, plane {plane}");
}

#[test]
fn values_beyond_the_range_take_the_colours_of_its_ends() {
    let mesh = square(50.0, 0.0);
    let color = |value: f64| {
        let mut surface = Surface::of(&mesh);
        surface.values = vec![value; 4];
        let look = Look { range: ValueRange { low: 1.0, high: 2.0 }, ..plain() };
        *render(&surface, &camera_of(&mesh, View::FRONT, Axes::default(), SIZE), SIZE, &look)
            .get_pixel(80, 60)
    };
    assert_eq!(color(0.0), color(1.0));
    assert_eq!(color(2.0), color(9.0));
    assert_ne!(color(1.0), color(2.0));
}

#[test]
fn lightness_runs_one_way_along_each_map() {
    for map in [ColorMap::Viridis, ColorMap::Ember] {
        let lightness = |step: u32| {
            let [r, g, b] = map.at(f64::from(step) / 50.0).map(|value| (value / 255.0).powf(2.2));
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let rises = (0..50).all(|step| lightness(step + 1) > lightness(step));
        let falls = (0..50).all(|step| lightness(step + 1) < lightness(step));
        assert!(rises || falls, "{map:?}");
    }
    assert_eq!(ColorMap::Viridis.at(0.0), [68.0, 1.0, 84.0]);
    assert_eq!(ColorMap::Viridis.at(1.0), [253.0, 231.0, 37.0]);
}

#[test]
fn spreads_and_ranges_are_as_defined() {
    let values: Vec<f64> = (1..=100).map(f64::from).collect();
    assert_eq!(Spread::of(&values), Spread { mean: 50.5, p95: 95.0, max: 100.0 });
    assert_eq!(ValueRange::up_to(2.3), ValueRange { low: 0.0, high: 3.0 });
    assert_eq!(ValueRange::up_to(0.5).high, 0.5);
    assert_eq!(ValueRange::up_to(0.0).high, 1.0);
    assert_eq!("0.5-2".parse::<ValueRange>(), Ok(ValueRange { low: 0.5, high: 2.0 }));
    assert!("2-1".parse::<ValueRange>().is_err());
    let origin = [Point3::origin()];
    assert_eq!(preview::distances(&origin, &[Point3::new(3.0, 4.0, 0.0)]), Ok(vec![5.0]));
    assert_eq!(preview::distances(&origin, &[]), Err(Error::VertexCount { count: 1, other: 0 }));
}

#[test]
fn a_close_up_of_a_box_fills_the_picture() {
    let mesh = sphere(100.0, 12);
    let frame = Frame::around(View::FRONT, Axes::default(), &mesh.positions);
    let camera = frame.camera([200, 200], &CloseUp::Box([-10.0, 20.0, 90.0], [10.0, 40.0, 90.0]));
    let corner = camera.project(&Point3::new(-10.0, 40.0, 90.0)).0;
    assert!((corner.x - 9.5).abs() < 0.6 && (corner.y - 9.5).abs() < 0.6, "{corner}");
}

#[test]
fn the_left_side_of_a_face_is_seen_from_its_left() {
    let left: View = "left".parse().unwrap();
    assert!((left.toward_camera(Axes::default()) - nalgebra::Vector3::x()).norm() < 1e-12);
    assert!("0,95".parse::<View>().is_err());
    assert!(Axes::new("y".parse().unwrap(), "-y".parse().unwrap()).is_err());
}

proptest! {
    #[test]
    fn everything_included_is_in_the_picture(
        points in prop::collection::vec(prop::array::uniform3(-500.0..500.0f64), 2..40),
        azimuth in -180.0..180.0f64,
        elevation in -89.0..89.0f64,
        width in 16u32..400,
        height in 16u32..400,
    ) {
        let points: Vec<Point3<f64>> = points.into_iter().map(Point3::from).collect();
        let view: View = format!("{azimuth},{elevation}").parse().unwrap();
        let mut frame = Frame::around(view, Axes::default(), &points);
        frame.include(&points);
        let camera = frame.camera([width, height], &CloseUp::None);
        for point in &points {
            let (image, depth) = camera.project(point);
            prop_assert!(depth > 0.0);
            prop_assert!(image.x > -0.5 && image.x < f64::from(width) - 0.5);
            prop_assert!(image.y > -0.5 && image.y < f64::from(height) - 0.5);
        }
    }
}
