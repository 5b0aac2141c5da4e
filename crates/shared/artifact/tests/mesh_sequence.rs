//! Mesh sequences: frames by number, lengths in mm, refusals.

#![allow(clippy::unwrap_used, reason = "a test may fail by panic")]

use artifact::{FileRef, LargeScale, MeshRef, MeshSequence, Unit, pc2};
use nalgebra::Point3;
use std::path::Path;

/// `take.pc2` with three samples whose one vertex stands at x = 1, 2, 3, and `take.json` over it.
fn write(folder: &Path, frames: Vec<i64>, vertex_count: usize) {
    let mut cache = pc2::Writer::create(&folder.join("take.pc2"), 1, 1001).unwrap();
    [1.0, 2.0, 3.0].iter().for_each(|&x| cache.write(&[x, 0.0, 0.0]).unwrap());
    cache.finish().unwrap().publish().unwrap();
    let file = FileRef { name: "rest.obj".into(), sha256: "0".repeat(64) };
    let mesh = MeshRef { file, unit: Unit::Cm, vertex_count };
    let index = LargeScale {
        mesh,
        cache: "take.pc2".into(),
        form: artifact::SequenceForm::Pc2,
        rate: None,
        frames,
        take: None,
    };
    artifact::write_document(&folder.join("take.json"), &index).unwrap().publish().unwrap();
}

#[test]
fn frames_are_read_by_number_in_millimetres() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), vec![10, 11, 20], 1);
    let sequence = MeshSequence::open(&folder.path().join("take.json"), None).unwrap();
    assert_eq!((sequence.frames(), sequence.vertex_count()), (&[10, 11, 20][..], 1));
    assert_eq!(sequence.cache(), Some(folder.path().join("take.pc2").as_path()));
    let mut cursor = sequence.cursor().unwrap();
    assert_eq!(cursor.read(10).unwrap(), [Point3::new(10.0, 0.0, 0.0)]);
    assert_eq!(cursor.read(20).unwrap(), [Point3::new(30.0, 0.0, 0.0)]);
    assert!(cursor.read(11).unwrap_err().to_string().contains("frame 11: was passed already"));
    assert!(cursor.read(12).unwrap_err().to_string().contains("frame 12: is not there"));
}

#[test]
fn a_bare_cache_needs_a_unit_and_counts_from_its_start() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), vec![10, 11, 20], 1);
    let path = folder.path().join("take.pc2");
    let refusal = MeshSequence::open(&path, None).unwrap_err();
    assert!(refusal.to_string().contains("its unit is not stated"));
    let sequence = MeshSequence::open(&path, Some(Unit::M)).unwrap();
    assert_eq!((sequence.frames(), sequence.cache()), (&[1001, 1002, 1003][..], None));
    assert_eq!(sequence.cursor().unwrap().read(1002).unwrap(), [Point3::new(2000.0, 0.0, 0.0)]);
}

#[test]
fn what_does_not_fit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("take.json");
    let refusal = |unit| MeshSequence::open(&path, unit).unwrap_err().to_string();
    write(folder.path(), vec![10, 11], 1);
    assert!(refusal(None).contains("names 2 frames, but take.pc2 holds 3"), "{}", refusal(None));
    write(folder.path(), vec![10, 11, 12], 2);
    assert!(refusal(None).contains("has 1 vertices, but"), "{}", refusal(None));
    write(folder.path(), vec![10, 11, 12], 1);
    assert!(refusal(Some(Unit::M)).contains("was made with its mesh in cm, not in m"));
    let unknown = MeshSequence::open(&folder.path().join("take.txt"), None).unwrap_err();
    assert!(unknown.to_string().contains("no mesh sequence known here"));
}
