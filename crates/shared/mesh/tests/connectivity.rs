//! What lies beside what, on meshes whose answers are known.

use mesh::{Connectivity, Mesh, shortest_way};
use proptest::prelude::*;
use testkit::shapes;

fn around(mesh: &Mesh) -> Connectivity {
    Connectivity::of(mesh.positions.len(), &mesh.triangles())
}

#[test]
fn a_sphere_is_closed_and_a_grid_has_one_rim() {
    let (sphere, grid) = (around(&shapes::sphere(10.0, 8)), around(&shapes::grid(6, 1.0)));
    assert!(sphere.boundary_loops().is_empty());
    // Euler's formula: V − E + F = 2 for a sphere, 1 for a disc.
    let mesh = shapes::sphere(10.0, 8);
    let euler = mesh.positions.len() as i64 - sphere.edge_count() as i64 + mesh.triangles().len() as i64;
    assert_eq!(euler, 2);
    let loops = grid.boundary_loops();
    assert_eq!((loops.len(), loops[0].len()), (1, 24));
    for around in [sphere, grid] {
        assert!(around.non_manifold_edges().is_empty() && around.flipped_edges().is_empty());
        assert!(around.bow_ties().is_empty() && around.unreferenced().is_empty());
        assert_eq!(around.components().1, 1);
    }
}

#[test]
fn faults_are_found_where_they_are() {
    let book = around(&shapes::open_book());
    assert_eq!(book.non_manifold_edges().len(), 1);
    assert_eq!(book.non_manifold_edges()[0].triangles.len(), 3);
    assert_eq!(around(&shapes::bow_tie()).bow_ties().len(), 1);
    let two = shapes::two_components(3, 1.0);
    let (labels, count) = around(&two).components();
    assert_eq!((count, labels[0], *labels.last().unwrap_or(&9)), (2, 0, 1));

    let mut turned = shapes::grid(2, 1.0);
    turned.polygons = mesh::Polygons::default();
    [[0u32, 1, 4], [0, 3, 4]].iter().for_each(|triangle| turned.polygons.push(triangle));
    let turned = around(&turned);
    assert_eq!(turned.flipped_edges().len(), 1);
    assert_eq!(turned.flipped_edges()[0].vertices, [0, 4]);
    assert_eq!(turned.unreferenced(), [2, 5, 6, 7, 8]);
}

/// Around a bow tie each loop stays within its own fan.
#[test]
fn loops_do_not_cross_at_a_bow_tie() {
    let loops = around(&shapes::bow_tie()).boundary_loops();
    assert!(loops.len() >= 2, "{loops:?}");
    for vertices in loops {
        let mut seen = vertices.clone();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), vertices.len(), "a loop visits a vertex once");
    }
}

/// Along a grid's edges the way is as long as its steps; a limit below that finds none, nor does another part.
#[test]
fn ways_are_shortest_and_keep_their_limit() {
    let grid = shapes::grid(5, 2.0);
    let mut edges = vec![Vec::new(); 36];
    for polygon in grid.polygons.iter() {
        (0..4).for_each(|i| edges[polygon[i] as usize].push(polygon[(i + 1) % 4]));
        (0..4).for_each(|i| edges[polygon[(i + 1) % 4] as usize].push(polygon[i]));
    }
    let way =
        |to: u32, limit: f64| shortest_way(&grid.positions, |v| edges[v as usize].as_slice(), 0, to, limit);
    assert_eq!(way(3, f64::INFINITY), Some(vec![0, 1, 2, 3]));
    assert_eq!(way(35, 20.0).map(|way| way.len()), Some(11));
    assert_eq!(way(35, 19.9), None);
    assert_eq!(way(0, 0.0), Some(vec![0]));
    let two = shapes::two_components(3, 1.0);
    let (starts, all) = around(&two).one_rings();
    let ring = |v: u32| &all[starts[v as usize]..starts[v as usize + 1]];
    let last = two.positions.len() as u32 - 1;
    assert_eq!(shortest_way(&two.positions, ring, 0, last, f64::INFINITY), None);
}

proptest! {
    /// Cutting out any faces: the map and its inverse agree, positions stay, and every kept face is what it was.
    #[test]
    fn cutting_keeps_what_it_keeps(flags in prop::collection::vec(any::<bool>(), 36)) {
        let mesh = shapes::grid(6, 2.0);
        let (cut, map) = mesh.keep_faces(&flags);
        prop_assert_eq!(cut.positions.len(), map.old_from_new.len());
        for (new, &old) in map.old_from_new.iter().enumerate() {
            prop_assert_eq!(map.new_from_old[old as usize], Some(new as u32));
            prop_assert_eq!(cut.positions[new], mesh.positions[old as usize]);
        }
        let kept: Vec<usize> = (0..36).filter(|&face| flags[face]).collect();
        prop_assert_eq!(cut.polygons.len(), kept.len());
        for (new, &old) in kept.iter().enumerate() {
            let back: Vec<u32> = cut.polygons.face(new).iter().map(|&v| map.old_from_new[v as usize]).collect();
            prop_assert_eq!(&back[..], mesh.polygons.face(old));
            for (a, b) in cut.polygons.corner_range(new).zip(mesh.polygons.corner_range(old)) {
                let (a, b) = (cut.corner_uvs[a] as usize, mesh.corner_uvs[b] as usize);
                prop_assert_eq!(cut.uvs[a], mesh.uvs[b]);
            }
        }
        prop_assert!(cut.labels.iter().all(|label| label.first_face < cut.polygons.len()));
    }

    /// Neighbours are mutual, and one-rings hold every edge twice.
    #[test]
    fn one_rings_are_mutual(rings in 3u32..9) {
        let mesh = shapes::sphere(5.0, rings);
        let around = around(&mesh);
        let (starts, neighbors) = around.one_rings();
        prop_assert_eq!(neighbors.len(), 2 * around.edge_count());
        let of = |vertex: usize| &neighbors[starts[vertex]..starts[vertex + 1]];
        for vertex in 0..mesh.positions.len() {
            prop_assert!(of(vertex).windows(2).all(|pair| pair[0] < pair[1]));
            prop_assert!(of(vertex).iter().all(|&other| of(other as usize).contains(&(vertex as u32))));
        }
    }
}
