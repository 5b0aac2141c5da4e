//! Pictures to look at and speed, by hand.

use crate::scene::{Thing, shot};
use crate::with_threads;
use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Point3, Vector2, Vector3};
use testkit::shapes;
use virtual_rig::body::Body;
use virtual_rig::film::{Film, Gloss, Grain, Scene, Sensor, develop, expose};
use virtual_rig::paint::{GREEN, HalfWidth, Layers, Outline, Stroke, StrokeCoordinates};

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
                texture: virtual_rig::paint::Texture::default(),
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
