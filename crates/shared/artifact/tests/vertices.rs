//! Vertex paths and vertex maps: what their checks let through.

use artifact::{Document, FileRef, MeshRef, Unit, VertexMapping, VertexPath};

fn mesh(vertex_count: usize) -> MeshRef {
    let file = FileRef { name: "mesh.obj".to_string(), sha256: "00".repeat(32) };
    MeshRef { file, unit: Unit::Mm, vertex_count }
}

fn map(new_from_old: &[Option<u32>], old_from_new: &[u32]) -> VertexMapping {
    VertexMapping {
        old: mesh(new_from_old.len()),
        new: mesh(old_from_new.len()),
        new_from_old: new_from_old.to_vec(),
        old_from_new: old_from_new.to_vec(),
    }
}

#[test]
fn a_map_may_drop_and_double_vertices() {
    assert_eq!(map(&[Some(0), None, Some(1)], &[0, 2]).check(), Ok(()));
    assert_eq!(map(&[Some(0), Some(1), Some(2)], &[0, 1, 2, 1, 1, 2]).check(), Ok(()));
    // The first copy of vertex 0 is gone, the second is not.
    assert_eq!(map(&[Some(2), Some(0), Some(1)], &[1, 2, 0]).check(), Ok(()));
}

#[test]
fn a_map_must_lead_there_and_back_in_order() {
    let mixed = map(&[Some(2), Some(1), Some(0)], &[2, 1, 0]).check().expect_err("two breaks");
    assert!(mixed.what.contains("mixed up"), "{mixed:?}");
    let late = map(&[Some(2), Some(1)], &[0, 1, 0]).check().expect_err("not the first copy");
    assert_eq!(late.place, "new vertex 0");
    let astray = map(&[Some(0), Some(0)], &[0]).check().expect_err("two onto one");
    assert_eq!(astray.place, "old vertex 1");
    let forgotten = map(&[Some(0), None], &[0, 1]).check().expect_err("a new vertex from nowhere");
    assert_eq!(forgotten.place, "new vertex 1");
    assert!(map(&[Some(0)], &[0, 7]).check().is_err());
}

#[test]
fn a_path_names_vertices_in_any_order() {
    let path = |vertices: &[u32]| {
        VertexPath { mesh: mesh(9), name: "mouth".to_string(), vertices: vertices.to_vec() }.check()
    };
    assert_eq!(path(&[5, 2, 8, 5]), Ok(()));
    for wrong in [&[3][..], &[3, 3], &[3, 9]] {
        assert!(path(wrong).is_err(), "{wrong:?}");
    }
}
