//! OBJ, in and out.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod support;

use artifact::{Unit, obj};
use mesh::{Label, LabelKind, Mesh, NO_UV};
use nalgebra::{Point3, Vector2};
use proptest::prelude::*;
use std::path::Path;
use support::{Place, bytes, refusal, says};

fn parse(text: &str) -> Mesh {
    obj::parse(Path::new("scan.obj"), text, Unit::Mm).unwrap()
}

fn refused(text: &str) -> String {
    refusal(obj::parse(Path::new("scan.obj"), text, Unit::Mm))
}

fn round_trip(mesh: &Mesh) -> Mesh {
    let place = Place::new();
    let path = place.path("scan.obj");
    obj::write(&path, mesh, Unit::Mm).unwrap().publish().unwrap();
    obj::read(&path, Unit::Mm).unwrap()
}

const SCAN: &str = "# a scan\nmtllib skin.mtl\no face\nv 0 0 0 1 0.5 0\nv 1 0 0 1 0.5 0\nv 1 1 0 1 0.5 0\n\
    v 0 1 0 1 0.5 0\nv 2 0.5 0 0 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 1.5 2.25\nvn 0 0 1\n\
    g cheek left\nusemtl skin\ns 1\nf 1/1/1 2/2/1 3/3/1 4/4/1\ns off\ng ear\nf 2/2 5/5 3/3\nf 2 5 3\n";

#[test]
fn vertex_order_polygons_uvs_groups_and_colors_survive() {
    let mesh = parse(SCAN);
    assert_eq!(mesh.positions[4], Point3::new(2.0, 0.5, 0.0));
    assert_eq!(mesh.polygons.iter().collect::<Vec<_>>(), [&[0, 1, 2, 3][..], &[1, 4, 2], &[1, 4, 2]]);
    assert_eq!(mesh.uvs[4], Vector2::new(1.5, 2.25), "UDIM tile 1022");
    assert_eq!(mesh.corner_uvs, [0, 1, 2, 3, 1, 4, 2, NO_UV, NO_UV, NO_UV]);
    assert_eq!(mesh.colors[4], [0.0, 0.0, 1.0]);
    let label = |first_face, kind, name: &str| Label { first_face, kind, name: name.to_string() };
    let labels = [
        label(0, LabelKind::MaterialLibrary, "skin.mtl"),
        label(0, LabelKind::Object, "face"),
        label(0, LabelKind::Group, "cheek left"),
        label(0, LabelKind::Material, "skin"),
        label(0, LabelKind::Smoothing, "1"),
        label(1, LabelKind::Smoothing, "off"),
        label(1, LabelKind::Group, "ear"),
    ];
    assert_eq!(mesh.labels, labels);
    assert_eq!(round_trip(&mesh), mesh);
}

#[test]
fn windows_lines_byte_order_marks_and_spaces_change_nothing() {
    let mesh = parse(SCAN);
    assert_eq!(parse(&SCAN.replace('\n', "\r\n")), mesh);
    assert_eq!(parse(&format!("\u{feff}{SCAN}")), mesh);
    assert_eq!(parse(&SCAN.replace("\nv ", "\n\n  v\t ").replace(" 0 ", "   0.0e0 ")), mesh);
    assert_eq!(parse(SCAN.trim_end()), mesh);
}

#[test]
fn negative_indices_count_back() {
    let mesh =
        parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf -3/-3 -2/-2 -1/-1\nv 5 5 5\nf -1 1 2\n");
    assert_eq!(mesh.polygons.iter().collect::<Vec<_>>(), [&[0, 1, 2][..], &[3, 0, 1]]);
    assert_eq!(mesh.corner_uvs, [0, 1, 2, NO_UV, NO_UV, NO_UV]);
}

#[test]
fn indices_may_point_forward() {
    assert_eq!(parse("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").polygons.face(0), [0, 1, 2]);
}

#[test]
fn a_backslash_continues_a_line_but_not_a_comment() {
    let mesh = parse("# from C:\\scans\\\nv 0 0 0\nv 1 0 \\\n 0\nv 0 1 0\nf 1 2 \\\r\n3\n");
    assert_eq!(mesh.positions.len(), 3);
    assert_eq!(mesh.polygons.face(0), [0, 1, 2]);
    says(
        &refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 \\\n 2 9\nf 1 2 3\n"),
        &["scan.obj, line 4: the face names vertex 9"],
    );
}

#[test]
fn the_unit_scales() {
    let triangle = "v 0.01 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let mesh = obj::parse(Path::new("a.obj"), triangle, Unit::M).unwrap();
    assert_eq!(mesh.positions[0].x, 10.0);
    let place = Place::new();
    let path = place.path("a.obj");
    obj::write(&path, &mesh, Unit::M).unwrap().publish().unwrap();
    assert_eq!(String::from_utf8(bytes(&path)).unwrap(), triangle);
}

#[test]
fn errors_name_the_line() {
    let sound = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n";
    for (text, line, what) in [
        ("f 0 1 2\n", 5, "the index 0; indices start at 1"),
        ("f 1 2 4\n", 5, "the face names vertex 4; the file has 3"),
        ("f 1 2 -4\n", 5, "the index -4 counts back past the first element"),
        ("f 1 2 4294967296\n", 5, "the index 4294967296 is too large"),
        ("f 1 2 99999999999999999999\n", 5, "'99999999999999999999' is not an index"),
        ("f 1 2\n", 5, "a face with 2 corners; it needs three"),
        ("f 1/1 2/2 3/1\n", 5, "the face names texture coordinate 2; the file has 1"),
        ("f 1 2 x\n", 5, "'x' is not an index"),
        ("f 1 2 3\nv 1 NaN 0\n", 6, "'NaN' is not a finite number"),
        ("f 1 2 3\nv 1 inf 0\n", 6, "'inf' is not a finite number"),
        ("f 1 2 3\nv 1 1e999 0\n", 6, "'1e999' is not a finite number"),
        ("f 1 2 3\nv 1 0,5 0\n", 6, "'0,5' is not a number"),
        ("f 1 2 3\nv 1 0\n", 6, "a vertex with 2 numbers"),
        ("f 1 2 3\nvt\n", 6, "a texture coordinate without numbers"),
        ("f 1 2 3\n\u{1}\u{2}ab 0 0\n", 6, "is not text (binary data)"),
    ] {
        for end in ["", "f 1 2 3\n"] {
            let message = refused(&format!("{sound}{text}{end}"));
            says(&message, &[&format!("scan.obj, line {line}: {what}"), "to do: "]);
        }
    }
    let place = Place::new();
    let message = refusal(obj::read(&place.file("scan.obj", b"v 0 0 0\nv \xff\xfe\x00 0 0\n"), Unit::Mm));
    says(&message, &["scan.obj, line 2 (byte 10): is not text (binary data)"]);
}

#[test]
fn latin_1_comments_and_names_are_read() {
    let place = Place::new();
    let plain = b"# Kopf\no Muller\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl Haut\nf 1 2 3\n";
    let latin = b"# K\xf6pf\no M\xfcller\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl H\xe4ut\nf 1 2 3\n";
    let [plain, mesh] =
        [plain.as_slice(), latin].map(|bytes| obj::read(&place.file("a.obj", bytes), Unit::Mm).unwrap());
    assert_eq!((mesh.positions, mesh.polygons), (plain.positions, plain.polygons));
    assert!(artifact::read_text(&place.file("a.obj", latin)).unwrap().contains("M\u{fc}ller"));
    let message = refused_bytes(&place, b"v 0 0 0\n# \xf6\nv \x1b 0 0\n");
    says(&message, &["scan.obj, line 2 (byte 10): is not text (binary data)"]);
}

fn refused_bytes(place: &Place, bytes: &[u8]) -> String {
    refusal(obj::read(&place.file("scan.obj", bytes), Unit::Mm))
}

#[test]
fn a_file_without_a_mesh_is_refused() {
    says(&refused(""), &["scan.obj: holds no vertices"]);
    says(&refused("# nothing\n"), &["holds no vertices"]);
    says(&refused("v 0 0 0\nv 1 0 0\n"), &["holds vertices but no faces", "point clouds cannot be used"]);
}

#[test]
fn a_cut_in_the_last_line_is_named_as_such() {
    says(
        &refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2"),
        &["line 5", "this is the last line", "cut short"],
    );
}

#[test]
fn numbers_beyond_the_range_are_refused() {
    let huge = "v 1e307 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert!(obj::parse(Path::new("a.obj"), huge, Unit::Mm).is_ok());
    let message = refusal(obj::parse(Path::new("a.obj"), huge, Unit::M));
    says(&message, &["a.obj, line 1: a number is too large"]);
    says(&refused("v 0 0 0 1e200 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), &["line 1: a number is too large"]);
}

#[test]
fn the_writer_refuses_numbers_that_are_not_finite() {
    let sound = parse(SCAN);
    let place = Place::new();
    let write = |mesh: &Mesh| refusal(obj::write(&place.path("a.obj"), mesh, Unit::Mm));
    let mut mesh = sound.clone();
    mesh.positions[2].z = f64::INFINITY;
    assert_eq!(write(&mesh), "a.obj, vertex 2: the position is not finite");
    let mut mesh = sound.clone();
    mesh.uvs[3].x = f64::NAN;
    assert_eq!(write(&mesh), "a.obj, texture coordinate 3: the value is not finite");
    let mut mesh = sound;
    mesh.colors[1][0] = f32::NAN;
    assert_eq!(write(&mesh), "a.obj, vertex 1: the colour is not finite");
    assert!(place.names().is_empty());
}

proptest! {
    #[test]
    fn positions_come_back_bit_by_bit(
        points in proptest::collection::vec(prop::array::uniform3(-1e6f64..1e6), 3..20)
    ) {
        let mesh = Mesh::from_triangles(points, &[[2, 0, 1]]);
        prop_assert_eq!(round_trip(&mesh), mesh);
    }

    #[test]
    fn any_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = obj::parse(Path::new("a.obj"), &String::from_utf8_lossy(&bytes), Unit::M);
    }

    /// Text of OBJ's own words: what reads can be written, and reads the same again.
    #[test]
    fn what_reads_survives(text in "(v 0 0 0\n){2}((v|vt|f|g|o|s|#|usemtl)( -?[0-4](/[0-3]?){0,2}){0,5}[ \\\\]?\r?\n){0,12}") {
        if let Ok(mesh) = obj::parse(Path::new("a.obj"), &text, Unit::Mm) {
            let back = round_trip(&mesh);
            prop_assert_eq!(&back.positions, &mesh.positions);
            prop_assert_eq!(&back.polygons, &mesh.polygons);
            prop_assert_eq!(&back.corner_uvs, &mesh.corner_uvs);
        }
    }
}
