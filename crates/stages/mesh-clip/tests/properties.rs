//! What a clip promises: nothing that stays moves, the map leads there and back, a slit only parts.

use mesh::{Connectivity, Mesh};
use mesh_clip::{Clipped, Error, Mask, Params, Picks, Region, clip};
use proptest::prelude::*;
use std::path::Path;
use testkit::shapes;

fn around(mesh: &Mesh) -> Connectivity {
    Connectivity::of(mesh.positions.len(), &mesh.triangles())
}

/// Positions bit for bit, and both maps leading to each other.
fn assert_maps_agree(old: &Mesh, clipped: &Clipped) {
    assert_eq!(clipped.old_from_new.len(), clipped.mesh.positions.len());
    assert_eq!(clipped.new_from_old.len(), old.positions.len());
    for (new, &from) in clipped.old_from_new.iter().enumerate() {
        let (a, b) = (clipped.mesh.positions[new], old.positions[from as usize]);
        assert_eq!([a.x, a.y, a.z].map(f64::to_bits), [b.x, b.y, b.z].map(f64::to_bits));
        let first = clipped.new_from_old[from as usize].unwrap_or(u32::MAX);
        assert!(first as usize <= new, "new {new} is a copy of {from}, whose first copy is {first}");
    }
    for (vertex, new) in clipped.new_from_old.iter().enumerate() {
        assert!(new.is_none_or(|new| clipped.old_from_new[new as usize] as usize == vertex));
    }
}

/// Per face its corners as (position, texture coordinate) and its group.
fn described(mesh: &Mesh) -> Vec<(Vec<[u64; 5]>, String)> {
    let describe = |face: usize| {
        let corner = |corner: usize| {
            let (p, uv) = (
                mesh.positions[mesh.polygons.corners()[corner] as usize],
                mesh.uvs[mesh.corner_uvs[corner] as usize],
            );
            [p.x, p.y, p.z, uv.x, uv.y].map(f64::to_bits)
        };
        let label = mesh.labels.iter().rfind(|label| label.first_face <= face);
        let group = label.map_or(String::new(), |label| label.name.clone());
        (mesh.polygons.corner_range(face).map(corner).collect(), group)
    };
    (0..mesh.polygons.len()).map(describe).collect()
}

#[test]
fn faces_keep_texture_coordinates_and_groups() {
    let grid = shapes::grid(6, 1.0);
    let params = Params { keep_regions: vec![Region::Above { axis: 1, value_mm: 2.0 }], ..Params::default() };
    let clipped = clip(&grid, &Picks::default(), &params).expect("the upper rows stay");
    assert_eq!(clipped.mesh.polygons.len(), 24);
    let before = described(&grid);
    assert!(described(&clipped.mesh).iter().all(|face| before.contains(face)));
    assert_maps_agree(&grid, &clipped);
}

#[test]
fn a_slit_between_inner_vertices_doubles_all_but_its_ends() {
    let grid = shapes::grid(6, 1.0);
    // Along row 3 from column 1 to column 5; between the ends the way is found.
    let line: [u32; 2] = [3 * 7 + 1, 3 * 7 + 5];
    let clipped = clip(&grid, &Picks { cuts: vec![&line], ..Picks::default() }, &Params::default());
    let clipped = clipped.expect("a slit");
    assert_eq!((clipped.slit_vertices, clipped.mesh.positions.len()), (3, 52));
    assert_eq!(clipped.old_from_new[49..], [23, 24, 25]);
    assert_eq!(clipped.mesh.polygons.len(), 36);
    let loops = around(&clipped.mesh).boundary_loops();
    assert_eq!(loops.iter().map(Vec::len).collect::<Vec<_>>(), [24, 8]);
    assert!(described(&clipped.mesh) == described(&grid), "faces, texture coordinates and groups stay");
    // The side on the left of the line (here: above) keeps the vertices.
    let above = clipped.mesh.polygons.iter().flatten().filter(|&&vertex| vertex == 24);
    assert_eq!(above.count(), 2);
    assert_maps_agree(&grid, &clipped);
}

#[test]
fn a_slit_to_the_rim_doubles_its_end_there_and_may_part_the_mesh() {
    let grid = shapes::grid(4, 1.0);
    let across = clip(&grid, &Picks { cuts: vec![&[10, 14]], ..Picks::default() }, &Params::default());
    let across = across.expect("cut in two");
    assert_eq!((across.slit_vertices, around(&across.mesh).components().1), (5, 2));
    let half = Params { keep_largest_component: true, ..Params::default() };
    let half = clip(&grid, &Picks { cuts: vec![&[10, 14]], ..Picks::default() }, &half).expect("one half");
    assert_eq!((half.mesh.polygons.len(), half.dropped_components), (8, 1));
    assert_maps_agree(&grid, &half);
}

#[test]
fn a_closed_cut_takes_out_what_it_surrounds() {
    let sphere = shapes::sphere(10.0, 8);
    // The ring at the equator of a sphere of 8 bands: 16 vertices from 1 + 3·16 on, moved one ring down.
    let first = 1 + 4 * 16;
    let mut ring: Vec<u32> = (first..first + 16).collect();
    ring.push(first);
    let params = Params { keep_largest_component: true, ..Params::default() };
    let clipped = clip(&sphere, &Picks { cuts: vec![&ring], ..Picks::default() }, &params).expect("a bowl");
    assert_eq!(clipped.slit_vertices, 16);
    let loops = around(&clipped.mesh).boundary_loops();
    assert_eq!(loops.iter().map(Vec::len).collect::<Vec<_>>(), [16]);
    assert_maps_agree(&sphere, &clipped);
}

#[test]
fn two_crossing_slits_give_four_copies() {
    let grid = shapes::grid(4, 1.0);
    let picks = Picks { cuts: vec![&[10, 14], &[2, 22]], ..Picks::default() };
    let clipped = clip(&grid, &picks, &Params::default()).expect("four quarters");
    assert_eq!(around(&clipped.mesh).components().1, 4);
    assert_eq!(clipped.old_from_new.iter().filter(|&&old| old == 12).count(), 4);
    assert_maps_agree(&grid, &clipped);
}

#[test]
fn the_map_of_a_slit_whose_first_side_is_removed_leads_to_the_copy() {
    let grid = shapes::grid(4, 1.0);
    let picks = Picks { cuts: vec![&[10, 14]], ..Picks::default() };
    let below = Params { keep_regions: vec![Region::Below { axis: 1, value_mm: 2.0 }], ..Params::default() };
    let clipped = clip(&grid, &picks, &below).expect("the lower half");
    assert_eq!(clipped.mesh.positions.len(), 15);
    assert_maps_agree(&grid, &clipped);
}

#[test]
fn a_slit_with_a_width_is_a_gap() {
    let grid = shapes::grid(6, 1.0);
    let params = Params { slit_width_mm: 1.2, ..Params::default() };
    let clipped = clip(&grid, &Picks { cuts: vec![&[22, 26]], ..Picks::default() }, &params).expect("a gap");
    assert_eq!(clipped.mesh.polygons.len(), 36 - 2 * 4);
}

#[test]
fn sets_regions_and_masks_select() {
    let grid = shapes::grid(4, 1.0);
    let corner: Vec<u32> = vec![0, 1, 5, 6];
    let faces = |picks: Picks, params: Params| clip(&grid, &picks, &params).map(|c| c.mesh.polygons.len());
    let none = Params::default;
    assert_eq!(faces(Picks { remove: vec![&corner], ..Picks::default() }, none()), Ok(15));
    let touching = Params { touching: true, ..none() };
    assert_eq!(faces(Picks { remove: vec![&corner], ..Picks::default() }, touching), Ok(12));
    assert_eq!(faces(Picks { keep: vec![&corner], ..Picks::default() }, none()), Ok(1));
    let ball = Region::Sphere { center_mm: [2.0, 2.0, 0.0], radius_mm: 1.5 };
    assert_eq!(faces(Picks::default(), Params { keep_regions: vec![ball], ..none() }), Ok(4));
    let low = Region::Box { low_mm: [0.0, 0.0, -1.0], high_mm: [4.0, 1.0, 1.0] };
    assert_eq!(faces(Picks::default(), Params { remove_regions: vec![low], ..none() }), Ok(12));
    // Dark in the lower left texel only: row 1 of the picture is v < 0.5.
    let mask = Mask { width: 2, height: 2, texels: vec![1.0, 1.0, 0.2, 1.0] };
    let masked = Params { mask_level: 0.5, ..none() };
    assert_eq!(faces(Picks { mask: Some(mask.clone()), ..Picks::default() }, masked), Ok(12));
    let bare = clip(&shapes::sphere(1.0, 4), &Picks { mask: Some(mask), ..Picks::default() }, &none());
    assert_eq!(bare.err(), Some(Error::NoTextureCoordinates));
}

#[test]
fn faults_are_mended_with_few_faces() {
    let params = Params { drop_non_manifold: true, ..Params::default() };
    let tie = clip(&shapes::bow_tie(), &Picks::default(), &params).expect("the larger fan");
    assert_eq!((tie.dropped.bow_ties, tie.dropped.faces, tie.mesh.polygons.len()), (1, 2, 3));
    let book = clip(&shapes::open_book(), &Picks::default(), &params).expect("two pages");
    assert_eq!((book.dropped.non_manifold_edges, book.dropped.faces), (1, 1));
    assert_eq!(book.old_from_new, [0, 1, 2, 3], "the smallest page went");
    let sound = clip(&shapes::grid(3, 1.0), &Picks::default(), &params).expect("all of it");
    assert_eq!(sound.dropped, mesh_clip::Dropped::default());
}

#[test]
fn of_two_components_the_larger_stays() {
    let both = shapes::two_components(4, 1.0);
    let params = Params { keep_largest_component: true, ..Params::default() };
    let clipped = clip(&both, &Picks::default(), &params).expect("the larger grid");
    assert_eq!((clipped.mesh.polygons.len(), clipped.dropped_components), (16, 1));
}

#[test]
fn what_cannot_be_done_says_why() {
    let grid = shapes::grid(2, 1.0);
    let nowhere = Region::Above { axis: 2, value_mm: 1.0 };
    let params = Params { keep_regions: vec![nowhere], ..Params::default() };
    let error = clip(&grid, &Picks::default(), &params).err();
    assert!(matches!(error, Some(Error::NothingLeft { face_count: 4, .. })), "{error:?}");
    let error = clip(&grid, &Picks { cuts: vec![&[0, 9]], ..Picks::default() }, &Params::default()).err();
    assert_eq!(error, Some(Error::VertexOutOfRange { vertex: 9, vertex_count: 9 }));
    let both = shapes::two_components(4, 1.0);
    let error = clip(&both, &Picks { cuts: vec![&[0, 30]], ..Picks::default() }, &Params::default()).err();
    assert_eq!(error, Some(Error::NoWay { from: 0, to: 30 }));
    let flat = Region::Sphere { center_mm: [0.0; 3], radius_mm: -1.0 };
    let params = Params { keep_regions: vec![flat], ..Params::default() };
    assert!(matches!(clip(&grid, &Picks::default(), &params), Err(Error::Parameter(_))));
}

#[test]
fn a_face_stays_one_piece_with_its_openings() {
    let scan = "../../../fixtures/tiny-face/00-virtual-rig/take/scan.obj";
    let face = artifact::obj::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(scan), artifact::Unit::Mm);
    let face = face.expect("the tiny face");
    let params = Params {
        keep_regions: vec![Region::Below { axis: 1, value_mm: 90.0 }],
        drop_non_manifold: true,
        keep_largest_component: true,
        ..Params::default()
    };
    let clipped = clip(&face, &Picks::default(), &params).expect("the face below the hair");
    let sound = around(&clipped.mesh);
    assert_eq!((sound.components().1, sound.boundary_loops().len()), (1, 4));
    assert!(sound.bow_ties().is_empty() && sound.non_manifold_edges().is_empty());
    assert_maps_agree(&face, &clipped);
}

proptest! {
    #[test]
    fn any_ball_and_any_cut_keep_positions_and_maps(
        x in 0.0..8.0f64, y in 0.0..8.0f64, radius in 1.5..6.0f64, cut in prop::collection::vec(0u32..81, 2..5)
    ) {
        let grid = shapes::bump_plane(8, 1.0, 2.0, 2.0);
        let mut cut = cut;
        cut.dedup();
        prop_assume!(cut.len() > 1);
        let ball = Region::Sphere { center_mm: [x, y, 0.0], radius_mm: radius };
        let params = Params { remove_regions: vec![ball], drop_non_manifold: true, ..Params::default() };
        let Ok(clipped) = clip(&grid, &Picks { cuts: vec![&cut], ..Picks::default() }, &params) else {
            return Ok(());
        };
        assert_maps_agree(&grid, &clipped);
        let sound = around(&clipped.mesh);
        prop_assert!(sound.bow_ties().is_empty() && sound.non_manifold_edges().is_empty());
        let before = described(&grid);
        prop_assert!(described(&clipped.mesh).iter().all(|face| before.contains(face)));
    }
}
