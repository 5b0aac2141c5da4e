//! Two real heads as the rig's face: a scan in metres, closed, with a picture; and an expression set in centimetres.

#![allow(clippy::expect_used, clippy::panic, reason = "helpers of tests may fail like tests")]

use artifact::picks::{self, Pick};
use artifact::{Unit, VertexPath, obj, read_document};
use mesh::{Connectivity, Mesh, shortest_way, vertex_normals};
use nalgebra::{Point2, Point3};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use virtual_rig::body::Base;
use virtual_rig::body::expressions::{ExpressionSet, Shape, expressions};
use virtual_rig::body::place::{LANDMARKS, Placement};
use virtual_rig::body::scan::{Notes, Scan, scan};
use virtual_rig::body::texture::Texture;
use virtual_rig::wrinkle::{Params, Style, Wrinkles, lines};

fn fixture(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures").join(file)
}

fn landmarks(folder: &str, unit: Unit) -> Vec<Pick> {
    picks::read(&fixture(folder).join("landmarks.csv"), unit).expect("the landmarks")
}

fn perry_smith() -> Option<Mesh> {
    Some(obj::read(&testkit::data("head_lee_perry_smith/LeePerrySmith.obj")?, Unit::M).expect("the scan"))
}

fn act_ready(head: &Mesh, texture: Option<&Texture>, levels: usize) -> Scan {
    let landmarks = landmarks("lee-perry-smith", Unit::M);
    scan(head, &Notes { unit: Unit::M, landmarks: &landmarks, texture, levels }).expect("a scan that can act")
}

/// Share of the triangles of the face's front that the map to the plane turns over.
fn folded_share(scan: &Scan) -> f64 {
    let triangles = scan.mesh.triangles();
    let normals = vertex_normals(&scan.mesh.positions, &triangles);
    let place = |vertex: u32| scan.domain[vertex as usize];
    let in_front = |&&[a, b, c]: &&[u32; 3]| {
        let middle = Point2::from((place(a).coords + place(b).coords + place(c).coords) / 3.0);
        let faces_front = [a, b, c].iter().all(|&vertex| normals[vertex as usize].z > 0.3);
        faces_front && middle.x.abs() < 85.0 && (-65.0..105.0).contains(&middle.y)
    };
    let is_folded = |&&[a, b, c]: &&[u32; 3]| (place(b) - place(a)).perp(&(place(c) - place(a))) <= 0.0;
    let front: Vec<&[u32; 3]> = triangles.iter().filter(in_front).collect();
    front.iter().filter(|triangle| is_folded(triangle)).count() as f64 / front.len() as f64
}

#[test]
fn a_real_scan_unrolls() {
    let Some(head) = perry_smith() else { return };
    let scan = act_ready(&head, None, 1);
    assert!((1.0..1.15).contains(&scan.face_from_canonical.scaling()));
    assert!(scan.residuals.iter().all(|(_, residual)| *residual < 17.0), "{:?}", scan.residuals);
    // The lids overlap: there, and in the sockets behind them, some triangles must turn over.
    assert!(folded_share(&scan) < 0.02, "{}", folded_share(&scan));
    assert!(!scan.mouth_is_open && !scan.eyes_are_open);
    let highest = (0..scan.mesh.positions.len())
        .max_by(|&a, &b| scan.mesh.positions[a].y.total_cmp(&scan.mesh.positions[b].y));
    assert!(scan.domain[highest.expect("vertices")].y > 115.0, "the crown is beyond the hair line");
}

/// Landmarks are met exactly, and points between them where one would look for them.
#[test]
fn places_are_where_one_would_look() {
    let Some(head) = perry_smith() else { return };
    let marks = landmarks("lee-perry-smith", Unit::M);
    let placement = Placement::of(&head.positions, Unit::M, &marks).expect("a face");
    for mark in &marks {
        let picks::PickPlace::Point(point) = mark.place else { panic!("picked as points") };
        let landmark = LANDMARKS.iter().find(|landmark| landmark.name == mark.marker).expect("a landmark");
        assert!((placement.domain_at(&point) - Point2::from(landmark.at)).norm() < 0.01, "{}", mark.marker);
    }
    // Other markers on the same scan, picked for another purpose: chin, cheek, forehead and brow.
    let others = picks::read(&fixture("lee-perry-smith/picks.csv"), Unit::M).expect("picks");
    let at = |name: &str| {
        let pick = others.iter().find(|pick| pick.marker == name).expect(name);
        let picks::PickPlace::Point(point) = pick.place else { panic!("picked as points") };
        placement.domain_at(&point)
    };
    let near = |name: &str, s: f64, t: f64| {
        let found = at(name);
        assert!((found - Point2::new(s, t)).norm() < 7.0, "{name} at {found}");
    };
    near("section7-2", 0.0, 6.0);
    near("section1-1", 15.0, 58.0);
    near("section2-2", -48.0, 57.0);
    near("section14-2", -2.0, -60.0);
    near("section10-2", 0.0, -23.0);
}

#[test]
fn two_levels_keep_the_scan_whole() {
    let Some(head) = perry_smith() else { return };
    let scan = act_ready(&head, None, 2);
    let (vertices, faces) = (scan.mesh.positions.len(), scan.mesh.polygons.len());
    assert_eq!((vertices, faces), (2 + 8842 * 16, 8842 * 2 * 16), "closed: Euler's number is 2");
    assert!(scan.mesh.positions.iter().flat_map(Point3::iter).all(|x| x.is_finite()));
    assert!(scan.domain.iter().flat_map(Point2::iter).all(|x| x.is_finite()));
    assert_eq!(scan.mesh.corner_uvs.len(), 3 * faces);
    // One file coordinate per corner becomes one per vertex and one more along seams.
    assert!((vertices..vertices + vertices / 10).contains(&scan.mesh.uvs.len()), "{}", scan.mesh.uvs.len());
    let moved = scan.mesh.positions.iter().zip(&head.positions).map(|(new, old)| (new - old).norm());
    let face = moved.zip(&scan.domain).enumerate().filter(|(_, (_, at))| at.x.abs() < 90.0 && at.y > -70.0);
    let worst = face.max_by(|a, b| a.1.0.total_cmp(&b.1.0)).expect("vertices");
    assert!(worst.1.0 < 4.0, "smoothing keeps the shape: {worst:?} {}", head.positions[worst.0]);
}

#[test]
fn its_picture_colours_it() {
    let Some(head) = perry_smith() else { return };
    let Some(picture) = testkit::data("head_lee_perry_smith/Map-COL.jpg") else { return };
    let bytes = artifact::read_bytes(&picture).expect("the picture");
    let picture = image::load_from_memory(&bytes).expect("a JPEG").to_rgb8();
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let texture = Texture::from_srgb(width, height, picture.as_raw()).expect("all of it");
    let scan = act_ready(&head, Some(&texture), 2);
    let mean = |s: f64, t: f64| {
        let near =
            scan.domain.iter().zip(&scan.albedo).filter(|(at, _)| (*at - Point2::new(s, t)).norm() < 2.0);
        let (sum, count) = near.fold(([0.0f32; 3], 0.0), |(sum, count), (_, color)| {
            ([0, 1, 2].map(|i| sum[i] + color[i]), count + 1.0f32)
        });
        sum.map(|channel| channel / count)
    };
    let luminance = |[r, g, b]: [f32; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    let redness = |[r, g, _]: [f32; 3]| r / g;
    assert!(
        luminance(mean(30.0, 58.0)) < 0.6 * luminance(mean(30.0, 75.0)),
        "brows are darker than the forehead"
    );
    assert!(redness(mean(0.0, -24.5)) > 1.15 * redness(mean(0.0, 75.0)), "lips are redder");
    assert!(redness(mean(0.0, 75.0)) > 1.1, "skin is red");
}

/// The faces on the side of a closed line of edges where a face lies; what `mesh-clip` does, in the small.
fn cut_along(head: &Mesh, line: &[u32], seed: usize) -> Mesh {
    let edge = |a: u32, b: u32| (a.min(b), a.max(b));
    let (starts, neighbors) = Connectivity::of(head.positions.len(), &head.triangles()).one_rings();
    let ring = |vertex: u32| &neighbors[starts[vertex as usize]..starts[vertex as usize + 1]];
    let way = |pair: &[u32]| shortest_way(&head.positions, ring, pair[0], pair[1], 50.0).expect("a way");
    let ways = line.windows(2).map(way);
    let barrier: HashSet<(u32, u32)> =
        ways.flat_map(|way| way.windows(2).map(|pair| edge(pair[0], pair[1])).collect::<Vec<_>>()).collect();
    let mut beside = std::collections::HashMap::<(u32, u32), Vec<usize>>::new();
    let sides = |face: usize| {
        let corners = head.polygons.face(face).to_vec();
        (0..corners.len())
            .map(move |i| edge(corners[i], corners[(i + 1) % corners.len()]))
            .collect::<Vec<_>>()
    };
    (0..head.polygons.len()).for_each(|face| {
        sides(face).into_iter().for_each(|side| beside.entry(side).or_default().push(face));
    });
    let mut keep = vec![false; head.polygons.len()];
    let mut open = vec![seed];
    while let Some(face) = open.pop() {
        if !std::mem::replace(&mut keep[face], true) {
            open.extend(
                sides(face).iter().filter(|side| !barrier.contains(side)).flat_map(|side| &beside[side]),
            );
        }
    }
    head.keep_faces(&keep).0
}

/// Cut open between the lips, which touch, no edge leads from one lip to the other.
#[test]
fn a_cut_mouth_can_open() {
    let Some(head) = perry_smith() else { return };
    let line: VertexPath = read_document(&fixture("lee-perry-smith/mouth.json")).expect("the mouth");
    let cut = cut_along(&head, &line.vertices, 0);
    assert!(cut.polygons.len() < head.polygons.len(), "the pocket behind the lips is gone");
    let scan = act_ready(&cut, None, 2);
    assert!(scan.mouth_is_open);
    let around = Connectivity::of(scan.mesh.positions.len(), &scan.mesh.triangles());
    let above = |at: Point2<f64>| at.y - mouth_line(at.x);
    let mut between = 0;
    for edge in around.edges() {
        let [a, b] = edge.vertices.map(|vertex| scan.domain[vertex as usize]);
        if a.x.abs().max(b.x.abs()) < 22.0 && above(a) * above(b) < 0.0 {
            between += 1;
        }
    }
    assert_eq!(between, 0);
}

/// The mouth line of the average face, written out anew.
fn mouth_line(s: f64) -> f64 {
    let bump = |x: f64| (-0.5 * x * x).exp();
    -28.5 - 0.9 * bump(s / 5.0) + 0.7 * bump((s.abs() - 12.0) / 6.0) + 1.5 * bump(s / 18.0)
}

fn facekit(names: &[&str], levels: usize) -> Option<(Mesh, ExpressionSet)> {
    let read = |name: &str| {
        let path = testkit::data(&format!("ict_facekit_dev/{name}.obj"))?;
        Some(obj::read(&path, Unit::Cm).expect("an expression"))
    };
    let neutral = read("neutral")?;
    let shape = |name: &&str| {
        Some(Shape { name: (*name).to_string(), file: format!("{name}.obj"), mesh: read(name)? })
    };
    let shapes: Vec<Shape> = names.iter().map(shape).collect::<Option<_>>()?;
    let landmarks = landmarks("ict-facekit", Unit::Cm);
    let notes = Notes { unit: Unit::Cm, landmarks: &landmarks, texture: None, levels };
    let set = expressions(&neutral, &shapes, &notes).expect("an expression set");
    Some((neutral, set))
}

#[test]
fn a_real_expression_set_acts() {
    let Some((neutral, set)) = facekit(&["smile", "jaw_open", "eye_blink"], 1) else { return };
    assert_eq!(set.names, ["smile", "jaw_open", "eye_blink"]);
    assert!(set.scan.mouth_is_open && set.scan.eyes_are_open);
    assert!(folded_share(&set.scan) < 0.002, "{}", folded_share(&set.scan));
    assert!(set.scan.mesh.positions.len() > 3 * neutral.positions.len());
    // Where the skin moves most, by the set's own description (mm), nearly nothing is lost to smoothing.
    for (offsets, most) in set.offsets.iter().zip([15.758, 41.987, 9.639]) {
        let found = offsets.iter().map(|offset| offset.norm()).fold(0.0, f64::max);
        assert!((0.9..1.01).contains(&(found / most)), "{found} of {most}");
    }
    // What a jaw moves lies below the mouth; what a blink moves, around the eyes.
    let place = |offsets: &[nalgebra::Vector3<f64>]| {
        let most = (0..offsets.len()).max_by(|&a, &b| offsets[a].norm().total_cmp(&offsets[b].norm()));
        set.scan.domain[most.expect("vertices")]
    };
    assert!(place(&set.offsets[1]).y < -28.0);
    let blink = place(&set.offsets[2]);
    assert!((blink.x.abs() - 33.0).abs() < 10.0 && (32.0..50.0).contains(&blink.y), "{blink}");
}

/// Lines and markers lie on the skin of the face, not at the back of the head and not in the pocket behind the lips.
#[test]
fn paint_stays_on_the_face() {
    let Some(head) = perry_smith() else { return };
    let lines = lines(0, &Style::default());
    let paths: Vec<Vec<Point2<f64>>> = lines.iter().map(|line| line.path.clone()).collect();
    let body = Base::Scan(act_ready(&head, None, 1)).body(150_000, &paths, 8.0);
    let rest = &body.mesh.positions;
    let wrinkles =
        Wrinkles::place(rest, &body.triangles, &body.domain, &lines, &Params::default()).expect("lines");
    for (number, line) in lines.iter().enumerate() {
        let drawn: f64 = line.path.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let length = wrinkles.widths(number).last().expect("sections").0;
        assert!((0.7..1.8).contains(&(length / drawn)), "{}: {length} mm of {drawn}", line.id);
        // Painted all along: no gap in what the line covers.
        let mut covered = wrinkles.coordinates(number).x_mm;
        covered.sort_by(f64::total_cmp);
        let gap = covered.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        assert!(gap < 0.5, "{}: {gap} mm", line.id);
    }
    let normals = vertex_normals(rest, &body.triangles);
    for marker in body.markers() {
        let (at, normal) = (rest[marker.vertex as usize], normals[marker.vertex as usize]);
        assert!(
            at.z > -110.0 && normal.dot(&nalgebra::Vector3::new(at.x, 0.0, 60.0)) > 0.0,
            "{}",
            marker.name
        );
    }
}

/// A headband fits any head; eyeballs fill open eyes and stay behind the lids.
#[test]
fn what_is_worn_fits() {
    let Some(head) = perry_smith() else { return };
    let body = Base::Scan(act_ready(&head, None, 1)).body(40_000, &[], 8.0);
    assert!(body.props.is_empty(), "its eyes are closed");
    for (name, center) in body.headband() {
        let near = |point: &Point3<f64>| (point - center).norm();
        let nearest = body.mesh.positions.iter().map(near).fold(f64::INFINITY, f64::min);
        assert!((4.9..20.0).contains(&nearest), "{name}: {nearest} mm");
    }
}

#[test]
fn open_eyes_have_eyeballs() {
    let Some((_, set)) = facekit(&["smile"], 1) else { return };
    let scale = set.scan.face_from_canonical.scaling();
    let body = Base::Expressions(set).body(40_000, &[], 8.0);
    assert_eq!(body.props.len(), 2);
    for (ball, side) in body.props.iter().zip([1.0, -1.0]) {
        let sum: nalgebra::Vector3<f64> = ball.mesh.positions.iter().map(|point| point.coords).sum();
        let center = Point3::from(sum / ball.mesh.positions.len() as f64);
        for (s, t) in [(33.0, 41.4), (33.0, 32.0)] {
            let place = Point2::new(side * s, t);
            let off = |vertex: &usize| (body.domain[*vertex] - place).norm();
            let lid = (0..body.domain.len()).min_by(|a, b| off(a).total_cmp(&off(b))).expect("vertices");
            let lid = body.mesh.positions[lid];
            let clear =
                ball.mesh.positions.iter().map(|point| (point - lid).norm()).fold(f64::INFINITY, f64::min);
            assert!((0.2..2.5).contains(&clear) && lid.z > center.z + 8.0 * scale, "{side} {t}: {clear} mm");
        }
    }
}
