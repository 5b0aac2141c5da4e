//! Normal maps: conventions, seams, and maps that are not what they are said to be.
#![allow(clippy::expect_used, reason = "a test may fail")]

use artifact::GreenAxis;
use mesh::{Mesh, vertex_normals};
use nalgebra::{Vector2, Vector3};
use scan_refine::{Error, NormalMap, Params, Space, refine};
use testkit::shapes;

const SIDE: usize = 256;

/// A map of `SIDE` × `SIDE` texels from a vector per (u, v).
fn map(vector: impl Fn(f64, f64) -> Vector3<f64>) -> NormalMap {
    let share = |texel: usize| {
        let (u, v) = ((texel % SIDE) as f64 + 0.5, SIDE as f64 - (texel / SIDE) as f64 - 0.5);
        let vector = vector(u / SIDE as f64, v / SIDE as f64);
        [0, 1, 2].map(|axis| (0.5 * (vector[axis] + 1.0) * 65535.0).round() / 65535.0)
    };
    NormalMap::new(SIDE, SIDE, (0..SIDE * SIDE).map(share)).expect("a map")
}

/// A cylinder's part of radius 20 mm and 90°, 20 mm long, u around it and v along it.
fn half_pipe() -> Mesh {
    let mut mesh = shapes::grid(40, 0.5);
    for (point, uv) in mesh.positions.iter_mut().zip(&mesh.uvs) {
        let angle = (uv.x - 0.5) * std::f64::consts::FRAC_PI_2;
        *point = nalgebra::Point3::new(20.0 * angle.sin(), 20.0 * uv.y, 20.0 * angle.cos());
    }
    mesh
}

fn outward(u: f64) -> Vector3<f64> {
    let angle = (u - 0.5) * std::f64::consts::FRAC_PI_2;
    Vector3::new(angle.sin(), 0.0, angle.cos())
}

/// A lean in tangent space that differs along u and v.
fn lean(u: f64, v: f64) -> Vector3<f64> {
    Vector3::new(0.15 * (9.0 * u).sin(), 0.25 * (7.0 * v).cos(), 1.0).normalize()
}

#[test]
fn both_spaces_say_the_same() {
    let pipe = half_pipe();
    let tangent = map(lean).measure(&pipe, Space::Tangent, GreenAxis::Opengl).expect("tangent");
    let turned = |u: f64, v: f64| {
        let (normal, lean) = (outward(u), lean(u, v));
        let along = Vector3::new(normal.z, 0.0, -normal.x);
        lean.x * along + lean.y * Vector3::y() + lean.z * normal
    };
    let object = map(turned).measure(&pipe, Space::Object, GreenAxis::Opengl).expect("object");
    let expected: Vec<Vector3<f64>> = pipe.uvs.iter().map(|uv| turned(uv.x, uv.y)).collect();
    // Vertices on the texture's border see the other side of it, since it repeats: a texel of 256 there.
    assert!(object.mean_degrees(&expected) < 0.5, "{}", object.mean_degrees(&expected));
    assert!(tangent.mean_degrees(&expected) < 0.5, "{}", tangent.mean_degrees(&expected));
    let down = map(lean).measure(&pipe, Space::Tangent, GreenAxis::Directx).expect("turned over");
    assert!(down.mean_degrees(&expected) > 5.0);
    let mirrored = map(|u, v| Vector3::new(lean(u, v).x, -lean(u, v).y, lean(u, v).z));
    let directx = mirrored.measure(&pipe, Space::Tangent, GreenAxis::Directx).expect("DirectX");
    assert!(directx.mean_degrees(&expected) < 0.5);
}

#[test]
fn mirrored_textures_keep_green_along_v() {
    let mut pipe = half_pipe();
    let mirrored = |uv: &Vector2<f64>| Vector2::new(1.0 - uv.x, uv.y);
    pipe.uvs = pipe.uvs.iter().map(mirrored).collect();
    let measured =
        map(|_, _| Vector3::new(0.3, 0.2, 1.0).normalize()).measure(&pipe, Space::Tangent, GreenAxis::Opengl);
    let measured = measured.expect("mirrored");
    let expected: Vec<Vector3<f64>> = pipe
        .uvs
        .iter()
        .map(|uv| {
            let normal = outward(1.0 - uv.x);
            let along = Vector3::new(-normal.z, 0.0, normal.x);
            Vector3::normalize(&(0.3 * along + 0.2 * Vector3::y() + normal))
        })
        .collect();
    assert!(measured.mean_degrees(&expected) < 0.7, "{}", measured.mean_degrees(&expected));
}

#[test]
fn a_fine_map_is_averaged_not_picked_from() {
    // Stripes of one texel that lean to and fro: at the mesh's scale they cancel.
    let stripes = map(|u, _| {
        let side = if ((u * SIDE as f64) as usize).is_multiple_of(2) { 0.4 } else { -0.4 };
        Vector3::new(side, 0.0, 1.0).normalize()
    });
    let coarse = shapes::grid(8, 2.0);
    let measured = stripes.measure(&coarse, Space::Tangent, GreenAxis::Opengl).expect("stripes");
    let straight = measured.mean_degrees(&vec![Vector3::z(); coarse.positions.len()]);
    assert!(straight < 2.0, "{straight}°, where each stripe leans by 21.8°");
}

#[test]
fn a_map_in_the_other_space_is_named() {
    let pipe = half_pipe();
    let object = map(|u, _| outward(u));
    let as_tangent = object.measure(&pipe, Space::Tangent, GreenAxis::Opengl);
    assert!(
        matches!(as_tangent, Err(Error::OtherSpace { stated: Space::Tangent, other: Space::Object, .. })),
        "{as_tangent:?}"
    );
    let as_object = map(lean).measure(&pipe, Space::Object, GreenAxis::Opengl);
    assert!(
        matches!(as_object, Err(Error::OtherSpace { stated: Space::Object, other: Space::Tangent, .. })),
        "{as_object:?}"
    );
    let backwards = map(|u, v| -lean(u, v)).measure(&pipe, Space::Tangent, GreenAxis::Opengl);
    assert!(matches!(backwards, Err(Error::Disagree { .. })), "{backwards:?}");
}

#[test]
fn maps_that_say_nothing_are_refused() {
    let all = |share: [f64; 3]| NormalMap::new(2, 2, vec![share; 4].into_iter());
    for unset in [[0.0; 3], [1.0; 3], [0.5; 3]] {
        assert!(matches!(all(unset), Err(Error::NothingMeasured { .. })), "{unset:?}");
    }
    // (0, 0, 1) taken through sRGB.
    assert!(matches!(all([0.735, 0.735, 1.0]), Err(Error::NotUnit { .. })));
    let flat = all([128.0 / 255.0, 128.0 / 255.0, 1.0]).expect("a map");
    let grid = shapes::grid(4, 1.0);
    assert!(matches!(flat.measure(&grid, Space::Tangent, GreenAxis::Opengl), Err(Error::Flat { .. })));
    assert_eq!(
        NormalMap::new(3, 2, vec![[0.5; 3]; 4].into_iter()),
        Err(Error::MapSize { width: 3, height: 2, values: 4 })
    );
    let bare = map(lean).measure(&shapes::sphere(1.0, 4), Space::Object, GreenAxis::Opengl);
    assert_eq!(bare, Err(Error::NoTextureCoordinates));
}

#[test]
fn unset_texels_leave_their_vertices_alone() {
    let grid = shapes::grid(20, 0.5);
    let half = map(|u, v| if u < 0.5 { lean(u, v) } else { Vector3::new(-1.0, -1.0, -1.0) });
    let measured = half.measure(&grid, Space::Tangent, GreenAxis::Opengl).expect("half");
    assert!((0.4..0.6).contains(&measured.coverage()), "{}", measured.coverage());
    let refined = refine(&grid, &measured, &Params::default()).expect("refined");
    let far =
        refined.positions.iter().filter(|point| point.x > 6.0).map(|point| point.z.abs()).fold(0.0, f64::max);
    assert!(far < 1e-9, "{far} mm");
    assert!(refined.report.moved_max_mm > 0.01);
    let normals = vertex_normals(&refined.positions, &grid.triangles());
    assert!(measured.mean_degrees(&normals) < measured.mean_degrees(&vec![Vector3::z(); normals.len()]));
}
