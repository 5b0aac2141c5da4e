//! The contours of the domain: the rim, the almonds of the eyes, the slit of the mouth.

use crate::body::face::person::Person;
use crate::body::face::profile::bump;
use nalgebra::Point2;

/// Half the width of an eye opening, mm.
pub(crate) const EYE_HALF_WIDTH: f64 = 14.0;
/// Half the height of the mouth opening at rest, mm.
pub(crate) const MOUTH_HALF_HEIGHT: f64 = 0.6;
const UPPER_LID: f64 = 5.4;
const LOWER_LID: f64 = 4.0;

/// The middle of an eye opening; `side` is +1 for the subject's left.
pub(crate) fn eye_center(person: &Person, side: f64) -> Point2<f64> {
    Point2::new(side * (33.0 + person.eye_spacing), 36.0)
}

/// t of the closed mouth line.
pub(crate) fn mouth_line(s: f64) -> f64 {
    -28.5 - 0.9 * bump(s / 5.0) + 0.7 * bump((s.abs() - 12.0) / 6.0) + 1.5 * bump(s / 18.0)
}

/// t of the edges of an eye opening (lower lid, upper lid) at s; `None` beyond its corners.
pub(crate) fn lid_edges(person: &Person, side: f64, s: f64) -> Option<(f64, f64)> {
    let center = eye_center(person, side);
    let u = side * (s - center.x) / EYE_HALF_WIDTH;
    // The corners themselves belong to the opening, rounding or not.
    if u.abs() > 1.0 + 1e-9 {
        return None;
    }
    let axis = center.y + person.eye_tilt * EYE_HALF_WIDTH * u;
    let arch = (1.0 - u * u).max(0.0);
    Some((axis - LOWER_LID * arch * (1.0 + 0.18 * u), axis + UPPER_LID * arch.powf(0.85) * (1.0 - 0.15 * u)))
}

/// A closed contour as a function of a parameter from 0 to 1.
pub(crate) enum Contour {
    Rim,
    Eye(f64),
    Mouth,
}

impl Contour {
    pub(crate) const ALL: [Self; 4] = [Self::Rim, Self::Eye(1.0), Self::Eye(-1.0), Self::Mouth];

    /// The point at parameter `u`, counter-clockwise; corners of eyes and mouth are at u = 0 and u = ½.
    pub(crate) fn at(&self, person: &Person, u: f64) -> Point2<f64> {
        let turn = std::f64::consts::TAU * u;
        match self {
            Self::Rim => rim(turn),
            Self::Eye(side) => {
                let s = eye_center(person, *side).x + EYE_HALF_WIDTH * turn.cos().clamp(-1.0, 1.0);
                let t = lid_edges(person, *side, s)
                    .map_or(0.0, |(lower, upper)| if turn.sin() >= 0.0 { upper } else { lower });
                Point2::new(s, t)
            }
            Self::Mouth => {
                let s = person.mouth_half_width * turn.cos();
                let open = MOUTH_HALF_HEIGHT * turn.sin().abs().powi(2) * turn.sin().signum();
                Point2::new(s, mouth_line(s) + open)
            }
        }
    }

    /// Parameters that must be vertices: the corners.
    pub(crate) fn corners(&self) -> &'static [f64] {
        match self {
            Self::Rim => &[0.0],
            _ => &[0.0, 0.5],
        }
    }
}

/// A rounded outline: hair line above, under the jaw below.
fn rim(turn: f64) -> Point2<f64> {
    let (cos, sin) = (turn.cos(), turn.sin());
    let (height, exponent) = if sin > 0.0 { (100.0, 2.5) } else { (107.0, 2.7) };
    let round = |x: f64| x.signum() * x.abs().powf(2.0 / exponent);
    Point2::new(95.0 * round(cos), 15.0 + height * round(sin))
}

/// Which part of the face a point of the domain belongs to, for groups and marker names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Region {
    Skin,
    Nose,
    LidsLeft,
    LidsRight,
    LipUpper,
    LipLower,
}

impl Region {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Skin => "skin",
            Self::Nose => "nose",
            Self::LidsLeft => "lids_l",
            Self::LidsRight => "lids_r",
            Self::LipUpper => "lip_upper",
            Self::LipLower => "lip_lower",
        }
    }

    pub(crate) fn of(person: &Person, at: Point2<f64>) -> Self {
        let side = at.x.signum();
        let eye = at - eye_center(person, side);
        let above = at.y - mouth_line(at.x);
        if (eye.x / 18.0).hypot(eye.y / 10.0) < 1.0 {
            return if side > 0.0 { Self::LidsLeft } else { Self::LidsRight };
        }
        if at.x.abs() < person.mouth_half_width + 3.0 && (-11.0..9.0).contains(&above) {
            return if above > 0.0 { Self::LipUpper } else { Self::LipLower };
        }
        let nose_half = 21.0 - 0.28 * (at.y - 2.0).max(0.0);
        if at.x.abs() < nose_half && (-8.0..46.0).contains(&at.y) {
            return Self::Nose;
        }
        Self::Skin
    }
}
