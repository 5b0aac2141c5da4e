//! What moves with the head only: eyeballs, teeth, the dark of the mouth, and a hood around the face.
//!
//! Props hide things, so that a picture looks like a person; they carry no truth.

use super::Body;
use super::face::outline::{Contour, mouth_line};
use super::face::profile::{bump, curve, smooth_step};
use super::face::{Person, surface};
use mesh::{Mesh, Polygons};
use nalgebra::{Point2, Point3, Similarity3, UnitQuaternion, Vector3};
use std::f64::consts::{PI, TAU};

/// A thing that hides others but carries no truth: an eyeball, the dark of the mouth.
#[derive(Debug, Clone, PartialEq)]
pub struct Prop {
    /// Triangles in the space of the face, mm.
    pub mesh: Mesh,
    /// Per vertex the linear RGB reflectance.
    pub albedo: Vec<[f32; 3]>,
}

/// Radius of an eyeball: the lids slide over it without touching, mm.
const BALL_RADIUS: f64 = surface::EYE_RADIUS - 1.1;
/// Angles of pupil and iris seen from the ball's centre, rad.
const PUPIL: f64 = 0.15;
const IRIS: f64 = 0.46;
const HOOD: [f32; 3] = [0.035, 0.037, 0.042];
const MOUTH: [f32; 3] = [0.035, 0.008, 0.008];

/// The props of a person.
pub(super) fn of(person: &Person) -> Vec<Prop> {
    vec![eyeball(person, 1.0), eyeball(person, -1.0), mouth_bag(person), teeth(person), hood(person)]
}

/// A grid over the unit square, wrapped around in u when `is_closed`; `at` gives the point and the reflectance.
fn sheet(columns: u32, rows: u32, is_closed: bool, at: impl Fn(f64, f64) -> (Point3<f64>, [f32; 3])) -> Prop {
    let width = if is_closed { columns } else { columns + 1 };
    let places = (0..=rows).flat_map(|j| (0..width).map(move |i| (i, j)));
    let (positions, albedo) =
        places.map(|(i, j)| at(f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows))).unzip();
    let mut polygons = Polygons::default();
    for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
        let vertex = |i: u32, j: u32| j * width + i % width;
        polygons.push(&[vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)]);
        polygons.push(&[vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)]);
    }
    Prop { mesh: Mesh { positions, polygons, ..Mesh::default() }, albedo }
}

/// An eyeball in its socket.
struct Eyeball {
    /// From the ball's own space, a radius of [`BALL_RADIUS`] around 0 looking along +z, to the face's.
    place: Similarity3<f64>,
    /// +1 for the subject's left.
    side: f64,
}

fn eyeball(person: &Person, side: f64) -> Prop {
    let center = surface::eyeball(person, side);
    let place = Similarity3::from_parts(center.coords.into(), UnitQuaternion::identity(), 1.0);
    Eyeball { place, side }.prop(person)
}

/// Lids are this far from the ball, share of its radius: the cornea is in front of it.
const UNDER_LID: f64 = 0.08;
/// Radius of the ball behind a scan's lids over its size, mm.
const SCAN_RADIUS: f64 = 12.0;
/// Places of the lids' edges among the landmarks: upper, lower.
const LIDS: [[f64; 2]; 2] = [[33.0, 41.4], [33.0, 32.0]];
/// The vertices of a lid's edge lie this near to its landmark's place, mm.
const AT_LANDMARK: f64 = 1.0;

/// The ball behind the open lids of a scan, which touch it: so far back that the edges of both are just over it.
pub(super) fn eyeball_behind(body: &Body, side: f64) -> Option<Prop> {
    let [upper, lower] = LIDS.map(|[s, t]| nearest(body, Point2::new(side * s, t)));
    let (upper, lower) = (upper?, lower?);
    let (turn, size) = (body.face_from_canonical.isometry.rotation, body.face_from_canonical.scaling());
    let radius = SCAN_RADIUS * size;
    let opening = upper - lower;
    let ahead = turn * Vector3::z();
    let out = (ahead - opening * (ahead.dot(&opening) / opening.norm_squared())).normalize();
    let depth = ((1.0 + UNDER_LID) * radius).powi(2) - 0.25 * opening.norm_squared();
    let center = nalgebra::center(&upper, &lower) - out * depth.max(0.0).sqrt();
    let place = Similarity3::from_parts(center.coords.into(), turn, radius / BALL_RADIUS);
    Some(Eyeball { place, side }.prop(&body.person))
}

/// The vertex at a place of the unrolled face.
fn nearest(body: &Body, at: Point2<f64>) -> Option<Point3<f64>> {
    let distances = body.domain.iter().map(|place| (place - at).norm());
    let (vertex, distance) = distances.enumerate().min_by(|one, other| one.1.total_cmp(&other.1))?;
    (distance < AT_LANDMARK).then_some(body.mesh.positions[vertex])
}

impl Eyeball {
    /// A ball that looks ahead; the cornea stands out a little.
    fn prop(&self, person: &Person) -> Prop {
        sheet(96, 72, true, |u, v| {
            // From the back to the front, where the rows are closer; the poles are left out: no triangle is empty.
            let polar = PI * (0.001 + 0.998 * (1.0 - v).powf(1.3));
            let (sin, cos) = polar.sin_cos();
            let (up, across) = (TAU * u).sin_cos();
            let radius = BALL_RADIUS + 0.7 * (1.0 - smooth_step(polar / (1.1 * IRIS)));
            // Wider beside the iris, most towards the nose, so that the corners of the eye are filled.
            let widest = 0.08 - 0.08 * self.side * across;
            let wide = 1.0 + widest * smooth_step((polar - IRIS) / 0.6);
            let out = Point3::new(across * sin * wide, up * sin, cos) * radius;
            (self.place * out, eye_color(person, polar, u))
        })
    }
}

fn eye_color(person: &Person, polar: f64, turn: f64) -> [f32; 3] {
    const BLUE: [f64; 3] = [0.09, 0.15, 0.20];
    const BROWN: [f64; 3] = [0.10, 0.045, 0.018];
    let fibres = 1.0 + 0.25 * (TAU * 23.0 * turn).sin() * (TAU * 7.0 * turn + 40.0 * polar).cos();
    let rim = 1.0 - 0.75 * bump((polar - IRIS) / 0.035);
    let in_iris = 1.0 - smooth_step((polar - IRIS + 0.015) / 0.03);
    let in_pupil = 1.0 - smooth_step((polar - PUPIL + 0.01) / 0.02);
    let corner = smooth_step((polar - 0.7) / 0.5);
    let white = [0.56 - 0.18 * corner, 0.51 - 0.27 * corner, 0.48 - 0.28 * corner];
    std::array::from_fn(|channel| {
        let iris = (BLUE[channel] + (BROWN[channel] - BLUE[channel]) * person.iris) * fibres;
        let open = white[channel] + (iris - white[channel]) * in_iris;
        ((open + (0.004 - open) * in_pupil) * rim) as f32
    })
}

/// A dark bowl behind the lips, far enough back for a jaw that is open.
fn mouth_bag(person: &Person) -> Prop {
    sheet(24, 24, false, |u, v| {
        // Narrow below, so that it stays within the chin.
        let (x, y) = ((20.0 + 46.0 * smooth_step(1.8 * v)) * (u - 0.5), -72.0 + 74.0 * v);
        let back = 0.7 * (-40.0 - y).max(0.0) + 0.55 * (y + 18.0).max(0.0);
        let z = 22.0 + 0.022 * x * x - back;
        (Point3::new(x * person.width, y * person.height, z), MOUTH)
    })
}

/// The upper teeth.
fn teeth(person: &Person) -> Prop {
    sheet(120, 10, false, |u, v| {
        let x = 46.0 * (u - 0.5);
        let tooth = x / (7.6 - 0.05 * x.abs());
        let between = bump((tooth - tooth.round()) / 0.06);
        let edge = mouth_line(0.0) + 2.0 + 1.2 * between * (1.0 - v) + 0.004 * x * x;
        let (y, z) = (edge + 12.0 * v, 60.5 - 0.028 * x * x - 0.8 * between - 2.5 * v);
        let light = (0.62 - 0.45 * between) * (1.0 - 0.5 * (x / 23.0).powi(2)) * (1.0 - 0.6 * v);
        let color = [light, 0.92 * light, 0.80 * light].map(|c| c as f32);
        (Point3::new(x * person.width, y * person.height, z), color)
    })
}

/// Rings from the face's rim over the crown and the nape to the neck: top and bottom (y, z), half-width above and
/// below, mm.
const RINGS: [[f64; 6]; 6] = [
    [131.0, -4.0, -92.0, 22.0, 74.0, 52.0],
    [124.0, -78.0, -97.0, 14.0, 80.0, 54.0],
    [62.0, -116.0, -102.0, 9.0, 76.0, 54.0],
    [-28.0, -92.0, -108.0, 6.0, 62.0, 54.0],
    [-84.0, -80.0, -124.0, 6.0, 56.0, 54.0],
    [-158.0, -94.0, -172.0, 8.0, 66.0, 62.0],
];

/// Skull and neck in a hood, from behind the rim of the face on.
fn hood(person: &Person) -> Prop {
    sheet(144, 60, true, |u, v| (hood_point(person, u, 1.0 - v), HOOD))
}

fn hood_point(person: &Person, u: f64, v: f64) -> Point3<f64> {
    let (sin, cos) = (TAU * u).sin_cos();
    let rim = surface::point(person, Contour::Rim.at(person, u));
    // Below, the jaw needs room to open.
    let low = smooth_step(0.5 - 0.9 * sin);
    let start = rim + Vector3::new(-1.5 * cos, 6.0 * low - 0.5 * sin, -1.0 - 13.0 * low);
    let ring = |&[top, top_z, bottom, bottom_z, above, below]: &[f64; 6]| {
        let half = above + (below - above) * smooth_step(0.3 - 0.9 * sin);
        let (middle, reach) = (0.5 * (top + bottom), 0.5 * (top - bottom));
        let (middle_z, reach_z) = (0.5 * (top_z + bottom_z), 0.5 * (top_z - bottom_z));
        let round = |x: f64| x.signum() * x.abs().powf(0.85);
        let (across, up) = (round(cos), round(sin));
        [half * across * person.width, (middle + reach * up) * person.height, middle_z + reach_z * up]
    };
    let rings: Vec<[f64; 3]> =
        std::iter::once([start.x, start.y, start.z]).chain(RINGS.iter().map(ring)).collect();
    let along: [f64; 3] = std::array::from_fn(|axis| {
        let knots: Vec<(f64, f64)> =
            rings.iter().enumerate().map(|(k, ring)| (k as f64, ring[axis])).collect();
        curve(&knots, v * RINGS.len() as f64)
    });
    Point3::from(along)
}
