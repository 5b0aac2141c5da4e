//! What landmarks missed: a dense, smooth displacement between the neutral photograph and the warped expression.
//!
//! Both are compared as high-passed log-light, which exposure does not change, from coarse to fine by least squares under a
//! Gaussian window [LucasKanade1981]. A wrinkle is darker in one of them and nowhere to be found in the other: a robust weight
//! leaves it out, and the window is wider than it.

use crate::blur::{blurred, doubled, halved};
use crate::plane::{Plane, median};
use crate::warp::Field;

/// Window, io.
const WINDOW_IO: f64 = 0.06;
/// Smoothness of the displacement, io.
const SMOOTH_IO: f64 = 0.03;
/// No displacement is longer, io.
const CAP_IO: f64 = 0.05;
/// Structures coarser than this are light, not skin, io.
const HIGH_PASS_IO: f64 = 0.05;
/// The finest pictures compared have no more pixels between the pupils than this.
const FINEST_IO_PX: f64 = 260.0;
/// Finer changes are pores, io.
const WRINKLE_IO: f64 = 0.012;
const LEVELS: usize = 3;
const STEPS: usize = 4;
/// A window counts the less, the less structure it has beside the usual one.
const STIFFNESS: f64 = 0.3;

/// How far the neutral photograph's pixels lie from where the warp looks for them.
#[derive(Debug, Clone)]
pub struct Refined {
    /// The warp, corrected.
    pub field: Field,
    /// Median length of the correction over the region, px.
    pub median_px: f64,
}

/// Corrects a warp so that structures of the skin agree.
///
/// `neutral`, `expression`: log-light, #px; `weight`: how much each pixel of the neutral one counts.
#[must_use]
pub fn refined(field: &Field, neutral: &Plane, expression: &Plane, weight: &Plane, io: f64) -> Refined {
    let warped = field.fetch(expression);
    let weight = &steady(neutral, &warped, weight, io);
    let mut levels =
        vec![(structure(neutral, weight, io), structure(&warped, weight, io), weight.clone(), io)];
    while levels.len() < LEVELS || levels.last().is_some_and(|level| level.3 > FINEST_IO_PX) {
        let Some((a, b, weight, io)) = levels.last() else { break };
        if a.width.min(a.height) < 48 {
            break;
        }
        levels.push((halved(a), halved(b), halved(weight), io / 2.0));
    }
    let mut shift: Option<[Plane; 2]> = None;
    for (a, b, weight, io) in levels.iter().rev() {
        let mut here = match shift.take() {
            None => [Plane::filled(a.width, a.height, 0.0), Plane::filled(a.width, a.height, 0.0)],
            Some(coarse) => coarse.map(|plane| doubled(&plane, a.width, a.height).map(|value| 2.0 * value)),
        };
        if *io <= FINEST_IO_PX {
            (0..STEPS).for_each(|_| step(&mut here, [a, b], weight, *io));
        }
        shift = Some(here);
    }
    let [dx, dy] = shift.unwrap_or_else(|| [neutral.map(|_| 0.0), neutral.map(|_| 0.0)]);
    let lengths = dx.with(&dy, f64::hypot);
    let counted = lengths.values.iter().zip(&weight.values).filter(|(_, weight)| **weight > 0.5);
    let median_px = median(counted.map(|(length, _)| length));
    // The displacement leads from a pixel to another pixel of the warped picture: the warp is looked up there.
    let look = |plane: &Plane| {
        Plane::from_fn(plane.width, plane.height, |column, row| {
            plane.bilinear(column as f64 + dx.at(column, row), row as f64 + dy.at(column, row))
        })
    };
    Refined { field: Field { x: look(&field.x), y: look(&field.y) }, median_px }
}

/// Log-light without its slow changes, faded where it does not count.
fn structure(plane: &Plane, weight: &Plane, io: f64) -> Plane {
    let slow = crate::blur::weighted(plane, weight, HIGH_PASS_IO * io);
    plane.with(&slow, |value, slow| value - slow).with(weight, |value, weight| value * weight)
}

/// The weight without wrinkles: places that became darker over more than a pore's width.
fn steady(neutral: &Plane, warped: &Plane, weight: &Plane, io: f64) -> Plane {
    let change = structure(&warped.with(neutral, |warped, neutral| warped - neutral), weight, io);
    let change = blurred(&change, WRINKLE_IO * io);
    let counted = change.values.iter().zip(&weight.values).filter(|(_, weight)| **weight > 0.5);
    let spread = 1.4826 * median(counted.map(|(value, _)| value.abs()).collect::<Vec<_>>().iter()) + 1e-9;
    let trust = change.map(|value| 1.0 / (1.0 + (value.min(0.0) / (2.0 * spread)).powi(4)));
    // A wrinkle's rims are changed too.
    let wide = blurred(&trust, 2.0 * WRINKLE_IO * io);
    weight.with(&wide, |weight, trust| weight * ((trust - 0.3) / 0.6).clamp(0.0, 1.0))
}

/// One step of least squares.
fn step(shift: &mut [Plane; 2], [a, b]: [&Plane; 2], weight: &Plane, io: f64) {
    let [dx, dy] = &*shift;
    let moved = Plane::from_fn(a.width, a.height, |column, row| {
        b.bilinear(column as f64 + dx.at(column, row), row as f64 + dy.at(column, row))
    });
    let difference = moved.with(a, |moved, a| moved - a);
    let noise = 1.4826 * median(difference.map(f64::abs).values.iter().filter(|value| **value > 0.0)) + 1e-6;
    let robust = difference.with(weight, |value, weight| weight / (1.0 + (value / (2.0 * noise)).powi(2)));
    let [gx, gy] = a.with(&moved, |a, moved| 0.5 * (a + moved)).gradient();
    let window = |one: &Plane, other: &Plane| {
        let product = one.with(other, |one, other| one * other).with(&robust, |value, weight| value * weight);
        blurred(&product, WINDOW_IO * io)
    };
    let [xx, xy, yy] = [window(&gx, &gx), window(&gx, &gy), window(&gy, &gy)];
    let [xt, yt] = [window(&gx, &difference), window(&gy, &difference)];
    let stiff = STIFFNESS * median(xx.with(&yy, |x, y| 0.5 * (x + y)).values.iter()) + 1e-12;
    let solve = |axis: usize| {
        Plane::from_fn(a.width, a.height, |column, row| {
            let value = |plane: &Plane| plane.at(column, row);
            let (p, q, r) = (value(&xx) + stiff, value(&xy), value(&yy) + stiff);
            let (s, t) = (value(&xt), value(&yt));
            let change = if axis == 0 { r * s - q * t } else { p * t - q * s };
            value(&shift[axis]) - change / (p * r - q * q)
        })
    };
    let next = [solve(0), solve(1)].map(|plane| blurred(&plane, SMOOTH_IO * io));
    let cap = CAP_IO * io;
    let long = next[0].with(&next[1], |x, y| (cap / x.hypot(y).max(1e-12)).min(1.0));
    *shift = next.map(|plane| plane.with(&long, |value, part| value * part));
}
