//! Expressions as displacement fields on the face, known everywhere, not only at markers.

use crate::body::face::outline::{EYE_HALF_WIDTH, eye_center, lid_edges, mouth_line};
use crate::body::face::person::Person;
use crate::body::face::profile::{bump, hill, smooth_step};
use crate::body::face::sampling::Samples;
use crate::body::face::surface;
use nalgebra::{Complex, Point2, Point3, Vector3};

/// How much of each expression: 0 none, 1 full strength.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Weights {
    /// The jaw drops: the lips part by about 25 mm.
    pub jaw_open: f64,
    /// The corners of the mouth go out and up, the cheeks rise.
    pub smile: f64,
    /// The brows rise by 8 mm.
    pub brow_raise: f64,
    /// The upper lids come down until the eyes are closed.
    pub blink: f64,
    /// The lips come forward and together.
    pub pucker: f64,
    /// The brows come down and together.
    pub frown: f64,
}

/// Rotation of the fully opened jaw, rad.
const JAW_ANGLE: f64 = 0.31;
/// Where the jaw turns: y and z of the axis through the joints before the ears, mm.
const JAW_AXIS: [f64; 2] = [18.0, -5.0];
/// How fast the jaw's motion fades above the mouth line.
const JAW_FADE: f64 = 1.5;
/// Share of the lid's way that a blink goes: the lids do not pass through each other.
const LID_TRAVEL: f64 = 0.97;
/// Height over the edge of the lid that takes part in a blink, mm.
const LID_FOLD: f64 = 10.0;

/// The fields at the vertices of a face.
#[derive(Debug, Clone)]
pub(crate) struct Fields {
    smile: Vec<Vector3<f64>>,
    brow_raise: Vec<Vector3<f64>>,
    pucker: Vec<Vector3<f64>>,
    frown: Vec<Vector3<f64>>,
    /// The corners of an open mouth come in.
    narrowing: Vec<Vector3<f64>>,
    /// Share in the jaw's rotation.
    jaw: Vec<f64>,
    /// Rotation of a full blink about the eyeball's centre, rad.
    lid_angle: Vec<f64>,
    /// Per vertex the eyeball of its side.
    eyeball: Vec<Point3<f64>>,
}

impl Fields {
    pub(crate) fn of(person: &Person, samples: &Samples) -> Self {
        let half = person.mouth_half_width;
        let field =
            |f: &dyn Fn(f64, f64) -> Vector3<f64>| samples.domain.iter().map(|at| f(at.x, at.y)).collect();
        let eyeball = |at: &Point2<f64>| scaled(person, surface::eyeball(person, at.x.signum()));
        Self {
            smile: field(&|s, t| smile(half, s, t)),
            brow_raise: field(&|s, t| brow_raise(s, t)),
            pucker: field(&|s, t| pucker(half, s, t)),
            frown: field(&|s, t| frown(s, t)),
            narrowing: field(&|s, t| {
                let corner = hill((s.abs() - half) / 12.0, (t - mouth_line(s)) / 14.0);
                Vector3::x() * (-3.5 * (s / 10.0).tanh() * corner)
            }),
            jaw: samples.domain.iter().map(|&at| jaw_share(half, at)).collect(),
            lid_angle: samples.domain.iter().map(|&at| lid_angle(person, at)).collect(),
            eyeball: samples.domain.iter().map(eyeball).collect(),
        }
    }

    pub(crate) fn deform(&self, rest: &[Point3<f64>], weights: &Weights) -> Vec<Point3<f64>> {
        let jaw_axis = Point3::new(0.0, JAW_AXIS[0], JAW_AXIS[1]);
        let moved = |vertex: usize| {
            let shifted = rest[vertex]
                + self.smile[vertex] * weights.smile
                + self.brow_raise[vertex] * weights.brow_raise
                + self.pucker[vertex] * weights.pucker
                + self.frown[vertex] * weights.frown
                + self.narrowing[vertex] * weights.jaw_open;
            let blinked = nod(shifted, self.eyeball[vertex], self.lid_angle[vertex] * weights.blink);
            nod(blinked, jaw_axis, self.jaw[vertex] * JAW_ANGLE * weights.jaw_open)
        };
        (0..rest.len()).map(moved).collect()
    }
}

/// A rotation about an axis along x; what is in front of the axis goes down.
fn nod(point: Point3<f64>, axis: Point3<f64>, angle: f64) -> Point3<f64> {
    if angle == 0.0 {
        // A point that does not turn stays exactly where it is.
        return point;
    }
    let (sin, cos) = angle.sin_cos();
    let (y, z) = (point.y - axis.y, point.z - axis.z);
    Point3::new(point.x, axis.y + y * cos - z * sin, axis.z + y * sin + z * cos)
}

fn scaled(person: &Person, point: Point3<f64>) -> Point3<f64> {
    Point3::new(point.x * person.width, point.y * person.height, point.z)
}

/// Share in the jaw's motion: nearly 1 on the lower lip, nearly 0 on the upper one, smooth beside the mouth.
///
/// The imaginary part of √(z² − a²) is the opening of a crack of half-length a under tension: it jumps across the
/// slit and nowhere else, and grows steadily away from it, so that no triangle turns over.
fn jaw_share(half: f64, at: Point2<f64>) -> f64 {
    let z = Complex::new(at.x, at.y - mouth_line(at.x)) / half;
    let crack = ((z - 1.0).sqrt() * (z + 1.0).sqrt()).im;
    0.5 - 0.5 * (JAW_FADE * crack).tanh()
}

/// The rotation that brings a point of the upper lid down with its edge.
fn lid_angle(person: &Person, at: Point2<f64>) -> f64 {
    let side = at.x.signum();
    let Some((lower, upper)) = lid_edges(person, side, at.x) else { return 0.0 };
    if at.y < 0.5 * (lower + upper) || at.y > upper + LID_FOLD {
        return 0.0;
    }
    let center = scaled(person, surface::eyeball(person, side));
    let elevation = |t: f64| {
        let point = surface::point(person, Point2::new(at.x, t)) - center;
        point.y.atan2(point.z)
    };
    let share = 1.0 - smooth_step((at.y - upper) / LID_FOLD);
    LID_TRAVEL * share * (elevation(upper) - elevation(lower))
}

/// −1 on the right, +1 on the left, smooth in the middle.
fn side(s: f64) -> f64 {
    (s / 10.0).tanh()
}

fn smile(half: f64, s: f64, t: f64) -> Vector3<f64> {
    let corner = hill((s.abs() - half) / 18.0, (t - mouth_line(s)) / 14.0);
    let cheek = hill((s.abs() - 38.0) / 14.0, (t + 2.0) / 12.0);
    Vector3::new(6.0 * side(s), 5.0, -3.5) * corner + Vector3::new(1.5 * side(s), 2.5, 2.0) * cheek
}

fn brow_raise(s: f64, t: f64) -> Vector3<f64> {
    let reach = if t > 56.0 { 16.0 } else { 7.0 };
    Vector3::new(0.0, 8.0, 1.0) * hill((s.abs() - 26.0) / 22.0, (t - 56.0) / reach)
}

fn pucker(half: f64, s: f64, t: f64) -> Vector3<f64> {
    let above = t - mouth_line(s);
    let corner = hill((s.abs() - half) / 14.0, above / 13.0);
    Vector3::new(-7.0 * side(s) * corner, 0.0, 6.0 * hill(s / 18.0, above / 11.0))
}

fn frown(s: f64, t: f64) -> Vector3<f64> {
    let brow = hill((s.abs() - 22.0) / 12.0, (t - 55.0) / 9.0);
    Vector3::new(-3.5 * side(s) * brow, -4.0 * brow, 1.0 * bump(s / 9.0) * bump((t - 54.0) / 9.0))
}

/// Where the marker of a lid sits.
pub(crate) fn lid_point(person: &Person, side: f64, upper: bool) -> Point2<f64> {
    let s = eye_center(person, side).x + 0.05 * EYE_HALF_WIDTH;
    let (low, high) = lid_edges(person, side, s).unwrap_or((0.0, 0.0));
    Point2::new(s, if upper { high + 2.5 } else { low - 3.0 })
}
