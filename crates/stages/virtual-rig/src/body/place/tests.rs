//! On a made-up head.

use super::*;
use crate::body::face::outline::{EYE_HALF_WIDTH, eye_center, lid_edges, mouth_line};

/// A mask of the average face in quads of 4 mm, with its landmarks; cut open along the mouth if asked, the lips touching.
pub(in crate::body) fn test_head(open_mouth: bool) -> (mesh::Mesh, Vec<Pick>) {
    const SIDE: i32 = 23;
    const ROWS: std::ops::Range<i32> = -24..27;
    let average = Person::of_seed(0);
    let row_length = (2 * SIDE + 1) as u32;
    let mut mesh = mesh::Mesh::default();
    for row in ROWS {
        for column in -SIDE..=SIDE {
            let (s, v) = (4.0 * f64::from(column), 4.0 * f64::from(row));
            // The row at −28 runs along the mouth.
            let t = v + (mouth_line(s) + 28.0) * (-((v + 28.0) / 15.0).powi(2)).exp();
            mesh.positions.push(surface::point(&average, Point2::new(s, t)));
        }
    }
    let vertex = |column: i32, row: i32| (row - ROWS.start) as u32 * row_length + (column + SIDE) as u32;
    let mut second = std::collections::HashMap::new();
    for column in -5..=5 {
        mesh.positions.push(mesh.positions[vertex(column, -7) as usize]);
        second.insert(vertex(column, -7), mesh.positions.len() as u32 - 1);
    }
    for row in ROWS.start..ROWS.end - 1 {
        for column in -SIDE..SIDE {
            let quad = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| vertex(column + i, row + j));
            let is_lower_lip = open_mouth && row == -8;
            mesh.polygons.push(&quad.map(|corner| match second.get(&corner) {
                Some(&lower) if is_lower_lip => lower,
                _ => corner,
            }));
        }
    }
    if !open_mouth {
        mesh.positions.truncate(mesh.positions.len() - second.len());
    }
    let pick = |landmark: &Landmark| Pick {
        marker: landmark.name.to_string(),
        place: PickPlace::Point(surface::point(&average, landmark.at.into())),
    };
    (mesh, LANDMARKS.iter().map(pick).collect())
}

fn at(name: &str) -> Point2<f64> {
    LANDMARKS.iter().find(|landmark| landmark.name == name).expect(name).at.into()
}

#[test]
fn the_table_agrees_with_the_contours() {
    let average = Person::of_seed(0);
    for (side, end) in [(1.0, "l"), (-1.0, "r")] {
        let center = eye_center(&average, side);
        let (lower, upper) = lid_edges(&average, side, center.x).expect("inside the eye");
        assert!((at(&format!("lid_upper_{end}")) - Point2::new(center.x, upper)).norm() < 0.1);
        assert!((at(&format!("lid_lower_{end}")) - Point2::new(center.x, lower)).norm() < 0.1);
        for (name, u) in [("inner", -1.0), ("outer", 1.0)] {
            let s = center.x + side * u * EYE_HALF_WIDTH;
            let (t, _) = lid_edges(&average, side, s).expect("a corner");
            assert!((at(&format!("eye_{name}_{end}")) - Point2::new(s, t)).norm() < 0.1);
        }
        let corner = at(&format!("mouth_corner_{end}"));
        assert!((corner - Point2::new(25.0 * side, mouth_line(25.0))).norm() < 0.1);
    }
    assert!((at("lip_line").y - mouth_line(0.0)).abs() < 0.1);
}

#[test]
fn the_table_agrees_with_the_profile() {
    let average = Person::of_seed(0);
    let z = |t: f64| surface::point(&average, Point2::new(0.0, t)).z;
    let extreme = |low: f64, high: f64, sign: f64| {
        let steps = (0..=1000).map(|i| low + (high - low) * f64::from(i) / 1000.0);
        steps.max_by(|a, b| (sign * z(*a)).total_cmp(&(sign * z(*b)))).unwrap_or(low)
    };
    let off = [
        ("nose_tip", extreme(-5.0, 20.0, 1.0), 1.0),
        ("nose_root", extreme(35.0, 56.0, -1.0), 1.5),
        ("chin_crease", extreme(-50.0, -38.0, -1.0), 1.5),
        ("chin", extreme(-68.0, -50.0, 1.0), 2.0),
    ]
    .map(|(name, t, tolerance)| ((t - at(name).y).abs() >= tolerance).then_some((name, t)));
    assert_eq!(off, [None; 4]);
}

#[test]
fn names_are_mirrored_and_unique() {
    for landmark in &LANDMARKS {
        assert_eq!(LANDMARKS.iter().filter(|other| other.name == landmark.name).count(), 1);
        if let Some(stem) = landmark.name.strip_suffix("_l") {
            let other = at(&format!("{stem}_r"));
            assert_eq!([-other.x, other.y], landmark.at, "{}", landmark.name);
        }
    }
    assert_eq!(closest_name("brow_iner_l"), "brow_inner_l");
}

fn place_of(picks: &mut [Pick], name: &str) -> usize {
    picks.iter().position(|pick| pick.marker == name).expect(name)
}

fn error(change: impl Fn(&mut Vec<Point3<f64>>, &mut Vec<Pick>)) -> String {
    let (head, mut picks) = test_head(false);
    let mut points = head.positions;
    change(&mut points, &mut picks);
    Placement::of(&points, Unit::Mm, &picks).expect_err("refused").to_string()
}

#[test]
fn the_average_face_lies_on_itself() {
    let (head, picks) = test_head(false);
    let placement = Placement::of(&head.positions, Unit::Mm, &picks).expect("a face");
    assert!((placement.face_from_canonical.to_homogeneous() - nalgebra::Matrix4::identity()).norm() < 1e-9);
    let average = Person::of_seed(0);
    let grid =
        (-16..=16).flat_map(|i| (-15..=22).map(move |j| Point2::new(5.0 * f64::from(i), 4.0 * f64::from(j))));
    // Below the jaw's edge the skin turns inwards: nothing is placed there.
    let face = grid.filter(|at| at.y > surface::jaw_line(&average, at.x) + 5.0);
    let error = |at: Point2<f64>| ((placement.domain_at(&surface::point(&average, at)) - at).norm(), at);
    let worst = face.map(error).max_by(|a, b| a.0.total_cmp(&b.0)).expect("points");
    assert!(worst.0 < 7.0, "{worst:?}");
}

#[test]
fn landmarks_are_met() {
    let (mut head, mut picks) = test_head(false);
    // Another face: wider, longer, with another nose.
    let other = |p: Point3<f64>| Point3::new(1.1 * p.x, 0.95 * p.y, p.z + 4.0 * (p.y / 20.0).sin());
    head.positions.iter_mut().for_each(|point| *point = other(*point));
    for pick in &mut picks {
        if let PickPlace::Point(point) = &mut pick.place {
            *point = other(*point);
        }
    }
    let placement = Placement::of(&head.positions, Unit::Mm, &picks).expect("a face");
    for (pick, landmark) in picks.iter().zip(&LANDMARKS) {
        let PickPlace::Point(point) = pick.place else { continue };
        assert!((placement.domain_at(&point) - Point2::from(landmark.at)).norm() < 0.01, "{}", pick.marker);
    }
}

#[test]
fn a_head_elsewhere_and_of_another_size_unrolls_alike() {
    let (head, mut picks) = test_head(false);
    let there = Similarity3::new(
        nalgebra::Vector3::new(20., 1600., -40.),
        nalgebra::Vector3::new(0.3, -0.7, 0.2),
        1.2,
    );
    let here = Placement::of(&head.positions, Unit::Mm, &picks).expect("a face");
    for pick in &mut picks {
        if let PickPlace::Point(point) = &mut pick.place {
            *point = there * *point;
        }
    }
    let moved: Vec<Point3<f64>> = head.positions.iter().map(|point| there * point).collect();
    let placement = Placement::of(&moved, Unit::Mm, &picks).expect("a face");
    let pairs = here.domain(&head.positions).into_iter().zip(placement.domain(&moved));
    assert!(pairs.into_iter().all(|(one, other)| (one - other).norm() < 1e-6));
}

#[test]
fn the_back_of_the_head_is_far_from_the_face() {
    let (head, picks) = test_head(false);
    let placement = Placement::of(&head.positions, Unit::Mm, &picks).expect("a face");
    for x in [-40.0, -5.0, 5.0, 40.0] {
        assert!(placement.domain_at(&Point3::new(x, 60.0, -110.0)).x.abs() > 130.0);
    }
}

#[test]
fn a_wrong_unit_is_named() {
    let said = error(|points, _| points.iter_mut().for_each(|point| *point *= 0.001));
    assert!(said.ends_with("mm large when read in mm; a head has 100 to 500 mm: is its unit m?"), "{said}");
    let said = error(|points, _| points.iter_mut().for_each(|point| *point *= 10.0));
    assert!(said.ends_with("a head has 100 to 500 mm"), "{said}");
}

#[test]
fn wrong_picks_are_named() {
    let said = error(|_, picks| picks[3].marker = "eye_outr_r".into());
    assert_eq!(said, "landmark eye_outr_r is not known; the closest name is eye_outer_r");
    let said = error(|_, picks| picks.truncate(11));
    assert_eq!(said, "11 landmarks; at least 12 are needed, spread over the face");
    let said = error(|points, picks| picks[0].place = PickPlace::Vertex(points.len() as u32));
    assert!(said.starts_with("landmark eye_inner_l: vertex "), "{said}");
    let said = error(|_, picks| {
        let (one, other) = (place_of(picks, "brow_mid_l"), place_of(picks, "mouth_corner_l"));
        picks[one].place = picks[other].place;
    });
    assert!(said.starts_with("landmark brow_mid_l lies "), "{said}");
    let said = error(|_, picks| picks[7].place = PickPlace::Point(Point3::new(0.0, 0.0, 0.1)));
    assert!(said.starts_with("landmark lid_lower_r lies "), "{said}");
}

#[test]
fn exchanged_sides_are_named() {
    let said = error(|_, picks| {
        for pick in picks {
            let stem = pick.marker.strip_suffix("_l").map(|stem| format!("{stem}_r"));
            let other = || pick.marker.strip_suffix("_r").map(|stem| format!("{stem}_l"));
            pick.marker = stem.or_else(other).unwrap_or_else(|| pick.marker.clone());
        }
    });
    assert_eq!(said, "left and right are exchanged: _l is the subject's left, at +x");
}
