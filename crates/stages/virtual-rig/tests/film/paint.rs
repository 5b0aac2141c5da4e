//! Strokes, dots, light and gloss.

use crate::dots::paint_in;
use crate::scene::{Thing, film, ruler, shot};
use camera::{Camera, Lens};
use nalgebra::{Point3, Vector2, Vector3};
use testkit::shapes;
use virtual_rig::film::{Film, Gloss, Scene, expose};
use virtual_rig::paint::{BLUE, GREEN, HalfWidth, Layers, Outline, Stroke, StrokeCoordinates, Texture};

/// A stroke along x in the middle of a grid of 40 mm, and a dot on it.
fn stroke_and_dot(grid: &Thing, missing: Vec<[f64; 2]>) -> Layers {
    textured(grid, missing, Texture::default())
}

fn textured(grid: &Thing, missing: Vec<[f64; 2]>, texture: Texture) -> Layers {
    let stroke = Stroke {
        id: "w1".to_string(),
        paint: GREEN,
        left: HalfWidth::through(vec![[5.0, 1.0], [35.0, 3.0]]),
        right: HalfWidth::through(vec![[5.0, 1.5]]),
        range: [5.0, 35.0],
        missing,
        smear_mm: 0.0,
        texture,
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

#[test]
fn uneven_paint_is_as_bright_on_average() {
    let grid = Thing::of(&shapes::grid(40, 1.0));
    let mean = |deviation: f64| {
        let layers = textured(&grid, vec![], Texture { deviation, seed: 3 });
        let exposure = shot(&above_the_grid(), &grid, &layers, &[]);
        let whole = exposure.covers.iter().filter(|cover| cover.layer == 0 && cover.share > 0.999);
        let lights: Vec<f64> =
            whole.map(|cover| f64::from(exposure.radiance[cover.pixel as usize][1])).collect();
        let mean = lights.iter().sum::<f64>() / lights.len() as f64;
        let square =
            lights.iter().map(|light| (light / mean - 1.0).powi(2)).sum::<f64>() / lights.len() as f64;
        [mean, square.sqrt()]
    };
    let ([even, none], [uneven, some]) = (mean(0.0), mean(0.02));
    assert!((uneven / even - 1.0).abs() < 0.004 && none < 1e-4, "{even} {uneven} {none}");
    assert!((0.012..0.024).contains(&some), "{some}");
}
