//! Two real scans: one dirty, one with closed lips and lids.

use artifact::{Unit, VertexPath, obj, read_document, sha256};
use mesh::{Connectivity, Mesh};
use mesh_clip::{Params, Picks, Region, clip};
use std::path::Path;

fn around(mesh: &Mesh) -> Connectivity {
    Connectivity::of(mesh.positions.len(), &mesh.triangles())
}

#[test]
fn a_raw_scan_is_clean_afterwards() {
    let Some(path) = testkit::data("head_meshmonk_demoface/DemoFace_10K.obj") else { return };
    let scan = obj::read(&path, Unit::Mm).expect("the scan");
    assert_eq!(around(&scan).bow_ties().len(), 21);
    let params = Params { drop_non_manifold: true, keep_largest_component: true, ..Params::default() };
    let clipped = clip(&scan, &Picks::default(), &params).expect("most of it");
    let clean = around(&clipped.mesh);
    assert!(clean.bow_ties().is_empty() && clean.non_manifold_edges().is_empty());
    assert_eq!(clean.components().1, 1);
    assert!(clipped.dropped.faces <= 2 * 21, "{:?}", clipped.dropped);
    assert!(clipped.mesh.polygons.len() + 100 > scan.polygons.len());
}

#[test]
fn closed_lips_and_lids_open() {
    let Some(path) = testkit::data("head_lee_perry_smith/LeePerrySmith.obj") else { return };
    let scan = obj::read(&path, Unit::M).expect("the scan");
    let picks = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/lee-perry-smith");
    let lines: Vec<VertexPath> = ["mouth.json", "lids_l.json", "lids_r.json"]
        .iter()
        .map(|name| read_document(&picks.join(name)).expect("the picks"))
        .collect();
    assert!(lines.iter().all(|line| line.mesh.file.sha256 == sha256(&path).expect("a hash")));
    let cuts = lines.iter().map(|line| line.vertices.as_slice()).collect();
    let params = Params {
        keep_regions: vec![
            Region::Above { axis: 2, value_mm: -40.0 },
            Region::Above { axis: 1, value_mm: -125.0 },
            Region::Below { axis: 1, value_mm: 72.0 },
        ],
        keep_largest_component: true,
        ..Params::default()
    };
    let clipped = clip(&scan, &Picks { cuts, ..Picks::default() }, &params).expect("a face");
    let face = around(&clipped.mesh);
    assert_eq!(clipped.dropped_components, 3, "a mouth pocket and two eye sockets");
    assert_eq!((face.components().1, face.boundary_loops().len()), (1, 4), "rim, mouth, eyes");
    assert!(face.bow_ties().is_empty() && face.non_manifold_edges().is_empty());
    assert!((2_000..4_000).contains(&clipped.mesh.positions.len()));
}
