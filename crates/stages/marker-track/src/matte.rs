//! How much of each pixel around a dot is paint.

use crate::center::Part;
use crate::paint::{Paint, median};
use nalgebra::{Matrix3, Vector3};

/// Fewer pixels around are no surroundings.
const FEWEST: usize = 12;
/// Surroundings are between these shares of their middle light; the rest is background, gleam, holes.
const LIGHT: [f64; 2] = [0.3, 3.0];
/// What stands out of the mixtures of skin and paint by so many times the usual amount, and by this share of the paint's own
/// brightness, is foreign.
const FOREIGN_NOISE: f64 = 4.0;
const FOREIGN: f64 = 0.05;
/// Fewer foreign pixels are noise.
const FOREIGN_PIXELS: usize = 3;
/// What stands out by this share of what stands out most is foreign through and through, no mixture.
const PURE: f64 = 0.7;
/// Hues are alike within 7°, cosine.
const ALIKE: f64 = 0.9925;
/// Residuals beyond this many middle ones are left out of the planes.
const OUTLIER: f64 = 4.0;
/// Light across a dot changes by this much against its middle; what changes more is no light, but a border.
const LIGHT_CHANGE: [f64; 2] = [0.87, 1.15];

/// What surrounds a dot, and what follows for the measure of cover.
///
/// With the colour s around and the paint's colour b, the direction w = b − (b·ŝ) ŝ answers to paint only, since w·s = 0
/// whatever the light. A foreign colour v, a wrinkle's paint, the white of an eye, also stands out along n = s × b, where
/// neither skin nor paint do; so what it adds to w follows from what is found along n, by a slope learnt from the pixels
/// around: one for each side of the plane of skin and paint. What remains on bare skin is a plane, and so is the light.
pub(crate) struct Surroundings {
    across: Vector3<f64>,
    out: Vector3<f64>,
    /// Foreign cover along w per foreign light along n, below and above.
    slopes: [f64; 2],
    bare: Vector3<f64>,
    light: Vector3<f64>,
    /// What full cover gives.
    full: f64,
}

/// A pixel around: x, y, along w, along n, along the skin's colour.
type Sample = [f64; 5];

impl Surroundings {
    /// `place` gives a pixel's place against the dot's middle. None where too little is seen around.
    pub(crate) fn of(
        parts: &[Part],
        colors: &[Vector3<f64>],
        place: impl Fn(usize) -> [f64; 2],
        paint: &Paint,
    ) -> Option<Self> {
        let mut ring: Vec<usize> = (0..parts.len()).filter(|&i| parts[i] == Part::Free).collect();
        let typical = median(&mut ring.iter().map(|&i| colors[i].sum()).collect::<Vec<_>>());
        ring.retain(|&i| (LIGHT[0] * typical..=LIGHT[1] * typical).contains(&colors[i].sum()));
        if ring.len() < FEWEST {
            return None;
        }
        let skin = prevailing(&ring, colors)?;
        let color = Vector3::from(paint.color);
        let across = color - color.dot(&skin) * skin;
        let out = skin.cross(&color).normalize();
        let sample = |&i: &usize| {
            let ([x, y], seen) = (place(i), &colors[i]);
            [x, y, across.dot(seen), out.dot(seen), skin.dot(seen)]
        };
        let samples: Vec<Sample> = ring.iter().map(sample).collect();
        let noise = median(&mut samples.iter().map(|s| s[3].abs()).collect::<Vec<_>>());
        let limit = (FOREIGN_NOISE * noise).min(0.5 * color.norm()).max(FOREIGN * color.norm());
        let own: Vec<Sample> = samples.iter().filter(|s| s[3].abs() <= limit).copied().collect();
        let [bare, light] = robust_planes(if own.len() < FEWEST { &samples } else { &own })?;
        let near: Vec<Sample> =
            (0..parts.len()).filter(|&i| parts[i] != Part::Other).map(|i| sample(&i)).collect();
        let slope = |above: bool| {
            let side = || near.iter().filter(|s| (s[3] > 0.0) == above);
            let purest = side().map(|s| s[3].abs()).fold(0.0, f64::max);
            let add = |(n, sum, square): (usize, f64, f64), s: &Sample| {
                let off = s[2] - bare.dot(&Vector3::new(1.0, s[0], s[1]));
                (n + 1, sum + off * s[3], square + s[3] * s[3])
            };
            let foreign = side().filter(|s| s[3].abs() > limit.max(PURE * purest));
            let (count, sum, square) = foreign.fold((0, 0.0, 0.0), add);
            if count < FOREIGN_PIXELS { 0.0 } else { sum / square }
        };
        let full = across.norm_squared();
        (full > 0.0).then_some(Self { across, out, slopes: [slope(false), slope(true)], bare, light, full })
    }

    /// The share of a pixel that is paint; x and y are against the middle. It may be a little below 0 or above 1.
    pub(crate) fn cover(&self, color: &Vector3<f64>, [x, y]: [f64; 2]) -> f64 {
        let at = Vector3::new(1.0, x, y);
        let light = (self.light.dot(&at) / self.light.x).clamp(LIGHT_CHANGE[0], LIGHT_CHANGE[1]);
        let out = self.out.dot(color);
        let foreign = out * self.slopes[usize::from(out > 0.0)];
        (self.across.dot(color) - self.bare.dot(&at) - foreign) / (light * self.full)
    }
}

/// The hue that prevails among some pixels, of unit length: that of the pixel nearest to the middle of all, and of those alike.
/// The middle itself may be a hue that nothing has, where two meet.
fn prevailing(ring: &[usize], colors: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    let middle = |c: usize| median(&mut ring.iter().map(|&i| colors[i][c]).collect::<Vec<_>>());
    let middle = Vector3::from_fn(|c, _| middle(c));
    let nearest = ring.iter().min_by(|&&a, &&b| {
        let [a, b] = [a, b].map(|i| (colors[i] - middle).norm_squared());
        a.total_cmp(&b)
    });
    let seed = colors[*nearest?].normalize();
    let alike = |color: &Vector3<f64>| seed.dot(color) > ALIKE * color.norm();
    let sum: Vector3<f64> = ring.iter().map(|&i| colors[i]).filter(|color| alike(color)).sum();
    (sum.norm() > 0.0).then(|| sum.normalize())
}

/// Planes 1, x, y through what is seen along w and along the skin's colour; samples off the first plane are left out in a
/// second round.
fn robust_planes(samples: &[Sample]) -> Option<[Vector3<f64>; 2]> {
    let planes = fit_planes(samples.iter())?;
    let residual = |s: &Sample| (s[2] - planes[0].dot(&Vector3::new(1.0, s[0], s[1]))).abs();
    let limit = OUTLIER * median(&mut samples.iter().map(residual).collect::<Vec<_>>());
    let kept: Vec<&Sample> = samples.iter().filter(|s| residual(s) <= limit).collect();
    let planes = if kept.len() < FEWEST { planes } else { fit_planes(kept.into_iter())? };
    (planes[1].x > 0.0).then_some(planes)
}

fn fit_planes<'a>(samples: impl Iterator<Item = &'a Sample>) -> Option<[Vector3<f64>; 2]> {
    let mut normal = Matrix3::zeros();
    let mut right = [Vector3::zeros(); 2];
    for [x, y, across, _, skin] in samples {
        let at = Vector3::new(1.0, *x, *y);
        normal += at * at.transpose();
        right[0] += *across * at;
        right[1] += *skin * at;
    }
    let inverse = normal.try_inverse()?;
    Some(right.map(|right| inverse * right))
}
