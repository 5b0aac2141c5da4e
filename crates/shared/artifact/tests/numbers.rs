//! OBJ numbers survive a change of unit.

use artifact::{FrameRange, Unit, obj};
use std::path::Path;

const SCAN: &str = "v 0.031877 -0.418213 0.309246\nv 0.1 0.2 0.3\nv -0.000054 1e-7 7.123456\nf 1 2 3\n";

#[test]
fn a_mesh_written_in_its_own_unit_keeps_its_numbers() {
    let folder = tempfile::TempDir::new().expect("a folder");
    for unit in [Unit::Mm, Unit::Cm, Unit::M] {
        let mesh = obj::parse(Path::new("scan.obj"), SCAN, unit).expect("the scan");
        let path = folder.path().join("again.obj");
        obj::write(&path, &mesh, unit).and_then(artifact::Staged::publish).expect("written");
        let text = artifact::read_text(&path).expect("read");
        assert!(
            text.starts_with("v 0.031877 -0.418213 0.309246\nv 0.1 0.2 0.3\nv -0.000054 "),
            "{unit}: {text}"
        );
        assert_eq!(obj::read(&path, unit).expect("read"), mesh);
    }
}

#[test]
fn a_file_of_zbrush_ends_with_a_zero_byte_and_no_other_does() {
    let parse = |text: &str| obj::parse(Path::new("scan.obj"), text, Unit::M);
    assert!(parse(&format!("{SCAN}\0\n")).is_ok() && parse(&format!("{SCAN}\0")).is_ok());
    assert!(parse(&format!("{SCAN}\0\0\0\n")).is_err() && parse(&format!("v 1 \0 2\n{SCAN}")).is_err());
}

#[test]
fn a_range_of_frames_is_shown_as_it_is_typed() {
    for text in ["1003-", "-20", "1003", "1001-1100"] {
        assert_eq!(text.parse::<FrameRange>().map(|range| range.to_string()), Ok(text.to_string()));
    }
    assert_eq!(FrameRange::ALL.to_string(), "all");
}
