//! Correspondences from other programs.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod support;

use artifact::Unit;
use artifact::picks::{Pick, PickPlace, read};
use nalgebra::Point3;
use proptest::prelude::*;
use support::{Place, refusal, says};

fn picked(name: &str, text: &str) -> Vec<Pick> {
    read(&Place::new().file(name, text), Unit::Mm).unwrap()
}

fn refused(name: &str, text: &str) -> String {
    refusal(read(&Place::new().file(name, text), Unit::Mm))
}

fn vertex(marker: &str, vertex: u32) -> Pick {
    Pick { marker: marker.to_string(), place: PickPlace::Vertex(vertex) }
}

fn point(marker: &str, point: [f64; 3]) -> Pick {
    Pick { marker: marker.to_string(), place: PickPlace::Point(Point3::from(point)) }
}

/// As MeshLab 2022 writes it.
const MESHLAB: &str = r#"<!DOCTYPE PickedPoints>
<PickedPoints>
 <DocumentData>
  <DateTime date="2024-05-06" time="12:00:00"/>
  <User name="artist"/>
  <DataFileName name="scan.obj"/>
  <templateName name=""/>
 </DocumentData>
 <point y="-0.5" x="12.25" z="3" name="brow_l" active="1"/>
 <point active="0" x="0" y="0" z="0" name="unused"/>
 <point x="1e-3" y="2" z="-3" name="nose &amp; tip" active="1"/>
</PickedPoints>
"#;

#[test]
fn meshlab_points_are_read_and_inactive_ones_passed_over() {
    let expected = [point("brow_l", [12.25, -0.5, 3.0]), point("nose & tip", [0.001, 2.0, -3.0])];
    assert_eq!(picked("a.pp", MESHLAB), expected);
    assert_eq!(picked("a.PP", &format!("\u{feff}{}", MESHLAB.replace('\n', "\r\n"))), expected);
    let cm = read(&Place::new().file("a.pp", MESHLAB), Unit::Cm).unwrap();
    assert_eq!(cm[0], point("brow_l", [122.5, -5.0, 30.0]));
}

#[test]
fn errors_in_meshlab_files_name_the_line() {
    says(&refused("a.pp", &MESHLAB.replace("12.25", "wide")), &["a.pp, line 9: 'wide' is not a number"]);
    says(&refused("a.pp", &MESHLAB.replace("12.25", "nan")), &["a.pp, line 9: NaN is not a finite number"]);
    says(
        &refused("a.pp", &MESHLAB.replace(" z=\"3\"", "")),
        &["a.pp, line 9: a point lacks the attribute z"],
    );
    says(&refused("a.pp", &MESHLAB.replace("brow_l", "")), &["a.pp, line 9: a pick has no marker name"]);
    let doubled = MESHLAB.replace("nose &amp; tip", "brow_l");
    says(&refused("a.pp", &doubled), &["a.pp, line 11: marker brow_l is picked twice, first in line 9"]);
    says(&refused("a.pp", &MESHLAB[..MESHLAB.len() - 30]), &["a.pp, line ", "is not XML that can be read: "]);
    says(&refused("a.pp", "<picks/>"), &["a.pp, line 1: is XML, but not MeshLab's PickedPoints"]);
    says(&refused("a.pp", "<PickedPoints/>"), &["a.pp: holds no picks"]);
}

#[test]
fn csv_with_vertices_is_read_with_and_without_a_header() {
    let expected = [vertex("brow_l", 12), vertex("lip, upper", 0)];
    for text in [
        "brow_l,12\n\"lip, upper\",0\n",
        "marker,vertex\nbrow_l,12\n\"lip, upper\",0\n",
        "Vertex, Marker\r\n\r\n12, brow_l\r\n0,\"lip, upper\"",
        "marker;vertex\nbrow_l;12\nlip, upper;0\n",
        "note\tmarker\tvertex\nfirst\tbrow_l\t12\n\tlip, upper\t0\n",
    ] {
        assert_eq!(picked("a.csv", text), expected, "{text}");
    }
}

#[test]
fn csv_with_points_is_read_with_and_without_a_header() {
    let expected = [point("brow_l", [1.0, -2.5, 3e-1]), point("nose", [0.0, 0.0, 0.0])];
    for text in [
        "brow_l,1,-2.5,0.3\nnose,0,0,0\n",
        "\u{feff}marker,x,y,z\nbrow_l,1,-2.5,0.3\nnose,0,0,0\n",
        "z,y,x,marker\n0.3,-2.5,1,brow_l\n0,0,0,nose\n",
    ] {
        assert_eq!(picked("a.csv", text), expected, "{text}");
    }
    let metres = read(&Place::new().file("a.csv", "brow_l,1,0,0.5\n"), Unit::M).unwrap();
    assert_eq!(metres, [point("brow_l", [1000.0, 0.0, 500.0])]);
}

#[test]
fn errors_in_csv_name_the_line() {
    let refused = |text: &str| refused("a.csv", text);
    says(&refused("marker,vertex\na,1\nb,-1\n"), &["a.csv, line 3: '-1' is not a vertex index"]);
    says(&refused("a,1\n\nb,1.5\n"), &["a.csv, line 3: '1.5' is not a vertex index"]);
    says(&refused("a,1,2,3\nb,1,2,x\n"), &["a.csv, line 2: 'x' is not a number"]);
    says(&refused("a,1,2,3\nb,1,2,inf\n"), &["a.csv, line 2: inf is not a finite number"]);
    says(&refused("a,1\nb,1,2,3\n"), &["a.csv, line 2: 4 columns; the first line has 2"]);
    says(&refused("a,1,2\n"), &["a.csv, line 1: 3 columns; say marker,vertex or marker,x,y,z"]);
    says(&refused("marker,x,y\na,1,2\n"), &["a.csv, line 1: the header names neither vertex nor x, y and z"]);
    says(&refused("name,id\na,1\n"), &["a.csv, line 1: 'id' is not a vertex index"]);
    says(&refused("a,1\nb,2\na,3\n"), &["a.csv, line 3: marker a is picked twice, first in line 1"]);
    says(&refused("a,1\n,2\n"), &["a.csv, line 2: a pick has no marker name"]);
    says(&refused("marker,vertex\n"), &["a.csv: holds no picks", "to do: "]);
    says(&refused(""), &["a.csv: holds no picks"]);
}

#[test]
fn other_endings_are_refused() {
    says(&refused("a.txt", "a,1\n"), &["a.txt: has an ending that is no format of picks", "MeshLab's .pp"]);
}

proptest! {
    #[test]
    fn nothing_panics(text in "\\PC{0,60}|[a-z0-9,;\"\n.-]{0,40}|<PickedPoints>[<>/pointxyz=\"0-9 ]{0,40}</PickedPoints>") {
        let place = Place::new();
        let _ = read(&place.file("a.csv", &text), Unit::Mm);
        let _ = read(&place.file("a.pp", &text), Unit::Mm);
    }
}
