//! The look of skin: how much light each point of it returns, and its pores.

use crate::body::face::noise::noise;
use crate::body::face::outline::{eye_center, lid_edges, lip_edges, mouth_line};
use crate::body::face::person::Person;
use crate::body::face::profile::{bump, hill, smooth_step};
use nalgebra::Point2;

/// Reflectance with little, middling and much melanin, linear RGB.
const TONES: [[f64; 3]; 3] = [[0.58, 0.40, 0.32], [0.43, 0.265, 0.18], [0.155, 0.085, 0.055]];
/// What more blood does to a reflectance.
const BLOOD: [f64; 3] = [0.95, 0.74, 0.76];
const LIP: [f64; 3] = [0.80, 0.52, 0.53];
const HAIR: [f64; 3] = [0.055, 0.038, 0.028];

/// Linear RGB reflectance of a point of the face.
pub(crate) fn albedo(person: &Person, at: Point2<f64>) -> [f32; 3] {
    let (s, t) = (at.x, at.y);
    let seed = person.seed;
    let blotches = noise(seed, s / 9.0, t / 9.0) + 0.6 * noise(seed ^ 1, s / 3.7, t / 3.7);
    let grain = 0.6 * noise(seed ^ 2, s / 1.1, t / 1.1) + 0.5 * noise(seed ^ 3, s / 0.45, t / 0.45);
    let blood = blood(s, t) + 0.12 * blotches;
    let light = 1.0 + 0.045 * grain - 0.10 * pore(person, at) - shadow(person, s, t);
    let mut color = tone(person.melanin);
    for channel in 0..3 {
        color[channel] *= light * BLOOD[channel].powf(blood);
    }
    let lip = lip_share(person, s, t);
    let stripes = 1.0 + 0.07 * noise(seed ^ 4, s / 0.7, t / 5.0);
    let hair = brow(person, s, t);
    let lash = lash(person, at);
    std::array::from_fn(|channel| {
        let skin = color[channel] * (1.0 + lip * (LIP[channel] * stripes - 1.0));
        let haired = skin + (HAIR[channel] - skin) * hair;
        (haired * (1.0 - 0.65 * lash)) as f32
    })
}

/// Reflectance of the bare skin.
pub(crate) fn tone(melanin: f64) -> [f64; 3] {
    let (low, share) = if melanin < 0.5 { (0, 2.0 * melanin) } else { (1, 2.0 * melanin - 1.0) };
    // Pigment multiplies: mean the logarithms.
    std::array::from_fn(|channel| TONES[low][channel].powf(1.0 - share) * TONES[low + 1][channel].powf(share))
}

/// Openings of pores, 0 to 1, in a band of 0.3 to 0.8 mm.
pub(crate) fn pore(person: &Person, at: Point2<f64>) -> f64 {
    let wave = |size: f64, salt: u64| noise(person.seed ^ salt, at.x / size, at.y / size);
    let rough = 0.6 * wave(0.8, 11) + 0.4 * wave(0.4, 12);
    smooth_step((rough - 0.05) / 0.6)
}

/// Where skin is redder: cheeks, nose, chin, around the eyes.
fn blood(s: f64, t: f64) -> f64 {
    0.45 * hill((s.abs() - 40.0) / 17.0, (t - 6.0) / 13.0)
        + 0.55 * hill(s / 12.0, (t - 4.0) / 9.0)
        + 0.3 * hill(s / 16.0, (t + 60.0) / 10.0)
        + 0.4 * hill((s.abs() - 30.0) / 15.0, (t - 34.0) / 9.0)
        - 0.15 * smooth_step((t - 58.0) / 30.0)
}

/// How much darker: rings under the eyes, and the shade of a beard.
fn shadow(person: &Person, s: f64, t: f64) -> f64 {
    let eye = eye_center(person, s.signum());
    let above = (t - mouth_line(s)) / 12.0;
    let cheeks = smooth_step((s.abs() - 26.0) / 30.0) * smooth_step((t + 12.0) / 14.0);
    let grown = smooth_step((4.0 - t) / 16.0) * (1.0 - hill(s / 24.0, above)) * (1.0 - cheeks);
    let stubble = 1.0 + 0.5 * noise(person.seed ^ 5, s / 0.6, t / 0.6);
    0.08 * hill((s - eye.x) / 13.0, (t - eye.y + 9.0) / 4.0) + person.beard * grown * stubble
}

fn lip_share(person: &Person, s: f64, t: f64) -> f64 {
    let (low, high) = lip_edges(person, s);
    let above = t - mouth_line(s);
    let inside = smooth_step((above - low + 0.7) / 1.4) * smooth_step((high + 0.7 - above) / 1.4);
    inside * smooth_step((person.mouth_half_width + 1.0 - s.abs()) / 2.5)
}

/// How densely hair covers a point of the brows: strands that rise outwards.
fn brow(person: &Person, s: f64, t: f64) -> f64 {
    let x = s.abs();
    let along = (x - 12.0) / 39.0;
    let line =
        53.5 + person.brow_height + 5.0 * bump((x - 36.0) / 12.0) - 4.0 * smooth_step((x - 40.0) / 14.0);
    let half = 5.2 - 3.0 * smooth_step(along);
    let across = (t - line) / half;
    let rise = 0.9 - 0.8 * along;
    let strand = noise(person.seed ^ 6, (t - rise * x) / 0.55 + 500.0 * s.signum(), (x + rise * t) / 5.0);
    let ends = smooth_step((x - 9.0) / 7.0) * smooth_step((53.0 - x) / 9.0);
    let body = (1.0 - smooth_step((across.abs() - 0.35) / 0.85)) * ends;
    (body * (0.85 + 0.55 * strand)).clamp(0.0, 0.92)
}

/// The dark edge of the upper lid, weaker of the lower one.
fn lash(person: &Person, at: Point2<f64>) -> f64 {
    let Some((lower, upper)) = lid_edges(person, at.x.signum(), at.x) else { return 0.0 };
    if at.y > 0.5 * (lower + upper) { bump((at.y - upper) / 0.8) } else { 0.45 * bump((at.y - lower) / 0.6) }
}
