//! The rest surface: a smooth map from the unrolled face to space.
//!
//! The domain is the unrolled face in millimetres: s runs around the head (0 in the middle, positive to the subject's
//! left, which is +x), t runs up (0 under the nose). Bones and soft parts are hills on an elliptic head.

use crate::body::face::outline;
use crate::body::face::person::Person;
use crate::body::face::profile::{bump, curve, hill, smooth_max, smooth_step, softplus};
use nalgebra::{Point2, Point3, Vector3};

/// Millimetres of s per radian around the head.
const ROLL: f64 = 72.0;
/// Exponent of the head's horizontal sections: flatter in front than an ellipse (2).
const SECTION: f64 = 2.3;
/// z of the head's widest part, mm.
const SIDE: f64 = -15.0;
/// Radius of the eyeball with its lid, mm.
pub(crate) const EYE_RADIUS: f64 = 14.0;

const HALF_WIDTH: [(f64, f64); 12] = [
    (-95., 44.),
    (-80., 46.5),
    (-60., 52.),
    (-40., 58.),
    (-20., 63.),
    (0., 66.5),
    (20., 69.5),
    (40., 69.),
    (60., 67.),
    (80., 64.),
    (100., 59.),
    (115., 54.),
];
const FRONT: [(f64, f64); 13] = [
    (-95., 58.),
    (-75., 65.),
    (-60., 68.),
    (-45., 67.5),
    (-27., 70.),
    (-5., 68.5),
    (10., 67.),
    (30., 66.),
    (45., 67.),
    (57., 69.5),
    (75., 70.5),
    (95., 64.),
    (115., 49.),
];
const NOSE_RIDGE: [(f64, f64); 13] = [
    (-16., 0.),
    (-12., 0.),
    (-8.5, 2.),
    (-5., 6.5),
    (-1., 13.0),
    (4., 17.8),
    (8., 18.6),
    (14., 16.5),
    (22., 13.),
    (30., 9.5),
    (38., 6.),
    (47., 2.5),
    (60., 0.),
];
const NOSE_WIDTH: [(f64, f64); 6] = [(-10., 14.), (2., 12.5), (12., 10.5), (25., 8.5), (38., 7.5), (55., 9.)];

/// The point of the rest surface over a point of the domain, mm.
pub(crate) fn point(person: &Person, at: Point2<f64>) -> Point3<f64> {
    let (s, t) = (at.x, at.y);
    let angle = s / ROLL;
    let out = Vector3::new(angle.sin(), 0.0, angle.cos());
    let bare = head(person, s, t) + out * bones(person, s, t);
    let skin = bare + Vector3::z() * (nose(person, s, t) + mouth(person, s, t) + folds(s, t));
    let mut skin = eyes(person, skin, s, t);
    skin.y -= 2.5 * hill(s / 11.0, (t - 2.0) / 5.0);
    skin += out * waves(person, s, t);
    Point3::new(skin.x * person.width, skin.y * person.height, skin.z)
}

/// Unit directions of the skin around the head (to the subject's left), up and out, the features smoothed away.
pub(crate) fn directions(person: &Person, at: Point2<f64>) -> [Vector3<f64>; 3] {
    const STEP: f64 = 4.0;
    let across = head(person, at.x + STEP, at.y) - head(person, at.x - STEP, at.y);
    let up = (head(person, at.x, at.y + STEP) - head(person, at.x, at.y - STEP)).normalize();
    let out = across.cross(&up).normalize();
    [up.cross(&out), up, out]
}

/// The head without features; below the jaw line it turns inwards.
fn head(person: &Person, s: f64, t: f64) -> Vector3<f64> {
    let angle = s / ROLL;
    let jaw = smooth_step((-t - 10.0) / 50.0);
    let half_width = curve(&HALF_WIDTH, t) * (1.0 + (person.jaw_width - 1.0) * jaw);
    let slope = person.forehead_slope * smooth_step((t - 55.0) / 60.0);
    let depth = curve(&FRONT, t) - slope - SIDE;
    let across = angle.sin();
    let z = SIDE + depth * (1.0 - across.abs().powf(SECTION)).max(0.0).powf(1.0 / SECTION);
    let below = 7.0 * softplus((jaw_line(person, s) - t) / 7.0);
    let inwards = Vector3::new(angle.sin(), 0.0, angle.cos()) * (0.95 * below);
    Vector3::new(half_width * across, t + 0.7 * below, z) - inwards
}

/// t of the jaw line.
pub(crate) fn jaw_line(person: &Person, s: f64) -> f64 {
    -71.0 - person.chin_drop * bump(s / 25.0) + 44.0 * (s / 88.0).powi(2)
}

/// |s|, rounded in the middle, so that no crease runs down the face.
fn folded(s: f64, round: f64) -> f64 {
    s.hypot(round)
}

fn bones(person: &Person, s: f64, t: f64) -> f64 {
    let side = folded(s, 6.0);
    let brow_line = 54.0 + person.brow_height + 5.0 * bump((side - 30.0) / 14.0);
    let brow_reach = smooth_step((side + 4.0) / 18.0) * smooth_step((60.0 - side) / 28.0);
    let chin_top = -60.0 - person.chin_drop;
    person.brow * 3.2 * brow_reach * bump((t - brow_line) / 6.0)
        + 2.5 * hill(s / 12.0, (t - 58.0) / 8.0)
        + 2.5 * hill((side - 24.0) / 17.0, (t - 84.0) / 14.0)
        - 5.0 * hill((side - 68.0) / 13.0, (t - 58.0) / 20.0)
        + person.cheekbone * 5.0 * hill((side - 48.0) / 15.0, (t - 18.0) / 11.0)
        + 3.0 * hill((side - 30.0) / 12.0, (t - 6.0) / 13.0)
        - person.cheek_hollow * 2.6 * hill((side - 54.0) / 14.0, (t + 22.0) / 16.0)
        + 4.5 * hill(s / 26.0, (t + 24.0) / 22.0)
        + person.chin * 7.0 * hill(s / 15.0, (t - chin_top) / 9.5)
        - 4.0 * hill(s / 17.0, (t + 44.5) / 4.8)
        + 1.2 * hill((side - 76.0) / 18.0, (t - jaw_line(person, s) - 8.0) / 11.0)
}

fn nose(person: &Person, s: f64, t: f64) -> f64 {
    let side = folded(s, 2.0);
    let width = curve(&NOSE_WIDTH, t) * (1.0 + (person.nose_width - 1.0) * smooth_step((40.0 - t) / 40.0));
    // The columella hangs lower than the wings.
    let hung = t + 3.0 * bump(side / 6.0) - 1.2;
    let ridge = curve(&NOSE_RIDGE, hung) * person.nose_height + person.nose_hook * bump((t - 26.0) / 7.0);
    let wing = 14.0 * person.nose_width;
    ridge * (-(side / width).powf(2.4)).exp()
        + person.nose_tip * 4.2 * hill(s / 6.5, (t - 5.0) / 6.0)
        + 6.4 * hill((side - wing + 0.5) / 4.4, (t - 1.8) / 5.2)
        - 2.2 * hill((side - wing - 7.0) / 2.6, (t - 3.0) / 6.5)
        - 4.5 * hill((side - 6.8 * person.nose_width) / 3.0, (t + 4.2) / 2.2)
        - 0.9 * hill((side - 9.5) / 2.6, (t - 8.0) / 3.5)
}

fn mouth(person: &Person, s: f64, t: f64) -> f64 {
    let half = person.mouth_half_width;
    let taper = (-(s.abs() / (0.84 * half)).powi(3)).exp();
    let inner = (-(s.abs() / (1.02 * half)).powi(6)).exp();
    let above = t - outline::mouth_line(s);
    let (lower_edge, bow) = outline::lip_edges(person, s);
    let upper =
        bump((above - 3.2) / 3.0) + 0.16 * smooth_step((bow + 0.8 - above) / 1.6) * smooth_step(above / 2.0);
    let lower = bump((above + 4.6) / 3.5)
        + 0.14 * smooth_step((above - lower_edge + 0.8) / 1.6) * smooth_step(-above / 2.0);
    let philtrum = bump(s / 3.0) - 0.6 * bump((s.abs() - 5.6) / 2.2);
    person.lip_fullness * taper * (4.0 * upper + 5.0 * lower)
        - 2.2 * inner * bump(above / 1.5)
        - 0.9 * philtrum * bump((t + 15.0) / 4.5)
        - 1.7 * hill((s.abs() - half - 2.5) / 4.0, above / 4.5)
}

/// |s| of the nasolabial line at t.
pub(crate) fn nasolabial_line(t: f64) -> f64 {
    22.0 + 13.0 * (1.0 - bump((t - 4.0) / 17.0))
}

/// The nasolabial fold: a crease from the nose wing past the corner of the mouth, the cheek standing over it.
fn folds(s: f64, t: f64) -> f64 {
    let along = smooth_step((t + 38.0) / 26.0) * smooth_step((9.0 - t) / 14.0);
    let past = s.abs() - nasolabial_line(t);
    along * (0.9 * bump((past - 7.0) / 6.5) - 1.0 * bump(past / 4.2))
}

/// The sockets, and the eyeballs that push through them.
fn eyes(person: &Person, skin: Vector3<f64>, s: f64, t: f64) -> Vector3<f64> {
    let eye = outline::eye_center(person, s.signum());
    let dt = t - eye.y;
    let side = folded(s, 6.0);
    let out = side - eye.x.abs();
    let socket = -8.0 * hill(out / 14.5, (dt - 1.0) / 8.5)
        - 4.5 * hill((side - 16.0) / 5.0, (dt + 1.0) / 7.0)
        - 1.2 * hill((out - 2.0) / 14.0, (dt + 13.0) / 3.5);
    let sunk = skin.z + socket;
    let ball = unscaled_eyeball(person, s.signum());
    let off = (skin.x - ball.x).powi(2) + (skin.y - ball.y).powi(2);
    // Beside the ball far behind the skin, so that only the ball itself shows.
    let front =
        ball.z + (EYE_RADIUS * EYE_RADIUS - off).max(0.0).sqrt() - 6.0 * (off.sqrt() - EYE_RADIUS).max(0.0);
    Vector3::new(skin.x, skin.y, smooth_max(sunk, front, 1.1))
}

/// The centre of an eyeball, mm.
pub(crate) fn eyeball(person: &Person, side: f64) -> Point3<f64> {
    let center = unscaled_eyeball(person, side);
    Point3::new(center.x * person.width, center.y * person.height, center.z)
}

fn unscaled_eyeball(person: &Person, side: f64) -> Point3<f64> {
    let eye = outline::eye_center(person, side);
    Point3::new(69.0 * (eye.x / ROLL).sin() - side, eye.y, 44.5)
}

/// Slow waves without symmetry.
fn waves(person: &Person, s: f64, t: f64) -> f64 {
    let [a, b, c, d] = person.asymmetry;
    a * (s / 23.0 + t / 41.0).sin()
        + b * (s / 37.0 - t / 19.0).cos()
        + c * (s / 17.0).sin() * (t / 29.0).cos()
        + d * (s / 31.0 + 1.0).sin()
}
