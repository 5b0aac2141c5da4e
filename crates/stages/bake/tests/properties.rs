//! Laws of baking.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use bake::{Corner, Error, High, Low, Params, Tile, bake, follow};
use mesh::{Label, LabelKind, Mesh};
use nalgebra::{Isometry3, Matrix3, Point3, Vector2, Vector3};
use proptest::prelude::*;
use testkit::shapes;

const SIDE_MM: f64 = 40.0;

/// A bent patch without detail, and the height of its relief.
fn bend(x: f64, y: f64) -> f64 {
    0.012 * (x - 20.0).powi(2) - 0.006 * (y - 14.0).powi(2)
}

fn groove(x: f64, y: f64) -> f64 {
    let p = (x - 20.0) * 0.8 + (y - 20.0) * 0.6;
    -0.6 * (-0.5 * p * p).exp()
}

fn patch(cells: u32, height: impl Fn(f64, f64) -> f64) -> Mesh {
    shapes::relief(cells, SIDE_MM / f64::from(cells), height)
}

fn small() -> Params {
    Params { size: 64, samples: 1, padding: 2, ..Params::default() }
}

fn baked(low: &Mesh, high: &Mesh, params: &Params) -> Tile {
    let high = High::of(high, &high.positions).unwrap();
    bake(&Low::of(low).unwrap(), &high, params, || ()).unwrap().0.remove(0)
}

/// The normal in the axes of space that a renderer gets from a map at texture coordinates: from the triangle under them.
fn rendered(low: &Low, tile: &Tile, uv: Vector2<f64>) -> Vector3<f64> {
    let shares = |triangle: &[Corner; 3]| {
        let [a, b, c] = [0, 1, 2].map(|k| triangle[k].uv - uv);
        let area = (triangle[1].uv - triangle[0].uv).perp(&(triangle[2].uv - triangle[0].uv));
        [b.perp(&c) / area, c.perp(&a) / area, a.perp(&b) / area]
    };
    let (triangle, shares) =
        low.triangles.iter().map(|t| (t, shares(t))).find(|(_, s)| s.iter().all(|s| *s >= -1e-9)).unwrap();
    let mixed = |of: fn(&Corner) -> Vector3<f64>| -> Vector3<f64> {
        triangle.iter().zip(shares).map(|(corner, share)| of(corner) * share).sum()
    };
    let (normal, tangent) = (mixed(|corner| corner.normal), mixed(|corner| corner.tangent.along));
    let texel = |x: f64| ((x * tile.size as f64) as usize).min(tile.size - 1);
    let value = tile.normals[texel(1.0 - uv.y) * tile.size + texel(uv.x)].map(f64::from);
    let frame = [tangent, triangle[0].tangent.sign * normal.cross(&tangent), normal];
    (Matrix3::from_columns(&frame) * Vector3::from(value)).normalize()
}

fn middle(tile: &Tile, column: usize, row: usize) -> Vector2<f64> {
    Vector2::new(column as f64 + 0.5, (tile.size - row) as f64 - 0.5) / tile.size as f64
}

#[test]
fn a_surface_baked_onto_itself_is_flat() {
    let mesh = patch(12, bend);
    let tile = baked(&mesh, &mesh, &small());
    for (normal, height) in tile.normals.iter().zip(&tile.displacement_mm) {
        assert!(normal[2] > 1.0 - 1e-6 && height.abs() < 1e-6, "{normal:?} {height}");
    }
}

#[test]
fn a_renderer_sees_the_normals_of_the_wrinkled_surface() {
    let height = |x: f64, y: f64| bend(x, y) + groove(x, y);
    let low = patch(8, bend);
    let tile = baked(&low, &patch(160, height), &small());
    let low = Low::of(&low).unwrap();
    let mut degrees = Vec::new();
    for at in 0..tile.size * tile.size {
        let uv = middle(&tile, at % tile.size, at / tile.size);
        // Under a bent mesh the ray meets the surface beside the texel: the place is found from the displacement.
        let flat = uv * SIDE_MM;
        let found = rendered(&low, &tile, uv);
        let near = |x: f64, y: f64| {
            let step = 1e-5;
            let slope = |dx: f64, dy: f64| (height(x + dx, y + dy) - height(x - dx, y - dy)) / (2.0 * step);
            Vector3::new(-slope(step, 0.0), -slope(0.0, step), 1.0).normalize()
        };
        let reach = [-0.4, -0.2, 0.0, 0.2, 0.4];
        let around = reach.iter().flat_map(|dx| reach.map(|dy| near(flat.x + dx, flat.y + dy)));
        degrees.push(around.map(|truth| truth.angle(&found).to_degrees()).fold(f64::INFINITY, f64::min));
    }
    degrees.sort_by(f64::total_cmp);
    assert!(degrees[degrees.len() * 99 / 100] < 1.0, "{}", degrees[degrees.len() * 99 / 100]);
}

#[test]
fn displacement_leads_from_one_surface_to_the_other() {
    let low = patch(8, |_, _| 0.0);
    let tile = baked(&low, &patch(160, groove), &small());
    for at in 0..tile.size * tile.size {
        let place = middle(&tile, at % tile.size, at / tile.size) * SIDE_MM;
        assert!((f64::from(tile.displacement_mm[at]) - groove(place.x, place.y)).abs() < 0.01);
    }
}

#[test]
fn the_outermost_sheet_counts_and_backs_do_not() {
    let mut high = patch(4, |_, _| 0.5);
    let mut lid = patch(4, |_, _| 1.0);
    // A sheet above that shows its back to whoever looks from outside.
    let turned: Vec<u32> = lid.polygons.corners().iter().rev().map(|&v| v + 25).collect();
    turned.chunks(4).for_each(|polygon| high.polygons.push(polygon));
    high.positions.append(&mut lid.positions);
    high.corner_uvs.clear();
    let tile = baked(&patch(2, |_, _| 0.0), &high, &small());
    assert!(tile.displacement_mm.iter().all(|height| (height - 0.5).abs() < 1e-6));
}

#[test]
fn nothing_hangs_on_the_number_of_threads() {
    let (low, high) = (patch(7, bend), patch(40, |x, y| bend(x, y) + groove(x, y)));
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| baked(&low, &high, &small()))
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn tangents_are_those_of_another_implementation() {
    struct Other<'a>(&'a Low, Vec<[[f32; 4]; 3]>);
    impl mikktspace::Geometry for Other<'_> {
        fn num_faces(&self) -> usize {
            self.0.triangles.len()
        }
        fn num_vertices_of_face(&self, _: usize) -> usize {
            3
        }
        fn position(&self, face: usize, corner: usize) -> [f32; 3] {
            self.0.triangles[face][corner].point.coords.map(|x| x as f32).into()
        }
        fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
            self.0.triangles[face][corner].normal.map(|x| x as f32).into()
        }
        fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
            self.0.triangles[face][corner].uv.map(|x| x as f32).into()
        }
        fn set_tangent_encoded(&mut self, tangent: [f32; 4], face: usize, corner: usize) {
            self.1[face][corner] = tangent;
        }
    }
    let mut mesh = patch(9, |x, y| bend(x, y) + groove(x, y));
    // The right half of the texture mirrors the left one.
    mesh.uvs.iter_mut().filter(|uv| uv.x > 0.5).for_each(|uv| uv.x = 1.0 - uv.x);
    let low = Low::of(&mesh).unwrap();
    let mut other = Other(&low, vec![[[0.0; 4]; 3]; low.triangles.len()]);
    assert!(mikktspace::generate_tangents(&mut other));
    let ours = |corner: &Corner| {
        let along = corner.tangent.along;
        [along.x, along.y, along.z, corner.tangent.sign].map(|x| x as f32)
    };
    let mut signs = [0, 0];
    for (ours, theirs) in low.triangles.iter().map(|triangle| triangle.each_ref().map(ours)).zip(&other.1) {
        assert_eq!(ours, *theirs);
        signs[usize::from(ours[0][3] < 0.0)] += 1;
    }
    assert!(signs[0] > 0 && signs[1] > 0, "both sides are there");
}

#[test]
fn smoothing_groups_and_seams() {
    let mut ridge = patch(2, |x, _| -(x - 20.0).abs());
    let normals = |mesh: &Mesh| {
        let low = Low::of(mesh).unwrap();
        let corners: Vec<Corner> = low.triangles.iter().flatten().copied().collect();
        corners.into_iter().filter(|corner| (corner.point.x - 20.0).abs() < 1e-9).map(|corner| corner.normal)
    };
    assert!(normals(&ridge.clone()).all(|normal| normal.x.abs() < 1e-12), "smooth over the ridge");
    // The two halves, cut apart as an exporter does along a seam.
    let mut cut = ridge.clone();
    cut.polygons = mesh::Polygons::default();
    for (face, polygon) in ridge.polygons.iter().enumerate() {
        let first = cut.positions.len() as u32;
        cut.positions.extend(polygon.iter().map(|&v| ridge.positions[v as usize]));
        let own: Vec<u32> = (first..first + 4).collect();
        cut.polygons.push(if face % 2 == 0 { &own } else { polygon });
    }
    assert!(normals(&cut).all(|normal| normal.x.abs() < 1e-12), "a seam is not an edge");
    ridge.labels.push(Label { first_face: 0, kind: LabelKind::Smoothing, name: "off".to_string() });
    assert!(normals(&ridge).all(|normal| (normal.x.abs() - 0.5f64.sqrt()).abs() < 1e-12), "off: flat faces");
}

#[test]
fn each_tile_gets_its_own_maps() {
    let mut mesh = patch(4, bend);
    // The right half lies on the tile above the next.
    let right: Vec<usize> = (0..mesh.polygons.len()).filter(|face| *face >= 8).collect();
    for face in right {
        for corner in mesh.polygons.corner_range(face) {
            mesh.uvs.push(mesh.uvs[mesh.corner_uvs[corner] as usize] + Vector2::new(0.5, 1.0));
            mesh.corner_uvs[corner] = mesh.uvs.len() as u32 - 1;
        }
    }
    let high = High::of(&mesh, &mesh.positions).unwrap();
    let (tiles, report) = bake(&Low::of(&mesh).unwrap(), &high, &small(), || ()).unwrap();
    assert_eq!(tiles.iter().map(|tile| tile.number).collect::<Vec<_>>(), [1001, 1012]);
    assert!((report.coverage - 0.5).abs() < 0.02, "{}", report.coverage);
    mesh.uvs.iter_mut().for_each(|uv| uv.x += 0.6);
    assert!(matches!(Low::of(&mesh), Err(Error::AcrossTiles { face: 2, .. })));
}

#[test]
fn what_cannot_be_baked_is_refused() {
    let low = Low::of(&patch(2, |_, _| 0.0)).unwrap();
    let far = patch(2, |_, _| 9.0);
    let error = bake(&low, &High::of(&far, &far.positions).unwrap(), &small(), || ()).unwrap_err();
    assert_eq!(error, Error::Apart { missed: 64 * 64, samples: 64 * 64, reach_mm: 3.0 });
    let bare = Mesh::from_triangles(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]]);
    assert_eq!(Low::of(&bare).err(), Some(Error::NoTextureCoordinates { face: 1 }));
    assert_eq!(High::of(&bare, &[]).err(), Some(Error::VertexCount { rest: 3, moved: 0 }));
    let params = Params { size: 0, ..Params::default() };
    assert!(params.check().unwrap_err().to_string().contains("--size"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn maps_do_not_hang_on_where_the_meshes_are(turn in prop::array::uniform3(-3.0..3.0f64), shift in prop::array::uniform3(-50.0..50.0f64)) {
        let (low, high) = (patch(6, bend), patch(50, |x, y| bend(x, y) + groove(x, y)));
        let motion = Isometry3::new(shift.into(), turn.into());
        let moved = |mesh: &Mesh| mesh.with_positions(mesh.positions.iter().map(|point| motion * point).collect());
        let (here, there) = (baked(&low, &high, &small()), baked(&moved(&low), &moved(&high), &small()));
        for (one, other) in here.normals.iter().zip(&there.normals) {
            prop_assert!((0..3).all(|k| (one[k] - other[k]).abs() < 2e-4), "{:?} {:?}", one, other);
        }
    }

    #[test]
    fn a_mesh_follows_rigid_motion_exactly(turn in prop::array::uniform3(-3.0..3.0f64), off in -2.0..2.0f64) {
        let rest = patch(10, bend);
        let motion = Isometry3::new(Vector3::new(5.0, -3.0, 8.0), turn.into());
        let moved: Vec<Point3<f64>> = rest.positions.iter().map(|point| motion * point).collect();
        let low = patch(3, |x, y| bend(x, y) + off);
        for (point, found) in low.positions.iter().zip(follow(&low.positions, &rest, &moved).unwrap()) {
            prop_assert!((found - motion * point).norm() < 1e-9);
        }
    }
}
