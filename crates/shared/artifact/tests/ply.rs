//! PLY, in and out.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod support;

use artifact::{Unit, read_mesh, write_mesh};
use mesh::{Mesh, NO_UV};
use nalgebra::Vector2;
use proptest::prelude::*;
use support::{Place, bytes, fixture, refusal, says};

/// A quad, a triangle and a pentagon.
fn polygons() -> Mesh {
    let mut mesh = Mesh::from_triangles((0..7).map(|i| [f64::from(i) / 3.0, 0.1, -7.25]).collect(), &[]);
    mesh.polygons.push(&[0, 1, 2, 3]);
    mesh.polygons.push(&[2, 3, 4]);
    mesh.polygons.push(&[0, 2, 4, 5, 6]);
    mesh
}

fn written(mesh: &Mesh, unit: Unit) -> (Place, std::path::PathBuf) {
    let place = Place::new();
    let path = place.path("mesh.ply");
    write_mesh(&path, mesh, unit).unwrap().publish().unwrap();
    (place, path)
}

fn round_trip(mesh: &Mesh) -> Mesh {
    read_mesh(&written(mesh, Unit::Mm).1, Unit::Mm).unwrap()
}

/// What the reader says about a file.
fn refused(file: impl AsRef<[u8]>) -> String {
    refusal(read_mesh(&Place::new().file("mesh.ply", file), Unit::Mm))
}

#[test]
fn positions_and_polygons_survive_exactly() {
    let mesh = polygons();
    assert_eq!(round_trip(&mesh), mesh);
}

#[test]
fn the_unit_scales_in_and_out() {
    let mesh = polygons();
    let (_place, path) = written(&mesh, Unit::M);
    let as_mm = read_mesh(&path, Unit::Mm).unwrap();
    assert!((as_mm.positions[6].x - 0.002).abs() < 1e-15);
    let back = read_mesh(&path, Unit::M).unwrap();
    let error = back.positions.iter().zip(&mesh.positions).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(error < 1e-14, "{error}");
}

#[test]
fn texture_coordinates_of_vertices_survive() {
    let mut mesh = polygons();
    mesh.uvs = (0..7).map(|i| Vector2::new(f64::from(i) / 4.0, 1.5)).collect();
    mesh.corner_uvs = mesh.polygons.corners().to_vec();
    let header = String::from_utf8_lossy(&bytes(&written(&mesh, Unit::Mm).1)).into_owned();
    says(&header, &["property float s\nproperty float t\n"]);
    assert_eq!(round_trip(&mesh), mesh);
}

#[test]
fn texture_seams_and_faces_without_texture_survive() {
    let mut mesh = polygons();
    // Vertex 2 has another coordinate in each of its faces; the triangle has none.
    mesh.uvs = (0..9).map(|i| Vector2::new(f64::from(i) / 4.0, 0.25)).collect();
    mesh.corner_uvs = vec![0, 1, 2, 3, NO_UV, NO_UV, NO_UV, 4, 5, 6, 7, 8];
    let header = String::from_utf8_lossy(&bytes(&written(&mesh, Unit::Mm).1)).into_owned();
    says(&header, &["property list uchar float texcoord\n"]);
    assert_eq!(round_trip(&mesh), mesh);
}

#[test]
fn colors_survive_to_a_byte() {
    let mut mesh = polygons();
    mesh.colors = (0..7).map(|i| [i as f32 * 51.0 / 255.0, 0.5, 2.0]).take(7).collect();
    mesh.colors[6] = [1.0, 0.0, -1.0];
    let back = round_trip(&mesh);
    for (color, was) in back.colors.iter().zip(&mesh.colors) {
        for (x, was) in color.iter().zip(was) {
            assert!((x - was.clamp(0.0, 1.0)).abs() <= 0.5 / 255.0 + 1e-6, "{color:?}");
        }
    }
}

#[test]
fn a_polygon_of_many_corners_survives() {
    let mut mesh = Mesh::from_triangles((0..300).map(|i| [f64::from(i), 0.0, 0.0]).collect(), &[[0, 1, 2]]);
    mesh.polygons.push(&(0..300).collect::<Vec<_>>());
    assert_eq!(round_trip(&mesh), mesh);
}

const ASCII: &str = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty float nx\n\
    property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n\
    property uchar blue\nproperty float u\nproperty float v\nelement edge 1\nproperty int vertex1\n\
    property list uchar uint many\nelement face 2\nproperty uchar flags\nproperty list uchar uint vertex_index\n\
    end_header\n\
    9 0 0 0.5 255 0 51 0 0\n9 1 0 0 255 0 51 1 0\n9 1 1e0 0 255 0 51 1 1\n9 0 1 0 255 0 51 0 1\n\
    7 2 1 2\n\
    0 3 0 1 2\n0 3 0 2 3\n";

#[test]
fn ascii_reads_with_other_names_elements_and_properties() {
    for text in [ASCII.to_string(), ASCII.replace('\n', "\r\n")] {
        let mesh = read_mesh(&Place::new().file("mesh.PLY", text), Unit::Cm).unwrap();
        assert_eq!(mesh.positions[0], [0.0, 0.0, 5.0].into());
        assert_eq!(mesh.polygons.face(1), [0, 2, 3]);
        assert_eq!(mesh.colors[3], [1.0, 0.0, 0.2]);
        assert_eq!(mesh.uvs[mesh.corner_uvs[2] as usize], Vector2::new(1.0, 1.0));
    }
}

#[test]
fn big_endian_with_floats_and_real_colors_reads() {
    let mut file =
        b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nproperty float red\nproperty float green\nproperty float blue\nelement face 1\n\
        property list int int vertex_indices\nend_header\n"
            .to_vec();
    for i in 0..3u8 {
        for x in [f32::from(i), 0.5, -1.0, 0.25, 0.5, 0.75] {
            file.extend(x.to_be_bytes());
        }
    }
    [3i32, 0, 1, 2].iter().for_each(|x| file.extend(x.to_be_bytes()));
    let mesh = read_mesh(&Place::new().file("mesh.ply", file), Unit::Mm).unwrap();
    assert_eq!(mesh.positions[2], [2.0, 0.5, -1.0].into());
    assert_eq!(mesh.colors[0], [0.25, 0.5, 0.75]);
    assert_eq!(mesh.polygons.face(0), [0, 1, 2]);
}

#[test]
fn errors_in_ascii_name_line_and_element() {
    let message = refused(ASCII.replace("9 1 1e0 0", "9 1 1e999 0"));
    says(&message, &["mesh.ply, line 23, vertex 2: inf is not a finite number"]);
    let message = refused(ASCII.replace("9 1 1e0 0", "9 1 nan 0"));
    says(&message, &["mesh.ply, line 23, vertex 2: "]);
    says(&refused(ASCII.replace("0 3 0 2 3\n", "0 3 0 2 4\n")), &["face 1: names vertex 4; the file has 4"]);
    says(
        &refused(ASCII.replace("0 3 0 2 3\n", "0 2 0 2\n")),
        &["line 27, face 1: has 2 corners; it needs three"],
    );
    says(&refused(ASCII.replace("0 3 0 2 3\n", "0 3 0 2\n")), &["line 27, face 1: "]);
    let message = refused(ASCII.replace("0 3 0 2 3\n", ""));
    says(&message, &["line 27, face 1: the file ends here; its header says 2 of kind face", "cut short"]);
    let signed = ASCII.replace("uchar uint vertex_index", "uchar int vertex_index");
    says(&refused(signed.replace("0 3 0 2 3\n", "0 3 0 2 -1\n")), &["face 1: a vertex index is negative"]);
}

#[test]
fn a_file_that_was_cut_short_is_refused_wherever_the_cut_is() {
    let whole = bytes(&fixture("ply/mesh.ply"));
    for length in 0..whole.len() {
        let message = refused(&whole[..length]);
        assert!(message.contains("mesh.ply, header") || message.contains("the file ends here"), "{message}");
    }
    let data = whole.windows(11).position(|part| part == b"end_header\n").unwrap() + 11;
    says(
        &refused(&whole[..data + 3 * 35 + 30]),
        &["mesh.ply, vertex 3: the file ends here; its header says 5"],
    );
    says(&refused(&whole[..whole.len() - 1]), &["mesh.ply, face 1: the file ends here; its header says 2"]);
}

#[test]
fn numbers_that_are_not_finite_are_refused_both_ways() {
    let mut mesh = polygons();
    mesh.positions[5].y = f64::NAN;
    let message = refusal(write_mesh(&Place::new().path("mesh.ply"), &mesh, Unit::Mm));
    assert_eq!(message, "mesh.ply, vertex 5: the position is not finite");
    let mut file = bytes(&fixture("ply/mesh.ply"));
    let data = file.windows(11).position(|part| part == b"end_header\n").unwrap() + 11;
    file[data + 2 * 35..][..8].copy_from_slice(&f64::NAN.to_le_bytes());
    says(&refused(&file), &["mesh.ply, vertex 2: NaN is not a finite number"]);
}

#[test]
fn files_that_hold_no_mesh_are_refused() {
    says(&refused("v 0 0 0\n"), &["mesh.ply, header, line 1: is not a PLY file", "to do: "]);
    says(&refused("solid\n"), &["mesh.ply, header"]);
    let no_faces = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
        property float z\nend_header\n0 0 0\n";
    says(&refused(no_faces), &["holds vertices but no faces", "point clouds"]);
    says(
        &refused(no_faces.replace("float z", "float w")),
        &["mesh.ply, header: its vertices lack x, y or z"],
    );
    says(&refused("ply\nformat ascii 1.0\nend_header\n"), &["holds no vertices"]);
    let strips = no_faces.replace("end_header\n0 0 0\n", "element tristrips 0\nend_header\n0 0 0\n");
    says(&refused(strips), &["triangle strips"]);
    says(&refused(ASCII.replace("uchar uint vertex_index", "uchar float vertex_index")), &["face 0: "]);
    // More vertices than memory could hold.
    says(
        &refused(no_faces.replace("vertex 1", "vertex 900000000000000")),
        &["line 9, vertex 1: the file ends"],
    );
    let message = refusal(read_mesh(&Place::new().file("mesh.stl", ""), Unit::Mm));
    says(&message, &["no mesh format known here", "use .obj or .ply"]);
}

proptest! {
    #[test]
    fn any_bytes_after_a_sound_header_never_panic(
        at in 0usize..471, new in proptest::collection::vec(any::<u8>(), 1..40)
    ) {
        let mut file = bytes(&fixture("ply/mesh.ply"));
        for (i, byte) in new.iter().enumerate().filter(|(i, _)| at + i < 471) {
            file[at + i] = *byte;
        }
        let place = Place::new();
        if let Ok(mesh) = read_mesh(&place.file("mesh.ply", &file), Unit::Mm) {
            write_mesh(&place.path("again.ply"), &mesh, Unit::Mm).unwrap().publish().unwrap();
        }
    }

    #[test]
    fn any_bytes_never_panic(file in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = read_mesh(&Place::new().file("mesh.ply", &file), Unit::Mm);
    }
}

/// How long a scan of 700,000 vertices takes; for a look now and then: `cargo test … -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement"]
fn a_large_scan() {
    let side = 840u32;
    let positions = (0..side * side).map(|i| [f64::from(i % side), f64::from(i / side), 0.1]).collect();
    let quads = (0..side - 1).flat_map(|y| (0..side - 1).map(move |x| y * side + x));
    let triangles: Vec<[u32; 3]> =
        quads.flat_map(|a| [[a, a + 1, a + side + 1], [a, a + side + 1, a + side]]).collect();
    let mesh = Mesh::from_triangles(positions, &triangles);
    let start = std::time::Instant::now();
    let (_place, path) = written(&mesh, Unit::Mm);
    let wrote = start.elapsed();
    let back = read_mesh(&path, Unit::Mm).unwrap();
    println!(
        "{} vertices: written in {wrote:.2?}, read in {:.2?}",
        mesh.positions.len(),
        start.elapsed() - wrote
    );
    assert_eq!(back, mesh);
}
