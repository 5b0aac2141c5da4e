//! Laws of a plan, on a mask with a mouth and two eyes.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use marker_plan::{Error, Frame, Params, Plan, Planned, plan};
use mesh::Mesh;
use nalgebra::{Point3, Rotation3, Vector3};
use proptest::prelude::*;
use testkit::shapes;

/// A vaulted mask of 150 × 200 mm; seen from +z, x goes to the face's own left.
fn mask(cells: u32) -> Mesh {
    let side = 200.0;
    let flat = shapes::grid(cells, side / f64::from(cells));
    let vault = |p: &Point3<f64>| {
        let (x, y) = (p.x - 100.0, p.y - 100.0);
        Point3::new(x * 0.75, y, 60.0 - x * x / 160.0 - y * y / 260.0)
    };
    let vaulted = flat.with_positions(flat.positions.iter().map(vault).collect());
    let middle = |face: &[u32]| {
        face.iter().map(|&v| vaulted.positions[v as usize].coords).sum::<Vector3<f64>>() / face.len() as f64
    };
    let inside = |c: &Vector3<f64>, x: f64, y: f64, rx: f64, ry: f64| {
        ((c.x - x) / rx).powi(2) + ((c.y - y) / ry).powi(2) < 1.0
    };
    let keep: Vec<bool> = vaulted
        .polygons
        .iter()
        .map(|face| {
            let c = middle(face);
            !(inside(&c, 0.0, -40.0, 26.0, 4.0)
                || inside(&c, 31.0, 32.0, 14.0, 6.0)
                || inside(&c, -31.0, 32.0, 14.0, 6.0))
        })
        .collect();
    vaulted.keep_faces(&keep).0
}

fn params(count: usize) -> Params {
    Params { count, ..Params::default() }
}

fn places(mesh: &Mesh, plan: &Plan) -> Vec<Vector3<f64>> {
    plan.markers.iter().map(|marker| plan.frame.place(&mesh.positions[marker.vertex as usize])).collect()
}

fn find<'a>(plan: &'a Plan, name: &str) -> &'a Planned {
    plan.markers.iter().find(|marker| marker.marker == name).unwrap()
}

#[test]
fn a_plan_is_symmetric_apart_and_complete() {
    let mesh = mask(66);
    let plan = plan(&mesh, &params(60)).unwrap();
    assert_eq!(plan.markers.len(), 60);
    assert!(plan.asymmetry_mm < 1.0, "{}", plan.asymmetry_mm);
    assert!(plan.least_distance_mm >= 5.0, "{}", plan.least_distance_mm);
    let places = places(&mesh, &plan);
    for (at, marker) in plan.markers.iter().enumerate() {
        let mirror = marker.mirror.unwrap_or(at);
        assert_eq!(plan.markers[mirror].mirror.unwrap_or(mirror), at, "{}", marker.marker);
        let image = Vector3::new(-places[mirror].x, places[mirror].y, places[mirror].z);
        // A cell is 3 mm wide, so its corners are no further than two from where an image falls.
        assert!((places[at] - image).norm() < 6.0 || marker.mirror.is_none(), "{}", marker.marker);
    }
    assert!(plan.markers.iter().filter(|marker| marker.mirror.is_none()).count() <= 2);
    let mut names: Vec<&str> = plan.markers.iter().map(|marker| marker.marker.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), 60);
}

/// Every name says where its marker is.
#[test]
fn features_stand_beside_their_edges() {
    let mesh = mask(80);
    let plan = plan(&mesh, &params(40)).unwrap();
    let place = |name: &str| plan.frame.place(&mesh.positions[find(&plan, name).vertex as usize]);
    let mouth = -72.0;
    assert!(place("lip_corner_l").x > 20.0 && place("lip_corner_r").x < -20.0);
    for (name, above) in [
        ("lip_upper_middle", true),
        ("lip_upper_l", true),
        ("lip_lower_middle", false),
        ("lip_lower_r", false),
    ] {
        assert_eq!(place(name).y > mouth, above, "{name} at {}", place(name));
        assert!((place(name).y - mouth).abs() < 12.0, "{name}");
    }
    assert!(place("lid_upper_l").y > 4.0 && place("lid_lower_l").y < -4.0 && place("lid_upper_l").x > 20.0);
    assert!(place("lid_upper_r").y > 4.0 && place("lid_upper_r").x < -20.0);
    let rest: Vec<&Planned> = plan.markers.iter().filter(|marker| marker.marker.starts_with('m')).collect();
    assert_eq!(rest.len(), 28);
    assert!(
        rest.iter().filter(|m| m.marker.ends_with("_l")).all(|m| plan
            .frame
            .place(&mesh.positions[m.vertex as usize])
            .x
            > 0.0)
    );
}

/// Markers near the lips stand closer together than on the forehead.
#[test]
fn density_follows_the_lips() {
    let mesh = mask(80);
    let spacing = |density: f64| {
        let params =
            Params { lip_density: density, lid_density: 1.0, lip_points: 0, lid_points: 0, ..params(60) };
        let plan = plan(&mesh, &params).unwrap();
        let places = places(&mesh, &plan);
        let around = places.iter().filter(|p| p.x.abs() < 45.0 && (p.y + 72.0).abs() < 22.0).count();
        assert_eq!(places.len(), 60);
        around
    };
    let (dense, even) = (spacing(2.5), spacing(1.0));
    assert!(dense > even + 4, "{dense} and {even}");
}

#[test]
fn nothing_stands_at_the_border_or_too_close() {
    let mesh = mask(66);
    let wide = Params { border_mm: 20.0, least_distance_mm: 9.0, ..params(30) };
    let plan = plan(&mesh, &wide).unwrap();
    assert!(plan.least_distance_mm >= 9.0);
    for marker in &plan.markers {
        let p = mesh.positions[marker.vertex as usize];
        assert!(p.x.abs() < 75.0 - 12.0 && p.y.abs() < 100.0 - 17.0, "{} at {p}", marker.marker);
    }
    let crowded = Params { least_distance_mm: 30.0, lip_points: 0, lid_points: 0, ..params(200) };
    assert!(matches!(marker_plan::plan(&mesh, &crowded), Err(Error::NoRoom { count: 200, .. })));
}

#[test]
fn openings_that_cannot_be_told_are_refused() {
    let closed = shapes::bump_plane(30, 5.0, 20.0, 40.0);
    let refused = plan(&closed, &Params::default()).unwrap_err();
    assert!(matches!(&refused, Error::Openings { lengths_mm } if lengths_mm.is_empty()));
    assert!(refused.to_string().contains("mesh-clip") && refused.to_string().contains("--mouth"));
    let named = Params { mouth: Some(40), eyes: Some([41, 42]), ..Params::default() };
    assert!(matches!(plan(&closed, &named), Err(Error::NotOnARim { vertex: 40, what: "mouth" })));
    for wrong in [
        Params { lip_points: 3, ..Params::default() },
        Params { count: 11, ..Params::default() },
        Params { lid_density: 0.5, ..Params::default() },
        Params { falloff_mm: f64::NAN, ..Params::default() },
    ] {
        assert!(plan(&closed, &wrong).is_err_and(|error| !matches!(error, Error::Openings { .. })));
    }
}

/// Rims that are named are the rims that are found.
#[test]
fn named_rims_give_the_same_plan() {
    let mesh = mask(66);
    let on_rim = |x: f64, y: f64| {
        let around = mesh::Connectivity::of(mesh.positions.len(), &mesh.triangles());
        let far = |v: &u32| (mesh.positions[*v as usize].xy() - Point3::new(x, y, 0.0).xy()).norm();
        around.boundary_loops().into_iter().flatten().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap()
    };
    let named = Params {
        mouth: Some(on_rim(0.0, -40.0)),
        eyes: Some([on_rim(31.0, 32.0), on_rim(-31.0, 32.0)]),
        ..params(40)
    };
    assert_eq!(plan(&mesh, &named).unwrap().markers, plan(&mesh, &params(40)).unwrap().markers);
}

fn frame_of(plan: &Plan) -> &Frame {
    &plan.frame
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    /// However a scan is turned and placed, the markers stand nearly where they stood: seen from its own frame it is the same face.
    #[test]
    fn a_rigid_motion_takes_the_plan_along(angles in prop::array::uniform3(-3.0..3.0f64), shift in prop::array::uniform3(-500.0..500.0f64)) {
        let mesh = mask(50);
        let turn = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        let moved = mesh.with_positions(mesh.positions.iter().map(|p| turn * p + Vector3::from(shift)).collect());
        let (here, there) = (plan(&mesh, &params(40)).unwrap(), plan(&moved, &params(40)).unwrap());
        prop_assert!((frame_of(&here).eye_distance_mm - frame_of(&there).eye_distance_mm).abs() < 1e-6);
        for name in ["lip_corner_l", "lip_upper_middle", "lid_lower_r"] {
            let [a, b] = [&here, &there].map(|plan| mesh.positions[find(plan, name).vertex as usize]);
            // Two vertices of this mask may be equally near to a corner; rounding chooses.
            prop_assert!((a - b).norm() < 9.0, "{name}: {a} and {b}");
        }
        prop_assert!((here.largest_gap_mm - there.largest_gap_mm).abs() < 8.0);
    }
}

/// The same scan gives the same plan, with any number of threads.
#[test]
fn a_plan_is_deterministic() {
    let mesh = mask(60);
    let made = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| plan(&mesh, &params(50)).unwrap())
    };
    assert_eq!(made(1), made(3));
}
