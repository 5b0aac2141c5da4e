//! Times the rays of the light, and writes them for another ray tracer: `rays FOLDER [MESH]`.
//!
//! The rays are those that lighting casts from all vertices of MESH (any that `artifact` reads, in mm), in the order in
//! which it casts them; without a mesh, from a groove. One thread. FOLDER gets `vertices`, `triangles`, `origins`, `directions`
//! and `occluded` (what we found), all `.npy`. One line of JSON says how fast it went.
#![allow(clippy::disallowed_methods, reason = "measures time and writes a folder for the peer")]

use nalgebra::{Point3, Vector3};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use virtual_rig::light::{Ambient, Scene, ambient, groove::Groove, irradiance};

use obvhs::BvhBuildParams;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::Ray;
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;

/// About this many rays are cast.
const RAYS: usize = 4_000_000;
const REPEATS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let folder = arguments.next().ok_or("rays FOLDER [MESH]")?;
    let (positions, triangles) = match arguments.next() {
        Some(path) => {
            let mesh = artifact::read_mesh(&path, artifact::Unit::Mm)?;
            let triangles = mesh.triangles();
            (mesh.positions, triangles)
        }
        None => {
            let groove = Groove::new(0.5);
            (groove.positions, groove.triangles)
        }
    };
    let line = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()?
        .install(|| measure(&folder, &positions, &triangles))?;
    writeln!(std::io::stdout(), "{line}")?;
    Ok(())
}

fn measure(folder: &Path, positions: &[Point3<f64>], triangles: &[[u32; 3]]) -> std::io::Result<String> {
    let start = Instant::now();
    let scene = Scene::build(positions, triangles, &[]);
    let build = start.elapsed();
    let normals = mesh::vertex_normals(positions, triangles);
    let sky = Ambient { rays: (RAYS / positions.len()).max(8) as u32, ..Ambient::default() };
    let rays = ambient::rays(&scene, positions, &normals, &sky);

    let beams = median(|| drop(irradiance(&scene, positions, &normals, &sky)));
    let mut occluded = vec![];
    let single = median(|| occluded = one_by_one(&scene, &rays));
    let wide = median_of(|| cwbvh(positions, triangles, &scene, &rays));
    write_folder(folder, &scene, positions, triangles, &rays, &occluded)?;
    let rate = |time: Duration| rays.len() as f64 / time.as_secs_f64();
    Ok(format!(
        r#"{{"rays": {}, "triangles": {}, "build_s": {:.3}, "beams_per_s": {:.0}, "bvh2_per_s": {:.0}, "cwbvh_per_s": {:.0}}}"#,
        rays.len(),
        triangles.len(),
        build.as_secs_f64(),
        rate(beams),
        rate(single),
        rate(wide)
    ))
}

fn one_by_one(scene: &Scene, rays: &[[[f32; 3]; 2]]) -> Vec<u8> {
    let center = scene.center().coords;
    let point = |origin: [f32; 3]| Point3::from(Vector3::from(origin).cast::<f64>() + center);
    rays.iter()
        .map(|&[origin, direction]| {
            u8::from(scene.occluded(&point(origin), &Vector3::from(direction).cast(), f64::INFINITY))
        })
        .collect()
}

/// The library's wide compressed tree.
fn cwbvh(
    positions: &[Point3<f64>],
    triangles: &[[u32; 3]],
    scene: &Scene,
    rays: &[[[f32; 3]; 2]],
) -> Duration {
    let corner = |vertex: u32| local(scene, &positions[vertex as usize]).into();
    let list: Vec<Triangle> =
        triangles.iter().map(|&[a, b, c]| Triangle { v0: corner(a), v1: corner(b), v2: corner(c) }).collect();
    let bvh = build_cwbvh_from_tris(&list, BvhBuildParams::medium_build(), &mut Duration::default());
    let list: Vec<RtTriangle> =
        bvh.primitive_indices.iter().map(|&id| RtTriangle::from(&list[id as usize])).collect();
    let start = Instant::now();
    let hits = rays
        .iter()
        .filter(|&&[origin, direction]| {
            let ray = Ray::new_inf(origin.into(), direction.into());
            !bvh.ray_traverse_miss(ray, |ray, at| list[at].intersect(ray))
        })
        .count();
    std::hint::black_box(hits);
    start.elapsed()
}

fn local(scene: &Scene, point: &Point3<f64>) -> [f32; 3] {
    let offset = point - scene.center();
    [offset.x as f32, offset.y as f32, offset.z as f32]
}

fn median(mut work: impl FnMut()) -> Duration {
    median_of(|| {
        let start = Instant::now();
        work();
        start.elapsed()
    })
}

fn median_of(work: impl FnMut() -> Duration) -> Duration {
    let mut times: Vec<Duration> = std::iter::repeat_with(work).take(REPEATS).collect();
    times.sort();
    times[REPEATS / 2]
}

fn write_folder(
    folder: &Path,
    scene: &Scene,
    positions: &[Point3<f64>],
    triangles: &[[u32; 3]],
    rays: &[[[f32; 3]; 2]],
    occluded: &[u8],
) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let floats = |rows: &mut dyn Iterator<Item = [f32; 3]>| {
        rows.flatten().flat_map(f32::to_le_bytes).collect::<Vec<u8>>()
    };
    let vertices = floats(&mut positions.iter().map(|point| local(scene, point)));
    write_npy(&folder.join("vertices.npy"), "<f4", &[positions.len(), 3], &vertices)?;
    let corners: Vec<u8> = triangles.iter().flatten().flat_map(|vertex| vertex.to_le_bytes()).collect();
    write_npy(&folder.join("triangles.npy"), "<u4", &[triangles.len(), 3], &corners)?;
    for (name, part) in [("origins.npy", 0), ("directions.npy", 1)] {
        let column = floats(&mut rays.iter().map(|ray| ray[part]));
        write_npy(&folder.join(name), "<f4", &[rays.len(), 3], &column)?;
    }
    write_npy(&folder.join("occluded.npy"), "|u1", &[occluded.len()], occluded)
}

fn write_npy(path: &Path, kind: &str, shape: &[usize], bytes: &[u8]) -> std::io::Result<()> {
    let shape: String = shape.iter().map(|size| format!("{size},")).collect();
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}");
    let width = (10 + header.len() + 1).next_multiple_of(64) - 10;
    header = format!("{header:<padded$}\n", padded = width - 1);
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    file.write_all(b"\x93NUMPY\x01\x00")?;
    file.write_all(&(width as u16).to_le_bytes())?;
    file.write_all(header.as_bytes())?;
    file.write_all(bytes)
}
