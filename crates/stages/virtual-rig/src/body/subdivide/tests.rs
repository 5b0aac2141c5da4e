use super::*;
use mesh::LabelKind;

fn octahedron() -> Mesh {
    let points = vec![[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    Mesh::from_triangles(points, &faces)
}

/// A flat grid of 6 × 6 quads, with two labels and texture coordinates that tear along the middle column.
fn sheet() -> Mesh {
    let mut mesh = Mesh::default();
    for row in 0..7 {
        for column in 0..7 {
            mesh.positions.push(Point3::new(f64::from(column), f64::from(row), 0.0));
        }
    }
    for row in 0..6u32 {
        for column in 0..6u32 {
            let quad = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| (column + i, row + j));
            mesh.polygons.push(&quad.map(|(column, row)| 7 * row + column));
            for (i, j) in quad {
                let island = if column < 3 { 0.0 } else { 10.0 };
                mesh.corner_uvs.push(mesh.uvs.len() as u32);
                mesh.uvs.push(Vector2::new(f64::from(i) + island, f64::from(j)));
            }
        }
    }
    let label = |first_face, name: &str| Label { first_face, kind: LabelKind::Group, name: name.into() };
    mesh.labels = vec![label(0, "low"), label(18, "high")];
    mesh
}

#[test]
fn counts_and_weights_add_up() {
    let refined = Refined::of(&octahedron(), 3);
    let around = Connectivity::of(refined.mesh.positions.len(), &refined.mesh.triangles());
    assert_eq!(refined.mesh.polygons.len(), 8 * 64);
    assert_eq!(refined.mesh.positions.len() + refined.mesh.polygons.len() - around.edge_count(), 2);
    assert!(around.boundary_loops().is_empty() && around.flipped_edges().is_empty());
    for stencil in &refined.stencils {
        for row in 0..stencil.starts.len() - 1 {
            assert!((stencil.row(row).iter().map(|entry| entry.1).sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }
}

/// [Loop1987]: a valence-6 vertex keeps 5/8, one of valence 3 keeps 7/16; an octahedron's (4) keeps 31/64.
#[test]
fn weights_are_the_papers() {
    let (_, stencil) = refine_once(&octahedron());
    let own = |vertex: usize| stencil.row(vertex)[0];
    let expected = 1.0 - (0.625 - 0.375f64.powi(2));
    assert!((own(0).1 - expected).abs() < 1e-15);
    let (_, stencil) = refine_once(&sheet());
    assert!((stencil.row(24)[0].1 - 0.625).abs() < 1e-15);
    assert!(stencil.row(24)[1..].iter().all(|entry| (entry.1 - 0.0625).abs() < 1e-15));
    assert_eq!(stencil.row(3), [(3, 0.75), (2, 0.125), (4, 0.125)]);
}

#[test]
fn flat_stays_flat_and_affine() {
    let sheet = sheet();
    let refined = Refined::of(&sheet, 2);
    // Inside, regular Loop subdivision reproduces affine maps; at the corners the boundary is rounded.
    for (point, field) in refined.mesh.positions.iter().zip(refined.field(&coordinates(&sheet.positions))) {
        assert_eq!(point.coords, field);
        assert_eq!(point.z, 0.0);
    }
    assert!((refined.mesh.positions[24] - Point3::new(3.0, 3.0, 0.0)).norm() < 1e-12);
}

#[test]
fn a_boundary_ignores_what_is_inside() {
    let mut bent = sheet();
    bent.positions[24].z = 5.0;
    bent.positions[8].z = -3.0;
    for (one, other) in
        Refined::of(&sheet(), 2).mesh.positions.iter().zip(&Refined::of(&bent, 2).mesh.positions)
    {
        if one.x.min(one.y) < 1e-9 || one.x.max(one.y) > 6.0 - 1e-9 {
            assert_eq!(one, other);
        }
    }
}

#[test]
fn seams_stay_seams() {
    let refined = Refined::of(&sheet(), 2).mesh;
    assert_eq!(refined.corner_uvs.len(), 3 * refined.polygons.len());
    for (corner, uv) in refined.polygons.corners().iter().zip(&refined.corner_uvs) {
        let (point, uv) = (refined.positions[*corner as usize], refined.uvs[*uv as usize]);
        let island = if uv.x > 5.0 { 10.0 } else { 0.0 };
        assert!((uv.x - island - point.x).abs() < 0.3 && (uv.y - point.y).abs() < 0.3, "{uv} at {point}");
        assert!(uv.x <= 3.0 + 1e-9 || uv.x >= 13.0 - 1e-9, "nothing lies between the islands");
    }
    // Both sides of the seam run along x = 3 in space.
    let on_seam = |island: f64| {
        let corners = refined.polygons.corners().iter().zip(&refined.corner_uvs);
        let uvs = corners.filter(|(v, _)| (refined.positions[**v as usize].x - 3.0).abs() < 1e-9);
        uvs.filter(|(_, uv)| (refined.uvs[**uv as usize].x - 3.0 - island).abs() < 1e-9).count()
    };
    assert!(on_seam(0.0) > 24 && on_seam(10.0) > 24);
}

#[test]
fn labels_keep_their_faces() {
    let refined = Refined::of(&sheet(), 1).mesh;
    let firsts: Vec<usize> = refined.labels.iter().map(|label| label.first_face).collect();
    assert_eq!(firsts, [0, 18 * 2 * 4]);
    let high = refined.polygons.face(firsts[1]);
    assert!(high.iter().all(|&vertex| refined.positions[vertex as usize].y >= 3.0));
}

#[test]
fn levels_refine_what_was_refined() {
    let twice = Refined::of(&Refined::of(&sheet(), 1).mesh, 1).mesh;
    assert_eq!(twice, Refined::of(&sheet(), 2).mesh);
}

/// Three triangles on one edge: nothing breaks, and the edge stays where it is.
#[test]
fn a_fin_is_borne() {
    let points = vec![[0., 0., 0.], [0., 0., 1.], [1., 0., 0.], [-1., 1., 0.], [-1., -1., 0.]];
    let fin = Mesh::from_triangles(points, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    let refined = Refined::of(&fin, 2).mesh;
    assert_eq!(refined.polygons.len(), 48);
    assert_eq!(refined.positions[0], Point3::origin());
}
