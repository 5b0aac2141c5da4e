//! Muscles: displacement fields on the unrolled face, known everywhere, not only at vertices.
//!
//! Every field is given in the skin's own directions (around the head, up, out), so that the skin slides along the
//! head instead of leaving it. The jaw and the lids turn; all else is a sum. Weights run from 0 to 1.

use super::face::Person;
use super::face::outline::{eye_center, lid_edges, mouth_line};
use super::face::profile::{bump, hill, smooth_step, softplus};
use super::face::surface::{self, nasolabial_line};
use super::motion::{Offsets, Turn, pose};
use nalgebra::{Complex, Point2, Point3, Similarity3, Unit, Vector3};
use rayon::prelude::*;

/// What a face can do, in this order: left and right are the subject's.
///
/// `jaw_open` parts the lips by about 25 mm · `smile_*` pulls a corner of the mouth out and up against the cheek ·
/// `brow_raise_*` lifts a brow by 7 mm, the forehead gives way · `frown` draws the brows down and together ·
/// `blink_*` closes an eye · `squint` narrows both eyes and gathers the skin beside them · `nose_wrinkle` draws the
/// sides of the nose up · `pucker` brings the lips forward and together · `lips_funnel` parts and rounds them (“oh”) ·
/// `lips_press` rolls them in (“m”) · `mouth_stretch` pulls the corners out and down (“ee”).
pub const MUSCLES: [&str; 14] = [
    "jaw_open",
    "smile_l",
    "smile_r",
    "brow_raise_l",
    "brow_raise_r",
    "frown",
    "blink_l",
    "blink_r",
    "squint",
    "nose_wrinkle",
    "pucker",
    "lips_funnel",
    "lips_press",
    "mouth_stretch",
];
const JAW: usize = 0;
const BLINKS: [(usize, f64); 2] = [(6, 1.0), (7, -1.0)];

const SQUINT: usize = 8;
/// Share of an eye's opening that a squint closes.
const SQUINT_SHARE: f64 = 0.45;

/// Rotation of the fully opened jaw, rad.
const JAW_ANGLE: f64 = 0.31;
/// Where the jaw turns: the axis through the joints before the ears, mm.
const JAW_AXIS: Point3<f64> = Point3::new(0.0, 18.0, -5.0);
/// How fast the jaw's motion fades above the mouth line.
const JAW_FADE: f64 = 1.9;
/// How far around the corners of the mouth its opening is blunted, as an opening of the crack.
const CORNER: f64 = 0.25;
/// Share of the lid's way that a blink goes: the lids do not pass through each other.
const LID_TRAVEL: f64 = 0.97;
/// Height over the edge of the lid that takes part in a blink, mm.
const LID_FOLD: f64 = 10.0;
/// Shorter displacements are none, mm.
const LEAST: f64 = 1e-4;
/// Smaller turns are none, rad.
const LEAST_TURN: f64 = 1e-6;

/// The fields at the vertices of a body.
#[derive(Debug, Clone)]
pub(super) struct Muscles {
    offsets: Vec<Offsets>,
    jaw: Turn,
    lids: [Turn; 2],
}

impl Muscles {
    /// The muscles of a person at points of the domain. `face_from_canonical` carries the person's space into the
    /// body's.
    pub(super) fn of(
        person: &Person,
        domain: &[Point2<f64>],
        face_from_canonical: &Similarity3<f64>,
    ) -> Self {
        let skin: Vec<[Vector3<f64>; 3]> =
            domain.par_iter().map(|&at| surface::directions(person, at)).collect();
        let field = |muscle: usize| {
            let by = |(at, [around, up, out]): (&Point2<f64>, &[Vector3<f64>; 3])| {
                let by = displacement(person, muscle, *at);
                face_from_canonical.transform_vector(&(around * by.x + up * by.y + out * by.z))
            };
            Offsets::of(&domain.par_iter().zip(&skin).map(by).collect::<Vec<_>>(), LEAST)
        };
        let axis = Unit::new_normalize(face_from_canonical.isometry.rotation * Vector3::x());
        let turn = |center: Point3<f64>, angle: &(dyn Fn(Point2<f64>) -> f64 + Sync)| {
            let angles: Vec<f64> = domain.par_iter().map(|&at| angle(at)).collect();
            Turn::of(face_from_canonical.transform_point(&center), axis, &angles, LEAST_TURN)
        };
        Self {
            offsets: (0..MUSCLES.len()).map(field).collect(),
            jaw: turn(JAW_AXIS, &|at| JAW_ANGLE * jaw_share(person.mouth_half_width, at)),
            lids: BLINKS.map(|(_, side)| {
                turn(surface::eyeball(person, side), &|at| {
                    if at.x * side > 0.0 { lid_angle(person, at) } else { 0.0 }
                })
            }),
        }
    }

    pub(super) fn pose(&self, rest: &[Point3<f64>], weights: &[f64]) -> Vec<Point3<f64>> {
        let weight = |muscle: usize| weights.get(muscle).copied().unwrap_or(0.0);
        let active = |muscle: &usize| weight(*muscle) != 0.0;
        let offsets: Vec<(&Offsets, f64)> =
            (0..MUSCLES.len()).filter(active).map(|muscle| (&self.offsets[muscle], weight(muscle))).collect();
        // Narrowed eyes have less to close.
        let open = 1.0 - SQUINT_SHARE * weight(SQUINT);
        let lids = BLINKS.iter().zip(&self.lids).map(|((muscle, _), lid)| (lid, open * weight(*muscle)));
        // The jaw last: it carries the moved lips with it.
        let turns: Vec<(&Turn, f64)> =
            lids.chain([(&self.jaw, weight(JAW))]).filter(|(_, weight)| *weight != 0.0).collect();
        pose(rest, &offsets, &turns)
    }
}

/// Displacement at full weight: around the head (to the subject's left), up, out, mm.
fn displacement(person: &Person, muscle: usize, at: Point2<f64>) -> Vector3<f64> {
    let (s, t, half) = (at.x, at.y, person.mouth_half_width);
    match MUSCLES[muscle] {
        "jaw_open" => narrowing(half, s, t),
        "smile_l" => smile(half, 1.0, s, t),
        "smile_r" => smile(half, -1.0, s, t),
        "brow_raise_l" => brow_raise(1.0, s, t),
        "brow_raise_r" => brow_raise(-1.0, s, t),
        "frown" => frown(s, t),
        "squint" => squint(person, s, t),
        "nose_wrinkle" => nose_wrinkle(s, t),
        "pucker" => pucker(half, s, t),
        "lips_funnel" => lips_funnel(half, s, t),
        "lips_press" => lips_press(half, s, t),
        "mouth_stretch" => mouth_stretch(half, s, t),
        _ => Vector3::zeros(),
    }
}

/// Share in the jaw's motion: nearly 1 on the lower lip, nearly 0 on the upper one, smooth beside the mouth; the neck
/// and the ears stay.
fn jaw_share(half: f64, at: Point2<f64>) -> f64 {
    let still = smooth_step((at.x.abs() - 80.0) / 70.0).max(smooth_step((-95.0 - at.y) / 55.0));
    let opening = crack(half, at.x, at.y);
    // Blunted at the corners, where a crack opens infinitely fast and skin does not.
    let corner = hill((at.x.abs() - half) / 6.0, (at.y - mouth_line(at.x)) / 8.0);
    let blunt = opening * opening.abs() / (opening.abs() + CORNER * corner).max(f64::MIN_POSITIVE);
    (0.5 - 0.5 * (JAW_FADE * blunt).tanh()) * (1.0 - still)
}

/// The imaginary part of √(z² − a²) is the opening of a crack of half-length a under tension: it jumps across the
/// slit of the mouth and nowhere else, and grows steadily away from it, so that no triangle turns over.
fn crack(half: f64, s: f64, t: f64) -> f64 {
    let z = Complex::new(s, t - mouth_line(s)) / half;
    ((z - 1.0).sqrt() * (z + 1.0).sqrt()).im
}

/// +1 on the upper lip, −1 on the lower one, smooth around the corners.
fn lip_side(half: f64, s: f64, t: f64) -> f64 {
    (3.0 * crack(half, s, t)).tanh()
}

/// The rotation that brings a point of the upper lid down with its edge.
fn lid_angle(person: &Person, at: Point2<f64>) -> f64 {
    let side = at.x.signum();
    let Some((lower, upper)) = lid_edges(person, side, at.x) else { return 0.0 };
    if at.y < 0.5 * (lower + upper) || at.y > upper + LID_FOLD {
        return 0.0;
    }
    let center = surface::eyeball(person, side);
    let elevation = |t: f64| {
        let point = surface::point(person, Point2::new(at.x, t)) - center;
        point.y.atan2(point.z)
    };
    let share = 1.0 - smooth_step((at.y - upper) / LID_FOLD);
    LID_TRAVEL * share * (elevation(upper) - elevation(lower))
}

/// −1 on the right, +1 on the left, smooth in the middle.
fn side_of(s: f64) -> f64 {
    (s / 10.0).tanh()
}

/// 1 on one side (+1: the left), 0 on the other, smooth in the middle; both sides add up to 1.
fn own_side(side: f64, s: f64) -> f64 {
    0.5 + 0.5 * side_of(side * s)
}

/// 0 below `low`, then rising with slope 1, constant above `high`, bends rounded over `round` mm.
fn ramp(t: f64, low: f64, high: f64, round: f64) -> f64 {
    round * (softplus((t - low) / round) - softplus((t - high) / round))
}

/// 1 around the middle, falling off steeply beyond `half`.
fn plateau(x: f64, half: f64) -> f64 {
    (-(x / half).powi(4)).exp()
}

/// The corners of an open mouth come in.
fn narrowing(half: f64, s: f64, t: f64) -> Vector3<f64> {
    let corner = hill((s.abs() - half) / 12.0, (t - mouth_line(s)) / 14.0);
    Vector3::x() * (-3.5 * side_of(s) * corner)
}

fn smile(half: f64, side: f64, s: f64, t: f64) -> Vector3<f64> {
    let x = side * s;
    let corner = hill((x - half) / 25.0, (t - mouth_line(s)) / 17.0);
    let cheek = hill((x - 45.0) / 15.0, (t - 4.0) / 14.0);
    // The skin inside the nasolabial line is pushed against the cheek.
    let past = x - nasolabial_line(t);
    let push = 0.13 * (10.0 - ramp(past, -10.0, 10.0, 2.5)) * smooth_step((x - 2.0) / 16.0);
    let along = smooth_step((t + 26.0) / 22.0) * smooth_step((16.0 - t) / 16.0);
    own_side(side, s) * Vector3::new(4.6 * side, 4.6, -2.5) * corner
        + Vector3::new(0.4 * side, 1.6, 2.2) * cheek
        + Vector3::new(0.8 * side, 0.6, 0.0) * (push * along)
}

fn brow_raise(side: f64, s: f64, t: f64) -> Vector3<f64> {
    let above = 0.175 * (39.0 - ramp(t, 61.0, 100.0, 2.5));
    let lid = smooth_step((t - 39.0) / 20.0);
    let out = 1.0 - smooth_step((side * s - 36.0) / 38.0);
    Vector3::y() * (above * lid * out * own_side(side, s))
}

fn frown(s: f64, t: f64) -> Vector3<f64> {
    let together = -0.20 * s * bump(s / 28.0) * plateau(t - 57.0, 16.0);
    let down = -4.0 * (bump((s - 18.0) / 11.0) + bump((s + 18.0) / 11.0)) * bump((t - 56.0) / 8.5);
    Vector3::new(together, down, 0.0)
}

fn squint(person: &Person, s: f64, t: f64) -> Vector3<f64> {
    let side = s.signum();
    let eye = eye_center(person, side);
    let outside = smooth_step((s.abs() - 44.0) / 12.0) * (1.0 - smooth_step((s.abs() - 70.0) / 25.0));
    let gather = -0.2 * (t - 35.0) * bump((t - 35.0) / 20.0) * outside;
    let at_eye = bump((s - eye.x) / 11.0) * bump((t - eye.y) / 9.0);
    let lids = -2.2 * (0.35 * (t - eye.y)).tanh() * at_eye;
    let cheek = 2.5 * hill((s.abs() - 42.0) / 16.0, (t - 8.0) / 12.0);
    // Out as well: the lids slide over the ball.
    Vector3::new(0.0, gather + lids + cheek, 0.5 * cheek + 0.6 * at_eye)
}

fn nose_wrinkle(s: f64, t: f64) -> Vector3<f64> {
    let up = 0.14 * (25.0 - ramp(t, 12.0, 37.0, 2.0));
    let below = smooth_step((t + 30.0) / 32.0);
    let brows = -2.0 * (bump((s - 16.0) / 11.0) + bump((s + 16.0) / 11.0)) * bump((t - 52.0) / 9.0);
    Vector3::new(0.0, up * below * plateau(s, 24.0) + brows, 0.0)
}

fn pucker(half: f64, s: f64, t: f64) -> Vector3<f64> {
    let above = t - mouth_line(s);
    let corner = hill((s.abs() - half) / 14.0, above / 13.0);
    Vector3::new(-7.0 * side_of(s) * corner, 0.0, 6.0 * hill(s / 18.0, above / 11.0))
}

fn lips_funnel(half: f64, s: f64, t: f64) -> Vector3<f64> {
    let above = t - mouth_line(s);
    let corner = hill((s.abs() - half) / 14.0, above / 13.0);
    let lips = hill(s / 17.0, above / 12.0);
    Vector3::new(-4.5 * side_of(s) * corner, 3.0 * lip_side(half, s, t) * lips, 4.5 * lips)
}

fn lips_press(half: f64, s: f64, t: f64) -> Vector3<f64> {
    let above = t - mouth_line(s);
    let lips = hill(s / (0.8 * half), above / 7.0);
    Vector3::new(0.0, -0.5 * lip_side(half, s, t) * lips, -2.0 * lips)
}

fn mouth_stretch(half: f64, s: f64, t: f64) -> Vector3<f64> {
    let corner = hill((s.abs() - half - 3.0) / 16.0, (t - mouth_line(s)) / 13.0);
    Vector3::new(5.5 * side_of(s), -2.0, -1.5) * corner
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    /// Strain of the skin at `at` along the direction `along` of the domain, negative where it is compressed.
    fn strain(person: &Person, active: &[&str], at: Point2<f64>, along: Vector2<f64>) -> f64 {
        const STEP: f64 = 0.05;
        let ends = [at - along * STEP, at + along * STEP];
        let muscles = Muscles::of(person, &ends, &Similarity3::identity());
        let weights: Vec<f64> = MUSCLES.map(|name| f64::from(u8::from(active.contains(&name)))).to_vec();
        let rest = ends.map(|end| surface::point(person, end));
        let posed = muscles.pose(&rest, &weights);
        (posed[1] - posed[0]).norm() / (rest[1] - rest[0]).norm() - 1.0
    }

    /// Asserts that the strain is between `most` and `least` compression at all places.
    fn assert_compressed(
        active: &[&str],
        places: impl Iterator<Item = (f64, f64)>,
        along: impl Fn(f64) -> Vector2<f64>,
        range: std::ops::RangeInclusive<f64>,
    ) {
        let person = Person::of_seed(0);
        for (s, t) in places {
            let compression = -strain(&person, active, Point2::new(s, t), along(t));
            assert!(range.contains(&compression), "{active:?} at {s:.0}, {t}: {compression:.3}");
        }
    }

    fn grid(across: &[f64], up: &[f64]) -> impl Iterator<Item = (f64, f64)> {
        up.iter().flat_map(move |&t| across.iter().map(move |&s| (s, t)))
    }

    #[test]
    fn raised_brows_compress_the_forehead_upwards() {
        let places = grid(&[-35., -20., 0., 10., 30.], &[65., 70., 80., 90., 95.]);
        assert_compressed(&["brow_raise_l", "brow_raise_r"], places, |_| Vector2::y(), 0.10..=0.20);
    }

    #[test]
    fn a_frown_compresses_the_glabella_sideways() {
        let places = grid(&[-9., -4., 0., 7.], &[48., 54., 60., 66.]);
        assert_compressed(&["frown"], places, |_| Vector2::x(), 0.10..=0.21);
    }

    #[test]
    fn a_squint_compresses_the_skin_beside_the_eyes() {
        let places = grid(&[-65., -58., 58., 62., 70.], &[25., 30., 40., 45.]);
        assert_compressed(&["squint"], places, |_| Vector2::y(), 0.10..=0.25);
    }

    #[test]
    fn a_smile_compresses_across_the_nasolabial_line() {
        let across = |t: f64| {
            let slope = (nasolabial_line(t + 0.1) - nasolabial_line(t - 0.1)) / 0.2;
            Vector2::new(1.0, -slope).normalize()
        };
        let places = [-30., -24., -18., -12., -6., 0.].map(|t| (nasolabial_line(t), t));
        assert_compressed(&["smile_l"], places.into_iter(), across, 0.08..=0.20);
    }

    #[test]
    fn the_left_half_of_the_average_face_mirrors_the_right_one() {
        let person = Person::of_seed(0);
        let mirrored = |vector: Vector3<f64>| Vector3::new(-vector.x, vector.y, vector.z);
        let opposite = |name: &str| match name.rsplit_once('_') {
            Some((stem, "l")) => format!("{stem}_r"),
            Some((stem, "r")) => format!("{stem}_l"),
            _ => name.to_string(),
        };
        let domain: Vec<Point2<f64>> = grid(&[3., 15., 33., 60.], &[-60., -30., 0., 37., 55., 80.])
            .flat_map(|(s, t)| [Point2::new(s, t), Point2::new(-s, t)])
            .collect();
        let rest: Vec<Point3<f64>> = domain.iter().map(|&at| surface::point(&person, at)).collect();
        let muscles = Muscles::of(&person, &domain, &Similarity3::identity());
        let alone = |name: &str| {
            let weights = MUSCLES.map(|other| f64::from(u8::from(other == name)));
            muscles.pose(&rest, &weights)
        };
        for name in MUSCLES {
            let (posed, other) = (alone(name), alone(&opposite(name)));
            for pair in (0..rest.len()).step_by(2) {
                let left = posed[pair] - rest[pair];
                let right = other[pair + 1] - rest[pair + 1];
                assert!((left - mirrored(right)).norm() < 1e-9, "{name} at {}", domain[pair]);
            }
        }
    }

    #[test]
    fn muscles_move_with_the_space_they_are_carried_into() {
        let person = Person::of_seed(0);
        let domain: Vec<Point2<f64>> =
            grid(&[-40., 2., 30.], &[-40., 0., 42., 70.]).map(|(s, t)| Point2::new(s, t)).collect();
        let rest: Vec<Point3<f64>> = domain.iter().map(|&at| surface::point(&person, at)).collect();
        let carry = Similarity3::new(Vector3::new(10., -3., 7.), Vector3::new(0.2, -0.4, 0.1), 1.1);
        let weights = [0.7; MUSCLES.len()];
        let here = Muscles::of(&person, &domain, &Similarity3::identity()).pose(&rest, &weights);
        let carried: Vec<Point3<f64>> = rest.iter().map(|point| carry * point).collect();
        let there = Muscles::of(&person, &domain, &carry).pose(&carried, &weights);
        for (here, there) in here.iter().zip(&there) {
            // Both leave out what is shorter than a ten-thousandth of a millimetre, each in its own scale.
            assert!((carry * here - there).norm() < 1e-3);
        }
    }
}
